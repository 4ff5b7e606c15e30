#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "closed_sets.hpp"
#include "complexes.hpp"

/// Closed sets of polygons as joints of a scene.
namespace cleave::testing {

using support::ClosedSet;
using support::Corners;
using support::Placement;

inline support::Uniform uniform(std::uint64_t seed) {
  return [random = std::mt19937_64{seed}]() mutable { return static_cast<double>(random() >> 11U) * 0x1p-53; };
}
inline Placement turned(const support::Uniform& u) { return {{6 * u(), 6 * u(), 6 * u()}, 1, {}}; }
inline constexpr double degree = std::numbers::pi / 180;

/// One polygon a joint.
inline void add(topology::CutInput& input, const std::vector<Corners>& polygons) {
  for (const Corners& corners : polygons) input.joints.emplace_back(joint(corners));
}
/// In a box twice as wide as it needs.
inline topology::CutInput in_a_box(const ClosedSet& set, const Placement& at) {
  const double half = 2 * at.scale;
  auto input = scene(box(at.shift - Vec3{half, half, half}, at.shift + Vec3{half, half, half}));
  add(input, placed(set, at).polygons);
  return input;
}
inline std::size_t convex_blocks(const topology::BlockComplex& complex) {
  return static_cast<std::size_t>(
      std::ranges::count_if(complex.blocks(), [](const topology::Block& b) { return b.convex; }));
}
inline void expect_parts(const ClosedSet& set, const Placement& at) {
  const auto input = in_a_box(set, at);
  const auto audited = certified(input);
  EXPECT_EQ(audited.complex().blocks().size(), set.parts + 1) << set.name;
  if (set.convex) {
    EXPECT_EQ(convex_blocks(audited.complex()), set.parts) << set.name;
  }
}

}  // namespace cleave::testing
