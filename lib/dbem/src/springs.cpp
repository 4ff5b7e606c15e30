#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "world_impl.hpp"

/// Springs in joints: how long a piece of a joint each contact stands for.
namespace cleave::dbem {

namespace {

struct Outline {
  std::span<const Vec2> corners;
  std::span<const std::uint8_t> sharp;
};

/// How far a side goes on from the corner `at` on, forwards or backwards: past corners that carry nothing and lie in
/// line with it. 0 where it does not lie nearly along `along` (a unit vector).
double goes_on(const Outline& of, std::size_t at, bool forwards, Vec2 along, double slope) {
  const std::size_t n = of.corners.size();
  double far = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = forwards ? (at + 1) % n : (at + n - 1) % n;
    const Vec2 side = of.corners[next] - of.corners[at];
    if (std::abs(cross(side, along)) > slope * norm(side)) break;
    far += std::abs(dot(side, along));
    if (of.sharp[next] != 0) break;
    at = next;
    slope = std::min(slope, 1e-3);
  }
  return far;
}

/// Of the edge of a body that lies on a stretch from its corner `at` along `along`: what the corner stands for. Empty
/// where the body has no shares, or none of its edges is the stretch.
std::optional<double> own_share(const Body& body, std::span<const Vec2> corners, std::size_t at, Vec2 along,
                                double length) {
  constexpr double nearly = 1e-3;
  if (body.shares.empty()) return std::nullopt;
  const std::size_t n = corners.size(), before = (at + n - 1) % n;
  const auto is_stretch = [&](std::size_t end) {
    return norm(corners[end] - corners[at] - length * along) <= nearly * length;
  };
  if (is_stretch((at + 1) % n)) return body.shares[at];
  return is_stretch(before) ? std::optional{1 - body.shares[before]} : std::nullopt;
}

/// A corner on an edge.
struct Touch {
  std::size_t vertex, edge;
  bool met;  ///< with the corner at the nearer end of the edge: the side beyond that is the joint, too
};

/// Length of the joint that a contact stands for: its share of the way to the next corner of either body along it, on
/// either side, where the side of the corner lies nearly along the edge; of a corner that touches alone `alone`.
template <class Share>
double length_of(const Outline& own, const Outline& other, const Touch& touch, double alone, const Share& share) {
  constexpr double nearly = 0.5, in_line = 1e-3, facing = 2e-2;
  const std::size_t n = own.corners.size(), m = other.corners.size(), next = (touch.edge + 1) % m;
  const Vec2 p = own.corners[touch.vertex], from = other.corners[touch.edge], to = other.corners[next];
  const double size = norm(to - from);
  const Vec2 along = (to - from) / size;
  const bool at_start = dot(p - from, along) < 0.5 * size;
  // Of a side of the corner and of the other body from the corner on: the lengths of both.
  const auto on_its_edge = [&](bool forwards, Vec2 side) {
    const bool ahead = dot(side, along) > 0;
    const std::size_t end = ahead ? next : touch.edge;
    const double left = std::abs(dot(other.corners[end] - p, along));
    // The corner may lie over the end of its edge.
    const bool on = other.sharp[end] == 0 || left < 1e-6 * size;
    return std::pair{goes_on(own, touch.vertex, forwards, along, nearly),
                     left + (on ? goes_on(other, end, ahead, along, in_line) : 0.0)};
  };
  // Springs press corners past each other: what has met stays so, however far the one lies off the other.
  const auto past_end = [&](bool forwards, Vec2 side) {
    const std::size_t end = at_start ? touch.edge : next, after = at_start ? (end + m - 1) % m : (end + 1) % m;
    const Vec2 step = other.corners[after] - other.corners[end], way = step / norm(step);
    if (dot(side, way) <= 0) return std::pair{0.0, 0.0};
    return std::pair{goes_on(own, touch.vertex, forwards, way, facing),
                     dot(other.corners[end] - p, way) + goes_on(other, end, !at_start, way, facing)};
  };
  double length = 0;
  for (const bool forwards : {true, false}) {
    const Vec2 side = own.corners[forwards ? (touch.vertex + 1) % n : (touch.vertex + n - 1) % n] - p;
    const bool past = touch.met && (dot(side, along) > 0) != at_start;
    const auto [reach, left] = past ? past_end(forwards, side) : on_its_edge(forwards, side);
    const double whole = std::min(reach, left);
    if (whole > 0) length += share(side / norm(side), whole) * whole;
  }
  return std::max(length, alone);
}

/// Of a corner that touches alone, over the smaller feature.
constexpr double length_alone = 0.05;

}  // namespace

double JointState::share_of(const ContactCandidate& t, Vec2 along, double length) const {
  std::optional<double> found = own_share(bodies[t.i], corners_of(corners, t.i), t.vertex, along, length);
  const auto others = corners_of(corners, t.j);
  const Vec2 p = corners_of(corners, t.i)[t.vertex];
  for (const std::size_t end : {std::size_t{t.edge}, (t.edge + 1) % others.size()}) {
    if (norm(others[end] - p) > 1e-2 * length) continue;
    const auto other = own_share(bodies[t.j], others, end, along, length);
    // Elements of two bodies that do not fit: as if there were none.
    if (found && other && std::abs(*found - *other) > 1e-9) return 0.5;
    if (other) found = other;
  }
  return found.value_or(0.5);
}

Vec2 JointState::compliance_of(const ContactCandidate& t) const {
  if (t.tie != no_tie) return {1 / ties[t.tie].stiffness.si(), 0};
  const JointLaw& law = law_of(t);
  if (!law.normal_stiffness && !law.shear_stiffness) return {law.compliance, law.compliance};
  const double alone = length_alone * std::min(shapes[t.i].feature, shapes[t.j].feature);
  const double length =
      length_of({corners_of(corners, t.i), shapes[t.i].sharp}, {corners_of(corners, t.j), shapes[t.j].sharp},
                {t.vertex, t.edge, t.met}, alone, [&](Vec2 along, double whole) { return share_of(t, along, whole); });
  Vec2 soft{law.normal_stiffness ? 1 / (*law.normal_stiffness * length) : 0.0,
            law.shear_stiffness ? 1 / (*law.shear_stiffness * length) : 0.0};
  if (const auto at = remembered(t, {})) {
    if (soft.x > 0) soft.x = std::max(soft.x, memory[*at].compliance.x);
    if (soft.y > 0) soft.y = std::max(soft.y, memory[*at].compliance.y);
  }
  return soft;
}

std::optional<World::SpringSwings> World::spring_swings() const {
  const Impl& w = *impl_;
  // The stiffness of all springs at a body, about the scene's axes.
  std::vector<bem::Mat2> stiffness(w.size());
  for (const ContactCandidate& t : w.touches) {
    const Vec2 soft = w.compliance_of(t), along = turned_left(t.normal);
    const double feature = std::min(w.shapes[t.i].feature, w.shapes[t.j].feature);
    if (soft == Vec2{} || t.gap > 1e-6 * feature) continue;
    const auto add = [&](double one, Vec2 d) {
      const bem::Mat2 k{d.x * d.x / one, d.x * d.y / one, d.x * d.y / one, d.y * d.y / one};
      for (const std::uint32_t body : {t.i, t.j}) stiffness[body] += k;
    };
    if (soft.x > 0) add(soft.x, t.normal);
    if (soft.y > 0) add(soft.y, along);
  }
  double least = std::numeric_limits<double>::infinity(), most = 0;  // squares of circular frequencies
  for (std::size_t b = 0; b < w.size(); ++b) {
    if (w.shapes[b].fixed || !(w.shapes[b].mass > 0)) continue;
    const bem::Mat2& k = stiffness[b];
    const double mean = 0.5 * (k.xx + k.yy), off = std::hypot(0.5 * (k.xx - k.yy), k.xy);
    for (const double square : {(mean - off) / w.shapes[b].mass, (mean + off) / w.shapes[b].mass}) {
      if (!(square > 1e-9 * mean / w.shapes[b].mass)) continue;
      least = std::min(least, square);
      most = std::max(most, square);
    }
  }
  if (!(most > 0)) return std::nullopt;
  const auto period = [](double square) { return Time::from_si(2 * std::numbers::pi / std::sqrt(square)); };
  return SpringSwings{period(most), period(least)};
}

}  // namespace cleave::dbem
