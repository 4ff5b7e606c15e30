// A random network, its blocks, and questions to them.    Run: build/release/bin/example_03_network
#include <cstdio>

#include "cleave/dfn/sample.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

using namespace cleave;

int main() {
  const auto set =
      dfn::JointSet::make({.orientation = dfn::FisherOrientation{Dip::degrees(60), DipDirection::degrees(90), 20},
                           .shape = dfn::Square{dfn::SizeLaw::constant(metres(8))},
                           .intensity = dfn::P32{1.5}});
  if (!set) return std::puts(describe(set.error()).c_str()), 1;
  topology::CutInput scene{.domain = geometry::make_box({0, 0, 0}, {10, 10, 10}).value()};
  const auto joints = dfn::sample(*set, 0, {{0, 0, 0}, {10, 10, 10}}, /*seed=*/1, /*realization=*/0);
  if (!joints) return std::puts(describe(joints.error()).c_str()), 1;
  for (const dfn::SampledJoint& joint : *joints) scene.joints.push_back(dfn::joint_of(joint));
  scene.joints.emplace_back(topology::PersistentJoint{{5, 5, 5}, {0, 0, 1}});

  auto blocks = topology::cut(scene);
  if (!blocks) return std::puts(describe(blocks.error()).c_str()), 1;
  const auto audited = topology::audit(*std::move(blocks));  // moved, not copied
  if (!audited) return std::puts(describe(audited.error()).c_str()), 1;

  const topology::BlockLocator locator{audited->complex()};
  const auto block = locator.block_at({5, 5, 9});
  if (!block) return 1;
  std::printf("block %u: %zu neighbours\n", block->value(), neighbours_of(audited->complex(), *block).size());

  const std::string bytes = saved(*audited);       // to keep, or for another process
  const auto again = topology::load_saved(bytes);  // audited anew: never an unchecked system
  if (!again) return std::puts(describe(again.error()).c_str()), 1;
  std::printf("%zu blocks, read back the same: %s\n", again->complex().blocks().size(),
              canonical_hash(again->complex()) == canonical_hash(audited->complex()) ? "yes" : "no");
}
