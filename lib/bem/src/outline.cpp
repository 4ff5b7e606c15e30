#include "cleave/bem/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cleave/core/overloaded.hpp"
#include "gauss.hpp"

namespace cleave::bem {
namespace {

struct Arc {
  Vec2 centre;
  double radius;
  double from;   // angle of the start
  double sweep;  // signed
};

Vec2 end_of(const Loop& loop, std::size_t side) { return loop[(side + 1) % loop.size()].start; }

/// Empty for straight sides and for arcs so flat that doubles cannot tell them from straight ones.
std::optional<Arc> arc_of(const Loop& loop, std::size_t side) {
  if (!loop[side].through) return std::nullopt;
  const Vec2 a = loop[side].start;
  const Vec2 m = *loop[side].through - a;
  const Vec2 b = end_of(loop, side) - a;
  const double twice = 2 * cross(m, b);
  if (std::abs(twice) < 1e-12 * (dot(m, m) + dot(b, b))) return std::nullopt;
  const Vec2 c{(b.y * dot(m, m) - m.y * dot(b, b)) / twice, (m.x * dot(b, b) - b.x * dot(m, m)) / twice};
  const Vec2 centre = a + c;
  const Vec2 from = a - centre;
  const Vec2 to = a + b - centre;
  double sweep = std::atan2(cross(from, to), dot(from, to));
  // The point between lies right of the chord on an counter-clockwise arc.
  const bool counter_clockwise = cross(b, m) < 0;
  if (counter_clockwise && sweep < 0) sweep += 2 * std::numbers::pi;
  if (!counter_clockwise && sweep > 0) sweep -= 2 * std::numbers::pi;
  return Arc{centre, norm(from), std::atan2(from.y, from.x), sweep};
}

struct Chord {
  Vec2 a, b;
  std::size_t loop, side;
  bool next_of_side_end;  // last chord of its side
};

std::vector<Chord> chords_of(const std::vector<Loop>& loops) {
  std::vector<Chord> chords;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    for (std::size_t s = 0; s < loops[l].size(); ++s) {
      const std::size_t pieces = arc_of(loops[l], s) ? 16 : 1;
      for (std::size_t k = 0; k < pieces; ++k) {
        const double n = static_cast<double>(pieces);
        const Vec2 a = k == 0 ? loops[l][s].start : point_on(loops[l], s, static_cast<double>(k) / n).x;
        const Vec2 b = k + 1 == pieces ? end_of(loops[l], s) : point_on(loops[l], s, static_cast<double>(k + 1) / n).x;
        chords.push_back({a, b, l, s, k + 1 == pieces});
      }
    }
  }
  return chords;
}

/// Whether two segments have a point in common; `at` is one.
bool meet(const Chord& p, const Chord& q, Vec2& at) {
  if (std::max(p.a.x, p.b.x) < std::min(q.a.x, q.b.x) || std::max(q.a.x, q.b.x) < std::min(p.a.x, p.b.x) ||
      std::max(p.a.y, p.b.y) < std::min(q.a.y, q.b.y) || std::max(q.a.y, q.b.y) < std::min(p.a.y, p.b.y)) {
    return false;
  }
  const Vec2 u = p.b - p.a;
  const Vec2 v = q.b - q.a;
  const double s1 = cross(u, q.a - p.a);
  const double s2 = cross(u, q.b - p.a);
  const double s3 = cross(v, p.a - q.a);
  const double s4 = cross(v, p.b - q.a);
  if ((s1 > 0 && s2 > 0) || (s1 < 0 && s2 < 0) || (s3 > 0 && s4 > 0) || (s3 < 0 && s4 < 0)) return false;
  const double span = s3 - s4;
  at = span != 0 ? p.a + (s3 / span) * u : q.a;
  return true;
}

/// Two neighbours fold back on each other when their common corner turns by half a turn.
bool folds_back(const Chord& p, const Chord& q) {
  const Vec2 u = p.b - p.a;
  const Vec2 v = q.b - q.a;
  return dot(u, v) < 0 && std::abs(cross(u, v)) <= 1e-12 * norm(u) * norm(v);
}

double signed_area(const Loop& loop) { return area_moments({loop}).area; }

}  // namespace

std::string describe(const OutlineError& error) {
  const auto place = [](std::size_t loop, std::size_t side) {
    return loop == 0 ? fmt::format("side {}", side + 1) : fmt::format("side {} of loop {}", side + 1, loop + 1);
  };
  return std::visit(
      overloaded{[](const TooFewSides& e) {
                   return fmt::format("loop {} has fewer than three sides (two when one is an arc)", e.loop + 1);
                 },
                 [&](const NotFinite& e) {
                   return fmt::format("{} has a coordinate that is not a finite number", place(e.loop, e.side));
                 },
                 [&](const SideWithoutLength& e) { return fmt::format("{} has no length", place(e.loop, e.side)); },
                 [&](const SidesCross& e) {
                   return fmt::format("{} and {} meet at ({:.9g}, {:.9g})", place(e.loop_a, e.side_a),
                                      place(e.loop_b, e.side_b), e.at.x, e.at.y);
                 },
                 [](const HoleOutside& e) {
                   return fmt::format(
                       "loop {} is a hole but does not lie inside the outer loop, or lies in another hole", e.loop + 1);
                 }},
      error);
}

Loop circle(Vec2 centre, double radius, bool clockwise, std::size_t condition, std::optional<std::size_t> elements) {
  const Vec2 r{radius, 0};
  const Vec2 up{0, clockwise ? -radius : radius};
  std::optional<std::size_t> half;
  if (elements) half = std::max<std::size_t>(1, *elements / 2);
  return {Side{.start = centre + r, .through = centre + up, .condition = condition, .elements = half},
          Side{.start = centre - r, .through = centre - up, .condition = condition, .elements = half}};
}

Loop polygon(const std::vector<Vec2>& corners, std::size_t condition, std::optional<std::size_t> elements) {
  Loop loop;
  for (const Vec2 corner : corners) {
    loop.push_back(Side{.start = corner, .condition = condition, .elements = elements});
  }
  return loop;
}

Loop reversed(const Loop& loop) {
  Loop out;
  for (std::size_t k = loop.size(); k-- > 0;) {
    Side side = loop[k];
    side.start = end_of(loop, k);
    std::swap(side.grade_start, side.grade_end);
    out.push_back(side);
  }
  return out;
}

SidePoint point_on(const Loop& loop, std::size_t side, double t) {
  const Vec2 a = loop[side].start;
  const Vec2 b = end_of(loop, side);
  if (const auto arc = arc_of(loop, side)) {
    const Vec2 from = a - arc->centre;
    const Vec2 r = rotated(from, t * arc->sweep);
    return {arc->centre + r, arc->sweep * turned_left(r)};
  }
  return {(1 - t) * a + t * b, b - a};
}

double length_of(const Loop& loop, std::size_t side) {
  if (const auto arc = arc_of(loop, side)) return std::abs(arc->sweep) * arc->radius;
  return norm(end_of(loop, side) - loop[side].start);
}

double sweep_of(const Loop& loop, std::size_t side) {
  const auto arc = arc_of(loop, side);
  return arc ? arc->sweep : 0.0;
}

AreaMoments area_moments(const std::vector<Loop>& loops) {
  // Green's theorem about a corner of the body (not the origin: far coordinates would cancel).
  AreaMoments out;
  if (loops.empty() || loops.front().empty()) return out;
  const Vec2 origin = loops.front().front().start;
  double area = 0, mx = 0, my = 0, polar = 0;
  const GaussRule& rule = gauss(16);
  for (const Loop& loop : loops) {
    for (std::size_t s = 0; s < loop.size(); ++s) {
      const int pieces = 1 + static_cast<int>(std::abs(sweep_of(loop, s)));
      for (int k = 0; k < pieces; ++k) {
        for (std::size_t g = 0; g < rule.s.size(); ++g) {
          const double t = (k + 0.5 * (1 + rule.s[g])) / pieces;
          const SidePoint p = point_on(loop, s, t);
          const Vec2 x = p.x - origin;
          const double w = 0.5 * rule.w[g] / pieces;
          const double c = w * cross(x, p.derivative);
          area += c / 2;
          mx += c * x.x / 3;
          my += c * x.y / 3;
          polar += c * dot(x, x) / 4;
        }
      }
    }
  }
  out.area = area;
  if (area != 0) {
    const Vec2 c{mx / area, my / area};
    out.centroid = origin + c;
    out.polar = polar - area * dot(c, c);
  }
  return out;
}

bool inside(const std::vector<Loop>& loops, Vec2 point) {
  double angle = 0;
  for (const Loop& loop : loops) {
    for (std::size_t s = 0; s < loop.size(); ++s) {
      const int pieces = sweep_of(loop, s) == 0 ? 1 : 64;
      Vec2 a = loop[s].start - point;
      for (int k = 1; k <= pieces; ++k) {
        const Vec2 b = (k == pieces ? end_of(loop, s) : point_on(loop, s, static_cast<double>(k) / pieces).x) - point;
        angle += std::atan2(cross(a, b), dot(a, b));
        a = b;
      }
    }
  }
  return angle > std::numbers::pi;
}

std::expected<CheckedLoops, OutlineError> check_loops(std::vector<Loop> loops, bool exterior) {
  if (loops.empty() && !exterior) return std::unexpected(TooFewSides{0});
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const Loop& loop = loops[l];
    const bool curved = std::ranges::any_of(loop, [](const Side& s) { return s.through.has_value(); });
    if (loop.size() < (curved ? 2U : 3U)) return std::unexpected(TooFewSides{l});
    for (std::size_t s = 0; s < loop.size(); ++s) {
      const Vec2 a = loop[s].start;
      const Vec2 m = loop[s].through.value_or(a);
      if (!std::isfinite(a.x + a.y + m.x + m.y)) return std::unexpected(NotFinite{l, s});
    }
    double longest = 0;
    for (std::size_t s = 0; s < loop.size(); ++s) longest = std::max(longest, length_of(loop, s));
    for (std::size_t s = 0; s < loop.size(); ++s) {
      if (!(length_of(loop, s) > 1e-12 * longest)) return std::unexpected(SideWithoutLength{l, s});
    }
  }
  const std::vector<Chord> chords = chords_of(loops);
  for (std::size_t i = 0; i < chords.size(); ++i) {
    for (std::size_t j = i + 1; j < chords.size(); ++j) {
      const Chord& p = chords[i];
      const Chord& q = chords[j];
      Vec2 at;
      const bool p_then_q = p.loop == q.loop && p.b == q.a;
      const bool q_then_p = p.loop == q.loop && q.b == p.a;
      const bool bad =
          p_then_q || q_then_p ? ((p_then_q && folds_back(p, q)) || (q_then_p && folds_back(q, p))) : meet(p, q, at);
      if (bad) {
        if (p_then_q) at = p.b;
        if (q_then_p) at = q.b;
        return std::unexpected(SidesCross{p.loop, p.side, q.loop, q.side, at});
      }
    }
  }
  CheckedLoops out{std::move(loops), {}};
  for (std::size_t l = 0; l < out.loops.size(); ++l) {
    const bool want_counter_clockwise = !exterior && l == 0;
    if ((signed_area(out.loops[l]) > 0) != want_counter_clockwise) {
      out.loops[l] = reversed(out.loops[l]);
      out.turned.push_back(l);
    }
  }
  for (std::size_t l = exterior ? 0 : 1; l < out.loops.size(); ++l) {
    const Vec2 point = out.loops[l].front().start;
    for (std::size_t k = 0; k < out.loops.size(); ++k) {
      if (k == l) continue;
      const bool is_outer = !exterior && k == 0;
      const bool within = inside({is_outer ? out.loops[k] : reversed(out.loops[k])}, point);
      if (within != is_outer) return std::unexpected(HoleOutside{l});
    }
  }
  return out;
}

}  // namespace cleave::bem
