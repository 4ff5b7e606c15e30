#pragma once

#include <span>

#include "cleave/exact/plane.hpp"
#include "cleave/geometry/vec3.hpp"

/// Lattice points in floating point: for boxes and measures, never for decisions.
namespace cleave::topology::detail {

[[nodiscard]] constexpr geometry::Vec3 as_vec3(exact::LatticePoint p) noexcept {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
/// In sites.
[[nodiscard]] inline double distance(exact::LatticePoint a, exact::LatticePoint b) noexcept {
  return geometry::norm(as_vec3(a - b));
}

/// Grown by `margin` sites.
[[nodiscard]] constexpr geometry::Box box_of(std::span<const exact::LatticePoint> points, double margin) noexcept {
  geometry::Box box;
  for (const exact::LatticePoint p : points) box.add(as_vec3(p));
  return box.grown(margin);
}

}  // namespace cleave::topology::detail
