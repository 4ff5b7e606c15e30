#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/dbem/body.hpp"

/// Contact geometry of two simple polygons: every contact is a corner of one body against an edge of the other.
namespace cleave::dbem {

/// The material at a corner: counter-clockwise from `out` (along the edge that leaves it) to `back` (towards the corner
/// before it). Neither need be of unit length.
struct Wedge {
  Vec2 out, back;
};

/// The two lines a corner of i meets when it enters a corner of j (Shi's entrance lines), from one rule: the boundary
/// of the cone K = wedge_j + (-wedge_i) of forbidden directions of p - q. Normals are of unit length and point from j
/// to i.
struct EntranceLines {
  Vec2 first, last;
  bool first_is_edge_of_j;  ///< the edge that leaves j's corner, else the edge that leaves i's corner
  bool last_is_edge_of_j;   ///< the edge that arrives at j's corner, else the one that arrives at i's
};
/// Precondition: both angles are below or equal to half a turn. The corners penetrate iff both normal gaps are
/// negative.
[[nodiscard]] EntranceLines entrance_lines(const Wedge& i, const Wedge& j);

constexpr std::uint32_t no_tie = static_cast<std::uint32_t>(-1);

/// Corner `vertex` of body i against edge `edge` (from corner `edge` to the next) of body j.
struct ContactCandidate {
  std::uint32_t i, vertex, j, edge;
  double gap;       ///< m, negative: penetration
  double ratio;     ///< of the foot along the edge, 0 .. 1
  Vec2 normal;      ///< unit, out of j
  Vec2 point;       ///< the corner
  double tilt = 0;  ///< rad, of `normal` against that of the edge: rough faces that ride up on one another
  /// Not a contact but a bar: `normal` points from its end on `i` to that on `j`, `gap` is by how much it is slack;
  /// `vertex` and `edge` are the edges its ends lie nearest to.
  std::uint32_t tie = no_tie;
  /// Two corners that are one place: the edge is one of the two at the other corner, and this their only contact.
  bool met = false;
  friend bool operator==(const ContactCandidate&, const ContactCandidate&) = default;
};

/// Two corners that nothing tells the line of yet: they lie over one another and stay there as far as is known, or pass
/// each other by. Only the motion tells whether they meet, and on which of the two lines.
struct CornerChoice {
  ContactCandidate first, last;
};

[[nodiscard]] inline bool overlap_boxes(const Box2& a, const Box2& b, double margin = 0) {
  return a.low.x - margin <= b.high.x && b.low.x - margin <= a.high.x && a.low.y - margin <= b.high.y &&
         b.low.y - margin <= a.high.y;
}

/// Motion in a step: displacement of the point x (scene) is shift + turn * turned_left(x).
struct Drift {
  Vec2 shift;
  double turn = 0;
  [[nodiscard]] Vec2 at(Vec2 x) const noexcept { return shift + turn * turned_left(x); }
};

/// A polygon where it lies now. `sharp`: 1 for corners that can touch (angle at most half a turn).
struct Placed {
  std::uint32_t body;
  std::span<const Vec2> corners;
  std::span<const std::uint8_t> sharp;
  Box2 box;
  bool convex;
};

/// What counts as a contact.
struct Reach {
  double margin;  ///< gaps below this, m
  double depth;   ///< penetrations up to this, m
  double near;    ///< places closer than this are one, m
  /// Pairs of corners closer than this are decided by the cone rule, m: as far as they can move in the step, and no
  /// farther than the cone holds (the smaller feature).
  double corner;
  double touching;  ///< penetrations up to this are rounding, m
};
/// Appends every contact of the two bodies. `drift` (of i relative to j) decides between two entrance lines with equal
/// gaps. Edge against edge gives the two ends of the common interval; a corner in a concave corner gives both edges.
/// Corners that are no contact yet go to `choices`.
void find_candidates(const Placed& i, const Placed& j, const Reach& reach, const Drift& drift,
                     std::vector<ContactCandidate>& out, std::vector<CornerChoice>& choices);

/// Gap, foot, normal and point of a known pair of corner and edge at new places of the corners.
void update_candidate(ContactCandidate& touch, std::span<const Vec2> corners_i, std::span<const Vec2> corners_j);

/// The line of a choice that was crossed last on the way from the gaps it was made with to those of `after`: the two
/// corners have come in there, or farther in. Nothing while one line holds but for `rounding`.
[[nodiscard]] std::optional<ContactCandidate> line_crossed(const CornerChoice& choice, const CornerChoice& after,
                                                           double rounding);

/// The edge of a polygon that moves from `before` to `after` which a point moving from `from` to `to` crosses first
/// from outside (or from a penetration of `rounding`).
[[nodiscard]] std::optional<std::size_t> first_crossing(std::span<const Vec2> before, std::span<const Vec2> after,
                                                        Vec2 from, Vec2 to, double rounding = 0);

/// Depth of the deepest corner of one inside the other, 0 when they do not overlap by more than `tolerance`.
struct Overlap {
  double depth = 0;  ///< m
  Vec2 at;
};
[[nodiscard]] Overlap overlap(const Placed& i, const Placed& j, double tolerance);

[[nodiscard]] bool inside(std::span<const Vec2> corners, Vec2 point);

/// Pairs (a < b, in order) of boxes that overlap; pairs of two `idle` ones are left out. Uniform grid of the size of
/// the usual box, the few large ones one by one: O(n + pairs).
struct BodyPair {
  std::uint32_t a, b;
  friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};
[[nodiscard]] std::vector<BodyPair> overlapping_pairs(const std::vector<Box2>& boxes,
                                                      const std::vector<std::uint8_t>& idle);

}  // namespace cleave::dbem
