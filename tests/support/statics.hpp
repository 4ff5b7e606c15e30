#pragma once

/// Shorthand for tests of the stability analysis: strengths by joint number, unit density and gravity so that volume =
/// weight.

#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include "cleave/stability/analyse.hpp"

namespace cleave::statics {

inline stability::JointStrength strength(double friction_degrees, double cohesion = 0, double tension = 0) {
  return stability::JointStrength::make(FrictionAngle::degrees(friction_degrees), pascals(cohesion), pascals(tension))
      .value();
}

/// Strength of joints 0, 1, 2, ...; weight in N = volume in m3, straight down.
inline stability::Settings settings(std::initializer_list<stability::JointStrength> strengths,
                                    geometry::Vec3 seismic = {}) {
  stability::StrengthTable table{*strengths.begin()};
  std::uint32_t joint = 0;
  for (const auto& s : strengths) table.set(topology::JointId{joint++}, s);
  return {.rock = stability::RockMass::make(kilograms_per_cubic_metre(1)).value(),
          .strengths = table,
          .loads = stability::Loads::make({0, 0, -1}, seismic).value()};
}

inline const stability::Judgement* find(const stability::Analysis& analysis, topology::BlockId block) {
  for (const auto& judgement : analysis.judgements) {
    if (judgement.block == block) return &judgement;
  }
  return nullptr;
}

}  // namespace cleave::statics
