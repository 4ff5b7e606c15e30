#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::report {

/// Loops of a flat face as indices into a list of positions: [0] outer, counter-clockwise seen from outside; the others
/// holes, clockwise.
using FaceLoops = std::vector<std::vector<std::uint32_t>>;

/// Three indices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Cuts a face, with or without holes, into triangles on its own vertices; no vertex is added.
///
/// `outward` need not have unit length, only its largest component is used: the face is seen along that axis, so no
/// coordinate is rounded, and all decisions are exact signs for the given positions. Loops may pass a vertex twice or
/// touch each other at vertices. What always holds, however the positions are rounded: each edge of the loops is used
/// once in its own direction, every other edge once in both directions. There are (corners + 2 holes - 2) triangles
/// when no loops touch.
[[nodiscard]] std::vector<Triangle> triangulate(std::span<const std::vector<std::uint32_t>> loops,
                                                std::span<const geometry::Vec3> positions, geometry::Vec3 outward);
/// The same triangles, appended to those that are there.
void append_triangles(std::span<const std::vector<std::uint32_t>> loops, std::span<const geometry::Vec3> positions,
                      geometry::Vec3 outward, std::vector<Triangle>& triangles);

}  // namespace cleave::report
