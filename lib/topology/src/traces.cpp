#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "detail/position.hpp"
#include "detail/stages.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LineApprox;
using exact::PointApprox;
using exact::Sign;

/// The part of the line of p and q inside all given half-spaces, as its two ends.
class Clipper {
 public:
  Clipper(Signs& signs, Index p, Index q, const LineApprox& line) : signs_{signs}, p_{p}, q_{q}, line_{line} {}

  /// False when nothing is left.
  bool cut(HalfSpace h) {
    if (h.plane == p_ || h.plane == q_) return true;
    const PointApprox point = exact::meet(line_, signs_.plane(h.plane));
    const Sign rate = signs_.det3(point, p_, q_, h.plane);
    if (rate == Sign::zero) {
      const Sign side = signs_.parallel_side(p_, q_, h.plane);
      return side == Sign::zero || (side == Sign::positive) == h.inside_positive;
    }
    auto& end = (rate == Sign::positive) == h.inside_positive ? lower_ : upper_;
    if (!end) {
      end = End{h, point};
    } else if (signs_.inside(end->point, p_, q_, end->half_space.plane, h) == Sign::negative) {
      end = End{h, point};
    }
    return true;
  }
  /// False when empty; one single point is not empty.
  [[nodiscard]] bool any() {
    return lower_ && upper_ &&
           signs_.inside(lower_->point, p_, q_, lower_->half_space.plane, upper_->half_space) != Sign::negative;
  }
  struct End {
    HalfSpace half_space;
    PointApprox point;
  };
  [[nodiscard]] const End& lower() const { return *lower_; }
  [[nodiscard]] const End& upper() const { return *upper_; }
  [[nodiscard]] std::array<double, 3> position(const End& end) const {
    return meet_position(end.point, signs_.plane(p_), signs_.plane(q_), signs_.plane(end.half_space.plane));
  }

 private:
  Signs& signs_;
  Index p_, q_;
  const LineApprox& line_;
  std::optional<End> lower_, upper_;
};

/// Pairs of facets on different planes whose boxes meet, by a sweep along x.
template <class Visit>
void for_each_candidate(const Prepared& prepared, Visit&& visit) {
  const auto& facets = prepared.facets;
  std::vector<Index> order(facets.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, [&](Index a, Index b) {
    return facets[a].lo[0] < facets[b].lo[0] || (facets[a].lo[0] == facets[b].lo[0] && a < b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Facet& f = facets[order[i]];
    for (std::size_t j = i + 1; j < order.size() && facets[order[j]].lo[0] <= f.hi[0]; ++j) {
      const Facet& g = facets[order[j]];
      if (f.plane == g.plane || f.lo[1] > g.hi[1] || g.lo[1] > f.hi[1] || f.lo[2] > g.hi[2] || g.lo[2] > f.hi[2])
        continue;
      visit(order[i], order[j]);
    }
  }
}

/// All corners of f safely on one side of the plane: they cannot meet.
bool apart(const Prepared& prepared, const Facet& f, const exact::Plane& plane) {
  constexpr double margin = 0x1p-34;
  if (f.corner_count == 0) return false;
  const auto& n = plane.approx();
  bool above = true, below = true;
  for (Index c = f.first_corner; c < f.first_corner + f.corner_count && (above || below); ++c) {
    const Vec& p = prepared.corners[c];
    const double value = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3];
    above = above && value > margin;
    below = below && value < -margin;
  }
  return above || below;
}

}  // namespace

Index Traces::find_line(Index p, Index q) const {
  if (p > q) std::swap(p, q);
  const auto first = lines.begin() + static_cast<std::ptrdiff_t>(lines_begin[p]);
  const auto last = lines.begin() + static_cast<std::ptrdiff_t>(lines_begin[p + std::size_t{1}]);
  const auto found = std::lower_bound(first, last, q, [](const Line& line, Index other) { return line.q < other; });
  return found != last && found->q == q ? static_cast<Index>(found - lines.begin()) : none;
}

Traces find_traces(const Prepared& prepared, Signs& signs) {
  struct Raw {
    Index p, q;
    Interval interval;
  };
  std::vector<Raw> raw;
  const auto& facets = prepared.facets;
  const auto cut_by_edges = [&](Clipper& clipper, const Facet& f, Index skip) {
    for (Index e = f.first_edge; e < f.first_edge + f.edge_count; ++e) {
      if (e != skip && !clipper.cut(prepared.edges[e])) return false;
    }
    return true;
  };
  const auto add = [&](Index p, Index q, Clipper& clipper, Interval interval) {
    interval.lower = clipper.lower().half_space;
    interval.upper = clipper.upper().half_space;
    interval.from = clipper.position(clipper.lower());
    interval.to = clipper.position(clipper.upper());
    raw.push_back({p, q, interval});
  };
  constexpr HalfSpace nowhere{none, true};
  const Interval trace{none, nowhere, nowhere, none, true, none, {}, {}};

  for_each_candidate(prepared, [&](Index i, Index j) {
    const Facet &f = facets[i], &g = facets[j];
    const Index p = std::min(f.plane, g.plane), q = std::max(f.plane, g.plane);
    if (apart(prepared, f, signs.plane(g.plane)) || apart(prepared, g, signs.plane(f.plane))) return;
    const LineApprox line = exact::line_of(signs.plane(p), signs.plane(q));
    constexpr double parallel_bound = 0x1p-46;  // > 48 u, the error of the direction's components
    if (std::abs(line.m[0]) < parallel_bound && std::abs(line.m[1]) < parallel_bound &&
        std::abs(line.m[2]) < parallel_bound && signs.plane(p).parallel_to(signs.plane(q))) {
      return;
    }
    Clipper clipper{signs, p, q, line};
    if (!cut_by_edges(clipper, f, none) || !cut_by_edges(clipper, g, none)) return;
    if (clipper.any()) add(p, q, clipper, trace);
  });

  // Planes with several facets: their faces are covered here and not there, so the outlines are drawn too.
  Traces out;
  out.with_outlines.assign(prepared.facet_planes, 0);
  for (Index p = 0; p < prepared.facet_planes; ++p) {
    const Index first = prepared.facets_begin[p], last = prepared.facets_begin[p + std::size_t{1}];
    const bool joint = prepared.facets[prepared.facets_on[first]].owner == Owner::joint;
    if (last - first < 2 && !(prepared.keep_dangling && joint)) continue;
    out.with_outlines[p] = 1;
    for (Index k = first; k < last; ++k) {
      const Index number = prepared.facets_on[k];
      const Facet& f = facets[number];
      for (Index e = f.first_edge; e < f.first_edge + f.edge_count; ++e) {
        const HalfSpace edge = prepared.edges[e];
        if (edge.plane == p || signs.plane(edge.plane).parallel_to(signs.plane(p)))
          continue;  // cuts all of it or nothing
        const Index a = std::min(p, edge.plane), b = std::max(p, edge.plane);
        const LineApprox line = exact::line_of(signs.plane(a), signs.plane(b));
        Clipper clipper{signs, a, b, line};
        if (!cut_by_edges(clipper, f, e) || !clipper.any()) continue;
        Interval outline = trace;
        outline.outline_of = number;
        outline.inside_positive = edge.inside_positive;
        outline.edge_plane = edge.plane;
        add(a, b, clipper, outline);
      }
    }
  }

  std::vector<Index> order(raw.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(
      order, [&](Index a, Index b) { return raw[a].p < raw[b].p || (raw[a].p == raw[b].p && raw[a].q < raw[b].q); });
  out.intervals.reserve(raw.size());
  for (const Index r : order) {
    if (out.lines.empty() || out.lines.back().p != raw[r].p || out.lines.back().q != raw[r].q) {
      out.lines.push_back({raw[r].p, raw[r].q, exact::line_of(signs.plane(raw[r].p), signs.plane(raw[r].q))});
    }
    out.intervals.push_back(raw[r].interval);
    out.intervals.back().line = static_cast<Index>(out.lines.size() - 1);
  }
  out.lines_begin.assign(prepared.planes.size() + 1, 0);
  for (const Line& line : out.lines) ++out.lines_begin[line.p + std::size_t{1}];
  for (std::size_t i = 1; i < out.lines_begin.size(); ++i) out.lines_begin[i] += out.lines_begin[i - 1];
  return out;
}

}  // namespace cleave::topology::detail
