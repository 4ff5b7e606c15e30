#include "detail/crossings.hpp"

#include <algorithm>
#include <cmath>

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

/// A meet so far away that it cannot lie in the scene (positions are below 1/2 in each coordinate).
bool far_away(const PointApprox& point) {
  const double w = std::abs(point.w) + exact::det3_error_bound;
  return std::ranges::any_of(point.x, [w](double x) { return std::abs(x) - exact::meet_error_bound > 0.75 * w; });
}

class Finder {
 public:
  Finder(const Prepared& prepared, const Traces& traces, Signs& signs)
      : prepared_{prepared}, traces_{traces}, signs_{signs}, out_{{}, {}, UnionFind{traces.lines.size()}} {}

  Crossings run() {
    std::vector<Index> begin(prepared_.facet_planes + std::size_t{1}, 0);
    for_each_drawing([&](Index plane, Index, bool) { ++begin[plane + std::size_t{1}]; });
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    segments_.resize(begin.back());
    auto next = begin;
    for_each_drawing([&](Index plane, Index interval, bool outline) {
      segments_[next[plane]++] = project(plane, interval, outline);
    });
    for (Index plane = 0; plane < prepared_.facet_planes; ++plane) {
      in_plane(plane, begin[plane], begin[plane + std::size_t{1}]);
    }
    return std::move(out_);
  }

 private:
  /// Which interval is looked at in which plane. Traces count in the lower of their planes: a vertex of three planes is
  /// found in the lowest one. Where outlines are drawn every trace is needed.
  template <class Visit>
  void for_each_drawing(Visit&& visit) const {
    for (Index k = 0; k < traces_.intervals.size(); ++k) {
      const Interval& interval = traces_.intervals[k];
      const Line& line = traces_.lines[interval.line];
      if (interval.outline_of != none) {
        visit(prepared_.facets[interval.outline_of].plane, k, true);
      } else {
        visit(line.p, k, false);
        if (traces_.with_outlines[line.q] != 0) visit(line.q, k, false);
      }
    }
  }

  [[nodiscard]] Segment project(Index plane, Index interval, bool outline) const {
    const auto& n = signs_.plane(plane).approx();
    const std::size_t drop = std::abs(n[0]) >= std::abs(n[1]) && std::abs(n[0]) >= std::abs(n[2]) ? 0
                             : std::abs(n[1]) >= std::abs(n[2])                                   ? 1
                                                                                                  : 2;
    const std::size_t u = drop == 0 ? 1 : 0, v = drop == 2 ? 1 : 2;
    const Interval& i = traces_.intervals[interval];
    const Line& line = traces_.lines[i.line];
    return {i.from[u], i.from[v], i.to[u], i.to[v], interval, line.p == plane ? line.q : line.p, outline};
  }

  void in_plane(Index plane, Index first, Index last) {
    for (Index i = first; i < last; ++i) {
      const Segment& s = segments_[i];
      for (Index j = i + 1; j < last; ++j) {
        const Segment& t = segments_[j];
        if (s.other == t.other) continue;
        if (!s.outline && !t.outline && (s.other < plane || t.other < plane)) continue;
        if (!apart(s, t)) meet_pair(plane, s, t);
      }
    }
  }

  void meet_pair(Index plane, const Segment& s, const Segment& t) {
    const Interval &a = traces_.intervals[s.interval], &b = traces_.intervals[t.interval];
    const Line& line = traces_.lines[a.line];
    const PointApprox point = exact::meet(line.approx, signs_.plane(t.other));
    if (far_away(point)) return;
    if (signs_.det3(point, line.p, line.q, t.other) == Sign::zero) {
      if (signs_.parallel_side(line.p, line.q, t.other) != Sign::zero) return;
      out_.coaxial.unite(a.line, b.line);
      if (const Index third = traces_.find_line(s.other, t.other); third != none) out_.coaxial.unite(a.line, third);
      return;
    }
    for (const HalfSpace h : {a.lower, a.upper, b.lower, b.upper}) {
      if (signs_.inside(point, line.p, line.q, t.other, h) == Sign::negative) return;
    }
    const Index vertex = static_cast<Index>(out_.vertices.size());
    out_.vertices.push_back({{line.p, line.q, t.other}, point});
    out_.on_lines.push_back({a.line, vertex, t.other});
    out_.on_lines.push_back({b.line, vertex, s.other});
    if (const Index third = traces_.find_line(s.other, t.other); third != none) {
      out_.on_lines.push_back({third, vertex, plane});
    }
  }

  const Prepared& prepared_;
  const Traces& traces_;
  Signs& signs_;
  std::vector<Segment> segments_;
  Crossings out_;
};

}  // namespace

Crossings find_crossings(const Prepared& prepared, const Traces& traces, Signs& signs) {
  return Finder{prepared, traces, signs}.run();
}

}  // namespace cleave::topology::detail
