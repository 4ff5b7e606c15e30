#pragma once

#include <functional>
#include <span>

#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// The faces of joints that have one block on both sides. `block_of` has the block of each half-face (`none` where
/// there is no rock), `points` the vertices in m.
[[nodiscard]] Dangling find_dangling(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                                     std::span<const Index> block_of, std::span<const geometry::Vec3> points,
                                     const std::function<VertexId(Index)>& vertex_id);

}  // namespace cleave::topology::detail
