#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "worlds.hpp"

/// Blocks on ground that moves.
namespace cleave::motion {
namespace {

using namespace worlds;

constexpr double g_earth = 9.81;  ///< m/s2

/// An acceleration for so long, from a time on.
GroundMotion rectangle(Vec3 acceleration, double duration, double from = 0) {
  return {.mean =
              [=](double a, double b) {
                const double acts = std::max(0.0, std::min(b, from + duration) - std::max(a, from));
                return (acts / (b - a)) * acceleration;
              },
          .peak = metres_per_second_squared(norm(acceleration)),
          .end = Time::from_si(from + duration)};
}
/// Half a wave of a sine, from a time on.
GroundMotion half_sine(Vec3 acceleration, double duration, double from = 0) {
  const double rate = std::numbers::pi / duration;
  return {.mean =
              [=](double a, double b) {
                const double begin = std::clamp(a - from, 0.0, duration), end = std::clamp(b - from, 0.0, duration);
                return ((std::cos(rate * begin) - std::cos(rate * end)) / (rate * (b - a))) * acceleration;
              },
          .peak = metres_per_second_squared(norm(acceleration)),
          .end = Time::from_si(from + duration)};
}
/// Turned about the vertical.
GroundMotion turned(GroundMotion ground, Turn by) {
  ground.mean = [mean = ground.mean, by](double a, double b) { return by * mean(a, b); };
  return ground;
}
/// A block on a plane through the origin.
World on_slope(double dip, double dip_direction, double friction, GroundMotion ground, double step = 0.005) {
  const Turn plane = slope(dip, dip_direction);
  return world({floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane))}, friction,
               {.step = step, .ground = std::move(ground)});
}

// Whatever does not come out finite is no step.
TEST(Ground, MotionThatIsNoNumberIsRefused) {
  GroundMotion ground = rectangle({1, 0, 0}, 1);
  ground.mean = [](double from, double) {
    return Vec3{from < 0.02 ? 1 : std::numeric_limits<double>::quiet_NaN(), 0, 0};
  };
  World w = on_slope(0, 0, 0.05, std::move(ground));
  while (w.time() < 0.0199) ASSERT_TRUE(w.step(0.005).has_value());
  const Vec3 reached = w.displacement(1);
  const auto failed = w.step(0.005);
  ASSERT_FALSE(failed.has_value());
  EXPECT_TRUE(describe(failed.error()).contains("is not finite"));
  EXPECT_EQ(w.displacement(1), reached);
}

TEST(Ground, ALevelBlockStaysUpToItsFrictionInAnyDirection) {
  const double mu = 0.3, time = 0.4;
  for (const Vec3 way : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0.6, -0.8, 0}}) {
    World stays = on_slope(0, 0, mu, rectangle(0.99 * mu * g_earth * way, 1));
    ASSERT_TRUE(run(stays, time));
    EXPECT_LT(norm(stays.displacement(1)), 1e-9);
    World slides = on_slope(0, 0, mu, rectangle(1.01 * mu * g_earth * way, 1));
    ASSERT_TRUE(run(slides, time));
    expect_near(slides.displacement(1), -0.01 * mu * g_earth * time * time / 2 * way, 1e-9);
  }
}

TEST(Ground, VerticalMotionWeighsOnFriction) {
  // Ground that drops takes weight off: friction ends at mu (g - drop).
  const double mu = 0.3, drop = 3;
  for (const double share : {0.99, 1.01}) {
    const double push = share * mu * (g_earth - drop);
    World w = on_slope(0, 0, mu, rectangle({push, 0, -drop}, 1));
    ASSERT_TRUE(run(w, 0.4));
    expect_near(w.displacement(1), {share > 1 ? -0.01 * mu * (g_earth - drop) * 0.08 : 0, 0, 0}, 1e-9);
  }
  // Ground that drops faster than a stone leaves the block behind.
  World falls = on_slope(0, 0, mu, rectangle({0, 0, -1.5 * g_earth}, 1));
  ASSERT_TRUE(run(falls, 0.2));
  expect_near(falls.displacement(1), {0, 0, 0.5 * g_earth * 0.02}, 1e-9);
}

// A wedge between steep rough walls: forces that lock it would hold it against any load, and it was held by friction
// before. Ground that drops faster than a stone leaves it behind all the same, as it does what was never pressed.
TEST(Ground, WhatStoodInAGrooveIsNotLockedThere) {
  const double t = std::tan(10 * degree), from = 0.3;
  const auto wall = [&](double side) {
    std::vector<std::pair<double, double>> outline{{-3, -1}, {-0.5 + t, -1}, {-0.5 - 2 * t, 2}, {-3, 2}};
    for (auto& [x, y] : outline) x *= side;
    if (side < 0) std::ranges::reverse(outline);
    BodySpec out = body(prism(outline, -1, 1));
    out.fixed = true;
    return out;
  };
  const auto wedge = body(prism({{-0.5, 0}, {0.5, 0}, {0.5 + t, 1}, {-0.5 - t, 1}}, -0.5, 0.5));
  World w = world({wall(1), wall(-1), wedge}, std::tan(30 * degree),
                  {.gravity = {0, -g_earth, 0}, .step = 0.01, .ground = rectangle({0, -2 * g_earth, 0}, 0.2, from)});
  ASSERT_TRUE(run(w, from));
  EXPECT_LT(norm(w.displacement(2)), 1e-9);
  ASSERT_TRUE(run(w, from + 0.2));
  expect_near(w.displacement(2), {0, g_earth * 0.02, 0}, 1e-6);
}

TEST(Ground, ASlopeGivesWayDownhillBeforeUphill) {
  const double dip = 20 * degree, phi = 25 * degree;
  const Vec3 down{std::sin(137 * degree), std::cos(137 * degree), 0};
  struct Way {
    double sign, threshold;
  };
  for (const Way& way : {Way{-1, g_earth * std::tan(phi - dip)}, Way{1, g_earth * std::tan(phi + dip)}}) {
    for (const double share : {0.99, 1.01}) {
      World w = on_slope(20, 137, std::tan(phi), rectangle(way.sign * share * way.threshold * down, 1));
      ASSERT_TRUE(run(w, 0.3));
      const double along = dot(w.displacement(1), down);
      if (share < 1) {
        EXPECT_LT(std::abs(along), 1e-9);
      } else {
        EXPECT_GT(-way.sign * along, 1e-5);
      }
    }
  }
}

TEST(Ground, NewmarkUnderARectangularPulse) {
  // Newmark (1965): slides as long as it is faster than friction lets it be.
  const double dip = 20 * degree, mu = std::tan(25 * degree), push = 4, time = 0.2;
  const Vec3 down{std::sin(222.5 * degree), std::cos(222.5 * degree), 0};
  const double slides =
      g_earth * std::sin(dip) + push * std::cos(dip) - mu * (g_earth * std::cos(dip) - push * std::sin(dip));
  const double brakes = g_earth * (mu * std::cos(dip) - std::sin(dip));
  const double path = slides * time * time / 2 * (1 + slides / brakes);
  World w = on_slope(20, 222.5, mu, rectangle(-push * down, time), 0.001);
  ASSERT_TRUE(run(w, time * (1 + slides / brakes) + 0.1));
  expect_near(w.displacement(1), path * downhill(20, 222.5), 1e-5);
  EXPECT_LT(norm(w.velocity(1)), 1e-9);
  // What the ground and the weight gave went into friction.
  const Energy& e = w.energy();
  EXPECT_NEAR(e.friction + e.lost, e.ground + e.start - e.potential, 1e-9);
  EXPECT_NEAR(e.ground, w.mass(1) * push * std::cos(dip) * slides * time * time / 2, 1e-9);
}

/// Of a level block under half a sine: how far it has slid when it stops, and when.
double slid_under_half_sine(double amplitude, double limit, double duration) {
  const double rate = std::numbers::pi / duration, start = std::asin(limit / amplitude) / rate;
  const auto speed = [&](double t) {
    const double in = std::min(t, duration);
    return amplitude / rate * (std::cos(rate * start) - std::cos(rate * in)) - limit * (t - start);
  };
  const auto path = [&](double t) {
    const double in = std::min(t, duration);
    const double wave = amplitude / rate * (std::cos(rate * start) * (in - start)) -
                        amplitude / (rate * rate) * (std::sin(rate * in) - std::sin(rate * start));
    const double after = t > duration ? amplitude / rate * (std::cos(rate * start) + 1) * (t - duration) : 0;
    return wave + after - limit * (t - start) * (t - start) / 2;
  };
  double low = duration / 2, high = 10 * duration;
  for (int k = 0; k < 100; ++k) {
    const double middle = (low + high) / 2;
    (speed(middle) > 0 ? low : high) = middle;
  }
  return path(low);
}

TEST(Ground, NewmarkUnderHalfASineConvergesWithTheStep) {
  const double mu = 0.2, amplitude = 5, duration = 0.31;
  const Vec3 way{0.6, 0.8, 0};
  const double exact = slid_under_half_sine(amplitude, mu * g_earth, duration);
  // How good one run is depends on where in a step the slip starts: the worst of several counts.
  std::vector<double> worst;
  for (const double step : {0.02, 0.01, 0.005, 0.0025}) {
    double& most = worst.emplace_back(0);
    for (const double late : {0.0, 0.2, 0.4, 0.6, 0.8}) {
      World w = on_slope(0, 0, mu, half_sine(amplitude * way, duration, late * step), step);
      ASSERT_TRUE(run(w, 1.2));
      const double slid = -dot(w.displacement(1), way);
      EXPECT_LT(norm(w.displacement(1) + slid * way), 1e-9);
      most = std::max(most, std::abs(slid / exact - 1));
    }
  }
  EXPECT_LT(worst[0], 0.01);
  EXPECT_LT(worst[3], 1.6e-4);  // 64 times less
  EXPECT_NEAR(std::log2(worst[0] / worst[3]) / 3, 2, 0.3) << worst[0] << " " << worst[1] << " " << worst[2];
}

TEST(Ground, ATurnedSceneGivesTheTurnedAnswer) {
  const Turn by = turn_by({0, 0, 0.7});
  const GroundMotion ground = half_sine({3, -4, 2}, 0.4);
  std::vector<Vec3> path;
  for (const bool turn : {false, true}) {
    const Turn plane = (turn ? by : Turn{}) * slope(15, 60);
    World w = world({floor(plane), body(moved(block(1, 2, 1), plane * Vec3{0, 0, 0.5}, plane))}, 0.3,
                    {.step = 0.005, .ground = turn ? turned(ground, by) : ground});
    ASSERT_TRUE(run(w, 0.6));
    path.push_back(turn ? by.back(w.displacement(1)) : w.displacement(1));
  }
  EXPECT_GT(norm(path[0]), 0.05);
  expect_near(path[0], path[1], 1e-7);
}

TEST(Ground, ASlenderBlockLiftsFromWidthOverHeightOn) {
  for (const double share : {0.99, 1.01}) {
    World w = world({floor(), body(moved(block(0.5, 1, 2), {0, 0, 1}))}, 2,
                    {.step = 0.005, .ground = rectangle({share * g_earth / 4, 0, 0}, 1)});
    ASSERT_TRUE(run(w, 0.3));
    if (share < 1) {
      EXPECT_LT(norm(w.spin(1)), 1e-9);
    } else {
      EXPECT_LT(w.spin(1).y, -1e-3);
    }
  }
}

TEST(Ground, ARectangularPulseOverturnsASlenderBlock) {
  // Housner (1963): k = a / (g alpha) overturns after p t = ln(k / (k - 1)); p^2 = 3 g / (4 R); small angles.
  const double alpha = std::atan(0.1), half = 0.5 * std::hypot(0.2, 2);
  const double p = std::sqrt(0.75 * g_earth / half);
  for (const double k : {1.5, 2.5}) {
    const double time = std::log(k / (k - 1)) / p;
    for (const double share : {0.98, 1.02}) {
      World w = world({floor(), body(moved(block(0.2, 1, 2), {0, 0, 1}))}, 2,
                      {.step = 0.001, .ground = rectangle({k * std::tan(alpha) * g_earth, 0, 0}, share * time)});
      double most = 0;
      for (int n = 0; n < 3000 && most < 1.2 * alpha; ++n) {
        ASSERT_TRUE(w.step());
        most = std::max(most, angle_of(w.turn(1)));
        if (most > 0.5 * alpha && angle_of(w.turn(1)) < 0.5 * most) break;
      }
      EXPECT_EQ(most > alpha * 1.1, share > 1) << k << " " << share << " " << most;
      EXPECT_LT(w.energy().closing_error, 1e-9);
    }
  }
}

TEST(Ground, NothingSleepsWhileTheGroundMayMove) {
  World w = on_slope(0, 0, 0.3, rectangle({6, 0, 0}, 0.2, 0.5), 0.01);
  ASSERT_TRUE(run(w, 0.5));
  EXPECT_FALSE(w.asleep(1));
  EXPECT_LT(norm(w.displacement(1)), 1e-9);
  ASSERT_TRUE(run(w, 0.7));
  EXPECT_GT(norm(w.velocity(1)), 0.5);
  ASSERT_TRUE(run(w, 1.4));
  EXPECT_TRUE(w.asleep(1));
  const double slides = 6 - 0.3 * g_earth, path = slides * 0.02 * (1 + slides / (0.3 * g_earth));
  expect_near(w.displacement(1), {-path, 0, 0}, 1e-3);
}

TEST(Ground, GoesOnFromASavedStateToTheLastBit) {
  const auto make = [](double push) { return on_slope(15, 60, 0.3, half_sine({push, -4, 2}, 0.4)); };
  World whole = make(3);
  ASSERT_TRUE(run(whole, 0.13));
  const std::string saved = whole.saved();
  ASSERT_TRUE(run(whole, 0.5));
  World later = make(3);
  ASSERT_TRUE(later.restore(saved));
  ASSERT_TRUE(run(later, 0.5));
  EXPECT_EQ(whole.saved(), later.saved());
  EXPECT_GT(whole.energy().ground, 0);
  // Another ground is another world, even where it shakes as strongly.
  for (const double push : {4.0, -3.0}) {
    const auto taken = make(push).restore(saved);
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error(), SavedFault::other_world);
  }
}

TEST(Ground, RefusesWhatMeansNothing) {
  const auto refused = [](WorldOptions options) { return !World::make({.bodies = {body(block(1, 1, 1))}}, options); };
  EXPECT_FALSE(refused({.ground = rectangle({1, 0, 0}, 1)}));
  EXPECT_TRUE(refused({.quasi_static = true, .ground = rectangle({1, 0, 0}, 1)}));
  GroundMotion endless = rectangle({1, 0, 0}, 1);
  endless.peak = metres_per_second_squared(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(refused({.ground = endless}));
}

}  // namespace
}  // namespace cleave::motion
