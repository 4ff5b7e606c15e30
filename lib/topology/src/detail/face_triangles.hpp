#pragma once

#include <array>
#include <vector>

#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// Three vertices of the graph, counter-clockwise about the plane's normal.
using FaceTriangle = std::array<Index, 3>;

/// Cuts a plane face into triangles on its own corners, by exact signs: none is flat, and together they are the face.
/// Its loops may turn back on themselves, where a joint ends within another one, and pass a vertex several times. Of
/// the corners n of all loops and h holes there are n + 2 h - 2. O(n^2) where ears are soon found, as they mostly are.
void append_triangles(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                      const std::vector<Vec>& positions, Index face, std::vector<FaceTriangle>& triangles);

}  // namespace cleave::topology::detail
