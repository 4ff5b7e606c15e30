#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.hpp"

// Joints that dilate: closed forms of a block on the slopes of a rough face (Patton 1966).
namespace cleave::dbem::dilation_test {
namespace {

using namespace scenes;

constexpr double phi = 35, psi = 12;

Laws rough(double slip, double friction = phi) {
  Laws laws = law(std::tan(radians(friction)));
  laws.otherwise.dilation = std::tan(radians(psi));
  laws.otherwise.dilation_slip = metres(slip);
  return laws;
}

/// A block of 2 x 1 m on a floor, pushed by a share of its weight.
std::vector<Body> pushed(double share) {
  std::vector<Body> bodies{fixed("floor", rectangle(-20, -1, 40, 1)), block("block", rectangle(0, 0, 2, 1))};
  bodies[1].forces.push_back({.at = {1, 0.5}, .force = {share * 2 * 2600 * g, 0}});
  return bodies;
}

TEST(DilationTest, APushedBlockRidesUpByTheDilationAngle) {
  for (const double sense : {1.0, -1.0}) {
    for (const double step : {1e-2, 2e-3}) {
      const double share = 1.2;
      World world = make(pushed(sense * share), rough(10), {.step = step});
      run(world, 0.8);
      const double p = radians(psi), base = std::tan(radians(phi - psi));
      // Along the slope: push, weight, friction of what is left of the angle.
      const double a = g * (share * std::cos(p) - std::sin(p) - base * (std::cos(p) + share * std::sin(p)));
      const double along = 0.5 * a * 0.64, tolerance = 3 * step * a * 0.8;
      EXPECT_NEAR(sense * world.displacement(1).x, along * std::cos(p), tolerance) << step;
      EXPECT_NEAR(world.displacement(1).y, std::tan(p) * std::abs(world.displacement(1).x), 1e-6) << step;
      const Energy& e = world.energy();
      EXPECT_NEAR(e.work, share * 2 * 2600 * g * std::abs(world.displacement(1).x), 1e-3 * step * e.work);
      EXPECT_NEAR(e.friction + e.kinetic + e.potential, e.work, 2e-2 * step / 1e-2 * e.work);
      EXPECT_GE(e.lost, -1e-9 * e.work);
      // Forces in the axes of the joint: it slides on at the whole friction.
      double n = 0, t = 0;
      for (const Contact& c : world.contacts()) {
        n += c.normal_force;
        t += std::abs(c.tangential_force);
        EXPECT_NEAR(c.normal.y, c.edge_body == 0 ? 1 : -1, 1e-9);
      }
      EXPECT_NEAR(t / n, std::tan(radians(phi)), 1e-6);
    }
  }
}

TEST(DilationTest, TheRiseEndsAtItsSlipAndTheBlockGoesOnAtTheWholeFriction) {
  World world = make(pushed(1.2), rough(0.1), {.step = 1e-3});
  run(world, 0.6);
  const double before = world.velocity(1).x, at = world.time();
  EXPECT_GT(world.displacement(1).x, 0.2);
  EXPECT_NEAR(world.displacement(1).y, 0.1 * std::tan(radians(psi)), 1e-6);
  run(world, 0.9);
  EXPECT_NEAR((world.velocity(1).x - before) / (world.time() - at), g * (1.2 - std::tan(radians(phi))), 1e-6);
  EXPECT_NEAR(world.displacement(1).y, 0.1 * std::tan(radians(psi)), 1e-6);
}

TEST(DilationTest, WhatIsPushedLessThanTheWholeFrictionStaysWhereItFits) {
  for (const double sense : {1.0, -1.0}) {
    World rests = make(pushed(sense * 0.99 * std::tan(radians(phi))), rough(0.1), {.step = 5e-3});
    run(rests, 0.5);
    EXPECT_LT(norm(rests.displacement(1)), 1e-8);
    World slides = make(pushed(sense * 1.01 * std::tan(radians(phi))), rough(0.1), {.step = 5e-3});
    run(slides, 0.5);
    EXPECT_GT(norm(slides.displacement(1)), 1e-3);
  }
}

// Less is left of the friction than the slope is steep: without the push the block slides back into its seat.
TEST(DilationTest, WithoutThePushItSlidesBackAndEnergyNeverGrows) {
  std::vector<Body> bodies = pushed(1);
  bodies[1].forces[0].factor = [](double t) { return t < 0.4 ? 1.0 : 0.0; };
  World world = make(bodies, rough(10, 20), {.step = 1e-3});
  run(world, 0.4);
  const double far = world.displacement(1).x;
  EXPECT_GT(far, 0.1);
  double energy = world.energy().total(), most = 0;
  const double first = energy;
  double highest = 0;
  while (world.time() < 3) {
    ASSERT_TRUE(world.step().has_value());
    most = std::max(most, world.energy().total() - energy);
    energy = world.energy().total();
    highest = std::max(highest, world.displacement(1).x);
  }
  EXPECT_LT(most, 1e-6 * first);
  EXPECT_GT(highest, far);
  EXPECT_LT(std::abs(world.displacement(1).x), 0.5 * highest);  // back, and past its seat up the other side perhaps
}

// Between plates that hold its height, on a joint with stiffness: the normal force grows by stiffness times rise.
TEST(DilationTest, HeldDownItsForceGrowsWithStiffnessTimesRise) {
  std::vector<Body> bodies{fixed("floor", rectangle(-20, -1, 40, 1)), block("block", rectangle(0, 0, 2, 1))};
  bodies[1].held = {true, true, true};
  bodies[1].held.y = false;
  bodies[1].velocity = {0.01, 0};
  bodies.push_back(fixed("roof", rectangle(-20, 1, 40, 1)));
  bodies[2].property = 1;
  Laws laws = rough(1);
  laws.otherwise.normal_stiffness = 1e8;
  JointLaw smooth;
  laws.pairs.push_back({0, 1, smooth});
  World world = make(bodies, laws, {.gravity = {0, 0}, .step = 1e-3});
  run(world, 0.5);
  double n = 0;
  for (const Contact& c : world.contacts()) n += c.edge_body == 0 || c.vertex_body == 0 ? c.normal_force : 0;
  const double slip = world.displacement(1).x;
  EXPECT_NEAR(slip, 5e-3, 1e-9);
  // The springs stand on the slope, pressed by the rise seen along its normal; friction pulls down what slides up.
  const double p = radians(psi), base = std::tan(radians(phi - psi));
  const double closed = 1e8 * 2 * slip * std::sin(p) * (std::cos(p) - base * std::sin(p));
  EXPECT_NEAR(n / closed, 1, 1e-3);
}

TEST(DilationTest, SaysWhatIsNoDilation) {
  EXPECT_FALSE(World::make(pushed(1), rough(0), {}).has_value());
  EXPECT_FALSE(World::make(pushed(1), rough(1, 10), {}).has_value());
}

}  // namespace
}  // namespace cleave::dbem::dilation_test
