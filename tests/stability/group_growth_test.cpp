// What is judged together grows around groups that touch its end, and says where it may not.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/key_groups.hpp"
#include "statics.hpp"

namespace cleave::stability::group_growth_test {
namespace {

using assembly::Verdict;
using geometry::Vec3;
using statics::audited;

constexpr int along = 14;
/// tan(friction) below block k of a bar.
using Grip = double (*)(int);
/// Blocks 4 and 10 stay by themselves; what lies behind them pushes them.
double firm_in_the_middle(int k) { return k == 4 || k == 10 ? 1 : k < 4 ? 0.72 : 0.4; }
/// All lean on the first one, which alone stays, and with the next three.
double firm_in_front(int k) { return k == 0 ? 3 : 0.5; }

/// A bar that dips 3 in 4 out of a wall at x = 40, in a box of rock: one end is open. 14 blocks in line, each on a
/// joint of its own; above it a short bar of one block. All corners are dyadic, so that the joints below lie in one
/// plane.
topology::CutInput bars() {
  constexpr double y0 = 6, y1 = 10, e = 0.0625;
  const auto joint = [](std::vector<Vec3> corners) {
    return topology::Joint{{geometry::Polygon::make(std::move(corners)).value()}};
  };
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {40, 16, 64}).value()};
  const auto at = [](double k, double z, double y) { return Vec3{40 - 2 * k, y, z + 1.5 * k}; };
  const Vec3 up{1.5, 0, 2}, over = 1.0625 * up, under = -0.0625 * up;
  const auto base = [&](double z, double from, double to) {
    input.joints.emplace_back(joint({at(from, z, y0 - e), at(to, z, y0 - e), at(to, z, y1 + e), at(from, z, y1 + e)}));
  };
  for (int k = 0; k < along; ++k) base(10, k == 0 ? -1 : k, k + 1);
  base(44, -1, 1);
  // Smooth: roofs, walls, and across.
  for (const auto& [z, blocks] : {std::pair{10.0, along}, std::pair{44.0, 1}}) {
    const double end = blocks;
    input.joints.emplace_back(joint(
        {at(-1, z, y0 - e) + up, at(end + e, z, y0 - e) + up, at(end + e, z, y1 + e) + up, at(-1, z, y1 + e) + up}));
    for (const double y : {y0, y1}) {
      input.joints.emplace_back(
          joint({at(-1, z, y) + under, at(end + e, z, y) + under, at(end + e, z, y) + over, at(-1, z, y) + over}));
    }
    for (int k = 1; k <= blocks; ++k) {
      const double s = k;
      input.joints.emplace_back(
          joint({at(s, z, y0 - e), at(s, z, y1 + e), at(s, z, y1 + e) + over, at(s, z, y0 - e) + over}));
    }
  }
  input.free_domain_tags = {1};  // east
  return input;
}

Settings grips(Grip grip) {
  Settings out = statics::settings({statics::strength(0)});
  const auto of = [](double tan) { return statics::strength(std::atan(tan) * 180 / std::numbers::pi); };
  for (std::uint32_t k = 0; k < along; ++k) out.strengths.set(topology::JointId{k}, of(grip(static_cast<int>(k))));
  out.strengths.set(topology::JointId{std::uint32_t{along}}, of(0.3));
  return out;
}

/// Of the first blocks of the bar, which go as one: the first is cut by the wall, 0.625 times as large as the others.
double factor(Grip grip, int blocks) {
  double load = 0, held = 0;
  for (int k = 0; k < blocks; ++k) {
    const double weight = k == 0 ? 0.625 : 1;
    load += 0.75 * weight;
    held += grip(k) * weight;
  }
  return held / load;
}

/// The larger of the two groups that move first.
const KeyGroup& first_bar(const KeyGroups& groups) {
  return groups.groups[0].blocks.size() > groups.groups[1].blocks.size() ? groups.groups[0] : groups.groups[1];
}

TEST(GroupGrowth, BlocksFarBehindThatHoldOneByOnePush) {
  const auto complex = audited(bars());
  ASSERT_EQ(complex.complex().blocks().size(), along + 2U);
  const KeyGroups found = find_key_groups(complex, grips(firm_in_the_middle));
  EXPECT_EQ(found.blocks, 5U);  // four of the bar, and the short one
  EXPECT_FALSE(found.cut_off);
  EXPECT_FALSE(found.too_many);
  // The short one is said once, and stays said though the rock looked at grows elsewhere.
  ASSERT_EQ(found.groups.size(), 2U);
  const KeyGroup& bar = first_bar(found);
  const KeyGroup& alone = &bar == &found.groups[0] ? found.groups[1] : found.groups[0];
  EXPECT_EQ(alone.blocks.size(), 1U);
  EXPECT_NEAR(alone.factor_move, 0.4, 1e-6);
  ASSERT_EQ(bar.blocks.size(), 1U * along);
  // Forces locked in between base and roof may hold it.
  EXPECT_EQ(bar.verdict, Verdict::unsafe);
  EXPECT_EQ(bar.batch, 1U);
  EXPECT_NEAR(bar.factor_move, factor(firm_in_the_middle, along), 1e-4);
  EXPECT_LT(factor(firm_in_the_middle, along), 0.8 * factor(firm_in_the_middle, 4));
}

// With three layers behind the first block the bar stays; with all that leans on it from farther off it does not.
TEST(GroupGrowth, WhatLeansOnTheFirstLayersPushesThem) {
  ASSERT_GT(factor(firm_in_front, 4), 1.1);
  const auto complex = audited(bars());
  const KeyGroups found = find_key_groups(complex, grips(firm_in_front));
  EXPECT_EQ(found.blocks, along + 1U);
  ASSERT_EQ(found.groups.size(), 2U);
  const KeyGroup& bar = first_bar(found);
  ASSERT_EQ(bar.blocks.size(), 1U * along);
  EXPECT_EQ(bar.verdict, Verdict::unsafe);
  EXPECT_NEAR(bar.factor_move, factor(firm_in_front, along), 1e-4);
}

// Half the cohesion counts, as for what rests: with a little more than twice what holds it a block leans on nothing.
TEST(GroupGrowth, WhatCohesionHoldsDoesNotLean) {
  const auto complex = audited(bars());
  const auto near = [&](double share) {
    Settings settings = grips(firm_in_front);
    // A block of 25 m3 on 10 m2 of 3 in 4: driven with 15 N, held with 10 N by friction of 1 in 2.
    const double lack = 1.05 * 15 - 10, friction = std::atan(0.5) * 180 / std::numbers::pi;
    const JointStrength held = statics::strength(friction, share * lack / 10);
    for (std::uint32_t k = 1; k < along; ++k) settings.strengths.set(topology::JointId{k}, held);
    return find_key_groups(complex, settings).blocks;
  };
  EXPECT_EQ(near(1.9), along + 1U);
  EXPECT_EQ(near(2.1), 5U);
}

TEST(GroupGrowth, SaysWhereItMayNotGrow) {
  const auto complex = audited(bars());
  const KeyGroups found = find_key_groups(complex, grips(firm_in_the_middle), {.blocks = 9, .turning = 9});
  EXPECT_TRUE(found.cut_off);
  EXPECT_FALSE(found.too_many);
  // What moves without the rest is still said, and the rest in later states.
  ASSERT_GT(found.groups.size(), 2U);
  ASSERT_EQ(found.groups[1].batch, 1U);
  EXPECT_EQ(found.groups[2].batch, 2U);
  const KeyGroup& bar = first_bar(found);
  ASSERT_EQ(bar.blocks.size(), 4U);
  EXPECT_NEAR(bar.factor_move, factor(firm_in_the_middle, 4), 1e-5);
  EXPECT_TRUE(find_key_groups(complex, grips(firm_in_the_middle), {.blocks = 4, .turning = 4}).too_many);
}

}  // namespace
}  // namespace cleave::stability::group_growth_test
