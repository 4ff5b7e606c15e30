#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/exact/predicates.hpp"
#include "detail/crossings.hpp"
#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Sign;

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The lines of space: traces on one and the same line in one class, classes in the order of their first lines.
struct LineClasses {
  const Prepared& prepared;
  const Traces& traces;
  Crossings crossings;
  std::vector<Index> class_begin, lines;  ///< lines of each class (CSR)
  std::vector<Index> on_begin, on_end;    ///< of each class, into `on`
  std::vector<OnLine> on;                 ///< vertices on each class
  std::vector<Index> sorted;              ///< distinct vertices in order, in the places of `on`
  std::vector<Index> intervals_begin;     ///< of each line
  std::vector<Index> number;              ///< of each vertex: in the graph

  [[nodiscard]] std::size_t count() const { return class_begin.size() - 1; }
  [[nodiscard]] const Line& representative(std::size_t c) const { return traces.lines[lines[class_begin[c]]]; }
};

LineClasses group_lines(const Prepared& prepared, const Traces& traces, Crossings crossings) {
  LineClasses out{prepared, traces, std::move(crossings), {}, {}, {}, {}, {}, {}, {}, {}};
  const std::size_t lines = traces.lines.size();
  std::vector<Index> class_of(lines);
  Index classes = 0;
  for (Index l = 0; l < lines; ++l) {
    const Index root = out.crossings.coaxial.find(l);
    class_of[l] = root == l ? classes++ : class_of[root];
  }
  out.class_begin.assign(classes + std::size_t{1}, 0);
  for (const Index c : class_of) ++out.class_begin[c + std::size_t{1}];
  begin_from_counts(out.class_begin);
  out.lines.resize(lines);
  auto next = out.class_begin;
  for (Index l = 0; l < lines; ++l) out.lines[next[class_of[l]]++] = l;

  out.on_begin.assign(classes + std::size_t{1}, 0);
  for (const OnLine& on : out.crossings.on_lines) ++out.on_begin[class_of[on.line] + std::size_t{1}];
  begin_from_counts(out.on_begin);
  out.on.resize(out.crossings.on_lines.size());
  next = out.on_begin;
  for (const OnLine& on : out.crossings.on_lines) out.on[next[class_of[on.line]]++] = on;
  let_go(out.crossings.on_lines);
  out.on_end.assign(classes, 0);
  out.sorted.resize(out.on.size());

  out.intervals_begin.assign(lines + 1, 0);
  for (const Interval& interval : traces.intervals) ++out.intervals_begin[interval.line + std::size_t{1}];
  begin_from_counts(out.intervals_begin);
  return out;
}

/// Sorts the vertices along lines, and finds which are the same point.
class Sorter {
 public:
  Sorter(LineClasses& classes, const Signs& signs) : classes_{classes}, signs_{signs.another()} {}

  struct Result {
    std::vector<std::array<Index, 2>> same_point;
    Signs signs;
  };
  [[nodiscard]] Result result() && { return {std::move(same_point_), signs_}; }

  void sort_along(std::size_t c) {
    const Line& line = classes_.representative(c);
    items_.clear();
    at_corners_.clear();
    for (Index k = classes_.on_begin[c]; k < classes_.on_begin[c + 1]; ++k) {
      const OnLine& on = classes_.on[k];
      if (on.corner != none && again(on)) continue;
      const Vertex& v = classes_.crossings.vertices[on.vertex];
      const Sign sense =
          signs_.det3(exact::meet(line.approx, signs_.plane(on.transversal)), line.p, line.q, on.transversal);
      CLEAVE_ASSERT(sense != Sign::zero);
      // Doubles may say nothing about a vertex of nearly parallel planes: the exact comparison below decides then.
      const double t = v.approx.w != 0 ? dot(v.approx.x, line.approx.m) / v.approx.w : 0;
      items_.push_back({t, on.vertex, on.transversal, sense});
    }
    std::ranges::sort(items_,
                      [](const Item& a, const Item& b) { return a.t < b.t || (!(b.t < a.t) && a.vertex < b.vertex); });
    if (!steps_forward()) {
      std::ranges::stable_sort(items_, [&](const Item& a, const Item& b) { return compare(a, b) == Sign::negative; });
      steps_forward();
    }
    Index end = classes_.on_begin[c];
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (items_[i].as_before) {
        same_point_.push_back({items_[i - 1].vertex, items_[i].vertex});
      } else {
        classes_.sorted[end++] = items_[i].vertex;  // the first of each point is enough
      }
    }
    classes_.on_end[c] = end;
  }

 private:
  struct Item {
    double t;
    Index vertex, transversal;
    Sign sense;              ///< of the transversal plane's normal along the line
    bool as_before = false;  ///< the same point as the item before
  };

  /// Whether the vertex is at a corner where this line has had one already; then they are the same point.
  bool again(const OnLine& on) {
    const auto first = std::ranges::find(at_corners_, on.corner, &OnLine::corner);
    if (first == at_corners_.end()) {
      at_corners_.push_back(on);
      return false;
    }
    if (first->vertex != on.vertex) same_point_.push_back({first->vertex, on.vertex});
    return true;
  }

  /// Compares each item with the one before; false where one lies behind it.
  bool steps_forward() {
    for (std::size_t i = 1; i < items_.size(); ++i) {
      const Sign step = compare(items_[i - 1], items_[i]);
      if (step == Sign::positive) return false;
      items_[i].as_before = step == Sign::zero;
    }
    if (!items_.empty()) items_.front().as_before = false;
    return true;
  }

  /// Negative when a comes before b in the direction of the line, zero when they are one point.
  Sign compare(const Item& a, const Item& b) {
    if (a.vertex == b.vertex) return Sign::zero;
    const Vertex& v = classes_.crossings.vertices[a.vertex];
    return signs_.side(v.approx, v.planes[0], v.planes[1], v.planes[2], b.transversal) * b.sense;
  }

  LineClasses& classes_;  ///< of which each Sorter changes its own classes
  Signs signs_;
  std::vector<Item> items_;
  std::vector<OnLine> at_corners_;  ///< the first at each
  std::vector<std::array<Index, 2>> same_point_;
};

/// Numbers the distinct points in the order of their first vertices.
std::vector<Vertex> number_vertices(LineClasses& classes, DisjointSets<Index> same_point) {
  const auto& all = classes.crossings.vertices;
  std::vector<Vertex> vertices;
  vertices.reserve(all.size());
  classes.number.resize(all.size());
  for (Index v = 0; v < all.size(); ++v) {
    const Index root = same_point.find(v);
    classes.number[v] = root == v ? static_cast<Index>(vertices.size()) : classes.number[root];
    if (root == v) vertices.push_back(all[v]);
  }
  return vertices;
}

/// Cuts lines into edges between neighbouring vertices.
class EdgeCutter {
 public:
  EdgeCutter(const LineClasses& classes, const Signs& signs)
      : classes_{classes}, prepared_{classes.prepared}, traces_{classes.traces}, signs_{signs.another()} {}

  struct Result {
    std::vector<LineClass> lines;
    std::vector<Slot> slots;
    std::vector<Edge> edges;
    std::vector<Use> uses;
    std::vector<OutlineMark> outlines;
    Signs signs;
  };
  [[nodiscard]] Result result() && {
    return {std::move(graph_.lines), std::move(graph_.slots),    std::move(graph_.edges),
            std::move(graph_.uses),  std::move(graph_.outlines), signs_};
  }

  void cut_into_edges(std::size_t c) {
    const std::size_t count = classes_.on_end[c] - classes_.on_begin[c];
    if (count < 2) return;
    const Line& main = classes_.representative(c);

    const std::vector<Member>& members = gather_members(c);
    const auto slot_of = [&](Index plane) {
      const auto found = std::ranges::lower_bound(members, plane, {}, &Member::plane);
      return static_cast<std::size_t>(found - members.begin());
    };

    struct Mark {
      std::ptrdiff_t segment;
      std::size_t slot;
      Index facet;  ///< none for traces
      bool facet_on_left;
    };
    std::vector<Mark> outline_marks;
    drawn_.assign((count - 1) * members.size(), 0);
    const std::ptrdiff_t base = classes_.on_begin[c];
    bool any = false;
    for (Index k = classes_.class_begin[c]; k < classes_.class_begin[c + 1]; ++k) {
      const Index l = classes_.lines[k];
      const Line& line = traces_.lines[l];
      const bool same_direction = signs_.same_sense(line.approx, line.p, line.q, main.approx, main.p, main.q);
      for (Index i = classes_.intervals_begin[l]; i < classes_.intervals_begin[l + std::size_t{1}]; ++i) {
        const Interval& interval = traces_.intervals[i];
        const auto [first, last] = span_of(c, interval, same_direction);
        if (first >= last) continue;
        any = true;
        const bool outline = interval.outline_of != none;
        const std::size_t slot_p = slot_of(outline ? prepared_.facets[interval.outline_of].plane : line.p);
        const std::size_t slot_q = outline ? slot_p : slot_of(line.q);
        bool on_left = false;
        if (outline) {
          // The left of direction d in plane P is n x d; with d = + (nP x nE) that is the negative side of E.
          const Index own = prepared_.facets[interval.outline_of].plane;
          on_left =
              signs_.same_sense(own, interval.edge_plane, main.approx, main.p, main.q) != interval.inside_positive;
        }
        for (std::ptrdiff_t s = first; s < last; ++s) {
          const auto segment = static_cast<std::size_t>(s - base);
          drawn_[segment * members.size() + slot_p] = 1;
          drawn_[segment * members.size() + slot_q] = 1;
          if (outline) outline_marks.push_back({s - base, slot_p, interval.outline_of, on_left});
        }
      }
    }
    if (!any) return;

    const Index line_number = static_cast<Index>(graph_.lines.size());
    const Index first_slot = static_cast<Index>(graph_.slots.size());
    graph_.lines.push_back({main.p, main.q, main.approx, first_slot, static_cast<Index>(members.size())});
    for (const auto& [plane, transversal] : members) {
      graph_.slots.push_back(
          {plane, 0, transversal, signs_.same_sense(plane, transversal, main.approx, main.p, main.q)});
    }
    order_around(first_slot, members.size());

    std::ranges::stable_sort(outline_marks, [](const Mark& a, const Mark& b) {
      return a.segment < b.segment || (a.segment == b.segment && a.slot < b.slot);
    });
    auto mark = outline_marks.begin();
    for (std::size_t s = 0; s + 1 < count; ++s) {
      const Index first_use = static_cast<Index>(graph_.uses.size());
      for (std::size_t m = 0; m < members.size(); ++m) {
        if (drawn_[s * members.size() + m] == 0) continue;
        const Index use = static_cast<Index>(graph_.uses.size());
        graph_.uses.push_back({static_cast<Index>(graph_.edges.size()), static_cast<Index>(first_slot + m)});
        for (; mark != outline_marks.end() && mark->segment == static_cast<std::ptrdiff_t>(s) && mark->slot == m;
             ++mark) {
          graph_.outlines.push_back({use, mark->facet, mark->facet_on_left});
        }
      }
      const Index uses = static_cast<Index>(graph_.uses.size()) - first_use;
      if (uses == 0) continue;
      const std::size_t at = static_cast<std::size_t>(base) + s;
      graph_.edges.push_back({classes_.number[classes_.sorted[at]], classes_.number[classes_.sorted[at + 1]],
                              line_number, first_use, uses});
    }
  }

 private:
  struct Member {
    Index plane, transversal;
  };

  /// Facet planes that contain the line of a class, each with a plane that meets it there; by plane.
  const std::vector<Member>& gather_members(std::size_t c) {
    members_.clear();
    for (Index k = classes_.class_begin[c]; k < classes_.class_begin[c + 1]; ++k) {
      const Line& line = traces_.lines[classes_.lines[k]];
      members_.push_back({line.p, line.q});
      if (line.q < prepared_.facet_planes) members_.push_back({line.q, line.p});
    }
    std::ranges::stable_sort(members_, {}, &Member::plane);
    const auto repeated = std::ranges::unique(members_, {}, &Member::plane);
    members_.erase(repeated.begin(), repeated.end());
    return members_;
  }

  /// The range [first, last] of sorted vertices of the class inside the interval; first > last when there is none.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> span_of(std::size_t c, const Interval& interval, bool same_direction) {
    const HalfSpace lower = same_direction ? interval.lower : interval.upper;
    const HalfSpace upper = same_direction ? interval.upper : interval.lower;
    const auto inside = [&](std::ptrdiff_t i, HalfSpace h) {
      const Vertex& v = classes_.crossings.vertices[classes_.sorted[static_cast<std::size_t>(i)]];
      return signs_.inside(v.approx, v.planes[0], v.planes[1], v.planes[2], h) != Sign::negative;
    };
    std::ptrdiff_t first = classes_.on_begin[c], last = classes_.on_end[c];
    const std::ptrdiff_t end = last;
    for (std::ptrdiff_t count = last - first; count > 0;) {  // first vertex inside `lower`
      const std::ptrdiff_t half = count / 2;
      if (inside(first + half, lower)) {
        count = half;
      } else {
        first += half + 1;
        count -= half + 1;
      }
    }
    last = first;
    for (std::ptrdiff_t count = end - first; count > 0;) {  // first vertex outside `upper`
      const std::ptrdiff_t half = count / 2;
      if (inside(last + half, upper)) {
        last += half + 1;
        count -= half + 1;
      } else {
        count = half;
      }
    }
    return {first, last - 1};
  }

  /// Places of the left half-planes around the line's direction: the angle of n x d is the angle of n turned by 90
  /// degrees.
  void order_around(Index first_slot, std::size_t count) {
    const auto slot = [&](std::size_t k) -> Slot& { return graph_.slots[first_slot + k]; };
    // Sign of d . (n_i x n_j): both planes contain the line, so the cross product is parallel to its direction d.
    const LineClass& line = graph_.lines.back();
    const auto sense = [&](std::size_t i, std::size_t j) {
      if (i == j) return 0;
      return signs_.same_sense(slot(i).plane, slot(j).plane, line.approx, line.p, line.q) ? 1 : -1;
    };
    // Turn every normal into the half-turn that starts at the first plane's, sort there, then undo the turning.
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<int> flip(count, 1);
    for (std::size_t k = 1; k < count; ++k) flip[k] = sense(0, k);
    std::ranges::stable_sort(order.begin() + 1, order.end(),
                             [&](std::size_t i, std::size_t j) { return flip[i] * flip[j] * sense(i, j) > 0; });
    for (std::size_t place = 0; place < count; ++place) {
      const std::size_t k = order[place];
      slot(k).left_place = static_cast<Index>(flip[k] >= 0 ? place : place + count);
    }
  }

  const LineClasses& classes_;
  const Prepared& prepared_;
  const Traces& traces_;
  Signs signs_;
  std::vector<std::uint8_t> drawn_;
  std::vector<Member> members_;
  Graph graph_;
};

/// The pieces of the graph put together.
void join(std::vector<EdgeCutter::Result>& parts, Graph& graph, ThreadLimit threads) {
  using Part = EdgeCutter::Result;
  const auto lines = offsets_of(parts, &Part::lines), slots = offsets_of(parts, &Part::slots),
             edges = offsets_of(parts, &Part::edges), uses = offsets_of(parts, &Part::uses);
  graph.lines = joined(parts, &Part::lines, threads,
                       [&](LineClass& line, std::size_t k) { line.first_slot += static_cast<Index>(slots[k]); });
  graph.slots = joined(parts, &Part::slots, threads, [](Slot&, std::size_t) {});
  graph.edges = joined(parts, &Part::edges, threads, [&](Edge& edge, std::size_t k) {
    edge.line += static_cast<Index>(lines[k]);
    edge.first_use += static_cast<Index>(uses[k]);
  });
  graph.uses = joined(parts, &Part::uses, threads, [&](Use& use, std::size_t k) {
    use.edge += static_cast<Index>(edges[k]);
    use.slot += static_cast<Index>(slots[k]);
  });
  graph.outlines = joined(parts, &Part::outlines, threads,
                          [&](OutlineMark& mark, std::size_t k) { mark.use += static_cast<Index>(uses[k]); });
}

}  // namespace

Graph build_graph(const Prepared& prepared, const Traces& traces, Signs& signs, ThreadLimit threads) {
  LineClasses classes = group_lines(prepared, traces, find_crossings(prepared, traces, signs, threads));
  const auto sorted = made_in_pieces(classes.count(), threads, [&](std::size_t first, std::size_t last) {
    Sorter sorter{classes, signs};
    for (std::size_t c = first; c < last; ++c) sorter.sort_along(c);
    return std::move(sorter).result();
  });
  DisjointSets<Index> same_point{classes.crossings.vertices.size()};
  for (const auto& part : sorted) {
    signs.add_counts(part.signs);
    for (const auto& [a, b] : part.same_point) same_point.join(a, b);
  }
  Graph graph;
  graph.vertices = number_vertices(classes, std::move(same_point));
  auto parts = made_in_pieces(classes.count(), threads, [&](std::size_t first, std::size_t last) {
    EdgeCutter cutter{classes, signs};
    for (std::size_t c = first; c < last; ++c) cutter.cut_into_edges(c);
    return std::move(cutter).result();
  });
  for (const auto& part : parts) signs.add_counts(part.signs);
  join(parts, graph, threads);
  return graph;
}

void Graph::let_approximations_go() {
  meets.reserve(vertices.size());
  for (const Vertex& vertex : vertices) meets.push_back(vertex.planes);
  let_go(vertices);
  let_go(outlines);
}

std::vector<Vec> positions_of(const Prepared& prepared, const Graph& graph, ThreadLimit threads) {
  std::vector<Vec> positions(graph.vertices.size());
  in_pieces(positions.size(), 4096, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const Vertex& v = graph.vertices[k];
      positions[k] = exact::meet_position(v.approx, prepared.planes[v.planes[0]], prepared.planes[v.planes[1]],
                                          prepared.planes[v.planes[2]]);
    }
  });
  return positions;
}

}  // namespace cleave::topology::detail
