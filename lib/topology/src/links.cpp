#include <algorithm>

#include "detail/stages.hpp"

namespace cleave::topology::detail {

std::vector<Index> link_around_edges(const Graph& graph, const Arrangement& arrangement,
                                     const std::vector<std::uint8_t>& present) {
  std::vector<Index> link(4 * graph.uses.size(), none);
  struct Half {
    Index place, half_edge;
  };
  std::vector<Half> halves;
  for (const Edge& edge : graph.edges) {
    halves.clear();
    for (Index use = edge.first_use; use < edge.first_use + edge.use_count; ++use) {
      const Slot& slot = graph.slots[graph.uses[use].slot];
      const Index planes = graph.lines[edge.line].slot_count;
      const auto add = [&](Index half_edge, Index place) {
        const Index face = arrangement.face[half_edge];
        if (face != none && present[face] != 0) halves.push_back({place, half_edge});
      };
      add(2 * use, slot.left_place);
      add(2 * use + 1, (slot.left_place + planes) % (2 * planes));
    }
    std::ranges::sort(halves, {}, &Half::place);
    for (std::size_t i = 0; i < halves.size(); ++i) {
      const Index h = halves[i].half_edge, g = halves[(i + 1) % halves.size()].half_edge;
      // Turning counter-clockwise about the edge leaves a left half on its positive side and arrives at one on its
      // negative side; for right halves it is the other way round.
      const Index leaving = 2 * h + (h % 2), arriving = 2 * g + 1 - (g % 2);
      link[leaving] = arriving;
      link[arriving] = leaving;
    }
  }
  return link;
}

}  // namespace cleave::topology::detail
