#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

struct TooFewCorners {
  std::size_t corners;
};
struct NonFiniteCorner {
  std::size_t corner;  ///< counted from 0, as given; not a number, infinite, or a coordinate beyond 1e12 m
};
struct ZeroArea {};  ///< all corners on one line (within 8 ulp of the largest coordinate) or in one point
struct NotPlanar {
  std::size_t corner;  ///< the one furthest off
  Length distance;     ///< from the plane
  Length allowed;
};
struct SelfCrossing {
  std::size_t first_edge,
      second_edge;  ///< edge i joins corners i and i + 1, numbered as given; they cross, touch or overlap
};
using PolygonError = std::variant<TooFewCorners, NonFiniteCorner, ZeroArea, NotPlanar, SelfCrossing>;
/// "what is wrong; what to do", in words for an engineer.
[[nodiscard]] std::string describe(const PolygonError& error);

/// A simple planar polygon in space, convex or not, corners in metres.
///
/// Invariant: at least three corners, no corner repeated in a row, finite, area > 0, no two edges cross or overlap, and
/// every corner lies within max(1e-6 of its size, 8 ulp of its largest coordinate) of its plane.
class Polygon final {
 public:
  /// Corners in either sense. A corner equal to the one before it is dropped; coordinates below 1e-60 m become 0.
  /// Crossing and convexity are decided by exact signs, seen along the dominant axis of the best-fit plane. "Size" is
  /// the diagonal of the bounding box.
  [[nodiscard]] static std::expected<Polygon, PolygonError> make(std::vector<Vec3> corners);

  [[nodiscard]] std::span<const Vec3> corners() const noexcept { return corners_; }
  [[nodiscard]] bool convex() const noexcept { return convex_; }

  /// Triangles, each a Polygon of its own, for polygons that `make` found not planar: ear clipping as in `triangulate`.
  /// Errors other than NotPlanar are those of `make`.
  [[nodiscard]] static std::expected<std::vector<Polygon>, PolygonError> triangulated(std::vector<Vec3> corners);

 private:
  Polygon(std::vector<Vec3> corners, bool convex) : corners_{std::move(corners)}, convex_{convex} {}
  std::vector<Vec3> corners_;
  bool convex_;
};

// ---- Shapes of joints -----------------------------------------------------------------------------------------------

// Joint shapes as polygons. Corners run counter-clockwise seen from above (from the tip of the upward normal).

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
