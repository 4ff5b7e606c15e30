#include "detail/nesting.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/facets/prepared.hpp"
#include "cleave/geometry/box_tree.hpp"

namespace cleave::topology::detail {
namespace {

using exact::PointApprox;
using exact::Sign;

struct Box : geometry::Extents {
  /// False only when `inner` is safely not inside.
  [[nodiscard]] bool may_hold(const Box& inner) const {
    constexpr double margin = 0x1p-36;
    for (std::size_t k = 0; k < 3; ++k) {
      if (inner.lo[k] < lo[k] - margin || inner.hi[k] > hi[k] + margin) return false;
    }
    return true;
  }
};

/// A connected piece of the drawing.
struct Piece {
  Index outside;  ///< its loop that is not outer
  std::vector<Index> uses;
  Box box;
  bool has_faces = false;
};

class Nesting {
 public:
  Nesting(const PlaneView& view, const std::vector<Index>& loop_of, const Arrangement& arrangement, const Graph& graph,
          Signs& signs)
      : plane_{view.plane},
        loop_of_{loop_of},
        arrangement_{arrangement},
        graph_{graph},
        signs_{signs},
        half_{arrangement.half_turn[view.plane]} {}

  /// The loop of `ring` whose left side holds the start of half-edge `from`: the first edge of `ring` met along the
  /// half-edge's direction tells. Empty when none is met (the point is outside).
  std::optional<Index> holder(const Piece& ring, Index from) {
    const Use& use = graph_.uses[from / 2];
    const Slot& slot = graph_.slots[use.slot];
    const Edge& edge = graph_.edges[use.edge];
    const Vertex& start = graph_.vertices[from % 2 == 0 ? edge.from : edge.to];
    const Index ray_plane = slot.transversal;
    const bool along = slot.along == (from % 2 == 0);  // the ray runs along + (nP x nQ)
    const exact::LineApprox line = exact::line_of(signs_.plane(plane_), signs_.plane(ray_plane));
    const bool negative_is_left = along;

    struct Hit {
      Index transversal, half_edge, turn;
      PointApprox point;
    };
    std::optional<Hit> nearest;
    for (const Index u : ring.uses) {
      const Edge& e = graph_.edges[graph_.uses[u].edge];
      // Points on the ray's line count as positive: the ray runs just beside it, on the negative side.
      if (positive(e.from, ray_plane) == positive(e.to, ray_plane)) continue;
      const Index across = graph_.slots[graph_.uses[u].slot].transversal;
      const PointApprox point = exact::meet(line, signs_.plane(across));
      Sign sense = signs_.det3(point, plane_, ray_plane, across);
      if (!along) sense = -sense;
      const Sign behind = signs_.side(start.approx, start.planes[0], start.planes[1], start.planes[2], across) * sense;
      if (behind != Sign::negative) continue;  // met behind the start
      // Of the edge's two half-edges the one that crosses the ray from right to left has the ray's start on its left.
      Index near = 2 * u;
      Index turn = (direction_of(near) + 2 * half_ - direction_of(from)) % (2 * half_);
      if (turn > half_) {
        near = 2 * u + 1;
        turn -= half_;
      }
      const Hit hit{across, near, turn, point};
      if (!nearest) {
        nearest = hit;
        continue;
      }
      const Sign order = signs_.side(nearest->point, plane_, ray_plane, nearest->transversal, across) * sense;
      const bool closer = order == Sign::positive ||
                          (order == Sign::zero && (negative_is_left ? turn > nearest->turn : turn < nearest->turn));
      if (closer) nearest = hit;
    }
    if (!nearest) return std::nullopt;
    return loop_of_[nearest->half_edge];
  }

 private:
  [[nodiscard]] Index direction_of(Index half_edge) const {
    return arrangement_.direction_of(half_edge, graph_.uses[half_edge / 2].slot, half_);
  }
  bool positive(Index vertex, Index plane) {
    const Vertex& v = graph_.vertices[vertex];
    return signs_.side(v.approx, v.planes[0], v.planes[1], v.planes[2], plane) != Sign::negative;
  }

  Index plane_;

  const std::vector<Index>& loop_of_;
  const Arrangement& arrangement_;
  const Graph& graph_;
  Signs& signs_;
  Index half_;
};

}  // namespace

std::vector<Index> nest_loops(const PlaneView& view, const std::vector<Loop>& loops, const std::vector<Index>& loop_of,
                              const Arrangement& arrangement, const Graph& graph, const std::vector<Vec>& positions,
                              Signs& signs) {
  std::vector<Index> parent(loops.size(), none);
  if (std::ranges::count_if(loops, [](const Loop& loop) { return !loop.outer; }) < 2) return parent;

  DisjointSets<Index> connected{loops.size()};
  for (const Index use : view.uses) connected.join(loop_of[2 * use], loop_of[2 * use + 1]);
  std::vector<Index> piece_of(loops.size(), none);
  std::vector<Piece> pieces;
  for (Index l = 0; l < loops.size(); ++l) {
    const Index root = connected.find(l);
    if (piece_of[root] == none) {
      piece_of[root] = static_cast<Index>(pieces.size());
      pieces.emplace_back();
    }
    Piece& piece = pieces[piece_of[root]];
    if (loops[l].outer) {
      piece.has_faces = true;
    } else {
      piece.outside = l;
    }
  }
  for (const Index use : view.uses) {
    Piece& piece = pieces[piece_of[connected.find(loop_of[2 * use])]];
    piece.uses.push_back(use);
    piece.box.add(positions[graph.edges[graph.uses[use].edge].from]);
    piece.box.add(positions[graph.edges[graph.uses[use].edge].to]);
  }

  Nesting nesting{view, loop_of, arrangement, graph, signs};
  struct Holder {
    Index piece, loop;
  };
  std::vector<std::vector<Holder>> holders(pieces.size());
  for (Index inner = 0; inner < pieces.size(); ++inner) {
    for (Index outer = 0; outer < pieces.size(); ++outer) {
      if (inner == outer || !pieces[outer].has_faces || !pieces[outer].box.may_hold(pieces[inner].box)) continue;
      const auto loop = nesting.holder(pieces[outer], loops[pieces[inner].outside].start);
      if (loop && loops[*loop].outer) holders[inner].push_back({outer, *loop});
    }
  }
  // All holders of one piece lie inside one another: the innermost has the most holders itself.
  for (Index inner = 0; inner < pieces.size(); ++inner) {
    const auto innermost =
        std::ranges::max_element(holders[inner], {}, [&](const Holder& h) { return holders[h.piece].size(); });
    if (innermost != holders[inner].end()) parent[pieces[inner].outside] = innermost->loop;
  }
  return parent;
}

}  // namespace cleave::topology::detail
