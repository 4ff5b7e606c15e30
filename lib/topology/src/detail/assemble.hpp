#pragma once

#include "detail/stages.hpp"

namespace cleave::topology::detail {

/// Last stage: faces, loops, counts and measures of each block, from the cells.
[[nodiscard]] BlockComplex::Data assemble(const CutInput& input, const Prepared& prepared, const Graph& graph,
                                          const Arrangement& arrangement, const Cells& cells,
                                          const std::vector<Vec>& positions);

}  // namespace cleave::topology::detail
