#pragma once

#include <array>
#include <optional>
#include <vector>

#include "cleave/stability/support.hpp"

namespace cleave::stability {

/// Bolts in rings along a straight or bent axis. The outline is the section's, (u, v) in metres, counter-clockwise
/// looking along the axis with u to the right; the bolted arc is where its outward normal lies within `arc` degrees of
/// up (to the right positive).
struct RingPattern {
  std::vector<geometry::Vec3> axis;
  geometry::Vec3 up{0, 0, 1};
  std::vector<std::array<double, 2>> outline;
  std::array<double, 2> arc{-120, 120};
  Length along = metres(1), around = metres(1);
  Length offset_along, offset_around;  ///< of the first ring and of the first bolt of a ring
  bool stagger = false;                ///< every second ring half a spacing further round
  double inclination = 0;              ///< degrees from the normal towards the axis's end
  Length length = metres(3);
  BoltType type;
  std::uint32_t group = 0, after_stage = 0;
};
/// A ring every `along` m, in each a bolt every `around` m of the arc: (floor((L - o)/along) + 1)
/// (floor((P - o)/around) + 1) bolts. Empty for spacings that are not > 0.
[[nodiscard]] std::vector<Bolt> bolts_of(const RingPattern& pattern);

/// Bolts on a grid in a plane: columns along strike, rows down dip, from `corner`.
struct GridPattern {
  geometry::Vec3 corner;
  geometry::Vec3 across, down;  ///< unit, in the plane
  Length width, height;
  Length spacing_across = metres(1), spacing_down = metres(1);
  Length offset_across, offset_down;
  bool stagger = false;
  geometry::Vec3 direction;  ///< unit, into the rock
  Length length = metres(3);
  BoltType type;
  std::uint32_t group = 0, after_stage = 0;
};
[[nodiscard]] std::vector<Bolt> bolts_of(const GridPattern& pattern);

}  // namespace cleave::stability
