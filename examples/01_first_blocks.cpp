// Cuts a box by three joints.    Run: build/release/bin/example_01_first_blocks    You will see: 8 blocks of 1 m3.
#include <cstdio>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

using namespace cleave;

int main() {
  const auto square = [](geometry::Vec3 centre, geometry::Vec3 u, geometry::Vec3 v) {
    return topology::Joint{
        {geometry::Polygon::make({centre - u - v, centre + u - v, centre + u + v, centre - u + v}).value()}};
  };
  const geometry::Vec3 middle{1, 1, 1}, x{1.5, 0, 0}, y{0, 1.5, 0}, z{0, 0, 1.5};
  const topology::CutInput scene{.domain = geometry::make_box({0, 0, 0}, {2, 2, 2}).value(),
                                 .joints = {square(middle, x, y), square(middle, y, z), square(middle, z, x)}};
  const auto blocks = topology::cut(scene);  // a value or a typed error, never an exception
  if (!blocks) return std::puts(describe(blocks.error()).c_str()), 1;
  const auto audited = topology::audit(*blocks);  // the only way to an AuditedComplex
  if (!audited) return std::puts("the certificate did not pass"), 1;
  for (const topology::Block& block : audited->complex().blocks()) {
    std::printf("%g m3, %u faces\n", block.volume.si(), block.counts.faces);
  }
  std::printf("volume residual %g\n", audited->certificate().volume_relative_error);
}
