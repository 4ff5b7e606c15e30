#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>

#include "cleave/exact/predicates.hpp"
#include "cleave/facets/gaps.hpp"
#include "detail/phases.hpp"
#include "detail/pieces.hpp"

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
  /// How far, about, the end of one half-space lies outside the other where nothing is left.
  [[nodiscard]] double missed_by() const {
    if (!lower_ || !upper_) return std::numeric_limits<double>::infinity();
    const auto& n = signs_.plane(upper_->half_space.plane).approx();
    const auto& [x, w] = lower_->point;
    return w == 0 ? 0 : std::abs((n[0] * x[0] + n[1] * x[1] + n[2] * x[2]) / w + n[3]);
  }
  struct End {
    HalfSpace half_space;
    PointApprox point;
  };
  [[nodiscard]] const End& lower() const { return *lower_; }
  [[nodiscard]] const End& upper() const { return *upper_; }
  [[nodiscard]] std::array<double, 3> position(const End& end) const {
    return exact::meet_position(end.point, signs_.plane(p_), signs_.plane(q_), signs_.plane(end.half_space.plane));
  }

 private:
  Signs& signs_;
  Index p_, q_;
  const LineApprox& line_;
  std::optional<End> lower_, upper_;
};

/// The box of a facet, for the sweep.
struct Boxed {
  Vec lo, hi;
  Index plane, facet;
};

/// By where they begin along x; grown by `margin`.
std::vector<Boxed> boxes_along_x(const Prepared& prepared, double margin) {
  std::vector<Boxed> boxes;
  boxes.reserve(prepared.facets.size());
  for (const Facet& f : prepared.facets) {
    Boxed box{f.lo, f.hi, f.plane, static_cast<Index>(boxes.size())};
    for (std::size_t k = 0; k < 3; ++k) {
      box.lo[k] -= margin;
      box.hi[k] += margin;
    }
    boxes.push_back(box);
  }
  std::ranges::sort(boxes, [](const Boxed& a, const Boxed& b) {
    return a.lo[0] < b.lo[0] || (!(b.lo[0] < a.lo[0]) && a.facet < b.facet);
  });
  return boxes;
}

/// Pairs of facets whose boxes meet, the first one of [first, last) in the order along x.
template <class Visit>
void for_each_candidate(const std::vector<Boxed>& boxes, std::size_t first, std::size_t last, const Visit& visit) {
  for (std::size_t i = first; i < last; ++i) {
    const Boxed& f = boxes[i];
    for (std::size_t j = i + 1; j < boxes.size() && boxes[j].lo[0] <= f.hi[0]; ++j) {
      const Boxed& g = boxes[j];
      if (f.lo[1] > g.hi[1] || g.lo[1] > f.hi[1] || f.lo[2] > g.hi[2] || g.lo[2] > f.hi[2]) continue;
      visit(f.facet, g.facet);
    }
  }
}

/// Where the corners of f lie, seen from a plane.
struct Heights {
  bool apart = false;  ///< all safely on one side: f cannot meet the plane
  double least = 0;    ///< then: how far
  bool across = true;  ///< some safely on either side
};
Heights heights(const Prepared& prepared, const Facet& f, const exact::Plane& plane) {
  constexpr double margin = 0x1p-34;
  if (f.corner_count == 0) return {};
  const auto& n = plane.approx();
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (Index c = f.first_corner; c < f.first_corner + f.corner_count; ++c) {
    const Vec& p = prepared.corners[c];
    const double value = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3];
    lo = std::min(lo, value);
    hi = std::max(hi, value);
    if (lo < -margin && hi > margin) return {};
  }
  return {lo > margin || hi < -margin, std::max(lo, -hi), false};
}

/// An interval with the planes of its line.
struct Found {
  Index p, q;
  Interval interval;
};

class Tracer {
 public:
  Tracer(const Prepared& prepared, const Signs& signs, const GapFinder& gaps)
      : prepared_{prepared}, signs_{signs.another()}, gaps_{gaps} {}

  void trace(Index i, Index j) {
    const Facet &f = prepared_.facets[i], &g = prepared_.facets[j];
    if (f.plane == g.plane) return gaps_.look(i, j, found_gaps_);
    const Index p = std::min(f.plane, g.plane), q = std::max(f.plane, g.plane);
    // Planes' normals are no longer than the root of 3.
    const double near = 2 * gaps_.limit();
    const Heights of_f = heights(prepared_, f, signs_.plane(g.plane));
    if (of_f.apart && of_f.least > near) return;
    const Heights of_g = heights(prepared_, g, signs_.plane(f.plane));
    if (of_g.apart && of_g.least > near) return;
    if (of_f.apart || of_g.apart) return gaps_.look(i, j, found_gaps_);
    const LineApprox line = exact::line_of(signs_.plane(p), signs_.plane(q));
    constexpr double parallel_bound = 0x1p-46;  // > 48 u, the error of the direction's components
    if (std::abs(line.m[0]) < parallel_bound && std::abs(line.m[1]) < parallel_bound &&
        std::abs(line.m[2]) < parallel_bound && signs_.plane(p).parallel_to(signs_.plane(q))) {
      return gaps_.look(i, j, found_gaps_);
    }
    Clipper clipper{signs_, p, q, line};
    if (cut_by_edges(clipper, f, none) && cut_by_edges(clipper, g, none)) {
      if (clipper.any()) {
        if (!of_f.across) look_short(i, j);
        if (!of_g.across) look_short(j, i);
        return add(p, q, clipper, blank);
      }
      if (clipper.missed_by() <= near) return gaps_.look(i, j, found_gaps_);
    }
    if (!of_f.across || !of_g.across) gaps_.look(i, j, found_gaps_);
  }

  /// The sides of all facets of a plane.
  void outline(Index plane) {
    for (Index k = prepared_.facets_begin[plane]; k < prepared_.facets_begin[plane + std::size_t{1}]; ++k) {
      const Index number = prepared_.facets_on[k];
      const Facet& f = prepared_.facets[number];
      for (Index e = f.first_edge; e < f.first_edge + f.edge_count; ++e) {
        const HalfSpace edge = prepared_.edges[e];
        if (edge.plane == plane || signs_.plane(edge.plane).parallel_to(signs_.plane(plane)))
          continue;  // cuts all of it or nothing
        const Index a = std::min(plane, edge.plane), b = std::max(plane, edge.plane);
        const LineApprox line = exact::line_of(signs_.plane(a), signs_.plane(b));
        Clipper clipper{signs_, a, b, line};
        if (!cut_by_edges(clipper, f, e) || !clipper.any()) continue;
        Interval side = blank;
        side.outline_of = number;
        side.inside_positive = edge.inside_positive;
        side.edge_plane = edge.plane;
        add(a, b, clipper, side);
      }
    }
  }

  struct Result {
    std::vector<Found> found;
    Signs signs;
    Gaps gaps;
  };
  [[nodiscard]] Result result() && { return {std::move(found_), signs_, std::move(found_gaps_)}; }

 private:
  static constexpr HalfSpace nowhere{none, true};
  static constexpr Interval blank{none, nowhere, nowhere, none, true, none, {}, {}};

  bool cut_by_edges(Clipper& clipper, const Facet& f, Index skip) const {
    for (Index e = f.first_edge; e < f.first_edge + f.edge_count; ++e) {
      if (e != skip && !clipper.cut(prepared_.edges[e])) return false;
    }
    return true;
  }
  /// But for the lattice.
  bool has_corner(Index facet, const Vec& p) const {
    const Facet& f = prepared_.facets[facet];
    return std::ranges::any_of(std::span{prepared_.corners}.subspan(f.first_corner, f.corner_count), [&](const Vec& c) {
      return std::abs(c[0] - p[0]) + std::abs(c[1] - p[1]) + std::abs(c[2] - p[2]) < 0x1p-45;
    });
  }
  /// Of a joint's facet that meets another one and ends about on its plane: whether it does so along all of its side.
  void look_short(Index number, Index other) {
    const Facet& f = prepared_.facets[number];
    if (f.owner != Owner::joint || f.corner_count == 0 || f.rim_shared || f.sheet != none) return;
    const Index onto = prepared_.facets[other].plane;
    const auto& n = signs_.plane(onto).approx();
    const auto height = [&](const Vec& p) { return n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3]; };
    double farthest = 0;
    for (Index c = f.first_corner; c < f.first_corner + f.corner_count; ++c) {
      if (const double h = height(prepared_.corners[c]); std::abs(h) > std::abs(farthest)) farthest = h;
    }
    const Sign own_side = farthest > 0 ? Sign::positive : Sign::negative;
    for (Index e = f.first_edge; e < f.first_edge + f.edge_count; ++e) {
      const Index edge = prepared_.edges[e].plane;
      if (edge == onto || edge == f.plane || signs_.plane(edge).parallel_to(signs_.plane(f.plane))) continue;
      const Index p = std::min(f.plane, edge), q = std::max(f.plane, edge);
      const LineApprox line = exact::line_of(signs_.plane(p), signs_.plane(q));
      Clipper side{signs_, p, q, line};
      if (!cut_by_edges(side, f, e) || !side.any()) continue;
      const Vec begins = side.position(side.lower()), ends = side.position(side.upper());
      const double from = height(begins), to = height(ends);
      if (std::max(std::abs(from), std::abs(to)) > gaps_.limit()) continue;
      if (has_corner(other, begins) && has_corner(other, ends)) continue;  // a side of both
      const auto stays_short = [&](const Clipper::End& end) {
        return signs_.side(end.point, p, q, end.half_space.plane, onto) == own_side;
      };
      const bool lower = stays_short(side.lower()), upper = stays_short(side.upper());
      if (!lower && !upper) continue;
      const double gap = std::max({lower ? std::abs(from) : 0, upper ? std::abs(to) : 0, 0x1p-50});
      found_gaps_.add({1, gap, std::min(number, other), std::max(number, other), {}});
      if (prepared_.facets[other].owner == Owner::joint && gap <= prepared_.roundings * 0x1p-48) {
        found_gaps_.endings.push_back({f.owner_index, prepared_.facets[other].owner_index});
      }
    }
  }
  void add(Index p, Index q, const Clipper& clipper, Interval interval) {
    interval.lower = clipper.lower().half_space;
    interval.upper = clipper.upper().half_space;
    interval.from = clipper.position(clipper.lower());
    interval.to = clipper.position(clipper.upper());
    found_.push_back({p, q, interval});
  }

  const Prepared& prepared_;
  Signs signs_;
  const GapFinder& gaps_;
  std::vector<Found> found_;
  Gaps found_gaps_;
};

/// Planes with several facets: their faces are covered here and not there, so the outlines are drawn too.
std::vector<std::uint8_t> planes_with_outlines(const Prepared& prepared) {
  std::vector<std::uint8_t> with_outlines(prepared.facet_planes, 0);
  for (Index p = 0; p < prepared.facet_planes; ++p) {
    const Index first = prepared.facets_begin[p], last = prepared.facets_begin[p + std::size_t{1}];
    if (first == last) continue;  // stands for a folded polygon
    const bool joint = prepared.facets[prepared.facets_on[first]].owner == Owner::joint;
    with_outlines[p] = last - first >= 2 || (prepared.draw_outlines && joint) ? 1 : 0;
  }
  return with_outlines;
}

/// Sorts by the planes of the lines, those of one line as they were found, and numbers the lines.
void sort_into(Traces& out, const std::vector<Tracer::Result>& results, const Prepared& prepared, ThreadLimit threads) {
  struct Place {
    Index q;
    const Interval* interval;
  };
  std::vector<Index> begin(prepared.facet_planes + std::size_t{1}, 0);  // by p, which is always a facet plane
  for (const auto& result : results) {
    for (const Found& f : result.found) ++begin[f.p + std::size_t{1}];
  }
  begin_from_counts(begin);
  std::vector<Place> places(begin.back());
  auto next = begin;
  for (const auto& result : results) {
    for (const Found& f : result.found) places[next[f.p]++] = {f.q, &f.interval};
  }
  constexpr std::size_t grain = 16;
  out.lines_begin.assign(prepared.planes.size() + 1, 0);
  in_pieces(prepared.facet_planes, grain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const std::span own = std::span{places}.subspan(begin[p], begin[p + 1] - begin[p]);
      std::ranges::stable_sort(own, {}, &Place::q);
      for (std::size_t k = 0; k < own.size(); ++k)
        out.lines_begin[p + 1] += k == 0 || own[k].q != own[k - 1].q ? 1U : 0U;
    }
  });
  begin_from_counts(out.lines_begin);
  out.lines.resize(out.lines_begin.back());
  out.intervals.resize(places.size());
  in_pieces(prepared.facet_planes, grain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      Index line = out.lines_begin[p];
      for (Index k = begin[p]; k < begin[p + 1]; ++k) {
        const Index q = places[k].q;
        if (k > begin[p] && q != places[k - 1].q) ++line;
        if (k == begin[p] || q != places[k - 1].q) {
          out.lines[line] = {static_cast<Index>(p), q, exact::line_of(prepared.planes[p], prepared.planes[q])};
        }
        out.intervals[k] = *places[k].interval;
        out.intervals[k].line = line;
      }
    }
  });
}

}  // namespace

Index Traces::find_line(Index p, Index q) const {
  if (p > q) std::swap(p, q);
  const auto first = lines.begin() + static_cast<std::ptrdiff_t>(lines_begin[p]);
  const auto last = lines.begin() + static_cast<std::ptrdiff_t>(lines_begin[p + std::size_t{1}]);
  const auto found = std::lower_bound(first, last, q, [](const Line& line, Index other) { return line.q < other; });
  return found != last && found->q == q ? static_cast<Index>(found - lines.begin()) : none;
}

Traces find_traces(const Prepared& prepared, Signs& signs, ThreadLimit threads) {
  const GapFinder gaps{prepared};
  const std::vector<Boxed> boxes = boxes_along_x(prepared, gaps.limit() / 2);
  std::vector<Tracer::Result> results = made_in_pieces(boxes.size(), threads, [&](std::size_t first, std::size_t last) {
    Tracer tracer{prepared, signs, gaps};
    for_each_candidate(boxes, first, last, [&](Index i, Index j) { tracer.trace(i, j); });
    return std::move(tracer).result();
  });
  Traces out;
  out.with_outlines = planes_with_outlines(prepared);
  auto outlines = made_in_pieces(prepared.facet_planes, threads, [&](std::size_t first, std::size_t last) {
    Tracer tracer{prepared, signs, gaps};
    for (std::size_t p = first; p < last; ++p) {
      if (out.with_outlines[p] != 0) tracer.outline(static_cast<Index>(p));
    }
    return std::move(tracer).result();
  });
  results.insert(results.end(), std::move_iterator{outlines.begin()}, std::move_iterator{outlines.end()});
  for (const auto& result : results) {
    signs.add_counts(result.signs);
    out.gaps.add(result.gaps);
  }
  sort_into(out, results, prepared, threads);
  return out;
}

}  // namespace cleave::topology::detail
