#include <gtest/gtest.h>

#include <utility>

#include "scenes.hpp"

// Water in joints: closed forms of effective stress.
namespace cleave::dbem::water_test {
namespace {

using namespace scenes;

/// Acceleration of a block of 1 x 0.5 m down a slope of 30 degrees under water of so much of its weight's pressure.
double moved(double friction, double share, double until, double angle = 30, double held_by = 0) {
  Laws laws = law(std::tan(radians(friction)));
  laws.otherwise.water_pressure = pascals(share * 0.5 * 2600 * g * std::cos(radians(angle)));
  laws.otherwise.cohesion = held_by;
  World world = World::make(slider(radians(angle)), laws, {.step = 2e-3}).value();
  run(world, until);
  return norm(world.displacement(1));
}

TEST(WaterTest, ABlockOnASlopeSlidesByItsEffectiveWeight) {
  for (const double share : {0.2, 0.5, 0.9}) {
    const double a = g * (0.5 - (1 - share) * std::cos(radians(30)) * std::tan(radians(25)));
    EXPECT_NEAR(moved(25, share, 0.5), 0.125 * a, 1e-8) << share;
  }
  // Dry it stays at 40 degrees of friction; under u it slides where (1 - u) tan 40 is less than tan 30.
  const double limit = 1 - std::tan(radians(30)) / std::tan(radians(40));
  EXPECT_LT(moved(40, limit - 0.005, 0.5), 1e-9);
  EXPECT_GT(moved(40, limit + 0.005, 0.5), 1e-3);
}

TEST(WaterTest, MoreThanItsWeightLiftsABlock) {
  Laws laws = law(0.5);
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)), block("block", rectangle(0, 0, 2, 1))};
  laws.otherwise.water_pressure = pascals(1.5 * 2600 * g);
  World world = World::make(bodies, laws, {.step = 2e-3}).value();
  run(world, 0.3);
  EXPECT_NEAR(world.displacement(1).y, 0.5 * 0.5 * g * 0.09, 1e-9);
  EXPECT_NEAR(world.rotation(1), 0, 1e-9);
}

// Two free bodies are pushed apart: no momentum comes of it.
TEST(WaterTest, PushesBothFacesAlike) {
  Laws laws = law(0.5);
  laws.otherwise.water_pressure = pascals(1e4);
  World world = World::make({block("a", rectangle(0, 0, 1, 2)), block("b", rectangle(1, 0.5, 2, 1))}, laws,
                            {.gravity = {0, 0}, .step = 1e-3})
                    .value();
  run(world, 0.1);
  EXPECT_NEAR(norm(world.momentum()), 0, 1e-9);
  EXPECT_NEAR(world.angular_momentum(), 0, 1e-9);
  EXPECT_NEAR(world.velocity(0).x * world.mass(0), -1e4 * 1 * 0.1, 1e-6);
}

/// A wall 3 m high on a floor, with still water up to `table` between it and a rock face.
World wall_before_water(double width, double friction, double table) {
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)), block("wall", rectangle(0, 0, width, 3)),
                           fixed("rock", rectangle(-2, 0, 2, 3))};
  bodies[2].property = 1;
  Laws laws = law(friction);
  JointLaw behind;
  behind.water_table = metres(table);
  laws.pairs.push_back({0, 1, behind});
  return World::make(bodies, laws, {.step = 2e-3}).value();
}

// A wall of 1 x 3 m against a rock face with still water behind: tips about its toe where the water's moment
// rho g h^3 / 6 is more than the weight's, and what the floor carries below that is the weight.
TEST(WaterTest, StillWaterBehindAWallTipsItAtItsLimit) {
  const double weight = 3 * 2600 * g, limit = std::cbrt(6 * weight * 0.5 / 9810);
  ASSERT_LT(limit, 3);
  for (const double table : {limit * 0.99, limit * 1.01, 2.9}) {
    World world = wall_before_water(1, 2, table);
    run(world, 0.3);
    if (table < limit) {
      EXPECT_LT(std::abs(world.rotation(1)), 1e-8) << table;
    } else {
      EXPECT_LT(world.rotation(1), -1e-4) << table;
    }
  }
  // A frictionless floor holds nothing of the resultant: a triangle below the table, a trapezium where it is higher.
  for (const auto& [table, push] : {std::pair{1.0, 0.5 * 1 * 1}, std::pair{5.0, 0.5 * (5 + 2) * 3}}) {
    World world = wall_before_water(4, 0, table);
    run(world, 0.1);
    EXPECT_NEAR(world.velocity(1).x * world.mass(1), 9810 * push * 0.1, 1e-3) << table;
  }
}

}  // namespace
}  // namespace cleave::dbem::water_test
