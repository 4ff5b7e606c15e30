// What a search at rest is checked by, and numbered cases that need more than two factors.

#include "balance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "cleave/assembly/groups.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

TEST(BalanceCertificates, SayWhatForcesLack) {
  const Assembly slope = single({{plane(25, 90), tan_deg(30)}}).made();
  ContactForces forces = holding_forces(slope, 1);
  const auto held = check_balance(slope, 1, forces);
  ASSERT_TRUE(held.has_value());
  EXPECT_LT(held->lack()[0], 1e-9);
  forces.at_points[0][0] = 0.9 * forces.at_points[0][0];
  const auto less = check_balance(slope, 1, forces);
  ASSERT_TRUE(less.has_value());
  EXPECT_NEAR(less->lack()[0], 0.1, 1e-6);
  forces.at_points.pop_back();
  EXPECT_FALSE(check_balance(slope, 1, forces).has_value());
}

TEST(BalanceCertificates, AreRefusedForForcesThatNoContactCarries) {
  // Steeper than its friction: what balances the weight is outside the cone.
  const Assembly slope = single({{plane(35, 90), tan_deg(30)}}).made();
  ContactForces forces = holding_forces(slope, 0.5);
  EXPECT_TRUE(check_balance(slope, 0.5, forces).has_value());
  EXPECT_FALSE(check_balance(slope, 1, forces).has_value());
  // A joint does not pull.
  const Assembly roof = single({{{0, 0, -1}, 1}}).made();
  forces = holding_forces(roof, 1);
  EXPECT_NEAR(check_balance(roof, 1, forces)->lack()[0], 1, 1e-9);
  forces.at_points[0][0] = {0, 0, 1};
  EXPECT_FALSE(check_balance(roof, 1, forces).has_value());
  forces.at_points[0][0] = {0, 0, std::nan("")};
  EXPECT_FALSE(check_balance(roof, 1, forces).has_value());
}

TEST(BalanceCertificates, CohesionCountsWherePressed) {
  const Assembly steep = single({{plane(60, 90), 0, 1}}).made();
  ContactForces forces = holding_forces(steep, 1);
  ASSERT_TRUE(check_balance(steep, 1, forces).has_value());
  EXPECT_LT(check_balance(steep, 1, forces)->lack()[0], 1e-9);
  EXPECT_FALSE(check_balance(steep, 2, forces).has_value());
  forces.at_points[0][0] = {};
  EXPECT_FALSE(check_balance(steep, 1, forces).has_value());
}

TEST(BalanceCertificates, CountMoments) {
  // A column that would topple: a force under its centroid does not balance it when it stands off the middle.
  Builder b{Freedom::section};
  const std::uint32_t column = b.polygon({{0, 0}, {1, 0}, {1, 4}, {0, 4}});
  b.edge(column, rock, {0, 0}, {1, 0}, 1);
  const Assembly assembly = b.made();
  ContactForces forces{.at_points = {{{0, 0, 2}, {0, 0, 2}}}, .at_bonds = {{}}};
  EXPECT_LT(check_balance(assembly, 1, forces)->lack()[0], 1e-9);
  forces.at_points[0] = {{0, 0, 3}, {0, 0, 1}};
  EXPECT_GT(check_balance(assembly, 1, forces)->lack()[0], 0.1);
}

/// A body held only by one that moves is no body at rest.
TEST(KeyGroups, WhatLeansOnWhatMovesIsNotHeld) {
  Builder b{Freedom::translation};
  // The lower slides; the upper lies on it behind a smooth wall.
  const std::uint32_t lower = b.block({0, 0, -2}, 2), upper = b.block({0, 0, -1}, 1);
  b.contact(lower, rock, plane(40, 90), tan_deg(20));
  b.contact(upper, lower, plane(40, 90), tan_deg(20));
  const Groups found = find_groups(b.made());
  std::size_t in_groups = 0;
  for (const Group& group : found.groups) in_groups += group.bodies.size();
  EXPECT_EQ(in_groups, 2U);
}

TEST(Pairs, ForceThatHoldsTheToeK4) {
  const auto holds = [](double force) {
    Builder b = toe(false);
    b.spec.bodies[1].force.x -= force;
    return static_factor(b.made()).factor >= 1.3;
  };
  double low = 36, high = 37;
  for (int k = 0; k < 22; ++k) {
    const double middle = (low + high) / 2;
    (holds(middle) ? high : low) = middle;
  }
  EXPECT_NEAR(high, 36.643680, 2e-5);
}

TEST(Pairs, CriticalEarthquakeK5) {
  const auto holds = [](double push) {
    Builder b = toe(false);
    for (Contact& c : b.spec.contacts) c.friction = c.friction > 0 ? tan_deg(40) : 0;
    for (Body& body : b.spec.bodies) body.force.x = -push * body.force.z;
    return static_factor(b.made()).factor >= 1;
  };
  double low = 0.2, high = 0.22;
  for (int k = 0; k < 18; ++k) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  EXPECT_NEAR(low, 0.207124, 2e-6);
}

TEST(Pairs, SmallRoughBlockBelowALargeOneK6) {
  Builder b{Freedom::translation};
  const std::uint32_t large = b.block({0, 0, -1000}, 1000), small = b.block({0, 0, -10}, 10);
  const Vec3 first = plane(40, 130), second = plane(60, 220);
  for (const Vec3 n : {first, second}) {
    b.contact(large, rock, n, tan_deg(25));
    b.contact(small, rock, n, tan_deg(45));
  }
  Vec3 down = normalized(cross(first, second));
  if (down.z > 0) down = -down;
  b.contact(small, large, down, tan_deg(30));
  const Assembly assembly = b.made();
  const StaticFactor up = static_factor(assembly);
  EXPECT_NEAR(up.factor, 0.986020, 2e-6);
  EXPECT_NEAR(moving_factor(assembly, up.factor).factor, 0.716370, 2e-6);
}

}  // namespace
}  // namespace cleave::assembly
