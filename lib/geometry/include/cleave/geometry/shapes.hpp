#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <variant>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"

/// Joint shapes as polygons. Corners run counter-clockwise seen from above (from the tip of the upward normal).
namespace cleave::geometry {

struct InPlaneKind;
/// In the shape's plane, from the strike (right-hand rule) to the first side or axis, counter-clockwise seen from
/// above.
using InPlaneRotation = Angle<InPlaneKind>;

struct NonPositiveSize {
  std::string what;  ///< "radius", "side_a", ...
  Length value;      ///< not positive, or not a number
};
struct TooFewSides {
  std::uint32_t sides;  ///< a polygon in place of a disc needs three
};
using ShapeError = std::variant<NonPositiveSize, TooFewSides, PolygonError>;
[[nodiscard]] std::string describe(const ShapeError& error);

/// Radius of the circle through the corners of the regular polygon that has the area of a disc of radius 1: sqrt(2 pi /
/// (n sin(2 pi / n))).
[[nodiscard]] double same_area_radius(std::uint32_t sides) noexcept;

/// Regular polygon of the same area as the disc, so that joint area per volume is kept; its corners lie slightly
/// outside the disc (0.32 % of the radius for 32 sides). The first corner lies along the strike.
[[nodiscard]] std::expected<Polygon, ShapeError> disc(Vec3 centre, Attitude plane, Length radius,
                                                      std::uint32_t sides = 32);

/// As a disc, stretched to the half axes; the first one lies along the strike before rotation.
[[nodiscard]] std::expected<Polygon, ShapeError> ellipse(Vec3 centre, Attitude plane, Length half_axis_a,
                                                         Length half_axis_b, InPlaneRotation rotation = {},
                                                         std::uint32_t sides = 32);

/// Whole sides; side_a lies along the strike before rotation, side_b down the dip.
[[nodiscard]] std::expected<Polygon, ShapeError> rectangle(Vec3 centre, Attitude plane, Length side_a, Length side_b,
                                                           InPlaneRotation rotation = {});

}  // namespace cleave::geometry
