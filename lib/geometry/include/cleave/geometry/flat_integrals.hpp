#pragma once

#include <vector>

#include "cleave/geometry/vec3.hpp"

/// Integrals over flat convex polygons, exact for what is linear on them.
namespace cleave::geometry {

/// Corners of a convex polygon in order.
using Convex = std::vector<Vec3>;
/// The part of a convex polygon where normal.x <= offset.
[[nodiscard]] Convex clipped(const Convex& polygon, Vec3 normal, double offset);

/// Integral of a scalar q over an area, and of q x.
struct Moments {
  double total = 0;
  Vec3 first;
  Moments& operator+=(const Moments& other) noexcept {
    total += other.total;
    first += other.first;
    return *this;
  }
  friend Moments operator*(double s, const Moments& m) noexcept { return {s * m.total, s * m.first}; }
};

/// slope (level - up.x) where that is positive, 0 elsewhere. SI units.
struct LinearPressure {
  double slope;
  double level;
  Vec3 up;  ///< unit
  [[nodiscard]] double at(Vec3 x) const noexcept { return slope * (level - dot(up, x)); }
};
/// Over the part of the polygon below the level; exact, the pressure being linear there.
[[nodiscard]] Moments integrate(const Convex& polygon, const LinearPressure& pressure);
/// q = 1.
[[nodiscard]] Moments integrate(const Convex& polygon);

}  // namespace cleave::geometry
