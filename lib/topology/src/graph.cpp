#include <algorithm>
#include <numeric>

#include "cleave/core/assert.hpp"
#include "detail/crossings.hpp"
#include "detail/pieces.hpp"
#include "detail/position.hpp"
#include "detail/stages.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Sign;

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Sorts the vertices along each line of space, finds which are the same point, and cuts the lines into edges.
class GraphBuilder {
 public:
  GraphBuilder(const Prepared& prepared, const Traces& traces, Signs& signs)
      : prepared_{prepared},
        traces_{traces},
        signs_{signs},
        crossings_{find_crossings(prepared, traces, signs)},
        same_point_{crossings_.vertices.size()} {}

  Graph run() {
    group_lines();
    const std::size_t classes = class_begin_.size() - 1;
    sorted_begin_.assign(classes + 1, 0);
    for (std::size_t c = 0; c < classes; ++c) sort_along(c);
    number_vertices();
    for (std::size_t c = 0; c < classes; ++c) cut_into_edges(c);
    return std::move(graph_);
  }

 private:
  struct Item {
    double t;
    Index vertex, transversal;
    Sign sense;  ///< of the transversal plane's normal along the line
  };

  /// Lines of one class together, classes in order of their first line.
  void group_lines() {
    const std::size_t lines = traces_.lines.size();
    std::vector<Index> class_of(lines);
    Index classes = 0;
    for (Index l = 0; l < lines; ++l) {
      const Index root = crossings_.coaxial.find(l);
      class_of[l] = root == l ? classes++ : class_of[root];
    }
    class_begin_.assign(classes + std::size_t{1}, 0);
    for (const Index c : class_of) ++class_begin_[c + std::size_t{1}];
    for (std::size_t i = 1; i < class_begin_.size(); ++i) class_begin_[i] += class_begin_[i - 1];
    class_lines_.resize(lines);
    auto next = class_begin_;
    for (Index l = 0; l < lines; ++l) class_lines_[next[class_of[l]]++] = l;

    items_begin_.assign(classes + std::size_t{1}, 0);
    for (const OnLine& on : crossings_.on_lines) ++items_begin_[class_of[on.line] + std::size_t{1}];
    for (std::size_t i = 1; i < items_begin_.size(); ++i) items_begin_[i] += items_begin_[i - 1];
    on_class_.resize(crossings_.on_lines.size());
    next = items_begin_;
    for (const OnLine& on : crossings_.on_lines) on_class_[next[class_of[on.line]]++] = on;

    line_intervals_.assign(lines + 1, 0);
    for (const Interval& interval : traces_.intervals) ++line_intervals_[interval.line + std::size_t{1}];
    for (std::size_t i = 1; i < line_intervals_.size(); ++i) line_intervals_[i] += line_intervals_[i - 1];
  }

  [[nodiscard]] const Line& representative(std::size_t c) const { return traces_.lines[class_lines_[class_begin_[c]]]; }

  /// Negative when a comes before b in the direction of the line, zero when they are one point.
  Sign compare(const Item& a, const Item& b) {
    if (a.vertex == b.vertex) return Sign::zero;
    const Vertex& v = crossings_.vertices[a.vertex];
    return signs_.side(v.approx, v.planes[0], v.planes[1], v.planes[2], b.transversal) * b.sense;
  }

  void sort_along(std::size_t c) {
    const Line& line = representative(c);
    std::vector<Item>& items = scratch_;
    items.clear();
    for (Index k = items_begin_[c]; k < items_begin_[c + 1]; ++k) {
      const OnLine& on = on_class_[k];
      const Vertex& v = crossings_.vertices[on.vertex];
      const Sign sense = signs_.det3(line.p, line.q, on.transversal);
      CLEAVE_ASSERT(sense != Sign::zero);
      items.push_back({dot(v.approx.x, line.approx.m) / v.approx.w, on.vertex, on.transversal, sense});
    }
    std::ranges::sort(items,
                      [](const Item& a, const Item& b) { return a.t < b.t || (!(b.t < a.t) && a.vertex < b.vertex); });
    bool in_order = true;
    for (std::size_t i = 1; i < items.size() && in_order; ++i)
      in_order = compare(items[i - 1], items[i]) != Sign::positive;
    if (!in_order) {
      std::ranges::stable_sort(items, [&](const Item& a, const Item& b) { return compare(a, b) == Sign::negative; });
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (i > 0 && compare(items[i - 1], items[i]) == Sign::zero) {
        same_point_.unite(items[i - 1].vertex, items[i].vertex);
      } else {
        sorted_.push_back(items[i].vertex);  // the first of each point is enough
      }
    }
    sorted_begin_[c + 1] = static_cast<Index>(sorted_.size());
  }

  void number_vertices() {
    number_.assign(crossings_.vertices.size(), none);
    for (Index v = 0; v < crossings_.vertices.size(); ++v) {
      const Index root = same_point_.find(v);
      if (root == v) {
        number_[v] = static_cast<Index>(graph_.vertices.size());
        graph_.vertices.push_back(crossings_.vertices[v]);
      } else {
        number_[v] = number_[root];
      }
    }
  }

  /// The range [first, last] of sorted vertices of the class inside the interval; first > last when there is none.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> span_of(std::size_t c, const Interval& interval, bool same_direction) {
    const HalfSpace lower = same_direction ? interval.lower : interval.upper;
    const HalfSpace upper = same_direction ? interval.upper : interval.lower;
    const auto inside = [&](std::ptrdiff_t i, HalfSpace h) {
      const Vertex& v = crossings_.vertices[sorted_[static_cast<std::size_t>(i)]];
      return signs_.inside(v.approx, v.planes[0], v.planes[1], v.planes[2], h) != Sign::negative;
    };
    std::ptrdiff_t first = sorted_begin_[c], last = sorted_begin_[c + 1];
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

  void cut_into_edges(std::size_t c) {
    const std::size_t count = sorted_begin_[c + 1] - sorted_begin_[c];
    if (count < 2) return;
    const Line& main = representative(c);

    // Facet planes that contain the line, each with a plane that meets it there.
    std::vector<Member>& members = members_;
    members.clear();
    for (Index k = class_begin_[c]; k < class_begin_[c + 1]; ++k) {
      const Line& line = traces_.lines[class_lines_[k]];
      members.push_back({line.p, line.q});
      if (line.q < prepared_.facet_planes) members.push_back({line.q, line.p});
    }
    std::ranges::stable_sort(members, {}, &Member::plane);
    const auto repeated = std::ranges::unique(members, {}, &Member::plane);
    members.erase(repeated.begin(), repeated.end());
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
    const std::ptrdiff_t base = sorted_begin_[c];
    bool any = false;
    for (Index k = class_begin_[c]; k < class_begin_[c + 1]; ++k) {
      const Index l = class_lines_[k];
      const Line& line = traces_.lines[l];
      const bool same_direction = signs_.same_sense(line.approx, line.p, line.q, main.approx, main.p, main.q);
      for (Index i = line_intervals_[l]; i < line_intervals_[l + std::size_t{1}]; ++i) {
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
      graph_.edges.push_back({number_[sorted_[at]], number_[sorted_[at + 1]], line_number, first_use, uses});
    }
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

  const Prepared& prepared_;
  const Traces& traces_;
  Signs& signs_;
  Crossings crossings_;
  UnionFind same_point_;
  std::vector<Index> class_begin_, class_lines_, items_begin_, line_intervals_, sorted_begin_, sorted_, number_;
  std::vector<OnLine> on_class_;
  std::vector<Item> scratch_;
  std::vector<std::uint8_t> drawn_;
  struct Member {
    Index plane, transversal;
  };
  std::vector<Member> members_;
  Graph graph_;
};

}  // namespace

Graph build_graph(const Prepared& prepared, const Traces& traces, Signs& signs) {
  return GraphBuilder{prepared, traces, signs}.run();
}

std::vector<Vec> positions_of(const Prepared& prepared, const Graph& graph, ThreadLimit threads) {
  std::vector<Vec> positions(graph.vertices.size());
  in_pieces(positions.size(), 4096, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const Vertex& v = graph.vertices[k];
      positions[k] = meet_position(v.approx, prepared.planes[v.planes[0]], prepared.planes[v.planes[1]],
                                   prepared.planes[v.planes[2]]);
    }
  });
  return positions;
}

}  // namespace cleave::topology::detail
