#pragma once

#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// Last phase: faces, loops, counts and measures of each block, from the cells. `excavated` says of each excavation
/// whether it is out; without it all are. A face on rock that left otherwise is free, without excavation and tag.
/// `measures` become those of the faces of blocks. `no_more_needed`: the graph itself, if its edges may be let go
/// before there are blocks.
[[nodiscard]] BlockComplex::Packed assemble(const CutInput& input, const Prepared& prepared, const Graph& graph,
                                            const Arrangement& arrangement, Cells cells,
                                            const std::vector<Vec>& positions, std::vector<FaceMeasure> measures,
                                            ThreadLimit threads, const std::vector<std::uint8_t>* excavated = nullptr,
                                            Graph* no_more_needed = nullptr);

}  // namespace cleave::topology::detail
