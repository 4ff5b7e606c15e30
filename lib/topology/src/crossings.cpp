#include "detail/crossings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include "cleave/core/disjoint_sets.hpp"

#include "detail/pieces.hpp"

namespace cleave::topology::detail {
namespace {

using exact::PointApprox;
using exact::Sign;

/// An interval seen in one plane, projected along the plane's largest normal component.
struct Segment {
  double ax, ay, bx, by;
  Index interval;
  Index other;  ///< the other plane of its line
  bool outline;
};

/// Safely apart in the projection; `margin` is far above the error of the end positions.
bool apart(const Segment& s, const Segment& t) {
  constexpr double margin = 0x1p-36;
  if (std::max(s.ax, s.bx) + margin < std::min(t.ax, t.bx) || std::max(t.ax, t.bx) + margin < std::min(s.ax, s.bx) ||
      std::max(s.ay, s.by) + margin < std::min(t.ay, t.by) || std::max(t.ay, t.by) + margin < std::min(s.ay, s.by)) {
    return true;
  }
  const auto same_side = [](const Segment& u, const Segment& v) {
    const double dx = u.bx - u.ax, dy = u.by - u.ay;
    const double a = dx * (v.ay - u.ay) - dy * (v.ax - u.ax);
    const double b = dx * (v.by - u.ay) - dy * (v.bx - u.ax);
    return (a > margin && b > margin) || (a < -margin && b < -margin);
  };
  return same_side(s, t) || same_side(t, s);
}

/// Safely with more than a point in common, of two on one line.
bool overlap(const Segment& s, const Segment& t) {
  constexpr double margin = 0x1p-36;
  const auto common = [](double a, double b, double c, double d) {
    return std::min(std::max(a, b), std::max(c, d)) - std::max(std::min(a, b), std::min(c, d)) > margin;
  };
  return common(s.ax, s.bx, t.ax, t.bx) || common(s.ay, s.by, t.ay, t.by);
}

/// A meet so far away that it cannot lie in the scene (positions are below 1/2 in each coordinate).
bool far_away(const PointApprox& point) {
  const double w = std::abs(point.w) + exact::det3_error_bound;
  return std::ranges::any_of(point.x, [w](double x) { return std::abs(x) - exact::meet_error_bound > 0.75 * w; });
}

/// Which corners the line of each segment of a plane goes through, as both its planes hold them, and whether the
/// segment was found to meet another one there. Where many planes hold a corner every pair of their lines meets there:
/// it is enough that each meets one of the others, so that all are known to be one point.
class AtCorners {
 public:
  struct Entry {
    Index corner;
    Index vertex = none;  ///< the first of those that are found to be the same point over the lines they are on
  };

  explicit AtCorners(const HeldCorners& held) : held_{held} {}

  void begin(Index plane, std::span<const Segment> segments) {
    entries_.clear();
    begin_.assign(1, 0);
    if (!held_.any()) return;
    const auto own = held_.of(plane);
    Index last = none;  // segments of one line stand together
    for (const Segment& s : segments) {
      if (s.other != last) {
        corners_.clear();
        std::ranges::set_intersection(own, held_.of(s.other), std::back_inserter(corners_));
        last = s.other;
      }
      for (const Index corner : corners_) entries_.push_back({corner});
      begin_.push_back(entries_.size());
    }
  }
  /// Of two segments at the one corner that both lines go through; none where that is none or several.
  struct Pair {
    Entry *one = nullptr, *other = nullptr;
    [[nodiscard]] bool any() const { return one != nullptr; }
    /// Both meet others there, and what they meet is known to be one point.
    [[nodiscard]] bool known() const { return any() && one->vertex != none && one->vertex == other->vertex; }
    [[nodiscard]] Index corner() const { return any() ? one->corner : none; }
  };
  [[nodiscard]] Pair at_one_corner(std::size_t i, std::size_t k) {
    Pair found;
    if (entries_.empty()) return found;
    const auto ones = of(i), others = of(k);
    for (auto a = ones.begin(), b = others.begin(); a != ones.end() && b != others.end();) {
      if (a->corner == b->corner) {
        if (found.any()) return {};
        found = {&*a++, &*b++};
      } else {
        ++(a->corner < b->corner ? a : b);
      }
    }
    return found;
  }
  /// The two were found to meet in this vertex, which is on both lines.
  static void met(const Pair& at, Index vertex) {
    if (!at.any()) return;
    if (at.one->vertex == none) at.one->vertex = at.other->vertex == none ? vertex : at.other->vertex;
    if (at.other->vertex == none) at.other->vertex = at.one->vertex;
  }

 private:
  [[nodiscard]] std::span<Entry> of(std::size_t i) {
    return std::span{entries_}.subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

  const HeldCorners& held_;
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;  ///< of each segment (CSR)
  std::vector<Index> corners_;
};

class Finder {
 public:
  Finder(const Prepared& prepared, const Traces& traces, const Signs& signs)
      : traces_{traces}, signs_{signs.another()}, at_corners_{prepared.held} {}

  struct Result {
    std::vector<Vertex> vertices;
    std::vector<OnLine> on_lines;
    std::vector<std::array<Index, 2>> coaxial;  ///< lines
    Signs signs;
  };
  [[nodiscard]] Result result() && { return {std::move(vertices_), std::move(on_lines_), std::move(coaxial_), signs_}; }

  /// Some segments of a plane, each with all those after it.
  void meet_others(Index plane, std::span<const Segment> segments, std::size_t first, std::size_t last) {
    head_.clear();
    at_corners_.begin(plane, segments);
    for (std::size_t i = first; i < last; ++i) {
      const Segment& s = segments[i];
      for (std::size_t k = i + 1; k < segments.size(); ++k) {
        const Segment& t = segments[k];
        if (s.other == t.other) continue;
        if (!s.outline && !t.outline && (s.other < plane || t.other < plane)) continue;
        if (apart(s, t) || known(i, k)) continue;
        const AtCorners::Pair corner = at_corners_.at_one_corner(i, k);
        if (corner.known() && cross_at(plane, s, t, corner)) continue;
        const std::size_t before = vertices_.size();
        const bool on_one_line = meet_pair(plane, s, t, corner.corner());
        if (vertices_.size() > before) AtCorners::met(corner, static_cast<Index>(before));
        if (on_one_line && lowest(plane, s) && lowest(plane, t) && overlap(s, t)) {
          if (head_.empty()) head_.assign(segments.size(), none);
          if (head_[i] == none) head_[i] = static_cast<Index>(i);
          if (head_[k] == none) head_[k] = static_cast<Index>(i);
        }
      }
    }
  }

 private:
  static bool lowest(Index plane, const Segment& s) { return !s.outline && s.other > plane; }
  /// Segments on one line with the same head overlap with it, and so, where with each other, all in a common point.
  /// That they are coaxial, and with the line of their other planes, is found in pairs with the head: here, and in the
  /// head's other plane.
  [[nodiscard]] bool known(std::size_t i, std::size_t k) const {
    return !head_.empty() && head_[k] != none && head_[k] == head_[i];
  }

  /// Of two that both end or pass in one corner, as is known: all that is not is that the line of their other planes
  /// goes through it, too. False where they lie on one line.
  bool cross_at(Index plane, const Segment& s, const Segment& t, const AtCorners::Pair& at) {
    const Line& line = traces_.lines[traces_.intervals[s.interval].line];
    const PointApprox point = exact::meet(line.approx, signs_.plane(t.other));
    if (signs_.det3(point, line.p, line.q, t.other) == Sign::zero) return false;
    const Index third = traces_.find_line(s.other, t.other);
    if (third != none && is_new(third, at.corner())) {
      on_lines_.push_back({third, at.one->vertex, plane, at.corner()});
    }
    return true;
  }
  /// False where the line is known to go through the corner; nearly always, as it meets as many planes there.
  bool is_new(Index line, Index corner) {
    if (corners_of_.empty()) corners_of_.assign(traces_.lines.size(), {none, none});
    for (Index& known : corners_of_[line]) {
      if (known == corner) return false;
      if (known != none) continue;
      known = corner;
      return true;
    }
    return true;  // more corners than are remembered
  }

  /// Whether they lie on one line. `corner`: the one that all three planes hold, or none.
  bool meet_pair(Index plane, const Segment& s, const Segment& t, Index corner) {
    const Interval &a = traces_.intervals[s.interval], &b = traces_.intervals[t.interval];
    const Line& line = traces_.lines[a.line];
    PointApprox point = exact::meet(line.approx, signs_.plane(t.other));
    if (far_away(point)) return false;
    if (signs_.det3(point, line.p, line.q, t.other) == Sign::zero) {
      if (signs_.parallel_side(line.p, line.q, t.other) != Sign::zero) return false;
      coaxial_.push_back({a.line, b.line});
      if (const Index third = traces_.find_line(s.other, t.other); third != none) coaxial_.push_back({a.line, third});
      return true;
    }
    if (!exact::det3_filtered(point)) {
      point = exact::refined_meet(signs_.plane(line.p), signs_.plane(line.q), signs_.plane(t.other));
      if (far_away(point)) return false;
    }
    for (const HalfSpace h : {a.lower, a.upper, b.lower, b.upper}) {
      if (signs_.inside(point, line.p, line.q, t.other, h) == Sign::negative) return false;
    }
    const Index vertex = static_cast<Index>(vertices_.size());
    vertices_.push_back({{line.p, line.q, t.other}, point});
    on_lines_.push_back({a.line, vertex, t.other, corner});
    on_lines_.push_back({b.line, vertex, s.other, corner});
    if (const Index third = traces_.find_line(s.other, t.other); third != none) {
      on_lines_.push_back({third, vertex, plane, corner});
    }
    return false;
  }

  const Traces& traces_;
  Signs signs_;
  std::vector<Vertex> vertices_;
  std::vector<OnLine> on_lines_;
  std::vector<std::array<Index, 2>> coaxial_;
  /// Of each segment of the plane: the first that overlaps with it on its line, itself where it is that; none. Empty
  /// where none do.
  std::vector<Index> head_;
  AtCorners at_corners_;
  std::vector<std::array<Index, 2>> corners_of_;  ///< of each line: corners it is known to go through
};

Segment project(const Prepared& prepared, const Traces& traces, Index plane, Index interval) {
  const auto [u, v] = View{prepared.planes[plane].approx()};
  const Interval& i = traces.intervals[interval];
  const Line& line = traces.lines[i.line];
  return {i.from[u], i.from[v], i.to[u], i.to[v], interval, line.p == plane ? line.q : line.p, i.outline_of != none};
}

/// Which interval is looked at in which plane. Traces count in the lower of their planes: a vertex of three planes is
/// found in the lowest one. Where outlines are drawn every trace is needed.
template <class Visit>
void for_each_drawing(const Prepared& prepared, const Traces& traces, const Visit& visit) {
  for (Index k = 0; k < traces.intervals.size(); ++k) {
    const Interval& interval = traces.intervals[k];
    const Line& line = traces.lines[interval.line];
    if (interval.outline_of != none) {
      visit(prepared.facets[interval.outline_of].plane, k);
    } else {
      visit(line.p, k);
      if (traces.with_outlines[line.q] != 0) visit(line.q, k);
    }
  }
}

struct Drawings {
  std::vector<Index> begin;  ///< first segment of each facet plane (CSR)
  std::vector<Segment> segments;
};

Drawings draw(const Prepared& prepared, const Traces& traces, ThreadLimit threads) {
  Drawings out{std::vector<Index>(prepared.facet_planes + std::size_t{1}, 0), {}};
  for_each_drawing(prepared, traces, [&](Index plane, Index) { ++out.begin[plane + std::size_t{1}]; });
  begin_from_counts(out.begin);
  std::vector<Index> drawn(out.begin.back());
  auto next = out.begin;
  for_each_drawing(prepared, traces, [&](Index plane, Index interval) { drawn[next[plane]++] = interval; });
  out.segments.resize(drawn.size());
  in_pieces(prepared.facet_planes, 16, threads, [&](std::size_t first, std::size_t last) {
    for (auto plane = static_cast<Index>(first); plane < last; ++plane) {
      for (Index k = out.begin[plane]; k < out.begin[plane + std::size_t{1}]; ++k) {
        out.segments[k] = project(prepared, traces, plane, drawn[k]);
      }
    }
  });
  return out;
}

}  // namespace

Crossings find_crossings(const Prepared& prepared, const Traces& traces, Signs& signs, ThreadLimit threads) {
  const auto [begin, segments] = draw(prepared, traces, threads);
  auto results = made_in_pieces(segments.size(), threads, [&](std::size_t first, std::size_t last) {
    Finder finder{prepared, traces, signs};
    auto plane = static_cast<Index>(std::ranges::upper_bound(begin, first) - begin.begin()) - 1;
    // Segments are taken in the same groups whatever the pieces, a group in the piece that has its first.
    constexpr std::size_t group = 1024;
    for (; plane < prepared.facet_planes && begin[plane] < last; ++plane) {
      const std::size_t own = begin[plane], end = begin[plane + std::size_t{1}];
      std::size_t from = own < first ? own + (first - own + group - 1) / group * group : own;
      for (; from < std::min(end, last); from += group) {
        finder.meet_others(plane, std::span{segments}.subspan(own, end - own), from - own,
                           std::min(from + group, end) - own);
      }
    }
    return std::move(finder).result();
  });
  Crossings out{{}, {}, DisjointSets<Index>{traces.lines.size()}};
  for (const auto& result : results) {
    signs.add_counts(result.signs);
    for (const auto& [a, b] : result.coaxial) out.coaxial.join(a, b);
  }
  const auto before = offsets_of(results, &Finder::Result::vertices);
  out.on_lines = joined(results, &Finder::Result::on_lines, threads,
                        [&](OnLine& on, std::size_t part) { on.vertex += static_cast<Index>(before[part]); });
  out.vertices = joined(results, &Finder::Result::vertices, threads, [](Vertex&, std::size_t) {});
  return out;
}

}  // namespace cleave::topology::detail
