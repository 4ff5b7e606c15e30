#pragma once

#include <vector>

#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// Of each connected piece of surface the half-face of another piece that its outside looks at, `none` where nothing is
/// around it. `piece_of_face`: `none` for faces that no facet covers.
[[nodiscard]] std::vector<Index> find_faced(const Prepared& prepared, const Graph& graph,
                                            const Arrangement& arrangement, const std::vector<Vec>& positions,
                                            const std::vector<Index>& piece_of_face, std::size_t pieces,
                                            ThreadLimit threads);

}  // namespace cleave::topology::detail
