#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cleave/core/vec2.hpp"
#include "cleave/dfn/sample.hpp"
#include "orientation.hpp"
#include "shape.hpp"

namespace cleave::dfn::detail {

/// A corner in the joint's own axes (m): x along the first side or axis, y across.
using FlatPoint = Vec2;
/// Corners of the outline with both half axes 1, counter-clockwise about the normal.
[[nodiscard]] std::vector<FlatPoint> unit_corners(std::uint32_t sides);
/// `unit`: those of outline.sides.
[[nodiscard]] std::vector<geometry::Vec3> corners_of(const JointOutline& outline, geometry::Vec3 centre,
                                                     std::span<const FlatPoint> unit);

/// Half sizes turned in the joint's plane: `rotation` in radians, from the strike.
[[nodiscard]] JointOutline outline_of(const Frame& frame, double rotation, const HalfAxes& half,
                                      std::uint32_t sides) noexcept;

/// Whether the corners are so far apart, against the rounding of coordinates, that they make a valid polygon for
/// certain.
[[nodiscard]] bool surely_valid(const JointOutline& outline, geometry::Vec3 centre) noexcept;
/// Half the extents along the axes of the rectangle, or of the ellipse through the corners.
[[nodiscard]] geometry::Vec3 half_extents(const JointOutline& outline) noexcept;

}  // namespace cleave::dfn::detail
