// A wedge on a slope.    Run: build/release/bin/example_02_wedge    You will see: how it moves and its factor of
// safety.
#include <cstdio>
#include <string>

#include "cleave/geometry/orientation.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

using namespace cleave;

int main() {
  const auto joint = [](double dip, double direction) {
    const geometry::Attitude attitude{Dip::degrees(dip), DipDirection::degrees(direction)};
    return topology::PersistentJoint{{0, 0, 0.5}, geometry::upward_normal(attitude)};
  };
  const topology::CutInput rock{.domain = geometry::make_box({-9, -9, -3}, {0, 9, 5}).value(),
                                .joints = {joint(60, 45), joint(60, 135)},
                                .excavations = {},
                                .free_domain_tags = {1, 5}};  // its east side and its top are free
  const auto blocks = topology::audit(topology::cut(rock).value()).value();
  const auto friction = stability::JointStrength::make(FrictionAngle::degrees(30)).value();
  const auto result =
      stability::analyse(blocks, {.rock = stability::RockMass::make(kilograms_per_cubic_metre(2700)).value(),
                                  .strengths = stability::StrengthTable{friction},
                                  .loads = stability::Loads::make({0, 0, -9.81}).value()});
  for (const stability::Judgement& block : result.judgements) {
    std::printf("%s along (%.6f, %.6f, %.6f), factor of safety %.9f\n", std::string{name(block.mode)}.c_str(),
                block.direction.x, block.direction.y, block.direction.z, block.factor_of_safety);
  }
}
