#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::motion {

using geometry::Vec3;

/// A flat side of a polyhedron: loops of vertex numbers, [0] outer, counter-clockwise seen from outside, then holes,
/// clockwise. Sides of a cavity look into the cavity.
struct Facet {
  std::vector<std::vector<std::uint32_t>> loops;
  std::uint32_t surface = 0;  ///< whose friction it has, an index into `Laws::surfaces`
};

/// A closed polyhedron, convex or not, with holes and cavities.
struct Polyhedron {
  std::vector<Vec3> vertices;  ///< m
  std::vector<Facet> facets;
};

/// A symmetric matrix.
struct Symmetric {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  [[nodiscard]] constexpr Vec3 operator*(Vec3 v) const noexcept {
    return {xx * v.x + xy * v.y + zx * v.z, xy * v.x + yy * v.y + yz * v.z, zx * v.x + yz * v.y + zz * v.z};
  }
};

struct BadPolyhedron {
  std::string reason;
};

/// Volume, centroid and inertia of unit density about the centroid.
struct MassProperties {
  double volume = 0;
  Vec3 centroid;
  Symmetric inertia;
};
/// By signed tetrahedra about a vertex of the polyhedron (Mirtich 1996): as good far from the origin as near it, up to
/// the rounding of the vertices themselves. Refused: numbers that are not finite, loops of fewer than three corners or
/// of vertices that are not there, no volume.
[[nodiscard]] std::expected<MassProperties, BadPolyhedron> mass_properties(const Polyhedron& polyhedron);

/// A unit quaternion: from body axes to the scene's.
struct Turn {
  double w = 1, x = 0, y = 0, z = 0;
  [[nodiscard]] Vec3 operator*(Vec3 v) const noexcept;  ///< turned
  [[nodiscard]] Vec3 back(Vec3 v) const noexcept;       ///< turned by the inverse
  friend Turn operator*(Turn a, Turn b) noexcept;       ///< first b, then a
  friend bool operator==(const Turn&, const Turn&) = default;
};
/// Cayley map of a rotation vector: angle 2 atan(|u| / 2).
[[nodiscard]] Turn cayley(Vec3 u) noexcept;
/// By the length of the vector, about it.
[[nodiscard]] Turn turn_by(Vec3 rotation) noexcept;
[[nodiscard]] Turn normalized(Turn turn) noexcept;
/// Angle between the body axes and the scene's, 0 to pi.
[[nodiscard]] double angle_of(Turn turn) noexcept;

/// How a free body turns: attitude, and angular momentum in body axes.
struct Spinning {
  Turn turn;
  Vec3 momentum;
};
/// The same after `h` without torque: momentum in space and energy are kept to rounding for every h; order 2 (Simo and
/// Wong 1991; Lewis and Simo 1994).
[[nodiscard]] Spinning drift(const Symmetric& inertia, const Spinning& start, double h) noexcept;
/// Spin in body axes: the inverse of the inertia times the momentum.
[[nodiscard]] Vec3 solve(const Symmetric& inertia, Vec3 momentum) noexcept;

}  // namespace cleave::motion
