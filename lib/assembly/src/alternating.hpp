#pragma once

#include "newton.hpp"

namespace cleave::assembly {

/// The Coulomb problem from rest by alternating directions (Boyd et al. 2011), friction as an associated cone about the
/// slip of the last step (de Saxce 1992): what the bodies do under given forces is solved for all of them at once, so
/// that heavy blocks may rest on light ones; what contacts carry one by one. Goes on from `state`, which becomes what
/// was found when that violates less; true when by no more than `enough`.
[[nodiscard]] bool alternate(const Elements& elements, double divisor, double enough, State& state);

}  // namespace cleave::assembly
