#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/direction.hpp"
#include "cleave/stability/result.hpp"

/// Classical block theory (Goodman & Shi 1985): which blocks persistent joint sets can make at a free surface, from
/// orientations alone.
namespace cleave::stability {

/// The blocks on one choice of sides of all joint planes. Bit i of `code` is 1 when the block lies below plane i
/// (against its upward normal).
struct JointPyramid {
  std::uint32_t code = 0;
  std::uint8_t dimension = 0;  ///< 3: has an interior
  bool finite = false;         ///< together with the rock at the free surface it holds no direction: blocks are finite
  /// Not empty and finite: blocks of this kind can come out.
  [[nodiscard]] bool removable() const noexcept { return dimension == 3 && finite; }
  Mode mode = Mode::tapered;      ///< under the force asked
  geometry::Vec3 direction = {};  ///< unit
  double driving = 0;             ///< T / |force|
  double resistance = 0;          ///< R / |force|, cohesion none
};

/// All 2^n joint pyramids of the planes (upward normals, n <= 16) at a free surface whose outward normals (out of the
/// rock) are given: one for a plane, several for a convex edge of rock. `tan_friction` by plane. In order of code.
[[nodiscard]] std::vector<JointPyramid> joint_pyramids(std::span<const Direction> planes,
                                                       std::span<const double> tan_friction,
                                                       std::span<const Direction> free_surfaces, geometry::Vec3 force);

/// A prismatic tunnel with a convex section.
struct ConvexTunnel {
  geometry::Vec3 axis;  ///< unit
  geometry::Vec3 right, up;
  std::vector<std::array<double, 2>> outline;  ///< (u, v) m, counter-clockwise seen along the axis with u to the right
};

/// The largest block of one joint pyramid at a tunnel: its apex lies where the outermost edges just touch the section.
struct MaximumBlock {
  std::uint32_t code = 0;
  std::array<double, 2> apex{};  ///< (u, v) m
  double volume = 0;             ///< m3
  double face_area = 0;          ///< m2 of the tunnel's wall
  geometry::Vec3 face_vector{};  ///< m2: the wall's parts times their normals into the rock, summed up
  double height = 0;             ///< m, apex to the nearest point of the section
  /// By plane, m: its trace on the wall, and the largest extent of its joint face.
  std::vector<double> traces = {}, extents = {};

  /// All lengths times `factor`: the block of the same shape at the same side, its apex nearer to the wall.
  void scale(double factor);
};
/// Empty where the pyramid is empty, holds the axis, or sees the section from all round.
[[nodiscard]] std::optional<MaximumBlock> maximum_block(std::span<const Direction> planes, std::uint32_t code,
                                                        const ConvexTunnel& tunnel);

/// A direction as integers, each component to 2^-40 of the largest. Empty for the zero vector.
[[nodiscard]] std::optional<Direction> direction_of(geometry::Vec3 v);

}  // namespace cleave::stability
