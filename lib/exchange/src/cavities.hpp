#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "cleave/exchange/polygons.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::report::detail {

inline constexpr std::size_t most_planes = 64;

/// The closed surfaces of the parts that a block with cavities falls into when it is cut by a few axis-parallel planes
/// so that each cavity meets one of them: then no part has a cavity. `triangles` is the block's surface after
/// `separate_pinches`.
///
/// No plane goes through a vertex, so every triangle is cut in a clear way and both sides share the new points: the
/// parts are closed whatever the rounding, and their volumes add up to the block's to rounding. `points` grows by the
/// new points. Empty when a cavity is left all the same, or when more than `most_planes` were needed: each part of a
/// large block has a section of its own, and thousands of cavities would write the block thousands of times.
[[nodiscard]] std::optional<std::vector<std::vector<Polygon>>> cut_through_cavities(
    std::vector<Polygon> triangles, std::vector<geometry::Vec3>& points);

/// Volume inside a closed surface, by the divergence theorem about its first corner.
[[nodiscard]] double volume_of(std::span<const Polygon> polygons, std::span<const geometry::Vec3> points);

}  // namespace cleave::report::detail
