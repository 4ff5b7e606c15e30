/// Cuts a box with three joints through its middle and checks the result: what a program of yours would do with the
/// installed library. Prints "8 blocks, 1000 m3".

#include <cstdio>
#include <utility>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

int main() {
  using namespace cleave;
  auto box = geometry::make_box({0, 0, 0}, {10, 10, 10});
  if (!box) return 1;
  topology::CutInput input{.domain = *std::move(box)};
  input.joints = {topology::PersistentJoint{.through = {5, 5, 5}, .normal = {1, 0, 0}},
                  topology::PersistentJoint{.through = {5, 5, 5}, .normal = {0, 1, 0}},
                  topology::PersistentJoint{.through = {5, 5, 5}, .normal = {0, 0, 1}}};
  auto blocks = topology::cut(input);
  if (!blocks) return 1;
  const auto audited = topology::audit(*std::move(blocks));
  if (!audited) return 1;
  const auto count = audited->complex().blocks().size();
  std::printf("%zu blocks, %g m3\n", count, audited->certificate().volume.si());
  return count == 8 ? 0 : 1;
}
