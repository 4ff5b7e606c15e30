#pragma once

#include <functional>
#include <vector>

#include "detail/block_maker.hpp"

namespace cleave::topology::detail {

/// The faces of joints that have rock on both sides. `points` are the vertices in m.
[[nodiscard]] JointNetwork make_joint_network(const BlockParts& parts, const std::vector<geometry::Vec3>& points,
                                              const std::function<VertexId(Index)>& vertex_id);

}  // namespace cleave::topology::detail
