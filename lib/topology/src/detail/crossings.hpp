#pragma once

#include <vector>

#include "cleave/core/disjoint_sets.hpp"

#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// A vertex on a line, with a plane of the vertex that crosses the line there.
struct OnLine {
  Index line;
  Index vertex;
  Index transversal;
  Index corner;  ///< that all three planes hold, if it is one; else none
};

/// All points where intervals on a common facet plane cross or touch, and which lines are one and the same in space.
struct Crossings {
  std::vector<Vertex> vertices;  ///< one point may occur several times, with other planes
  std::vector<OnLine> on_lines;
  DisjointSets<Index> coaxial;  ///< of lines
};
[[nodiscard]] Crossings find_crossings(const Prepared& prepared, const Traces& traces, Signs& signs,
                                       ThreadLimit threads);

}  // namespace cleave::topology::detail
