#include "cleave/geometry/flat_integrals.hpp"

#include <cstddef>

namespace cleave::geometry {
namespace {

/// Midpoint rule on a fan: exact for quadratic integrands, so for linear q and q x.
template <class Q>
Moments over_fan(const Convex& polygon, Q q) {
  Moments sum;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec3 a = polygon[0], b = polygon[i], c = polygon[i + 1];
    const double third = norm(cross(b - a, c - a)) / 6;
    for (const Vec3 x : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
      const double value = third * q(x);
      sum.total += value;
      sum.first += value * x;
    }
  }
  return sum;
}

}  // namespace

Convex clipped(const Convex& polygon, Vec3 normal, double offset) {
  Convex kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double da = offset - dot(normal, a), db = offset - dot(normal, b);
    if (da >= 0) kept.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back(a + (da / (da - db)) * (b - a));
  }
  return kept;
}

Moments integrate(const Convex& polygon, const LinearPressure& pressure) {
  return over_fan(clipped(polygon, pressure.up, pressure.level), [&](Vec3 x) { return pressure.at(x); });
}

Moments integrate(const Convex& polygon) {
  return over_fan(polygon, [](Vec3) { return 1.0; });
}

}  // namespace cleave::geometry
