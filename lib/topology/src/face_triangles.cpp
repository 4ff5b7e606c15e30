#include "detail/face_triangles.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/exact/wide.hpp"
#include "cleave/geometry/ear_ring.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Sign;

/// A corner of a face, by its number; one for each vertex, however often loops pass it.
using Number = std::size_t;
/// Corners in the order in which they are passed, the face on the left.
using Ring = std::vector<Number>;

/// The corners of one face as they are seen in its plane, counter-clockwise about its normal.
class FaceCorners final {
 public:
  FaceCorners(const Prepared& prepared, const Graph& graph, const std::vector<Vec>& positions, Index plane)
      : prepared_{prepared}, graph_{graph}, positions_{positions}, view_{prepared.planes[plane].approx()} {
    const std::size_t dropped = 3 - view_.u - view_.v;
    turned_ = (prepared.planes[plane].approx()[dropped] > 0) == (dropped == 1);
  }

  Number number(Index vertex) {
    const auto [entry, fresh] = numbers_.try_emplace(vertex, corners_.size());
    if (fresh) corners_.push_back({vertex, positions_[vertex][view_.u], positions_[vertex][view_.v], {}, {}});
    return entry->second;
  }
  /// The corner lies on this line of the graph: what is on one line needs no determinant.
  void lies_on(Number corner, Index line) {
    auto& lines = corners_[corner].lines;
    const auto place = std::ranges::lower_bound(lines, line);
    if (place == lines.end() || *place != line) lines.insert(place, line);
  }
  [[nodiscard]] std::size_t count() const noexcept { return corners_.size(); }
  [[nodiscard]] Index vertex(Number i) const { return corners_[i].vertex; }
  [[nodiscard]] double square_distance(Number i, Number j) const {
    const double du = corners_[j].u - corners_[i].u, dv = corners_[j].v - corners_[i].v;
    return du * du + dv * dv;
  }

  // ---- For EarRing
  // ---------------------------------------------------------------------------------------------------
  [[nodiscard]] Sign turn(Number i, Number j, Number k) const {
    if (i == j || j == k || k == i) return Sign::zero;
    const Corner &a = corners_[i], &b = corners_[j], &c = corners_[k];
    const double cross = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    // Positions are good to 2^-43 units, and no two are more than one unit apart in a coordinate.
    constexpr double bound = 0x1p-40;
    if (std::abs(cross) > bound) return seen(cross > 0 ? Sign::positive : Sign::negative);
    if (on_one_line(a, b, c)) return Sign::zero;
    const auto &p = exactly(i), &q = exactly(j), &r = exactly(k);
    const Integer value =
        p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
    return seen(value > 0 ? Sign::positive : value < 0 ? Sign::negative : Sign::zero);
  }
  [[nodiscard]] static auto ignored(Number a, Number b, Number c) {
    return [=](Number i) { return i == a || i == b || i == c; };
  }

  /// Of three on one line: whether p lies beyond `a` as seen from `from`, or on the same side as `from`.
  [[nodiscard]] bool same_side(Number a, Number from, Number p) const {
    const Corner &at = corners_[a], &f = corners_[from], &g = corners_[p];
    const double dot = (f.u - at.u) * (g.u - at.u) + (f.v - at.v) * (g.v - at.v);
    constexpr double bound = 0x1p-40;
    if (std::abs(dot) > bound) return dot > 0;
    const auto &o = exactly(a), &x = exactly(from), &y = exactly(p);
    Integer sum = 0;
    for (std::size_t k = 0; k < 2; ++k) sum += (x[k] * o[2] - o[k] * x[2]) * (y[k] * o[2] - o[k] * y[2]);
    return sum > 0;
  }
  /// The boxes of two segments are safely apart.
  [[nodiscard]] bool boxes_apart(Number i, Number j, Number k, Number l) const {
    constexpr double margin = 0x1p-40;
    const Corner &a = corners_[i], &b = corners_[j], &c = corners_[k], &d = corners_[l];
    return std::max(a.u, b.u) + margin < std::min(c.u, d.u) || std::max(c.u, d.u) + margin < std::min(a.u, b.u) ||
           std::max(a.v, b.v) + margin < std::min(c.v, d.v) || std::max(c.v, d.v) + margin < std::min(a.v, b.v);
  }

 private:
  using Integer = boost::multiprecision::cpp_int;
  using Exact = std::array<Integer, 3>;  ///< (u, v) times the last, which is above 0
  struct Corner {
    Index vertex;
    double u, v;
    std::vector<Index> lines;  ///< ascending
    mutable std::optional<Exact> exact;
  };

  [[nodiscard]] Sign seen(Sign sign) const { return turned_ ? -sign : sign; }
  static bool on_one_line(const Corner& a, const Corner& b, const Corner& c) {
    return std::ranges::any_of(a.lines, [&](Index line) {
      return std::ranges::binary_search(b.lines, line) && std::ranges::binary_search(c.lines, line);
    });
  }
  [[nodiscard]] const Exact& exactly(Number i) const {
    const Corner& corner = corners_[i];
    if (!corner.exact) {
      const Meet& meet = graph_.meet(corner.vertex);
      const auto& planes = prepared_.planes;
      const auto point = exact::exact_meet(exact::exact_line(planes[meet[0]], planes[meet[1]]), planes[meet[2]]);
      const int sign = point.w < 0 ? -1 : 1;
      corner.exact = Exact{Integer{point.x[view_.u]} * sign, Integer{point.x[view_.v]} * sign, Integer{point.w} * sign};
    }
    return *corner.exact;
  }

  const Prepared& prepared_;
  const Graph& graph_;
  const std::vector<Vec>& positions_;
  View view_;
  bool turned_ = false;  ///< the view looks along the normal, not against it
  std::vector<Corner> corners_;
  std::unordered_map<Index, Number> numbers_;
};

Number before(const Ring& ring, std::size_t k) { return ring[k == 0 ? ring.size() - 1 : k - 1]; }
Number after(const Ring& ring, std::size_t k) { return ring[k + 1 == ring.size() ? 0 : k + 1]; }

/// Whether the direction from ring[k] to p leads into what is left of the ring there.
bool opens_to(const FaceCorners& corners, const Ring& ring, std::size_t k, Number p) {
  const Number from = before(ring, k), at = ring[k], to = after(ring, k);
  const Sign of_in = corners.turn(from, at, p), of_out = corners.turn(at, to, p);
  const Sign bend = corners.turn(from, at, to);
  if (bend == Sign::positive) return of_in == Sign::positive && of_out == Sign::positive;
  if (bend == Sign::zero && (from == to || corners.same_side(at, from, to))) {  // it turns back here
    return of_in != Sign::zero || !corners.same_side(at, from, p);
  }
  return of_in == Sign::positive || of_out == Sign::positive;
}

/// Whether the segment from a to b has a point in common with that from c to d, other than an end of both.
bool in_the_way(const FaceCorners& corners, Number a, Number b, Number c, Number d) {
  if (corners.boxes_apart(a, b, c, d)) return false;
  if (a == c || a == d || b == c || b == d) {
    const Number shared = a == c || a == d ? a : b;
    const Number mine = shared == a ? b : a, theirs = shared == c ? d : c;
    return corners.turn(shared, mine, theirs) == Sign::zero && corners.same_side(shared, mine, theirs);
  }
  const Sign of_c = corners.turn(a, b, c), of_d = corners.turn(a, b, d);
  const Sign of_a = corners.turn(c, d, a), of_b = corners.turn(c, d, b);
  const auto apart = [](Sign x, Sign y) { return x == y && x != Sign::zero; };
  if (apart(of_c, of_d) || apart(of_a, of_b)) return false;
  if (of_c != Sign::zero || of_d != Sign::zero) return true;
  // On one line: apart where both ends of one lie on the outer side of both ends of the other.
  const auto holds = [&](Number p, Number q, Number r) { return !corners.same_side(r, p, q); };
  return holds(a, b, c) || holds(a, b, d) || holds(c, d, a) || holds(c, d, b);
}

bool blocked(const FaceCorners& corners, Number a, Number b, const Ring& ring) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    if (in_the_way(corners, a, b, ring[k], after(ring, k))) return true;
  }
  return false;
}

/// Joins a hole to the ring by a bridge that nothing is in the way of, walked once in each direction. False where there
/// is none yet, because other holes are in between.
bool join_hole(const FaceCorners& corners, Ring& ring, const Ring& hole, const std::vector<Ring>& others) {
  std::vector<std::pair<double, std::size_t>> nearest(ring.size());
  for (std::size_t i = 0; i < hole.size(); ++i) {
    for (std::size_t k = 0; k < ring.size(); ++k) nearest[k] = {corners.square_distance(hole[i], ring[k]), k};
    std::ranges::sort(nearest);
    for (const auto& [distance, k] : nearest) {
      const Number from = ring[k], to = hole[i];
      if (from == to || !opens_to(corners, ring, k, to) || !opens_to(corners, hole, i, from)) continue;
      if (blocked(corners, from, to, ring) || blocked(corners, from, to, hole)) continue;
      if (std::ranges::any_of(others, [&](const Ring& other) { return blocked(corners, from, to, other); })) continue;
      Ring bridge;
      for (std::size_t n = 0; n <= hole.size(); ++n) bridge.push_back(hole[(i + n) % hole.size()]);
      bridge.push_back(from);
      ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(k) + 1, bridge.begin(), bridge.end());
      return true;
    }
  }
  return false;
}

/// One ring of all loops. There always is a hole that can be joined next: what has corners can be cut into triangles.
Ring join_holes(const FaceCorners& corners, std::vector<Ring> loops) {
  Ring ring = std::move(loops.front());
  loops.erase(loops.begin());
  while (!loops.empty()) {
    bool joined = false;
    for (std::size_t h = 0; h < loops.size() && !joined; ++h) {
      const Ring hole = std::move(loops[h]);
      loops.erase(loops.begin() + static_cast<std::ptrdiff_t>(h));
      joined = join_hole(corners, ring, hole, loops);
      if (!joined) loops.insert(loops.begin() + static_cast<std::ptrdiff_t>(h), hole);
    }
    CLEAVE_ASSERT(joined);
  }
  return ring;
}

/// Up to so many corners the ear with the shortest new edge is looked for; beyond, any ear will do.
constexpr std::size_t careful_up_to = 64;

std::optional<std::size_t> next_ear(const FaceCorners& corners, const geometry::EarRing<FaceCorners>& ring,
                                    std::size_t from) {
  if (ring.size() > careful_up_to) return ring.find(from, [&](std::size_t k) { return ring.is_ear(k); });
  std::optional<std::size_t> best;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double length = corners.square_distance(ring.before(k), ring.after(k));
    if (length >= shortest || !ring.is_ear(k)) continue;
    best = k;
    shortest = length;
  }
  return best;
}

}  // namespace

void append_triangles(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                      const std::vector<Vec>& positions, Index face, std::vector<FaceTriangle>& triangles) {
  const PlaneFace& own = arrangement.faces[face];
  FaceCorners corners{prepared, graph, positions, own.plane};
  std::vector<Ring> loops;
  for (Index l = own.first_loop; l < own.first_loop + own.loop_count; ++l) {
    Ring& ring = loops.emplace_back();
    const Index start = arrangement.loops[l];
    Index h = start;
    do {
      const Index line = graph.edges[graph.uses[h / 2].edge].line;
      const Number corner = corners.number(arrangement.start[h]);
      corners.lies_on(corner, line);
      corners.lies_on(corners.number(arrangement.start[arrangement.next[h]]), line);
      ring.push_back(corner);
      h = arrangement.next[h];
    } while (h != start);
  }
  const auto add = [&](const std::array<std::size_t, 3>& ear) {
    triangles.push_back({corners.vertex(ear[0]), corners.vertex(ear[1]), corners.vertex(ear[2])});
  };
  geometry::EarRing<FaceCorners> ring{join_holes(corners, std::move(loops)), corners};
  std::size_t from = 0;
  while (ring.size() > 3) {
    const std::optional<std::size_t> ear = next_ear(corners, ring, from);
    CLEAVE_ASSERT(ear.has_value());
    add(ring.cut(*ear));
    from = *ear + 1;  // not the neighbour: fans of slivers are avoided
  }
  CLEAVE_ASSERT(ring.turn(1) == Sign::positive);
  add(ring.triangle(1));
}

}  // namespace cleave::topology::detail
