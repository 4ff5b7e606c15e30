#pragma once

#include <span>

#include "cleave/exact/sign.hpp"
#include "detail/stages.hpp"

namespace cleave::topology::detail {

/// Sign of the volume enclosed by half-faces that close (positive when they look inwards to it), by rational
/// arithmetic. Slow; for shells so thin that doubles cannot tell.
[[nodiscard]] exact::Sign exact_volume_sign(const Prepared& prepared, const Graph& graph,
                                            const Arrangement& arrangement, std::span<const Index> half_faces);

}  // namespace cleave::topology::detail
