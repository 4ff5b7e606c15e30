#include "contact_candidate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cleave::dbem {
namespace {
using std::numbers::pi;

/// Angle from a to b, counter-clockwise, in [0, 2 pi).
double turn(Vec2 a, Vec2 b) {
  const double angle = std::atan2(cross(a, b), dot(a, b));
  return angle < 0 ? angle + 2 * pi : angle;
}

Vec2 unit(Vec2 a) { return a / norm(a); }

std::size_t next(std::size_t k, std::size_t n) { return k + 1 == n ? 0 : k + 1; }
std::size_t before(std::size_t k, std::size_t n) { return k == 0 ? n - 1 : k - 1; }

Wedge wedge_at(std::span<const Vec2> c, std::size_t k) {
  return {c[next(k, c.size())] - c[k], c[before(k, c.size())] - c[k]};
}

/// Edges of two corners that face each other and close away from them: no line parts the two corners there.
enum class Facing : std::uint8_t { none, back_and_out, out_and_back };  // of i, of j
Facing facing_edges(const Wedge& i, const Wedge& j) {
  const double a2 = turn(i.out, i.back);
  const double b1 = turn(i.out, j.out);
  const double b2 = b1 + turn(j.out, j.back);
  if (b1 < a2 - 1e-9) return Facing::back_and_out;
  if (b2 > 2 * pi + 1e-9) return Facing::out_and_back;
  return Facing::none;
}

struct Against {
  double gap, ratio;
  Vec2 normal;
};

Against against(std::span<const Vec2> corners, std::size_t edge, Vec2 p) {
  const Vec2 start = corners[edge];
  const Vec2 along = corners[next(edge, corners.size())] - start;
  const double length2 = dot(along, along);
  const Vec2 normal = turned_right(along) / std::sqrt(length2);
  return {dot(normal, p - start), dot(p - start, along) / length2, normal};
}

ContactCandidate touch_of(const Placed& i, std::size_t vertex, const Placed& j, std::size_t edge) {
  const Against a = against(j.corners, edge, i.corners[vertex]);
  return {i.body, static_cast<std::uint32_t>(vertex), j.body,   static_cast<std::uint32_t>(edge),
          a.gap,  std::clamp(a.ratio, 0.0, 1.0),      a.normal, i.corners[vertex]};
}

/// When the way from gap `from` to gap `to` lies behind a line, as shares of the way.
struct Behind {
  double since = 2, until = 2;
};
Behind behind(double from, double to, double tolerance) {
  if (from < -tolerance) return {-1, to < 0 ? 2 : from / (from - to)};
  if (to >= 0) return {};
  return {from == to ? 0.0 : std::max(0.0, from / (from - to)), 2};
}

/// One of the two lines that bound what is forbidden to corner p of i at corner q of j.
struct Line {
  ContactCandidate touch;  // clamped ratio
  double ratio;            // of the foot along the edge, not clamped
  double after;            // gap at the end of the predicted motion
};

Line line_of(const Placed& i, std::size_t vertex, const Placed& j, std::size_t edge, Vec2 motion) {
  ContactCandidate t = touch_of(i, vertex, j, edge);
  t.met = true;
  return {t, against(j.corners, edge, i.corners[vertex]).ratio, t.gap + dot(t.normal, motion)};
}

/// How far the foot lies off the edge, in lengths of the edge.
double off(const Line& line) { return std::max({0.0, -line.ratio, line.ratio - 1}); }

/// Which line of a corner pair holds: the one the predicted way comes through, which is the one it crosses last. Any
/// line with a positive gap keeps the bodies apart; the choice is which of them does not stop what would pass by.
/// Nothing when the way leads round behind the corner, or nowhere: the motion will tell (`line_crossed`).
const Line* holding_line(const Line& first, const Line& last, double tolerance) {
  const double size = std::max(std::abs(first.touch.gap), std::abs(last.touch.gap));
  const double drift = std::abs(first.after - first.touch.gap) + std::abs(last.after - last.touch.gap);
  // Corners that lie over one another and stay there: a contact would have to guess its line, and guess anew in every
  // step.
  const bool two = std::abs(cross(first.touch.normal, last.touch.normal)) > 1e-6;
  if (two && size <= tolerance && drift <= tolerance) return nullptr;
  const bool level = std::abs(first.touch.gap - last.touch.gap) <= 1e-12 * size + 1e-3 * tolerance;
  if (level && std::abs(first.after - last.after) <= 1e-9 * (size + drift) + 1e-3 * tolerance) {
    return off(last) < off(first) ? &last : &first;  // one line by two names: where the foot lies on the edge
  }
  const Behind a = behind(first.touch.gap, first.after, tolerance);
  const Behind b = behind(last.touch.gap, last.after, tolerance);
  if (a.since < 0 && b.since < 0) return first.touch.gap >= last.touch.gap ? &first : &last;  // in: the shallower
  if (a.since < 0 || b.since < 0) {
    const Line& outside = a.since < 0 ? last : first;
    const double in = a.since < 0 ? b.since : a.since;
    const double out = a.since < 0 ? a.until : b.until;
    return in < 2 && out < in ? nullptr : &outside;
  }
  if (std::abs(a.since - b.since) > 1e-9) return a.since > b.since ? &first : &last;
  return first.after >= last.after ? &first : &last;
}

struct Found {
  std::vector<ContactCandidate>& touches;
  std::vector<CornerChoice>& choices;
};

/// Corner p of i near corner q of j, both sharp: at most one contact, a corner of one against an edge of the other.
void corner_on_corner(const Placed& i, std::size_t p, const Placed& j, std::size_t q, const Reach& reach,
                      const Drift& drift, Found& out) {
  const Wedge own = wedge_at(i.corners, p), other = wedge_at(j.corners, q);
  const Vec2 motion = drift.at(i.corners[p]);
  const std::size_t before_p = before(p, i.corners.size()), before_q = before(q, j.corners.size());
  // i's corner against an edge of j, or j's against one of i: seen from i, j's corner moves the other way.
  const auto on_j = [&](std::size_t edge) { return line_of(i, p, j, edge, motion); };
  const auto on_i = [&](std::size_t edge) { return line_of(j, q, i, edge, -motion); };
  const auto keep = [&](const Line& line) {
    if (line.touch.gap < reach.margin && line.touch.gap > -reach.depth) out.touches.push_back(line.touch);
  };
  // Faces that close away from the corners: the corners may still meet when the bodies turn.
  if (const Facing facing = facing_edges(own, other); facing != Facing::none) {
    const Line theirs = on_j(facing == Facing::back_and_out ? q : before_q);
    const Line ours = on_i(facing == Facing::back_and_out ? before_p : p);
    keep(off(ours) < off(theirs) ? ours : theirs);
    return;
  }
  const EntranceLines lines = entrance_lines(own, other);
  const Line first = lines.first_is_edge_of_j ? on_j(q) : on_i(p);
  const Line last = lines.last_is_edge_of_j ? on_j(before_q) : on_i(before_p);
  if (const Line* line = holding_line(first, last, reach.touching)) {
    keep(*line);
  } else {
    out.choices.push_back({first.touch, last.touch});
  }
}

bool in_box(const Box2& box, Vec2 p, double margin) {
  return p.x >= box.low.x - margin && p.x <= box.high.x + margin && p.y >= box.low.y - margin &&
         p.y <= box.high.y + margin;
}

struct Candidate {
  std::size_t edge;
  Against at;
};

/// Corners of i against edges and corners of j. Pairs of corners are made only when `corners_too`; otherwise the other
/// direction has made them.
void one_direction(const Placed& i, const Placed& j, const Reach& reach, const Drift& drift, bool corners_too,
                   Found& out) {
  const auto [margin, depth, near, corner, touching] = reach;

  const std::size_t n = j.corners.size();
  std::vector<Candidate> found;
  for (std::size_t v = 0; v < i.corners.size(); ++v) {
    const Vec2 p = i.corners[v];
    // Corners that springs have pressed past each other lie out of the box, too.
    if (i.sharp[v] == 0 || !in_box(j.box, p, std::max({margin, near, corner}))) continue;
    std::size_t close = n;
    double closest = reach.corner;
    for (std::size_t q = 0; q < n; ++q) {
      const double distance = norm(p - j.corners[q]);
      if (distance < closest) {
        closest = distance;
        close = q;
      }
    }
    if (close < n) {
      if (j.sharp[close] != 0) {
        if (corners_too) corner_on_corner(i, v, j, close, reach, drift, out);
      } else {  // in a concave corner: both edges hold it
        for (const std::size_t edge : {before(close, n), close}) {
          const ContactCandidate t = touch_of(i, v, j, edge);
          if (t.gap < margin && t.gap > -depth) out.touches.push_back(t);
        }
      }
    }
    found.clear();
    for (std::size_t e = 0; e < n; ++e) {
      if (close < n && (e == close || e == before(close, n))) continue;
      const Against a = against(j.corners, e, p);
      if (a.ratio > 0 && a.ratio < 1 && a.gap < margin && a.gap > -depth) found.push_back({e, a});
    }
    if (found.empty()) continue;
    // Behind an edge is in the body only if it is in the body; near one of its corners that corner decides.
    const bool behind = std::ranges::any_of(found, [&](const Candidate& c) { return c.at.gap < -touching; });
    if (close < n || (behind && !inside(j.corners, p))) {
      std::erase_if(found, [&](const Candidate& c) { return c.at.gap < (close < n ? 0 : -touching); });
    }
    if (found.empty()) continue;
    const auto best = std::ranges::max_element(found, {}, [](const Candidate& c) { return std::min(c.at.gap, 0.0); });
    for (const Candidate& c : found) {
      const bool beside = (c.edge == next(best->edge, n) && j.sharp[c.edge] == 0) ||
                          (best->edge == next(c.edge, n) && j.sharp[best->edge] == 0);
      const bool keep = c.edge == best->edge || (!j.convex && (c.at.gap >= 0 || (beside && c.at.gap > -near)));
      if (keep) out.touches.push_back(touch_of(i, v, j, c.edge));
    }
  }
}

}  // namespace

EntranceLines entrance_lines(const Wedge& i, const Wedge& j) {
  // Angles from i.out: a1 = 0.
  const double a2 = turn(i.out, i.back);
  double b1 = turn(i.out, j.out);
  if (b1 < a2 - 1e-9) b1 += 2 * pi;
  const double b2 = b1 + turn(j.out, j.back);
  EntranceLines lines{};
  lines.first_is_edge_of_j = b1 <= pi;
  lines.last_is_edge_of_j = b2 >= a2 + pi;
  lines.first = lines.first_is_edge_of_j ? unit(turned_right(j.out)) : -unit(turned_right(i.out));
  lines.last = lines.last_is_edge_of_j ? unit(turned_right(-j.back)) : -unit(turned_right(-i.back));
  return lines;
}

void find_candidates(const Placed& i, const Placed& j, const Reach& reach, const Drift& drift,
                     std::vector<ContactCandidate>& out, std::vector<CornerChoice>& choices) {
  if (!overlap_boxes(i.box, j.box, std::max(reach.margin, reach.near))) return;
  const std::size_t first = out.size();
  Found found{out, choices};
  one_direction(i, j, reach, drift, true, found);
  one_direction(j, i, reach, drift, false, found);
  // Two corners may hold each other twice where an edge passes through both: keep one a place and line.
  std::vector<ContactCandidate> kept;
  for (std::size_t k = first; k < out.size(); ++k) {
    const bool again = std::ranges::any_of(kept, [&](const ContactCandidate& t) {
      return norm(t.point - out[k].point) < reach.near && std::abs(cross(t.normal, out[k].normal)) < 1e-6;
    });
    if (!again) kept.push_back(out[k]);
  }
  out.resize(first);
  out.insert(out.end(), kept.begin(), kept.end());
}

void update_candidate(ContactCandidate& touch, std::span<const Vec2> corners_i, std::span<const Vec2> corners_j) {
  touch.point = corners_i[touch.vertex];
  const Against a = against(corners_j, touch.edge, touch.point);
  touch.gap = a.gap;
  touch.ratio = std::clamp(a.ratio, 0.0, 1.0);
  touch.normal = a.normal;
  touch.tilt = 0;
}

std::optional<ContactCandidate> line_crossed(const CornerChoice& choice, const CornerChoice& after, double rounding) {
  const auto keeps = [&](const ContactCandidate& was, const ContactCandidate& is) {
    return is.gap >= std::min(was.gap, 0.0) - rounding;
  };
  if (keeps(choice.first, after.first) || keeps(choice.last, after.last)) return std::nullopt;
  const double a = behind(choice.first.gap, after.first.gap, rounding).since;
  const double b = behind(choice.last.gap, after.last.gap, rounding).since;
  // Both at once, from corner on corner: the line that is less far behind takes the least away from the motion.
  const bool level = std::abs(a - b) <= 1e-9 || std::max(choice.first.gap, choice.last.gap) <= rounding;
  return (level ? after.first.gap >= after.last.gap : a > b) ? choice.first : choice.last;
}

std::optional<std::size_t> first_crossing(std::span<const Vec2> before, std::span<const Vec2> after, Vec2 from, Vec2 to,
                                          double rounding) {
  const std::size_t n = before.size();
  std::optional<std::size_t> best;
  double earliest = 2;
  for (std::size_t e = 0; e < n; ++e) {
    const Against a = against(before, e, from);
    const Against b = against(after, e, to);
    if (a.gap < -rounding || b.gap >= std::min(a.gap, 0.0)) continue;
    const double t = std::max(a.gap, 0.0) / (std::max(a.gap, 0.0) - b.gap);
    const double foot = a.ratio + t * (b.ratio - a.ratio);
    if (foot < -1e-9 || foot > 1 + 1e-9 || t >= earliest) continue;
    earliest = t;
    best = e;
  }
  return best;
}

bool inside(std::span<const Vec2> corners, Vec2 point) {
  bool in = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec2 a = corners[k] - point;
    const Vec2 b = corners[next(k, corners.size())] - point;
    if ((a.y > 0) != (b.y > 0) && (cross(a, b) > 0) == (b.y > a.y)) in = !in;
  }
  return in;
}

namespace {

double depth_in(std::span<const Vec2> corners, Vec2 p) {
  double nearest = 1e300;
  for (std::size_t e = 0; e < corners.size(); ++e) {
    const Vec2 along = corners[next(e, corners.size())] - corners[e];
    const double t = std::clamp(dot(p - corners[e], along) / dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, norm(p - corners[e] - t * along));
  }
  return nearest;
}

}  // namespace

Overlap overlap(const Placed& i, const Placed& j, double tolerance) {
  Overlap worst;
  if (!overlap_boxes(i.box, j.box, 0)) return worst;
  const auto corner = [&](const Placed& a, const Placed& b) {
    for (std::size_t k = 0; k < a.corners.size(); ++k) {
      // Middles of edges too: two bars may cross without a corner inside the other, and equal outlines have none.
      for (const Vec2 p : {a.corners[k], 0.5 * (a.corners[k] + a.corners[next(k, a.corners.size())])}) {
        if (!in_box(b.box, p, 0) || !inside(b.corners, p)) continue;
        const double depth = depth_in(b.corners, p);
        if (depth > tolerance && depth > worst.depth) worst = {depth, p};
      }
    }
  };
  corner(i, j);
  corner(j, i);
  if (worst.depth > 0) return worst;
  // Edges that cross: the depth is the least that would part them.
  for (std::size_t a = 0; a < i.corners.size(); ++a) {
    const Vec2 p = i.corners[a];
    const Vec2 r = i.corners[next(a, i.corners.size())] - p;
    for (std::size_t b = 0; b < j.corners.size(); ++b) {
      const Vec2 q = j.corners[b];
      const Vec2 s = j.corners[next(b, j.corners.size())] - q;
      const double turned = cross(r, s);
      if (std::abs(turned) < 1e-12 * norm(r) * norm(s)) continue;
      const double t = cross(q - p, s) / turned;
      const double u = cross(q - p, r) / turned;
      const double depth = std::min({t, 1 - t, u, 1 - u});
      const double deep = depth * std::min(norm(r), norm(s)) * std::abs(turned) / (norm(r) * norm(s));
      if (depth > 0 && deep > tolerance && deep > worst.depth) worst = {deep, p + t * r};
    }
  }
  if (worst.depth > 0) return worst;
  // The same polygon twice, or one whose corners all lie on the other's boundary.
  Vec2 middle{};
  for (const Vec2 c : i.corners) middle += c / static_cast<double>(i.corners.size());
  if (inside(i.corners, middle) && inside(j.corners, middle)) {
    const double depth = std::min(depth_in(i.corners, middle), depth_in(j.corners, middle));
    if (depth > tolerance) worst = {depth, middle};
  }
  return worst;
}

}  // namespace cleave::dbem
