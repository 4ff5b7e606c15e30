#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cleave/exact/plane.hpp"

namespace cleave::topology::detail {

/// A simple polygon on the lattice with the plane that stands for it.
///
/// The plane goes through three of the corners: the first one, the corner farthest from it, and the corner farthest
/// from the line of these two (ties: the earlier one); corners named in `preferred` come before all others. Corners
/// that are exactly coplanar give the same plane whichever three are taken. The polygon meant is the lattice polygon
/// projected on the plane along `along`.
struct LatticePolygon {
  exact::Plane plane;                        ///< corners turn counter-clockwise about its normal
  exact::LatticePoint along;                 ///< close to the normal; the normal itself where it is small enough
  std::vector<exact::LatticePoint> corners;  ///< none repeated in a row, none in the middle of a straight side
  bool convex;
  bool exactly_planar;  ///< all corners lie on the plane
};

/// The plane of such three corners; empty when all lie on one line. Preferred corners come first, unless they lie about
/// on one line: their roundings would turn the plane any way.
[[nodiscard]] std::optional<exact::Plane> plane_of(std::span<const exact::LatticePoint> corners,
                                                   std::span<const std::size_t> preferred);

/// Empty when the corners have collapsed to a line or a point.
[[nodiscard]] std::optional<LatticePolygon> make_lattice_polygon(std::vector<exact::LatticePoint> corners,
                                                                 std::span<const std::size_t> preferred = {});

/// A lattice direction close to the plane's normal, at most 2^46 long in each component; the normal itself where it is
/// small enough.
[[nodiscard]] exact::LatticePoint direction_along(const exact::Plane& plane);

/// Sign of the turn a -> b -> c seen against `along`: positive = left.
[[nodiscard]] exact::Sign orient2d(exact::LatticePoint a, exact::LatticePoint b, exact::LatticePoint c,
                                   exact::LatticePoint along) noexcept;

/// Triangles (indices into corners, counter-clockwise) by ear clipping with exact signs; empty when the polygon crosses
/// itself.
[[nodiscard]] std::vector<std::array<std::size_t, 3>> triangulate(const LatticePolygon& polygon);

}  // namespace cleave::topology::detail
