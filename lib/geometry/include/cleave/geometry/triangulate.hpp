#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <span>
#include <vector>

#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

/// Triangles (corner numbers, same sense as the corners) that together are the polygon: ear clipping with exact signs,
/// seen along the dominant axis of the best-fit plane; of the possible ears the one with the shortest new edge first.
/// The corners may be bent. No triangle is degenerate. Repeated corners are used once, flat corners are kept: k
/// distinct corners give k - 2 triangles. Errors: those of Polygon::make but NotPlanar. O(n^2) to O(n^3) for n corners.
[[nodiscard]] std::expected<std::vector<std::array<std::uint32_t, 3>>, PolygonError> triangulate(
    std::span<const Vec3> corners);

/// Newell's normal of a ring of corners, twice its area long; about the first corner, because far from 0 the products
/// would cancel.
[[nodiscard]] Vec3 area_vector(std::span<const Vec3> corners) noexcept;

}  // namespace cleave::geometry
