#include "detail/crossings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

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

/// A meet so far away that it cannot lie in the scene (positions are below 1/2 in each coordinate).
bool far_away(const PointApprox& point) {
  const double w = std::abs(point.w) + exact::det3_error_bound;
  return std::ranges::any_of(point.x, [w](double x) { return std::abs(x) - exact::meet_error_bound > 0.75 * w; });
}

class Finder {
 public:
  Finder(const Traces& traces, const Signs& signs) : traces_{traces}, signs_{signs.another()} {}

  struct Result {
    std::vector<Vertex> vertices;
    std::vector<OnLine> on_lines;
    std::vector<std::array<Index, 2>> coaxial;  ///< lines
    Signs signs;
  };
  [[nodiscard]] Result result() && { return {std::move(vertices_), std::move(on_lines_), std::move(coaxial_), signs_}; }

  /// Segment `s` of a plane with all those after it.
  void meet_others(Index plane, const Segment& s, std::span<const Segment> others) {
    for (const Segment& t : others) {
      if (s.other == t.other) continue;
      if (!s.outline && !t.outline && (s.other < plane || t.other < plane)) continue;
      if (!apart(s, t)) meet_pair(plane, s, t);
    }
  }

 private:
  void meet_pair(Index plane, const Segment& s, const Segment& t) {
    const Interval &a = traces_.intervals[s.interval], &b = traces_.intervals[t.interval];
    const Line& line = traces_.lines[a.line];
    const PointApprox point = exact::meet(line.approx, signs_.plane(t.other));
    if (far_away(point)) return;
    if (signs_.det3(point, line.p, line.q, t.other) == Sign::zero) {
      if (signs_.parallel_side(line.p, line.q, t.other) != Sign::zero) return;
      coaxial_.push_back({a.line, b.line});
      if (const Index third = traces_.find_line(s.other, t.other); third != none) coaxial_.push_back({a.line, third});
      return;
    }
    for (const HalfSpace h : {a.lower, a.upper, b.lower, b.upper}) {
      if (signs_.inside(point, line.p, line.q, t.other, h) == Sign::negative) return;
    }
    const Index vertex = static_cast<Index>(vertices_.size());
    vertices_.push_back({{line.p, line.q, t.other}, point});
    on_lines_.push_back({a.line, vertex, t.other});
    on_lines_.push_back({b.line, vertex, s.other});
    if (const Index third = traces_.find_line(s.other, t.other); third != none) {
      on_lines_.push_back({third, vertex, plane});
    }
  }

  const Traces& traces_;
  Signs signs_;
  std::vector<Vertex> vertices_;
  std::vector<OnLine> on_lines_;
  std::vector<std::array<Index, 2>> coaxial_;
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
    Finder finder{traces, signs};
    auto plane = static_cast<Index>(std::ranges::upper_bound(begin, first) - begin.begin()) - 1;
    for (std::size_t s = first; s < last; ++s) {
      while (begin[plane + std::size_t{1}] <= s) ++plane;
      finder.meet_others(plane, segments[s],
                         std::span{segments}.subspan(s + 1, begin[plane + std::size_t{1}] - (s + 1)));
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
