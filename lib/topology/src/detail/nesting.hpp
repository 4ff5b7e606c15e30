#pragma once

#include <vector>

#include "detail/phases.hpp"
#include "detail/plane_view.hpp"

namespace cleave::topology::detail {

/// For each loop that is not outer: the outer loop whose face holds it, `none` for the unbounded face. Exact.
[[nodiscard]] std::vector<Index> nest_loops(const PlaneView& view, const std::vector<Loop>& loops,
                                            const std::vector<Index>& loop_of, const Arrangement& arrangement,
                                            const Graph& graph, const std::vector<Vec>& positions, Signs& signs);

}  // namespace cleave::topology::detail
