#include <algorithm>

#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {

Links link_around_edges(const Graph& graph, const Arrangement& arrangement, const std::vector<std::uint8_t>& present,
                        ThreadLimit threads) {
  Links links{std::vector<Index>(4 * graph.uses.size(), none),
              std::vector<std::uint8_t>(2 * graph.uses.size(), std::uint8_t{0})};
  struct Half {
    Index place, half_edge;
  };
  in_pieces(graph.edges.size(), 8192, threads, [&](std::size_t first_edge, std::size_t last_edge) {
    std::vector<Half> halves;
    for (std::size_t e = first_edge; e < last_edge; ++e) {
      const Edge& edge = graph.edges[e];
      halves.clear();
      const Index planes = graph.lines[edge.line].slot_count;
      const auto add = [&](Index half_edge, Index place) {
        const Index face = arrangement.face[half_edge];
        if (face == none || present[face] == 0) return;
        halves.push_back({place, half_edge});
        for (std::size_t i = halves.size() - 1; i > 0 && halves[i - 1].place > halves[i].place; --i) {
          std::swap(halves[i - 1], halves[i]);
        }
      };
      for (Index use = edge.first_use; use < edge.first_use + edge.use_count; ++use) {
        const Index left = graph.slots[graph.uses[use].slot].left_place;
        add(2 * use, left);
        add(2 * use + 1, left < planes ? left + planes : left - planes);
      }
      for (std::size_t i = 0; i < halves.size(); ++i) {
        const Half &from = halves[i], &to = halves[i + 1 < halves.size() ? i + 1 : 0];
        const Index h = from.half_edge, g = to.half_edge;
        // Turning counter-clockwise about the edge leaves a left half on its positive side and arrives at one on its
        // negative side; for right halves it is the other way round.
        const Index leaving = 2 * h + (h % 2), arriving = 2 * g + 1 - (g % 2);
        links.to[leaving] = arriving;
        links.to[arriving] = leaving;
        const Index span = to.place > from.place ? to.place - from.place : to.place + 2 * planes - from.place;
        if (span > planes) links.reflex[h] = 1;  // 2 n: one half-plane alone
      }
    }
  });
  return links;
}

}  // namespace cleave::topology::detail
