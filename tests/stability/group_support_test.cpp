// Whether support holds blocks that only move together.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <vector>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/support.hpp"
#include "slab_behind_toe.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using statics::audited;
using statics::slab_behind_toe;
using statics::slope;
using statics::strength;
using topology::BlockId;

constexpr Together translation{20'000, 0};

/// Level bolts through the toe, each of `tendon` N, into what lies behind it.
std::vector<Bolt> level_bolts(double tendon, double z, double length, int count = 4) {
  std::vector<Bolt> out;
  for (int k = 0; k < count; ++k) {
    out.push_back({.collar = {31, 3.0 + k, z},
                   .direction = {-1, 0, 0},
                   .length = metres(length),
                   .type = {.tendon = newtons(tendon),
                            .plate = newtons(1e9),
                            .anchorage = metres(0.3),
                            .kind = GroutedBar{.bond = newtons_per_metre(1e9)}}});
  }
  return out;
}

GroupSupport checked(const topology::AuditedComplex& complex, const Settings& settings, const SupportPlan& plan,
                     const Together& most = translation) {
  const Analysis analysis = analyse(complex, settings);
  return check_groups(complex, settings, plan, check_support(complex, settings, analysis, plan), most);
}

/// Volume that still moves or is in doubt with the support.
double left(const topology::AuditedComplex& complex, const Settings& settings, const SupportPlan& plan,
            const Together& most = translation) {
  const GroupSupport found = checked(complex, settings, plan, most);
  double sum = 0;
  for (const KeyGroup& group : found.left.groups) sum += group.volume.si();
  for (const KeyGroup& group : found.below.groups) {
    if (found.left.groups.empty()) {
      EXPECT_FALSE(found.left_of(group));
    }
  }
  return sum;
}

/// The slab's push on the toe at strengths over `factor`, less what the toe's base takes; loads are volumes.
double level_force(double factor) {
  const double dip = 35 * std::numbers::pi / 180, m = std::tan(std::numbers::pi / 6) / factor;
  const double slab = 312, toe = 18.8620205076;
  const double push =
      slab * (std::sin(dip) - m * std::cos(dip)) / ((1 - m * m) * std::cos(dip) + 2 * m * std::sin(dip));
  return push - m * (toe + m * push);
}

TEST(GroupSupportTest, LevelBoltsHoldTheToeOfASlab) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  EXPECT_NEAR(level_force(1.3), 36.643680, 1e-6);
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.3};
  // Alone each of the two is held by the other: a check block by block finds nothing to hold.
  EXPECT_TRUE(check_support(complex, settings, analyse(complex, settings), plan).passes());
  const double whole = 312 + 18.8620205076;
  EXPECT_NEAR(left(complex, settings, plan), whole, 1e-6);
  const auto verdict = [&](double tendon, int count = 4) -> std::optional<assembly::Verdict> {
    plan.bolts = level_bolts(tendon, 16, 6, count);
    const GroupSupport found = checked(complex, settings, plan);
    if (found.below.groups.size() != 1U) {
      ADD_FAILURE() << found.below.groups.size();
      return {};
    }
    // Verdicts are all that is asked of them.
    EXPECT_FALSE(found.below.groups.front().factors);
    return found.left_of(found.below.groups.front());
  };
  // Bolts are over the factor as strengths are. Within 5 % of the target: in doubt, as without support.
  const auto tendon = [](double factor) { return factor * level_force(factor) / 4; };
  EXPECT_EQ(verdict(1.002 * tendon(1.3 * 1.05)), std::nullopt);
  EXPECT_EQ(verdict(0.998 * tendon(1.3 * 1.05)), assembly::Verdict::in_doubt);
  EXPECT_EQ(verdict(1.002 * tendon(1.3)), assembly::Verdict::in_doubt);
  EXPECT_EQ(verdict(0.998 * tendon(1.3)), assembly::Verdict::unsafe);
  EXPECT_EQ(verdict(1.002 * tendon(1.3 * 1.05), 2), assembly::Verdict::unsafe);
  // With moments a level pull at the foot of the toe does not do; strong bolts on two levels do.
  plan.bolts = level_bolts(500, 15.9, 8);
  std::ranges::copy(level_bolts(500, 17.5, 8), std::back_inserter(plan.bolts));
  EXPECT_EQ(left(complex, settings, plan, most_together), 0);
}

TEST(GroupSupportTest, BoltsBetweenTwoBlocksThatMoveHoldNothing) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  // Through the toe into the slab behind it, and no farther.
  SupportPlan plan{.bolts = level_bolts(1e8, 18, 2), .target_falling = 1.5, .target_sliding = 1.3};
  EXPECT_GT(left(complex, settings, plan), 300);
  plan.bolts = level_bolts(1e8, 18, 6);
  EXPECT_EQ(left(complex, settings, plan), 0);
  // Down through the slab ahead of its motion, which would shorten them: a bar carries no compression.
  const double z = 40 - 10 * slope;
  for (Bolt& bolt : plan.bolts) {
    bolt.collar = {10, bolt.collar.y, z};
    bolt.direction = {0.5, 0, -std::sqrt(0.75)};
  }
  EXPECT_GT(left(complex, settings, plan), 300);
}

/// A block of 2 x 2 x `deep` m in the roof of a box, cut by five joints; only the roof's face is free.
topology::CutInput block_in_a_roof(double deep) {
  const auto polygon = [](std::vector<Vec3> corners) {
    return topology::Joint{{geometry::Polygon::make(std::move(corners)).value()}};
  };
  const double e = 0.1;
  return {
      .domain = geometry::make_box({-5, -5, 0}, {5, 5, 10}).value(),
      .joints = {polygon({{-1, -1 - e, -1}, {-1, 1 + e, -1}, {-1, 1 + e, deep + e}, {-1, -1 - e, deep + e}}),
                 polygon({{1, -1 - e, -1}, {1, 1 + e, -1}, {1, 1 + e, deep + e}, {1, -1 - e, deep + e}}),
                 polygon({{-1 - e, -1, -1}, {1 + e, -1, -1}, {1 + e, -1, deep + e}, {-1 - e, -1, deep + e}}),
                 polygon({{-1 - e, 1, -1}, {1 + e, 1, -1}, {1 + e, 1, deep + e}, {-1 - e, 1, deep + e}}),
                 polygon({{-1 - e, -1 - e, deep}, {1 + e, -1 - e, deep}, {1 + e, 1 + e, deep}, {-1 - e, 1 + e, deep}})},
      .excavations = {},
      .free_domain_tags = {4}};
}

TEST(GroupSupportTest, OneBlockIsHeldAsTheCheckOfBlocksSays) {
  const double deep = 1.5;
  const auto complex = audited(block_in_a_roof(deep));
  const Settings settings = statics::settings({strength(10)});
  const double weight = 4 * deep;
  const auto both = [&](const SupportPlan& plan) {
    const SupportResult alone = check_support(complex, settings, analyse(complex, settings), plan);
    EXPECT_EQ(alone.blocks.size(), 1U);
    EXPECT_EQ(alone.passes(), left(complex, settings, plan) == 0);
    return alone.passes();
  };
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.3};
  EXPECT_FALSE(both(plan));
  Bolt bolt{
      .collar = {0, 0, 0},
      .direction = {0, 0, 1},
      .length = metres(3),
      .type = {.plate = newtons(1e9), .anchorage = metres(0.3), .kind = GroutedBar{.bond = newtons_per_metre(1e9)}}};
  for (const double share : {0.998, 1.002}) {
    bolt.type.tendon = newtons(share * 1.5 * weight);
    plan.bolts = {bolt};
    EXPECT_EQ(both(plan), share > 1);
    // What the anchor holds, and the plate with the bond in front of the joint.
    Bolt other = bolt;
    other.type.tendon = newtons(1e9);
    other.type.kind = GroutedBar{.bond = newtons_per_metre(share * weight)};  // 1.5 m behind the joint
    plan.bolts = {other};
    EXPECT_EQ(both(plan), share > 1);
    other.type.plate = newtons(share * weight);
    other.type.kind = GroutedBar{.bond = newtons_per_metre(weight / 3)};
    other.length = metres(10 - 1e-3);
    plan.bolts = {other};
    EXPECT_EQ(both(plan), share > 1);
  }
  // What is left out of balance: its weight less what the bolt holds over the target.
  for (const double share : {0.0, 0.25, 0.9}) {
    bolt.type.tendon = newtons(std::max(share, 1e-9) * 1.5 * weight);
    plan.bolts = {bolt};
    const GroupSupport found = checked(complex, settings, plan);
    ASSERT_EQ(found.below.groups.size(), 1U);
    EXPECT_NEAR(found.below.groups[0].net.value().si(), weight, 1e-6 * weight);
    EXPECT_NEAR(found.net_left_of(found.below.groups[0]).value().si(), (1 - share) * weight, 1e-6 * weight);
  }
  bolt.type.tendon = newtons(3 * weight);
  plan.bolts = {bolt};
  const GroupSupport held = checked(complex, settings, plan);
  EXPECT_EQ(held.net_left_of(held.below.groups.at(0)), std::nullopt);
  // Too short behind the joint.
  bolt.type.tendon = newtons(1e9);
  bolt.length = metres(1.7);
  plan.bolts = {bolt};
  EXPECT_FALSE(both(plan));
  // Ring shear along 8 m.
  plan.bolts.clear();
  for (const double share : {0.998, 1.002}) {
    plan.shotcrete = Shotcrete{
        .thickness = metres(0.1), .shear_strength = pascals(share * 1.5 * weight / 0.8), .on = {AnyFreeFace{}}};
    EXPECT_EQ(both(plan), share > 1);
    plan.shotcrete = Shotcrete{.thickness = metres(0.1),
                               .shear_strength = pascals(1e9),
                               .adhesion = pascals(share * 1.5 * weight / (8 * 0.03)),
                               .on = {AnyFreeFace{}}};
    EXPECT_EQ(both(plan), share > 1);
  }
}

/// What moves at an angle to the face that it comes out of has all of its layer against it, here as by itself.
TEST(GroupSupportTest, ShotcreteHoldsWhatSlidesAsTheCheckOfBlocksSays) {
  // A slab on 40 degrees, and a wedge between two planes, in the wall of a cutting.
  topology::CutInput slab{.domain = geometry::make_box({0, 0, 0}, {14, 2, 8}).value(),
                          .joints = {},
                          .excavations = {geometry::make_box({-1, -1, 4}, {5, 3, 9}).value()},
                          .free_domain_tags = {2, 3, 5}};
  const double dip = 40 * std::numbers::pi / 180;
  slab.joints.emplace_back(topology::PersistentJoint{{5, 0, 5.5}, {-std::sin(dip), 0, std::cos(dip)}});
  topology::CutInput wedge{.domain = geometry::make_box({0, -10, 0}, {20, 10, 8}).value(),
                           .joints = {},
                           .excavations = {geometry::make_box({-1, -11, 2}, {5, 11, 9}).value()},
                           .free_domain_tags = {5}};
  for (const double side : {-1.0, 1.0}) {
    wedge.joints.emplace_back(topology::PersistentJoint{{5, 0, 4}, geometry::normalized({-0.9, side * 1.1, 1})});
  }
  for (const topology::CutInput& input : {slab, wedge}) {
    const auto complex = audited(input);
    const Settings settings = statics::settings({strength(25)});
    SupportPlan plan{.shotcrete = Shotcrete{.thickness = metres(0.1), .shear_strength = pascals(1e-3)},
                     .target_falling = 1.5,
                     .target_sliding = 1.3};
    const auto alone = [&] { return check_support(complex, settings, analyse(complex, settings), plan); };
    const SupportResult little = alone();
    ASSERT_EQ(little.blocks.size(), 1U);
    const double needed = 1e-3 / 0.1 * little.blocks[0].needed_thickness.value();  // Pa, at 0.1 m
    for (const double share : {0.99, 1.01}) {
      plan.shotcrete->shear_strength = pascals(share * needed);
      EXPECT_EQ(alone().passes(), share > 1);
      EXPECT_EQ(left(complex, settings, plan) == 0, share > 1) << share;
    }
  }
}

/// The slab with layers on its face alone: straight against its sliding they let it turn, straight out they do not.
TEST(GroupSupportTest, ShotcreteOfAFaceHoldsWhatWouldTurn) {
  const double dip = 38 * std::numbers::pi / 180;
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {40, 20, 20}).value(),
                           .joints = {},
                           .excavations = {geometry::make_box({16, -1, 4}, {41, 21, 21}).value(),
                                           geometry::make_box({-1, -1, 16}, {17, 21, 21}).value()},
                           .free_domain_tags = {5}};
  input.joints.emplace_back(topology::PersistentJoint{{16, 10, 5}, {std::sin(dip), 0, std::cos(dip)}});
  for (const double y : {5.0, 15.0}) input.joints.emplace_back(topology::PersistentJoint{{0, y, 0}, {0, 1, 0}});
  input.joints.emplace_back(topology::PersistentJoint{{12, 10, 16}, {1, 0, 0}});
  const auto complex = audited(input);
  const Settings settings = statics::settings({strength(30)});
  SupportPlan plan{.shotcrete = Shotcrete{.thickness = metres(0.1), .shear_strength = pascals(1e-3)},
                   .target_falling = 1.5,
                   .target_sliding = 1.3};
  const SupportResult little = check_support(complex, settings, analyse(complex, settings), plan);
  ASSERT_EQ(little.blocks.size(), 1U);
  const double needed = 1e-3 / 0.1 * little.blocks[0].needed_thickness.value();
  plan.shotcrete->shear_strength = pascals(2.5 * needed);
  EXPECT_EQ(left(complex, settings, plan), 0);
  EXPECT_EQ(left(complex, settings, plan, most_together), 0);
}

/// Beyond two sides of the plug lie two blocks each: the layer is held at both of them.
TEST(GroupSupportTest, ShotcreteIsHeldAtSeveralBlocksBeyondOneEdge) {
  const double deep = 1.5, weight = 4 * deep, y = 0.3, e = 0.1;
  topology::CutInput input = block_in_a_roof(deep);
  for (const double side : {-1.0, 1.0}) {
    const double x = side, end = side * (5 + e);
    input.joints.emplace_back(topology::Joint{
        {geometry::Polygon::make({{x, y, -e}, {end, y, -e}, {end, y, 10 + e}, {x, y, 10 + e}}).value()}});
  }
  input.joints.emplace_back(topology::Joint{
      {geometry::Polygon::make({{-1, y, deep}, {1, y, deep}, {1, y, 10 + e}, {-1, y, 10 + e}}).value()}});
  const auto complex = audited(input);
  ASSERT_EQ(complex.complex().blocks().size(), 3U);
  const Settings settings = statics::settings({strength(10)});
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.3};
  for (const double share : {0.99, 1.01}) {
    plan.shotcrete = Shotcrete{
        .thickness = metres(0.1), .shear_strength = pascals(share * 1.5 * weight / 0.8), .on = {AnyFreeFace{}}};
    EXPECT_EQ(check_support(complex, settings, analyse(complex, settings), plan).passes(), share > 1);
    EXPECT_EQ(left(complex, settings, plan) == 0, share > 1) << share;
  }
}

TEST(GroupSupportTest, TwoBlocksOnOneBoltShareItsAnchor) {
  topology::CutInput input = block_in_a_roof(1.5);
  input.joints.emplace_back(topology::Joint{
      {geometry::Polygon::make({{-1.1, -1.1, 0.75}, {1.1, -1.1, 0.75}, {1.1, 1.1, 0.75}, {-1.1, 1.1, 0.75}}).value()}});
  const auto complex = audited(input);
  const Settings settings = statics::settings({strength(10)});
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.3};
  for (const double share : {0.75, 0.998, 1.06}) {
    // 1.5 m behind the upper block; the lower one hangs on the plate, the upper one has a bond of its own.
    plan.bolts = {{.collar = {0, 0, 0},
                   .direction = {0, 0, 1},
                   .length = metres(3),
                   .type = {.tendon = newtons(1e9),
                            .plate = newtons(1e9),
                            .anchorage = metres(0.3),
                            .kind = GroutedBar{.bond = newtons_per_metre(share * 6)}}}};
    EXPECT_EQ(left(complex, settings, plan) == 0, share > 1) << share;
  }
}

TEST(GroupSupportTest, WhatScalingLaidBareNeedsSupport) {
  // A plate of 0.1 m in front of the block is scaled off: the block has no free face of its own.
  topology::CutInput input = block_in_a_roof(1.5);
  input.joints.emplace_back(topology::Joint{
      {geometry::Polygon::make({{-1.1, -1.1, 0.1}, {1.1, -1.1, 0.1}, {1.1, 1.1, 0.1}, {-1.1, 1.1, 0.1}}).value()}});
  const auto complex = audited(input);
  Settings settings = statics::settings({strength(10)});
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.3};
  EXPECT_EQ(check_support(complex, settings, analyse(complex, settings), plan).blocks.size(), 1U);
  for (const BlockId id : complex.complex().blocks().ids()) {
    if (complex.complex().blocks()[id].volume.si() < 1) settings.left_out.push_back(id);
  }
  ASSERT_EQ(settings.left_out.size(), 1U);
  const double weight = 4 * 1.4;
  const auto alone = [&] {
    const SupportResult found = check_support(complex, settings, analyse(complex, settings), plan);
    EXPECT_EQ(found.blocks.size(), 1U);
    if (found.blocks.size() == 1) {
      EXPECT_NEAR(found.blocks[0].net_force, weight, 1e-9);
      EXPECT_NEAR(found.blocks[0].free_area.si(), 4, 1e-9);
      EXPECT_NEAR(found.blocks[0].required_pressure, 1.5 * weight / 4, 1e-6);
    }
    EXPECT_EQ(found.passes(), left(complex, settings, plan) == 0);
    return found.passes();
  };
  EXPECT_FALSE(alone());
  for (const double share : {0.998, 1.002}) {
    plan.shotcrete = Shotcrete{
        .thickness = metres(0.1), .shear_strength = pascals(share * 1.5 * weight / 0.8), .on = {AnyFreeFace{}}};
    EXPECT_EQ(alone(), share > 1);
  }
  // The plate of a bolt is on what is left; what it held in the scaled plate counts no more.
  plan.shotcrete.reset();
  for (const double share : {0.998, 1.002}) {
    plan.bolts = {{.collar = {0, 0, 0},
                   .direction = {0, 0, 1},
                   .length = metres(9.99),
                   .type = {.tendon = newtons(1e9),
                            .plate = newtons(share * 1.5 * weight - 1.4),
                            .anchorage = metres(0.3),
                            .kind = GroutedBar{.bond = newtons_per_metre(1)}}}};
    EXPECT_EQ(alone(), share > 1);
  }
}

}  // namespace
}  // namespace cleave::stability
