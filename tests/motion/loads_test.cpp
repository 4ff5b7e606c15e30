#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "worlds.hpp"

/// Forces beside weight: loads at points, pressure in joints until they drain, water about all bodies.
namespace cleave::motion {
namespace {

using namespace worlds;

constexpr double g = 9.81;

World loaded(std::vector<BodySpec> bodies, std::vector<Load> loads, double friction = 0, WorldOptions options = {}) {
  auto made =
      World::make({.bodies = std::move(bodies), .surfaces = {{friction, 0}}, .loads = std::move(loads)}, options);
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}
World wet(std::vector<BodySpec> bodies, const StillWater& water, WorldOptions options = {}) {
  auto made = World::make({.bodies = std::move(bodies), .water = water}, options);
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}
Load load(std::uint32_t body, std::optional<std::uint32_t> other, Vec3 at, Vec3 force) {
  return {.body = body, .other = other, .at = at, .force = force};
}

/// A block of mass 1 on a plane, the second body, with a load on it or in the joint of both.
World on_slope(Turn plane, double friction, Load own, double step = 0.01) {
  return loaded({floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane))}, {std::move(own)},
                friction, {.step = step});
}

TEST(Loads, PushAFreeBodyAsNewtonSays) {
  const Vec3 force{0.3, -0.2, 0.5}, at{0.4, 0.1, -0.3};
  World w = loaded({body(block(1, 1, 1))}, {load(0, std::nullopt, at, force)}, 0, {.gravity = {}, .step = 0.01});
  ASSERT_TRUE(w.step().has_value());
  expect_near(w.angular_momentum(), 0.01 * cross(at, force), 1e-15);
  ASSERT_TRUE(run(w, 0.5));
  expect_near(w.velocity(0), 0.5 * force, 1e-12);
  EXPECT_NEAR(w.energy().loads, w.energy().kinetic, 1e-12);
  EXPECT_GT(w.energy().loads, 0.5 * dot(w.velocity(0), w.velocity(0)));
}

// The same force through the centroid turns nothing; on the way of the point it would do other work.
TEST(Loads, KeepTheirDirectionOnOneBody) {
  World w = loaded({body(block(1, 1, 1), {}, {0, 0, 2})}, {load(0, std::nullopt, {}, {1, 0, 0})}, 0, {.gravity = {}});
  ASSERT_TRUE(run(w, 1));
  expect_near(w.velocity(0), {1, 0, 0}, 1e-12);
  expect_near(w.spin(0), {0, 0, 2}, 1e-12);
}

// Uplift in the joint below a block: it slides by g sin - mu (g cos - U / m), and stands where that is less than none.
TEST(Loads, UpliftInTheBaseOfABlock) {
  const Turn plane = slope(30, 222.5);
  const Vec3 normal = plane * Vec3{0, 0, 1};
  const double mu = 0.8, across = g * std::cos(30 * degree), along = g * std::sin(30 * degree);
  const double limit = across - along / mu;  // U / m at which it begins to slide
  ASSERT_GT(limit, 0);
  for (const double share : {0.5, 0.999}) {
    World stands = on_slope(plane, mu, load(1, 0, {}, share * limit * normal));
    ASSERT_TRUE(run(stands, 0.3));
    EXPECT_LT(norm(stands.displacement(1)), 1e-9) << share;
  }
  for (const double share : {1.001, 1.2, 1.6}) {
    World slides = on_slope(plane, mu, load(1, 0, {}, share * limit * normal));
    ASSERT_TRUE(run(slides, 0.3));
    const double faster = along - mu * (across - share * limit);
    expect_near(slides.velocity(1), 0.3 * faster * downhill(30, 222.5), 1e-9);
  }
  // Named the other way round it is the same.
  World turned = on_slope(plane, mu, load(0, 1, {}, -1.2 * limit * normal));
  ASSERT_TRUE(run(turned, 0.3));
  expect_near(turned.velocity(1), 0.3 * (along - mu * (across - 1.2 * limit)) * downhill(30, 222.5), 1e-9);
}

// A level push at the top of a cube turns it over its edge from half its weight on.
TEST(Loads, TurnABlockOverItsEdge) {
  const auto pushed = [](double share) {
    World w = loaded({floor(), body(box({-0.5, -0.5, 0}, {0.5, 0.5, 1}))},
                     {load(1, std::nullopt, {-0.5, 0, 1}, {share * 0.5 * g, 0, 0})}, 1);
    EXPECT_TRUE(run(w, 0.3));
    return angle_of(w.turn(1));
  };
  EXPECT_LT(pushed(0.999), 1e-9);
  EXPECT_GT(pushed(1.001), 1e-5);
  EXPECT_GT(pushed(1.5), 0.05);
}

// What presses two bodies apart gives them no momentum and no angular momentum, and all the energy that they have.
TEST(Loads, BetweenTwoBodiesAddNoMomentum) {
  const double opens = 0.05, force = 2;
  World w = loaded({body(box({-1, -0.5, -0.5}, {0, 0.5, 0.5})), body(box({0, -0.7, -0.4}, {2, 0.3, 0.6}))},
                   {{.body = 0, .other = 1, .at = {0, 0.1, 0.2}, .force = {-force, 0, 0}, .opens = metres(opens)}}, 0,
                   {.gravity = {}, .step = 0.001});
  ASSERT_TRUE(run(w, 0.1));
  EXPECT_FALSE(w.load_gone(0));
  ASSERT_TRUE(run(w, 0.5));
  EXPECT_TRUE(w.load_gone(0));
  EXPECT_LT(norm(w.momentum()), 1e-12);
  EXPECT_LT(norm(w.angular_momentum()), 1e-12);
  EXPECT_NEAR(w.energy().kinetic, w.energy().loads, 1e-12);
  EXPECT_NEAR(w.energy().loads, force * opens, 0.01 * force * opens);
}

// By either rule of the step a load works along the way that its body goes in it: no step gains energy, and all of it
// is known.
TEST(Loads, WorkAlongTheWayOfEachStep) {
  for (const double theta : {0.5, 1.0}) {
    const WorldOptions options{.step = 0.02, .theta = theta};
    const Vec3 force{1, -2, 2 * g};
    World free = loaded({body(block(1, 1, 1))}, {load(0, std::nullopt, {}, force)}, 0, options);
    ASSERT_TRUE(run(free, 0.3));
    EXPECT_NEAR(free.energy().loads, dot(force, free.displacement(0)), 1e-12) << theta;
    EXPECT_LT(free.energy().largest_gain, 1e-12) << theta;
    // Pushed off the floor at a corner, so that it turns: it leaves its contacts one after the other.
    World lifted = loaded({floor(), body(box({-0.5, -0.5, 0}, {0.5, 0.5, 1}))},
                          {load(1, std::nullopt, {0.5, 0.4, 0}, {0, 0, 1.5 * g})}, 0.3, options);
    ASSERT_TRUE(run(lifted, 0.3));
    EXPECT_GT(angle_of(lifted.turn(1)), 0.1);
    EXPECT_LT(lifted.energy().largest_gain, 1e-9 * lifted.energy().loads) << theta;
  }
}

// Water holds no joint up that has opened, or slid apart.
TEST(Loads, EndWhereTheJointHasOpenedOrSlidAway) {
  const Turn plane = slope(30, 100);
  const double mu = 0.5, across = g * std::cos(30 * degree), along = g * std::sin(30 * degree), uplift = 4, way = 0.3;
  Load own = load(1, 0, {}, uplift * (plane * Vec3{0, 0, 1}));
  own.slides = metres(way);
  World w = on_slope(plane, mu, own, 0.001);
  const double first = along - mu * (across - uplift), then = along - mu * across;
  const double at = std::sqrt(2 * way / first);
  ASSERT_TRUE(run(w, at - 0.002));
  EXPECT_FALSE(w.load_gone(0));
  ASSERT_TRUE(run(w, at + 0.4));
  EXPECT_TRUE(w.load_gone(0));
  EXPECT_NEAR(norm(w.velocity(1)), first * at + 0.4 * then, 0.002 * first);
  // Pushed off the floor: gone once it is up by more than `opens`.
  Load up = load(1, 0, {}, {0, 0, 2 * g});
  up.opens = metres(0.02);
  World flies = on_slope({}, mu, up, 0.001);
  ASSERT_TRUE(run(flies, 0.02));
  EXPECT_FALSE(flies.load_gone(0));
  ASSERT_TRUE(run(flies, 0.1));
  EXPECT_TRUE(flies.load_gone(0));
  EXPECT_NEAR(flies.velocity(1).z, std::sqrt(2 * g * 0.02) - g * (0.1 - std::sqrt(2 * 0.02 / g)), 0.03);
}

// A block that sleeps, pressed to its slope by the load of another one, moves once that has gone.
TEST(Loads, WhatTheyHeldWakesAsTheyEnd) {
  const Turn plane = slope(30, 0);
  Load own = load(1, 2, plane * Vec3{0, 0, 0.5}, -20.0 * (plane * Vec3{0, 0, 1}));
  own.opens = own.slides = metres(0.1);
  World w = loaded({floor(plane),
                    body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane)),
                    {.shape = moved(block(1, 1, 1), {0, 0, 30}), .fixed = true}},
                   {own}, 0.4);
  ASSERT_TRUE(run(w, 0.5));
  ASSERT_TRUE(w.asleep(1));
  w.set_fixed(2, false);
  ASSERT_TRUE(run(w, 1));
  EXPECT_TRUE(w.load_gone(0));
  EXPECT_GT(dot(w.velocity(1), downhill(30, 0)), 0.1);
}

TEST(Loads, TurnWithTheSceneAndDoNotHangOnTheOrder) {
  const auto end = [](Turn by, bool swapped) {
    const Turn plane = by * slope(35, 20);
    std::vector<Load> loads{load(1, 0, by * Vec3{0.2, 0.1, 0}, plane * Vec3{0, 0, 3}),
                            load(1, std::nullopt, by * Vec3{-0.3, 0.4, 0.1}, by * Vec3{1, -2, 0.5})};
    if (swapped) std::swap(loads[0], loads[1]);
    World w = loaded({floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane))}, std::move(loads),
                     0.3, {.gravity = by * Vec3{0, 0, -g}, .step = 0.005});
    EXPECT_TRUE(run(w, 0.3));
    return std::pair{by.back(w.displacement(1)), w.energy().loads};
  };
  const auto [way, work] = end({}, false);
  EXPECT_GT(norm(way), 0.05);
  // Four points share the pressure under one face in more ways than one.
  const auto [turned, same_work] = end(turn_by({0.3, -1.1, 0.7}), false);
  expect_near(turned, way, 1e-6);
  EXPECT_NEAR(same_work, work, 1e-5);
  expect_near(end({}, true).first, way, 1e-9);
}

// ---- water about all bodies

/// An L with a notch: several cells.
Polyhedron notched() { return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 0, 1); }

TEST(StillWater, LiftsBySubmergedVolume) {
  const double unit_weight = 4;
  for (const Polyhedron& shape : {block(1, 1, 1), notched(), moved(notched(), {3, 1, 0.4}, turn_by({0.5, 1, -0.3}))}) {
    World w = wet({body(shape)}, {.level = metres(50), .unit_weight = newtons_per_cubic_metre(unit_weight)});
    ASSERT_TRUE(run(w, 0.5));
    expect_near(w.velocity(0), {0, 0, -0.5 * (g - unit_weight)}, 1e-11);
    EXPECT_LT(norm(w.spin(0)), 1e-11);
    World dry = wet({body(shape)}, {.level = metres(-9), .unit_weight = newtons_per_cubic_metre(unit_weight)});
    ASSERT_TRUE(run(dry, 0.1));
    expect_near(dry.velocity(0), {0, 0, -0.1 * g}, 1e-12);
    EXPECT_EQ(dry.energy().loads, 0);
  }
}

// Archimedes' cube: at rest where it displaces its weight, it swings by sqrt(w A / m) about that, to order 2.
TEST(StillWater, AFloatingCubeSwings) {
  const double unit_weight = 2 * g, amplitude = 0.05, rate = std::sqrt(unit_weight);
  const auto after_a_turn = [&](double step) {
    World w = wet({body(box({-0.5, -0.5, -0.5 - amplitude}, {0.5, 0.5, 0.5 - amplitude}))},
                  {.level = metres(0), .unit_weight = newtons_per_cubic_metre(unit_weight)}, {.step = step});
    EXPECT_TRUE(run(w, 0.3));
    EXPECT_LT(norm(w.spin(0)), 1e-9);
    return std::abs(w.displacement(0).z - amplitude * (1 - std::cos(0.3 * rate)));
  };
  const double coarse = after_a_turn(0.01), fine = after_a_turn(0.005);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

// A bar that lies half under water lies stably, one that stands does not: the moment of lift rights it, or turns it.
TEST(StillWater, RightsWhatLies) {
  const auto turned_after = [](Polyhedron shape) {
    World w = wet({body(moved(std::move(shape), {}, turn_by({0, 0.02, 0})))},
                  {.level = metres(0), .unit_weight = newtons_per_cubic_metre(2 * g)}, {.step = 0.005});
    EXPECT_TRUE(run(w, 0.5));
    // Of its axis about y, from where it would lie straight.
    return 0.02 + 2 * std::asin(w.turn(0).y);
  };
  EXPECT_LT(turned_after(block(4, 1, 0.5)), 0.015);
  EXPECT_GT(turned_after(block(0.5, 1, 4)), 0.03);
}

TEST(StillWater, IsMeasuredAlongItsOwnVertical) {
  const Turn by = turn_by({0.4, 0.2, 1});
  World w = wet({body(moved(block(1, 1, 1), by * Vec3{0, 0, -3}, by))},
                {.level = metres(0), .up = by * Vec3{0, 0, 1}, .unit_weight = newtons_per_cubic_metre(4)},
                {.gravity = by * Vec3{0, 0, -g}});
  ASSERT_TRUE(run(w, 0.2));
  expect_near(by.back(w.velocity(0)), {0, 0, -0.2 * (g - 4)}, 1e-12);
}

TEST(Loads, WhatIsNoLoadIsRefused) {
  const auto refused = [](Load own) {
    return !World::make(
                {.bodies = {body(block(1, 1, 1)), body(moved(block(1, 1, 1), {3, 0, 0}))}, .loads = {std::move(own)}},
                {})
                .has_value();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refused(load(0, 1, {}, {1, 0, 0})));
  EXPECT_TRUE(refused(load(2, std::nullopt, {}, {1, 0, 0})));
  EXPECT_TRUE(refused(load(0, 2, {}, {1, 0, 0})));
  EXPECT_TRUE(refused(load(0, 0, {}, {1, 0, 0})));
  EXPECT_TRUE(refused(load(0, 1, {}, {})));
  EXPECT_TRUE(refused(load(0, 1, {}, {nan, 0, 0})));
  EXPECT_TRUE(refused(load(0, 1, {nan, 0, 0}, {1, 0, 0})));
  Load ended = load(0, 1, {}, {1, 0, 0});
  ended.opens = metres(0);
  EXPECT_TRUE(refused(ended));
  const auto no_water = [](StillWater water) {
    return !World::make({.bodies = {body(block(1, 1, 1))}, .water = water}, {}).has_value();
  };
  EXPECT_FALSE(no_water({}));
  EXPECT_TRUE(no_water({.level = metres(nan)}));
  EXPECT_TRUE(no_water({.up = {0, 0, 2}}));
  EXPECT_TRUE(no_water({.unit_weight = newtons_per_cubic_metre(-1)}));
}

}  // namespace
}  // namespace cleave::motion
