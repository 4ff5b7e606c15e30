#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

/// A block slides down 30 degrees under its weight and a push along the slope that swings with time.
double swung(double step, bool adaptive = false, std::optional<double> longest = {}) {
  const double up = radians(30), mu = std::tan(radians(10));
  const Vec2 down{-std::cos(up), -std::sin(up)};
  std::vector<Body> bodies = slider(up);
  const double mass = 2600 * 0.5, push = 0.2 * mass * g, omega = 8;
  // At the height of the base: the pressure stays on both corners.
  bodies[1].forces.push_back({bodies[1].outline[0], push * down, [=](double t) { return std::cos(omega * t); }, false});
  auto world =
      World::make(bodies, law(mu), {.step = step, .longest_step = longest, .adaptive = adaptive, .displacement = 1});
  EXPECT_TRUE(world.has_value()) << describe(world.error());
  run(*world, 0.8);
  const double exact =
      0.5 * g * (std::sin(up) - std::cos(up) * mu) * 0.64 + push / mass / (omega * omega) * (1 - std::cos(omega * 0.8));
  return std::abs(norm(world->displacement(1)) - exact);
}

TEST(StepOrderTest, TheErrorFallsWithTheSquareOfTheStep) {
  const double coarse = swung(0.04), middle = swung(0.02), fine = swung(0.01);
  EXPECT_GT(fine, 1e-8);
  EXPECT_NEAR(coarse / middle, 4, 0.3);
  EXPECT_NEAR(middle / fine, 4, 0.3);
}

/// Way of a block on a floor that shakes harmonically, at times 0.01 s apart: integrated on its own in short steps,
/// parted where slip turns round.
std::vector<double> shaken_exactly(double amplitude, double frequency, double mu, double duration) {
  constexpr double h = 2e-6;
  const double omega = 2 * std::numbers::pi * frequency;
  std::vector<double> out;
  double way = 0, speed = 0;
  const auto steps = std::lround(duration / h);
  for (long k = 0; k < steps; ++k) {
    if (k % 5000 == 0) out.push_back(way);
    const double drive = -amplitude * std::sin(omega * (static_cast<double>(k) + 0.5) * h);
    const double from_rest = std::abs(drive) > mu * g ? drive - std::copysign(mu * g, drive) : 0;
    double pull = speed != 0 ? drive - std::copysign(mu * g, speed) : from_rest, left = h;
    if (speed != 0 && (speed + h * pull) * speed < 0) {  // it turns round, or stops
      const double until = -speed / pull;
      way += 0.5 * until * speed;
      left = h - until;
      speed = 0;
      pull = from_rest;
    }
    way += left * (speed + 0.5 * left * pull);
    speed += left * pull;
  }
  out.push_back(way);
  return out;
}

struct Shaken {
  double error = 0;  ///< largest at any of those times, over the largest way
  std::size_t ends = 0, steps = 0;
};
Shaken shaken(double step, double amplitude, double frequency, double mu) {
  const double omega = 2 * std::numbers::pi * frequency;
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)), block("block", rectangle(0, 0, 1, 0.1))};
  WorldOptions options;
  options.step = step;
  options.displacement = 1;
  options.ground = [=](double t) { return Vec2{amplitude * std::sin(omega * t), 0}; };
  options.ground_mean = [=](double from, double to) {
    return Vec2{amplitude * (std::cos(omega * from) - std::cos(omega * to)) / (omega * (to - from)), 0};
  };
  World world = World::make(bodies, law(mu), options).value();
  const std::vector<double> exact = shaken_exactly(amplitude, frequency, mu, 1);
  Shaken out;
  double size = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const double until = 0.01 * static_cast<double>(k);
    while (world.time() < until - 1e-12) {
      const auto report = world.step(until - world.time());
      EXPECT_TRUE(report.has_value());
      if (!report) return out;
      out.ends += report->slip_ends > 0 ? 1U : 0U;
      ++out.steps;
    }
    size = std::max(size, std::abs(exact[k]));
    out.error = std::max(out.error, std::abs(world.displacement(1).x - exact[k]));
  }
  out.error /= size;
  return out;
}

// Slip that stops, and slip that turns round at once, each twice a period: in steps that end with it.
TEST(StepOrderTest, SlipThatTurnsRoundIsFollowedWithTheSquareOfTheStep) {
  for (const auto& [amplitude, mu] : {std::pair{8.0, 0.2}, {8.0, 0.6}, {3.0, 0.2}}) {
    const Shaken coarse = shaken(4e-3, amplitude, 5, mu), middle = shaken(2e-3, amplitude, 5, mu),
                 fine = shaken(5e-4, amplitude, 5, mu);
    EXPECT_LT(coarse.error, 1e-2) << amplitude << ' ' << mu;
    EXPECT_LT(middle.error, 1.5e-3) << amplitude << ' ' << mu;
    EXPECT_LT(fine.error, 1.5e-4) << amplitude << ' ' << mu;
    EXPECT_LT(12 * fine.error, coarse.error) << amplitude << ' ' << mu;  // an eighth of the step: 64, of first order 8
    RecordProperty(fmt::format("error_{}_{}", amplitude, mu),
                   fmt::format("{:.2e} {:.2e} {:.2e}", coarse.error, middle.error, fine.error));
    // Ten half periods, an end in each, and a step more for it.
    EXPECT_GE(fine.ends, 9U);
    EXPECT_LE(fine.steps, 2000U + 2 * fine.ends);
  }
}

// A force at a corner that turns with its body turns it ever faster: the angle is exact, the path (Fresnel's integrals)
// of second order.
TEST(StepOrderTest, AFollowingForceTurnsAtHalfTheStep) {
  const auto path = [](double step) {
    Body body;
    body.name = "thruster";
    body.outline = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    body.density = 2600;
    body.forces.push_back({.at = {0.5, -0.5}, .force = {0, 2600}, .follows = true});
    WorldOptions options;
    options.gravity = {};
    options.step = step;
    options.displacement = 1;
    auto world = World::make({body}, {}, options).value();
    while (world.time() < 1 - 1e-9) EXPECT_TRUE(world.step().has_value());
    EXPECT_NEAR(world.rotation(0), 1.5, 1e-9);  // moment 1,300, inertia 2,600 / 6
    return world.displacement(0);
  };
  // Velocity is the integral of (-sin, cos)(1.5 t^2), the path that of (1 - t) times it.
  Vec2 exact;
  constexpr int slices = 2000;
  for (int k = 0; k < slices; ++k) {
    const double t = (k + 0.5) / slices;
    exact += (1 - t) / slices * Vec2{-std::sin(1.5 * t * t), std::cos(1.5 * t * t)};
  }
  const double coarse = norm(path(0.01) - exact), fine = norm(path(0.005) - exact);
  EXPECT_LT(coarse, 2e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.3);
}

TEST(AdaptiveTest, StepsGrowWhileLittleMovesUpToTheLongest) {
  auto world = World::make(stack(4), law(0.6), {.step = 1e-3, .longest_step = 1e-2, .adaptive = true, .sleep = false});
  ASSERT_TRUE(world.has_value());
  double before = 0, longest = 0;
  std::size_t steps = 0;
  while (world->time() < 0.3) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value());
    EXPECT_LE(report->step, 1.5 * std::max(before, 1e-3) * (1 + 1e-12));
    longest = std::max(longest, report->step);
    before = report->step;
    ++steps;
  }
  EXPECT_DOUBLE_EQ(longest, 1e-2);
  EXPECT_LT(steps, 75U);  // 300 of the first step
}

TEST(AdaptiveTest, WithoutItOrWithoutALongerStepNothingGrows) {
  for (const bool adaptive : {false, true}) {
    auto world = World::make(
        stack(2), law(0.6),
        {.step = 1e-3, .longest_step = adaptive ? std::nullopt : std::optional{1e-2}, .adaptive = adaptive});
    ASSERT_TRUE(world.has_value());
    for (int k = 0; k < 30; ++k) EXPECT_DOUBLE_EQ(world->step()->step, 1e-3);
  }
}

TEST(AdaptiveTest, LargeMovesCutTheStepAndItStaysCut) {
  // 10 m/s may move 0.05 of the height of 20 m in a step: 0.1 s at most.
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)), block("b", rectangle(0, 18, 1, 1))};
  bodies[1].velocity = {0, 10};
  auto world = World::make(bodies, law(0.6), {.gravity = {}, .step = 0.5, .longest_step = 1, .adaptive = true});
  ASSERT_TRUE(world.has_value());
  for (int k = 0; k < 10; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value());
    EXPECT_LE(report->step * 10, 0.05 * 20 * (1 + 1e-9)) << k;
    EXPECT_GE(report->step * 10, 0.3 * 0.05 * 20) << k;
    EXPECT_EQ(report->cuts, 0U);  // not counted as failures
  }
}

TEST(AdaptiveTest, AnAdaptiveSliderKeepsToTheClosedForm) { EXPECT_LT(swung(2e-3, true, 1e-2), 1e-4); }

TEST(ErrorTargetTest, TheStepFollowsTheErrorAskedFor) {
  double last = 1;
  for (const double target : {1e-5, 1e-7}) {
    const double up = radians(30);
    std::vector<Body> bodies = slider(up);
    const double push = 0.2 * 2600 * 0.5 * g;
    bodies[1].forces.push_back({bodies[1].outline[0], push * Vec2{-std::cos(up), -std::sin(up)},
                                [](double t) { return std::cos(8 * t); }, false});
    auto world = World::make(bodies, law(0.1), {.step = 0.04, .displacement = 1, .position_error = target});
    ASSERT_TRUE(world.has_value());
    double shortest = 1;
    while (world->time() < 0.4) {
      const auto report = world->step(0.4 - world->time() + 1e-12);
      ASSERT_TRUE(report.has_value());
      if (world->time() < 0.4 - 1e-9) shortest = std::min(shortest, report->step);
    }
    EXPECT_LT(shortest, 0.7 * last);
    last = shortest;
  }
}

}  // namespace
}  // namespace cleave::dbem
