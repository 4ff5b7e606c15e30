#include "cleave/assembly/groups.hpp"

#include <gtest/gtest.h>

#include "cases.hpp"
#include "chains.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

TEST(MotionCertificates, SlabBehindToeK1) {
  const Assembly assembly = toe(false).made();
  const Projection below = project(assembly, 0.95);
  const auto proof = check_motion(assembly, 0.95, below.motion, 3e6);
  ASSERT_TRUE(proof.has_value());
  EXPECT_GT(proof->driving(), 100 * proof->charge());
  // 1.1e-5 above the limit.
  EXPECT_TRUE(check_motion(assembly, 0.9428, project(assembly, 0.9428).motion, 3e3).has_value());
  EXPECT_LT(project(assembly, 0.9427).largest, 1e-10);
}

// What proves motion at one strength must not prove it where the assembly is known to hold.
TEST(MotionCertificates, AreRefusedBelowTheLimit) {
  const Assembly assembly = toe(false).made();
  const Motion motion = project(assembly, 0.95).motion;
  const auto refused = check_motion(assembly, 0.9427, motion, 1e3);
  ASSERT_FALSE(refused.has_value());
  EXPECT_GT(refused.error().charge, refused.error().driving);
  Motion still(2);
  EXPECT_FALSE(check_motion(assembly, 0.95, still).has_value());
  EXPECT_FALSE(check_motion(assembly, 0.95, Motion(1)).has_value());
  Motion back = motion;
  for (Rate& r : back) r.velocity = -r.velocity;
  EXPECT_FALSE(check_motion(assembly, 0.95, back).has_value());
  Motion slab_alone = motion;
  slab_alone[1] = {};
  EXPECT_FALSE(check_motion(assembly, 0.95, slab_alone).has_value());
}

TEST(MotionCertificates, ChargeCohesionAndTension) {
  Builder b = single({{plane(35, 90), tan_deg(30)}});
  EXPECT_TRUE(check_motion(b.made(), 1, project(b.made(), 1).motion).has_value());
  const Motion slide = project(b.made(), 1).motion;
  b.spec.contacts[0].bonds = {{.corners = {}, .cohesion = 1}};
  EXPECT_FALSE(check_motion(b.made(), 1, slide).has_value());
  Builder roof = single({{{0, 0, -1}, 0}});
  const Motion fall = project(roof.made(), 1).motion;
  EXPECT_TRUE(check_motion(roof.made(), 1, fall).has_value());
  roof.spec.contacts[0].bonds = {{.corners = {}, .cohesion = 0, .tension = 1.01}};
  EXPECT_FALSE(check_motion(roof.made(), 1, fall).has_value());
}

TEST(MotionCertificates, AtTheLimitOfEveryCase) {
  struct Case {
    Assembly assembly;
    double up;
  };
  const std::vector<Case> cases{{toe_section().made(), 0.917061},
                                {active_passive().made(), 0.933277},
                                {ploughing(e1).made(), 1.214805},
                                {ploughing(e3).made(), 0.998805},
                                {circle(Freedom::section).made(), 1.489006}};
  for (const Case& c : cases) {
    const double f = c.up * (1 + 1e-4);
    EXPECT_TRUE(check_motion(c.assembly, f, project(c.assembly, f).motion).has_value()) << c.up;
    EXPECT_FALSE(check_motion(c.assembly, c.up * (1 - 1e-4), project(c.assembly, f).motion).has_value()) << c.up;
  }
}

TEST(RestCertificates, HoldAtAnyFriction) {
  const Assembly floor = single({{plane(60, 0), 0}, {plane(60, 120), 0}, {plane(60, 240), 0}}).made();
  EXPECT_TRUE(check_rest(floor, infinite, holding_forces(floor, infinite, 1e-3)).has_value());
  // A notch holds a block in its section, not along it.
  const Builder notch = single({{{sin_deg(60), 0, cos_deg(60)}, 0}, {{-sin_deg(60), 0, cos_deg(60)}, 0}});
  EXPECT_FALSE(check_rest(notch.made(), infinite, holding_forces(notch.made(), infinite, 1e-3)).has_value());
  const Assembly flat_notch = notch.made().with(Freedom::section_translation);
  EXPECT_TRUE(check_rest(flat_notch, infinite, holding_forces(flat_notch, infinite, 1e-3)).has_value());
  // Level: nothing drives it and nothing but friction holds it.
  const Assembly level = level_stack().made();
  EXPECT_FALSE(check_rest(level, infinite, holding_forces(level, infinite, 1e-3)).has_value());
  // Held by friction alone.
  const Assembly slope = single({{plane(25, 90), tan_deg(30)}}).made();
  EXPECT_FALSE(check_rest(slope, infinite, holding_forces(slope, infinite, 1e-3)).has_value());
  EXPECT_TRUE(check_rest(slope, 1, holding_forces(slope, 1.0)).has_value());
  EXPECT_TRUE(check_rest(slope, 1.2381, holding_forces(slope, 1.2381)).has_value());
  EXPECT_FALSE(check_rest(slope, 1.239, holding_forces(slope, 1.239)).has_value());
}

TEST(RestCertificates, RefuseForcesThatLackBalance) {
  const Assembly floor = single({{plane(60, 0), 0}, {plane(60, 120), 0}, {plane(60, 240), 0}}).made();
  ContactForces forces = holding_forces(floor, infinite, 1e-3);
  for (auto& at : forces.at_points) at[0] = 0.1 * at[0];
  EXPECT_FALSE(check_rest(floor, infinite, forces).has_value());
  forces.at_points.pop_back();
  EXPECT_FALSE(check_rest(floor, infinite, forces).has_value());
}

// The unique projection (K2, K3).
TEST(Projections, BoundTheAccelerationK2) {
  const Assembly assembly = toe(false).made();
  const Projection p = project(assembly, 1);
  const double least = std::hypot(p.speed[0], p.speed[1]) * std::sqrt(312.0);
  EXPECT_NEAR(least, 0.522163721, 1e-6);
  const Start start = start_from_rest(assembly, 1);
  ASSERT_EQ(start.found, FromRest::moves);
  EXPECT_NEAR(std::hypot(start.speed[0], start.speed[1]) * std::sqrt(312.0), 0.617903823, 1e-6);
  EXPECT_NEAR(start.motion[0].velocity.x, 0.0280914, 1e-6);
  EXPECT_NEAR(start.motion[1].velocity.x, 0.0280914, 1e-6);
  EXPECT_NEAR(start.motion[0].velocity.z, -0.0196698, 1e-6);
  EXPECT_LT(start.residual, 1e-6);
}

TEST(Projections, LeaveOutWhatHoldsK3) {
  Builder b = toe(false);
  const std::uint32_t third = b.block({0, 0, -50}, 50);
  b.contact(third, rock, {sin_deg(20), 0, cos_deg(20)}, tan_deg(30));
  const Projection p = project(b.made(), 1);
  EXPECT_LT(p.speed[2], 1e-11);
  EXPECT_GT(p.speed[0], 1e-3);
}

}  // namespace
}  // namespace cleave::assembly
