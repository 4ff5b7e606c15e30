#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "worlds.hpp"

/// Bolts and cables between bodies: what they carry, how they yield, when they break.
namespace cleave::motion {
namespace {

using namespace worlds;

constexpr double g = 9.81;

/// Walls far above, which ties hang from.
BodySpec roof() { return {.shape = box({-20, -20, 4}, {20, 20, 5}), .fixed = true}; }

World tied(std::vector<BodySpec> bodies, std::vector<Tie> ties, double friction = 0, WorldOptions options = {}) {
  auto made = World::make(
      {.bodies = std::move(bodies), .surfaces = {{friction, 0}}, .bonds = {}, .ties = std::move(ties)}, options);
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}

Tie tie(Vec3 end, Vec3 other_end, double capacity, double ductility = 0) {
  return {0, 1, end, other_end, newtons(capacity), metres(ductility)};
}

/// Displacement of the first body after some time.
double moved_after(World world, double time) {
  EXPECT_TRUE(run(world, time));
  return norm(world.displacement(0)) + angle_of(world.turn(0));
}

// A cube of weight g.
TEST(Ties, CarryAWeightUpToTheirCapacity) {
  const auto hung = [](double capacity) {
    return tied({body(block(1, 1, 1)), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, capacity)});
  };
  World holds = hung(1.001 * g);
  ASSERT_TRUE(run(holds, 0.3));
  EXPECT_NEAR(holds.tie(0).force.si(), g, 1e-8);
  EXPECT_EQ(holds.tie(0).lengthened.si(), 0);
  EXPECT_LT(norm(holds.displacement(0)), 1e-9);
  // What gives is gone after its first step: the rest is free fall.
  World falls = hung(0.999 * g);
  ASSERT_TRUE(run(falls, 0.3));
  EXPECT_TRUE(falls.tie(0).broken);
  EXPECT_NEAR(falls.velocity(0).z, -g * 0.3 + 0.999 * g * 0.01, 1e-9);
}

TEST(Ties, YieldAtTheirCapacityAndBreakAtTheirDuctility) {
  const double ductility = 0.05, capacity = 0.8 * g;
  World world =
      tied({body(block(1, 1, 1)), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, capacity, ductility)}, 0, {.step = 0.001});
  // 0.2 g down to there, then g.
  const double there = std::sqrt(2 * ductility / (0.2 * g));
  ASSERT_TRUE(run(world, there - 0.002));
  EXPECT_FALSE(world.tie(0).broken);
  EXPECT_NEAR(world.velocity(0).z, -0.2 * g * world.time(), 1e-9);
  EXPECT_NEAR(world.tie(0).lengthened.si(), -world.displacement(0).z, 1e-6 + 0.001 * 0.2 * g * world.time());
  ASSERT_TRUE(run(world, there + 0.05));
  EXPECT_TRUE(world.tie(0).broken);
  EXPECT_NEAR(world.energy().lost, capacity * ductility, 0.01 * capacity * ductility);
}

// A yielding tie that the load leaves stays as long as it is, and pulls again from there.
TEST(Ties, StopWhatTheyAreStrongEnoughFor) {
  World world =
      tied({body(block(1, 1, 1), {0, 0, -1}), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, 3 * g, 1)}, 0, {.step = 0.002});
  ASSERT_TRUE(run(world, 0.5));
  // Slowed by 2 g from 1 m/s: 1 / (2 * 2 g) further down, then at rest.
  EXPECT_NEAR(-world.displacement(0).z, 1 / (4 * g), 2e-3);
  EXPECT_LT(norm(world.velocity(0)), 1e-7);
  EXPECT_NEAR(world.tie(0).force.si(), g, 1e-6);
  EXPECT_FALSE(world.tie(0).broken);
}

// Three ties in one line share 1.2 times the weight whatever rigid bodies leave open: limit analysis.
TEST(Ties, ShareWhatTheirCapacitiesAllow) {
  const auto beam = [](double each) {
    std::vector<Tie> ties;
    for (const double x : {-1.0, 0.0, 1.0}) ties.push_back(tie({x, 0, 0.5}, {x, 0, 4}, each));
    return tied({body(block(3, 1, 1)), roof()}, std::move(ties));
  };
  EXPECT_LT(moved_after(beam(1.001 * g), 0.1), 1e-8);  // weight 3 g
  EXPECT_GT(moved_after(beam(0.999 * g), 0.1), 1e-3);
}

// Two ties 2 m apart, the centroid 0.5 m from one: three quarters and one quarter.
TEST(Ties, TurnWhatHangsOffTheMiddle) {
  const auto beam = [](double far, double near) {
    return tied({body(block(1, 1, 1)), roof()},
                {tie({-1.5, 0, 0.5}, {-1.5, 0, 4}, far), tie({0.5, 0, 0.5}, {0.5, 0, 4}, near)});
  };
  EXPECT_LT(moved_after(beam(0.2501 * g, 0.7501 * g), 0.1), 1e-8);
  EXPECT_GT(moved_after(beam(0.2501 * g, 0.7480 * g), 0.1), 1e-5);
  EXPECT_GT(moved_after(beam(0.2480 * g, 0.7501 * g), 0.1), 1e-5);
}

// On a slope of 45 degrees, friction 30: T = W (sin b - cos b tan f) / (cos d + sin d tan f), d from the slope down.
TEST(Ties, HoldABlockOnASlopeAtAnyAngle) {
  constexpr double dip = 45, friction = 30;
  const Turn turn = slope(dip, 0);
  for (const double d : {0.0, 20.0, 50.0}) {
    const double weight = 0.5 * g, f = std::tan(friction * degree);
    const double need = weight * (std::sin(dip * degree) - std::cos(dip * degree) * f) /
                        (std::cos(d * degree) + std::sin(d * degree) * f);
    for (const double share : {0.99, 1.01}) {
      // From the centroid, so that nothing turns, up the slope and into it by d.
      const Vec3 middle = turn * Vec3{0, 0, 0.25};
      const Vec3 along = turn * Vec3{0, -std::cos(d * degree), -std::sin(d * degree)};
      World world = tied({body(moved(block(1, 1, 0.5), middle, turn)), floor(turn)},
                         {tie(middle, middle + 30.0 * along, share * need)}, f);
      EXPECT_EQ(moved_after(std::move(world), 0.2) > 1e-4, share < 1) << d << " " << share;
    }
  }
}

// A pendulum keeps its length and its books; slack ties carry nothing.
TEST(Ties, SwingAndGoSlack) {
  World swings = tied({body(block(0.2, 0.2, 0.2)), roof()}, {tie({0, 0, 0}, {2, 0, 4}, 1e3)});
  double longest = 0;
  while (swings.time() < 0.6 - 1e-9) {
    ASSERT_TRUE(swings.step(0.6 - swings.time()).has_value());
    longest = std::max(longest, norm(swings.centroid(0) - Vec3{2, 0, 4}) - std::sqrt(20));
  }
  EXPECT_LT(longest, 1e-8);
  EXPECT_LT(swings.energy().closing_error, 1e-10);
  EXPECT_LT(swings.momentum_error(), 1e-10);
  EXPECT_FALSE(swings.tie(0).broken);
  World thrown = tied({body(block(1, 1, 1), {0, 0, 1}), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, 1e3)});
  ASSERT_TRUE(run(thrown, 0.1));
  EXPECT_EQ(thrown.tie(0).force.si(), 0);
  EXPECT_NEAR(thrown.velocity(0).z, 1 - 0.1 * g, 1e-12);
}

// What sleeps is drawn along by what is hit at the other end of its tie, 3 m away.
TEST(Ties, WakeWhatHangsOnThem) {
  World world = tied({body(moved(block(1, 1, 1), {0, 0, 0.5})), body(moved(block(1, 1, 1), {4, 0, 0.5})),
                      body(moved(block(0.5, 0.5, 0.5), {2.5, 0, 0.5}), {4, 0, 0}), floor()},
                     {tie({0, 0, 0.5}, {4, 0, 0.5}, 1e3)}, 0.01, {.gravity = {0, 0, -9.81}});
  bool slept = false;
  while (world.time() < 0.6 - 1e-9) {
    ASSERT_TRUE(world.step().has_value());
    slept = slept || world.asleep(0);
  }
  EXPECT_TRUE(slept);
  EXPECT_GT(world.displacement(0).x, 1e-3);
  EXPECT_LT(world.centroid(1).x - world.centroid(0).x, 4 + 1e-8);
}

// What is cut holds nothing any more, and wakes what hung on it.
TEST(Ties, AreCut) {
  World world = tied({body(block(1, 1, 1)), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, 2 * g)});
  ASSERT_TRUE(run(world, 0.3));
  EXPECT_TRUE(world.asleep(0));
  world.cut(0);
  EXPECT_TRUE(world.tie(0).broken);
  EXPECT_EQ(world.tie(0).force.si(), 0);
  ASSERT_TRUE(run(world, 0.5));
  EXPECT_NEAR(world.velocity(0).z, -g * 0.2, 1e-9);
}

// A slab that lies over an edge, held down by what hangs on its other end: when that comes off it tips.
TEST(Ties, WakeWhatTheyHeldDown) {
  std::vector<BodySpec> bodies{body(box({-1, -0.5, 0}, {2, 0.5, 0.3})),
                               body(moved(block(0.5, 0.5, 0.5), {-0.9, 0, -3})),
                               {.shape = box({-0.95, -20, -1}, {0, 20, 0}), .fixed = true}};
  bodies[1].density = kilograms_per_cubic_metre(20);
  const double hangs = 2.5 * g;
  World world = tied(std::move(bodies), {{0, 1, {-0.9, 0, 0}, {-0.9, 0, -2.75}, newtons(0.99 * hangs), metres(0.02)}},
                     0.6, {.step = 0.01});
  // The slab of 0.9 g would turn about the edge at 0: 0.5 m times 0.9 against 0.9 m times 2.475. It lies still while
  // the tie yields.
  bool held = true;
  while (world.time() < 2 - 1e-9) {
    ASSERT_TRUE(world.step(2 - world.time()).has_value());
    if (!world.tie(0).broken) held = held && angle_of(world.turn(0)) < 1e-6;
  }
  EXPECT_TRUE(held);
  EXPECT_TRUE(world.tie(0).broken);
  EXPECT_GT(angle_of(world.turn(0)), 0.1);
}

// A tie that gives is never drawn back: beside a body a million times heavier its capacity is far below what an
// accepted answer may be off by.
TEST(Ties, GiveBesideWhatIsFarHeavier) {
  std::vector<BodySpec> bodies{body(moved(block(1, 1, 1), {0, 0, 0.5})), roof(), floor()};
  bodies[0].density = kilograms_per_cubic_metre(1e6);
  // A light cube lies on it at a slope too steep for friction, on a tie of half of what it takes.
  const double light = 1e-2;
  bodies.push_back(body(moved(block(0.2, 0.2, 0.2), {0, 0, 3})));
  bodies.back().density = kilograms_per_cubic_metre(light);
  const double weight = 0.008 * light * g;
  World world = tied(std::move(bodies),
                     {{3, 1, {0, 0, 3}, {0, 0, 4}, newtons(0.5 * weight), metres(10)},
                      {3, 0, {0, 0, 2.9}, {0, 0, 1}, newtons(1e-9), metres(10)}},
                     0.5, {.step = 0.01, .solver = {.accept = 1e-5}});
  ASSERT_TRUE(run(world, 0.5));
  EXPECT_NEAR(world.velocity(3).z, -0.5 * g * 0.5, 1e-3);
  EXPECT_NEAR(world.tie(0).lengthened.si(), -world.displacement(3).z, 1e-6);
  EXPECT_LT(std::abs(world.energy().projected), 1e-9 * weight);
}

// A tie that was slack and is drawn tight lengthens by what is beyond its length alone.
TEST(Ties, LengthenByWhatIsBeyondTheirLength) {
  World world =
      tied({body(block(1, 1, 1), {0, 0, 1}), roof()}, {tie({0, 0, 0.5}, {0, 0, 4}, 0.5 * g, 10)}, 0, {.step = 0.01});
  // Up and down again: there after 2 / g s, then down at 0.5 g from 1 m/s.
  ASSERT_TRUE(run(world, 0.4));
  EXPECT_NEAR(world.tie(0).lengthened.si(), -world.displacement(0).z, 1e-9);
  const double t = 0.4 - 2 / g;
  EXPECT_NEAR(-world.displacement(0).z, t + 0.25 * g * t * t, 0.02);
}

TEST(Ties, GoOnFromBytes) {
  const auto make = [] {
    return tied({body(block(1, 1, 1)), roof()},
                {tie({0.1, 0, 0.5}, {0.1, 0, 4}, 0.5 * g, 0.02), tie({-0.1, 0, 0.5}, {-0.1, 0, 4}, 0.4 * g, 1)});
  };
  World whole = make();
  ASSERT_TRUE(run(whole, 0.1));
  const std::string half = whole.saved();
  World again = make();
  ASSERT_TRUE(again.restore(half).has_value());
  EXPECT_GT(again.tie(0).lengthened.si(), 0);
  ASSERT_TRUE(run(whole, 0.5));
  ASSERT_TRUE(run(again, 0.5));
  EXPECT_TRUE(whole.tie(0).broken);
  EXPECT_EQ(whole.saved(), again.saved());
}

TEST(Ties, WhatIsNoTieIsRefused) {
  const auto refused = [](Tie tie) {
    const auto made = World::make({.bodies = {body(block(1, 1, 1)), roof()}, .ties = {tie}}, {});
    return made ? std::string{} : describe(made.error());
  };
  EXPECT_EQ(refused({0, 0, {}, {0, 0, 4}, newtons(1)}), "a tie has no two bodies");
  EXPECT_EQ(refused(tie({}, {}, 1)), "a tie has no length");
  EXPECT_EQ(refused(tie({}, {0, 0, 4}, -1)), "a capacity or ductility of a tie is negative");
  EXPECT_EQ(refused(tie({}, {0, 0, NAN}, 1)), "an end of a tie is not finite");
  EXPECT_EQ(refused(tie({}, {0, 0, 4}, 1)), "");
}

}  // namespace
}  // namespace cleave::motion
