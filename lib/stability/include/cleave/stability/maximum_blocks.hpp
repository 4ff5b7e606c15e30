#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/stability/strength.hpp"

namespace cleave::stability {

/// A joint set as block theory sees it: planes of one orientation, anywhere and without end.
struct TheoryPlane {
  Direction upward;  ///< normal
  JointStrength strength;
};

/// The largest block of three sets at a tunnel that could come out, and its statics.
struct MaximumKeyBlock {
  std::array<std::size_t, 3> planes{};        ///< which, ascending
  std::array<geometry::Vec3, 3> upward = {};  ///< their unit normals
  MaximumBlock block;                         ///< bit i of its code: below planes[i]
  double scale = 1;                           ///< of its lengths, that no joint be longer than it may be
  [[nodiscard]] double longest_trace() const noexcept;
  [[nodiscard]] double largest_extent() const noexcept;
  std::array<double, 3> areas{};  ///< m2 of the joint faces
  Force weight = {};
  Mode mode = Mode::stable;
  geometry::Vec3 direction = {};  ///< unit; zero where nothing drives it
  Force driving = {}, resistance = {}, net = {};
  double factor_of_safety = std::numeric_limits<double>::infinity();
  double target = 1;
  /// Pa on its free face, at right angles to the wall, that reaches the target: 0 where none is needed, inf where none
  /// does.
  double required_pressure = 0;
};

/// How long joints may be, m.
struct Persistence {
  double trace = std::numeric_limits<double>::infinity();  ///< on the wall
  double size = std::numeric_limits<double>::infinity();   ///< largest extent of a joint face
};

struct TheoryLoads {
  Density density;
  geometry::Vec3 gravity;       ///< m/s2
  geometry::Vec3 seismic = {};  ///< force / weight
  PartialFactors partial = {};
  double target_falling = 1.5, target_sliding = 1.3;
};

/// For every three of the planes and every choice of their sides: the largest removable block (Goodman and Shi 1985),
/// its faces, mode and factor of safety; scaled down where joints are not as long. Blocks below `least` m3 are left
/// out. In order of planes, then code.
[[nodiscard]] std::vector<MaximumKeyBlock> maximum_key_blocks(std::span<const TheoryPlane> planes,
                                                              const ConvexTunnel& tunnel, const TheoryLoads& loads,
                                                              const Persistence& persistence = {}, double least = 1e-9);

/// Whether the corners, counter-clockwise, bound a convex region.
[[nodiscard]] bool is_convex(std::span<const std::array<double, 2>> outline);

}  // namespace cleave::stability
