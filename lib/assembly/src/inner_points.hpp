#pragma once

#include <cstdint>
#include <vector>

#include "newton.hpp"

namespace cleave::assembly {

/// What is near a solution of the Coulomb problem from rest at strengths over a divisor, by interior points from no
/// forces: without a search along motion, so that motion is found that others do not come by.
struct Near {
  State state;
  double left = 1;  ///< products of force and opening along the path, of the largest load
};
/// How the path is followed.
struct Path {
  bool coupled = true;   ///< slip in the linearised system, else renewed from step to step
  double weight = 1e-9;  ///< of forces
};
/// `pressing`: by element; bonds marked 0 have no cohesion.
[[nodiscard]] Near by_inner_points(const Elements& elements, double divisor, const std::vector<std::uint8_t>& pressing,
                                   Path path);

}  // namespace cleave::assembly
