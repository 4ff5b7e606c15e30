#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/bem/statics.hpp"

namespace cleave::bem::testing {

inline Material material(double young, double poisson, double density = 0, PlaneState state = PlaneState::strain) {
  return Material::make(pascals(young), poisson, kilograms_per_cubic_metre(density), state).value();
}

inline Material of_shear(double mu, double nu, double density = 0) { return material(2 * mu * (1 + nu), nu, density); }

/// Rectangle with one condition a side: bottom, right, top, left; element counts likewise.
inline Loop rectangle(Vec2 low, Vec2 high, std::array<std::size_t, 4> condition, std::array<std::size_t, 4> elements) {
  return {Side{.start = low, .condition = condition[0], .elements = elements[0]},
          Side{.start = {high.x, low.y}, .condition = condition[1], .elements = elements[1]},
          Side{.start = high, .condition = condition[2], .elements = elements[2]},
          Side{.start = {low.x, high.y}, .condition = condition[3], .elements = elements[3]}};
}

inline Sym2 turned_stress(double rr, double tt, Vec2 x) {
  const Vec2 g = x / norm(x);
  return {rr * g.x * g.x + tt * g.y * g.y, (rr - tt) * g.x * g.y, rr * g.y * g.y + tt * g.x * g.x};
}

inline double rate(double coarse, double fine) { return std::log2(coarse / fine); }

inline double largest(Sym2 s) { return std::max({std::abs(s.xx), std::abs(s.xy), std::abs(s.yy)}); }

}  // namespace cleave::bem::testing
