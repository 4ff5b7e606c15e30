#pragma once

#include "cleave/exact/plane.hpp"
#include "cleave/geometry/vec3.hpp"

/// Lattice points in floating point: for boxes and measures, never for decisions.
namespace cleave::topology::detail {

[[nodiscard]] inline geometry::Vec3 as_vec3(exact::LatticePoint p) noexcept {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
/// In sites.
[[nodiscard]] inline double distance(exact::LatticePoint a, exact::LatticePoint b) noexcept {
  return geometry::norm(as_vec3(a - b));
}

}  // namespace cleave::topology::detail
