#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "closed_scenes.hpp"

// Sides that nearly touch something are noted.

namespace cleave::testing {
namespace {

/// What is noted of joints that nearly reach one another.
topology::NearMisses near_misses(const topology::CutInput& input) {
  return certified(input).complex().report().near_misses;
}

TEST(NearMisses, ASideShortOfAFace) {
  for (const double gap : {1e-6, 1e-8, 1e-10, 5e-12, 1e-12, 2e-13}) {
    // The second ends on the first but for the gap; it reaches beyond the domain elsewhere.
    const auto input = scene(
        box({-5, -5, -5}, {5, 5, 5}),
        {rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 0.5, {gap, -9}, {9, 9}), rectangle(2, -1, {-9, -9}, {-2, 9})});
    const auto found = near_misses(input);
    if (gap < 16 * 0x1p-47 * 10) {  // roundings: it was drawn to end there
      EXPECT_EQ(count_blocks(input), 3U) << gap;
      EXPECT_EQ(found.sides, 0U) << gap;
      continue;
    }
    EXPECT_EQ(found.sides, 1U) << gap;
    EXPECT_NEAR(found.largest.si(), gap, 1.2e-13 + 1e-3 * gap) << "but for the lattice";
    EXPECT_EQ(found.joint, topology::JointId{0U});
    EXPECT_EQ(found.other, topology::JointId{1U});
    auto snapped = input;
    snapped.snap = 1.05 * found.largest;
    EXPECT_EQ(count_blocks(input), 2U);
    EXPECT_EQ(count_blocks(snapped), 3U);
    EXPECT_EQ(near_misses(snapped).sides, 0U);
  }
}

TEST(NearMisses, OnlyWhatDoesNotTouch) {
  const auto cube = box({-5, -5, -5}, {5, 5, 5});
  const auto sides = [&](std::initializer_list<topology::Joint> joints) {
    return near_misses(scene(cube, joints)).sides;
  };
  const auto fault = rectangle(0, 0, {-9, -9}, {9, 9});
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {0, -9}, {9, 9})}), 0U) << "it ends on the fault";
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {-1e-9, -9}, {9, 9})}), 0U) << "it goes through";
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {1e-3, -9}, {9, 9})}), 0U) << "it keeps away";
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 0}), rectangle(0, 0, {-9, 1e-8}, {9, 9})}), 1U) << "in one plane";
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 0}), rectangle(0, 0, {-9, 0}, {9, 9})}), 0U) << "in one plane";
  EXPECT_EQ(sides({rectangle(2, 0, {-4, -4}, {4, 4 - 1e-9}), rectangle(1, 4, {-4, -1}, {4, 1})}), 1U);
  EXPECT_EQ(sides({rectangle(2, 0, {-4.9999999, -9}, {9, 9})}), 1U) << "of the domain's side";
  // Beyond the domain nothing is missed.
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 6, {1e-9, -9}, {9, 9})}), 0U);
}

TEST(NearMisses, NotOfWhatWasCutOff) {
  // The second ends on the first; the third ends just above where the second would have gone on.
  auto input = scene(
      box({-5, -5, -5}, {5, 5, 5}),
      {rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 1, {-2, -9}, {9, 9}), rectangle(0, -1, {-9, 1 + 1e-8}, {9, 9})});
  EXPECT_EQ(near_misses(input).sides, 1U);
  input.terminations.push_back({topology::JointId{1U}, topology::JointId{0U}});
  EXPECT_EQ(near_misses(input).sides, 0U);
}

TEST(NearMisses, ASlitInAWall) {
  // Two tiles above a long one come apart from the corner they share upwards; roundings apart they are one wall.
  const auto u = uniform(26);
  for (const double gap : {1e-7, 1e-9, 0.0}) {
    for (int k = 0; k < 4; ++k) {
      const Placement at = turned(u);
      auto input = scene(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
      const auto p = [&](double x, double y) { return at({x, y, 0.01}); };
      add(input, {{p(-3, -3), p(3, -3), p(3, -0.2), p(0, -0.2), p(-3, -0.2)},
                  {p(-3, -0.2), p(0, -0.2), p(-gap / 2, 3), p(-3, 3)},
                  {p(0, -0.2), p(3, -0.2), p(3, 3), p(gap / 2, 3)}});
      const auto found = near_misses(input);
      EXPECT_EQ(found.sides, gap > 0 ? 1U : 0U) << gap;
      EXPECT_EQ(count_blocks(input), gap > 0 ? 1U : 2U) << gap;
      if (gap == 0) continue;
      EXPECT_LE(found.largest.si(), gap);
      EXPECT_GT(found.largest.si(), 0);
      EXPECT_EQ(found.joint, topology::JointId{1U});
      EXPECT_EQ(found.other, topology::JointId{2U});
    }
  }
}

TEST(NearMisses, ClosedSurfacesHaveNone) {
  const auto u = uniform(13);
  for (int k = 0; k < 30; ++k) {
    const ClosedSet set = support::any_closed_set(u);
    EXPECT_EQ(near_misses(in_a_box(set, turned(u))).sides, 0U) << set.name;
  }
  // A surface of triangles that is flat but for 1e-7, and goes on beyond the domain: where its triangles meet at a
  // corner, a side of the one runs close to the other.
  auto flat = scene(box({-1, -1, -1}, {1, 1, 1}));
  const auto at = [](int i, int j) -> geometry::Vec3 { return {0.7 * i, 0.7 * j, i == j ? 0 : 1e-7 * (i - j) * j}; };
  std::vector<std::vector<geometry::Vec3>> triangles;
  for (int i = -2; i < 2; ++i) {
    for (int j = -2; j < 2; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  add(flat, triangles);
  EXPECT_EQ(count_blocks(flat), 2U);
  EXPECT_EQ(near_misses(flat).sides, 0U);
  // A bar with one edge taken off by 1e-7: the sides that it parts do not meet, and yet nothing is open.
  const double d = 1e-7;
  const std::vector<std::array<double, 2>> outline{{0, 0}, {0.5, 0}, {0.5, 0.5 - d}, {0.5 - d, 0.5}, {0, 0.5}};
  ClosedSet bar{"bar", {{}, {}}, 1, true};
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto [x, y] = outline[k];
    const auto [to_x, to_y] = outline[(k + 1) % outline.size()];
    bar.polygons.push_back({{x, y, 0}, {to_x, to_y, 0}, {to_x, to_y, 0.5}, {x, y, 0.5}});
    bar.polygons[0].push_back({x, y, 0});
    bar.polygons[1].push_back({x, y, 0.5});
  }
  const auto input = in_a_box(bar, turned(u));
  EXPECT_EQ(count_blocks(input), 2U);
  EXPECT_EQ(near_misses(input).sides, 0U);
}

}  // namespace
}  // namespace cleave::testing
