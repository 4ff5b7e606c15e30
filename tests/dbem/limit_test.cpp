#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "cleave/core/rng.hpp"
#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

double fastest(const World& world) {
  double most = 0;
  for (std::size_t b = 0; b < world.size(); ++b) most = std::max(most, norm(world.velocity(b)));
  return most;
}

/// Whether anything still moves after `time` seconds.
bool falls(std::vector<Body> bodies, Laws laws, double step, double time) {
  auto world = World::make(std::move(bodies), std::move(laws), {.step = step});
  EXPECT_TRUE(world.has_value()) << describe(world.error());
  run(*world, time);
  return fastest(*world) > 1e-5;
}

TEST(ArchTest, CriticalThicknessIsThatOfLimitAnalysis) {
  const std::map<std::size_t, double> table{{7, 0.096245}, {12, 0.105098}, {21, 0.106790}};
  for (const auto& [count, critical] : table) {
    double low = 0.9 * critical, high = 1.1 * critical;
    ASSERT_TRUE(falls(arch(count, low), law(2), 5e-3, 0.2));
    ASSERT_FALSE(falls(arch(count, high), law(2), 5e-3, 0.2));
    for (int k = 0; k < 7; ++k) {
      const double middle = 0.5 * (low + high);
      (falls(arch(count, middle), law(2), 5e-3, 0.2) ? low : high) = middle;
    }
    std::printf("N=%zu critical %g table %g\n", count, 0.5 * (low + high), critical);
    EXPECT_NEAR(0.5 * (low + high) / critical, 1, 0.005) << count;
  }
}

/// Goodman and Bray (1976), 16 blocks on a stepped base; the first body is the base, then the toe first.
std::vector<Body> toppling_slope() {
  const std::vector<double> heights{4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4};
  std::vector<Vec2> base{{-40, -20}, {200, -20}, {200, 16}};
  for (int n = 15; n >= 1; --n) {
    base.push_back({10.0 * n, n + 1.0});
    base.push_back({10.0 * n, 1.0 * n});
  }
  base.push_back({-40, 1});
  std::vector<Body> bodies{fixed("base", turned(base, radians(30)))};
  for (int n = 1; n <= 16; ++n) {
    const double height = heights[static_cast<std::size_t>(n - 1)];
    bodies.push_back(
        block(fmt::format("{}", n), turned(rectangle(10.0 * (n - 1), n, 10, height), radians(30)), 25000 / g));
  }
  return bodies;
}

TEST(TopplingTest, LimitingFrictionIsThatOfGoodmanAndBray) {
  const auto moves = [](double phi) { return falls(toppling_slope(), law(std::tan(radians(phi))), 1e-2, 1.0); };
  double low = 36, high = 40;
  EXPECT_TRUE(moves(low));
  EXPECT_FALSE(moves(high));
  for (int k = 0; k < 7; ++k) {
    const double middle = 0.5 * (low + high);
    (moves(middle) ? low : high) = middle;
  }
  std::printf("limiting friction %g\n", 0.5 * (low + high));
  EXPECT_NEAR(0.5 * (low + high), 38.151, 0.1);
}

TEST(StackTest, TwoHundredAndMassRatiosStand) {
  for (const auto& [count, ratio] : {std::pair{200, 1.0}, std::pair{50, 1e3}, std::pair{8, 1e6}}) {
    auto world = World::make(stack(static_cast<std::size_t>(count), ratio), law(0.6), {.step = 5e-3});
    ASSERT_TRUE(world.has_value());
    for (int k = 0; k < 10; ++k) {
      const auto report = world->step();
      ASSERT_TRUE(report.has_value()) << count << ' ' << ratio << describe(report.error());
      EXPECT_LT(report->max_speed, 1e-6) << count << ' ' << ratio;
    }
    double base = 0;
    for (const Contact& c : world->contacts()) {
      if (c.vertex_body == 0 || c.edge_body == 0) base += c.normal_force;
    }
    EXPECT_NEAR(base / ((count - 1 + ratio) * 2600 * g), 1, 1e-7) << count << ' ' << ratio;
  }
}

TEST(RestTest, TinyGapsAndNearlyParallelFacesComeToRest) {
  for (const double gap : {0.0, 1e-9}) {
    for (const double turn : {0.0, 1e-10, 1e-8, 1e-6}) {
      std::vector<Body> bodies = stack(1);
      bodies[1].outline = turned(bodies[1].outline, turn);
      for (Vec2& c : bodies[1].outline) c.y += gap + 0.5 * turn;
      auto world = World::make(bodies, law(0.6), {.step = 2e-3});
      ASSERT_TRUE(world.has_value()) << describe(world.error());
      run(*world, 0.1);
      EXPECT_LT(fastest(*world), 1e-6) << gap << ' ' << turn;
    }
  }
}

TEST(RestTest, ABlockRestsInANotch) {
  const std::vector<Vec2> ell{{-1, -1}, {4, -1}, {4, 0}, {0, 0}, {0, 3}, {-1, 3}};
  for (const double friction : {0.0, 0.3}) {
    std::vector<Body> bodies{fixed("notch", turned(ell, radians(-20))),
                             block("b", turned(rectangle(0, 0, 1, 1), radians(-20))),
                             block("c", turned(rectangle(1, 0, 1.5, 0.7), radians(-20)))};
    // Leaning to the right: nothing holds them but the wall on the left when turned the other way.
    for (Body& body : bodies) body.outline = turned(body.outline, radians(40));
    auto world = World::make(bodies, law(friction), {.step = 2e-3});
    ASSERT_TRUE(world.has_value()) << describe(world.error());
    run(*world, 0.2);
    EXPECT_LT(fastest(*world), 1e-8) << friction;
    EXPECT_LT(norm(world->displacement(1)), 1e-9);
    double carried = 0;
    for (const Contact& c : world->contacts()) {
      const double side = c.edge_body == 0 ? 1.0 : c.vertex_body == 0 ? -1.0 : 0.0;
      carried += side * (c.normal_force * c.normal.y + c.tangential_force * c.normal.x);
    }
    EXPECT_NEAR(carried / ((1 + 1.05) * 2600 * g), 1, 1e-8);
  }
}

TEST(WedgeTest, AJammedWedgeCarriesItsWeightAsStaticsSays) {
  // A wedge of half angle 10 degrees between two planes, without friction: 2 N sin(10) = W.
  const double s = std::sin(radians(10)), c = std::cos(radians(10)), t = s / c;
  std::vector<Body> bodies{fixed("left", {{-3, 0}, {-0.5, 0}, {-0.5 - 4 * t, 4}, {-3, 4}}),
                           fixed("right", {{0.5, 0}, {3, 0}, {3, 4}, {0.5 + 4 * t, 4}}),
                           block("wedge", {{-0.5 - t, 1}, {0.5 + t, 1}, {0.5 + 2 * t, 2}, {-0.5 - 2 * t, 2}})};
  auto world = World::make(bodies, law(0), {.step = 2e-3});
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  run(*world, 0.05);
  double normal = 0;
  for (const Contact& k : world->contacts()) normal += k.normal_force;
  EXPECT_NEAR(normal * s / (world->mass(2) * g), 1, 1e-8);
  EXPECT_LT(fastest(*world), 1e-8);
}

TEST(DeterminismTest, TheSameRunTwiceIsTheSame) {
  const auto once = [] {
    auto world = World::make(arch(12, 0.1), law(0.8), {.step = 5e-3});
    run(*world, 0.3);
    return world->outline(6);
  };
  EXPECT_EQ(once(), once());
}

TEST(WorldTest, ACopyGoesTheSameWay) {
  auto world = World::make(arch(12, 0.1), law(0.8), {.step = 5e-3});
  ASSERT_TRUE(world.has_value());
  run(*world, 0.2);
  World saved = *world;
  run(*world, 0.4);
  run(saved, 0.4);
  EXPECT_EQ(world->outline(6), saved.outline(6));
}

TEST(WorldTest, SaysWhatIsWrongWithAScene) {
  const auto error = [](std::vector<Body> bodies, Laws laws = {}, WorldOptions options = {}) {
    const auto world = World::make(std::move(bodies), std::move(laws), std::move(options));
    return world ? std::string{"none"} : describe(world.error());
  };
  std::vector<Body> bodies = stack(1);
  EXPECT_EQ(error(bodies), "none");
  bodies[1].density = 0;
  EXPECT_EQ(error(bodies), "body 'b0' can move but has no mass: give a density, or mass and inertia, or fix it");
  bodies = stack(1);
  bodies[1].origin = {0, -0.25};
  EXPECT_EQ(error(bodies), "bodies 'floor' and 'b0' overlap at the start: 0.25 m deep at (0, 0)");
  bodies = stack(1);
  std::ranges::reverse(bodies[1].outline);
  EXPECT_EQ(error(bodies), "body 'b0': outline: corners run clockwise; state them counter-clockwise");
  bodies = stack(1);
  bodies[1].outline.resize(2);
  EXPECT_NE(error(bodies), "none");
  Laws laws;
  laws.otherwise.friction = -1;
  EXPECT_EQ(error(stack(1), laws), "joint law: friction -1 is not at least 0");
  EXPECT_EQ(error(stack(1), {}, {.step = 0}), "contact option: step 0 s is not positive");
  bodies = stack(1);
  bodies[1].modes = ModalBasis{.omega = {10}, .shapes = {1, 2}};
  EXPECT_EQ(error(bodies), "body 'b0': elastic shapes: 2 numbers instead of 2 x 4 corners x 1 modes");
}

TEST(WorldTest, UnsupportedBlocksFallFreely) {
  auto world =
      World::make({block("b", rectangle(0, 0, 1, 1)), block("c", rectangle(3, 0, 1, 2))}, law(0.5), {.step = 1e-2});
  ASSERT_TRUE(world.has_value());
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step(1e-2).has_value());
  EXPECT_NEAR(world->displacement(1).y, -0.5 * g * world->time() * world->time(), 1e-13);
}

TEST(WorldTest, AStepThatDoesNotConvergeIsRefusedAndChangesNothing) {
  WorldOptions options{.step = 5e-3};
  options.solver.accept = -1;  // nothing is good enough
  auto world = World::make(slider(radians(30)), law(0.2), options);
  ASSERT_TRUE(world.has_value());
  const std::vector<Vec2> before = world->outline(1);
  const auto report = world->step();
  ASSERT_FALSE(report.has_value());
  const StepFailed& failed = std::get<StepFailed>(report.error());
  EXPECT_NEAR(failed.step, 5e-3 / 729, 1e-12);  // six cuts to a third
  EXPECT_EQ(failed.reason, "the contact law was not met");
  EXPECT_EQ(world->outline(1), before);
  EXPECT_EQ(world->time(), 0);
  EXPECT_EQ(world->velocity(1), (Vec2{}));
}

TEST(WorldTest, ABeltDragsABlockAndItsWorkIsAccountedFor) {
  std::vector<Body> bodies = stack(1);
  bodies[0].velocity = {0.5, 0};  // a fixed body that moves on
  auto world = World::make(bodies, law(0.3), {.step = 1e-3});
  ASSERT_TRUE(world.has_value());
  run(*world, 0.1);
  EXPECT_NEAR(world->velocity(1).x, 0.3 * g * 0.1, 1e-8);
  run(*world, 0.5);
  EXPECT_NEAR(world->velocity(1).x, 0.5, 1e-8);
  const Energy& e = world->energy();
  EXPECT_NEAR(e.kinetic, 0.5 * 2600 * 0.25, 1e-4);
  EXPECT_NEAR(e.work, 2600 * 0.25, 1e-3 * 2600 * 0.25);  // twice the kinetic energy: half is lost in slip
  EXPECT_NEAR(e.friction, 0.5 * 2600 * 0.25, 2e-3 * 2600 * 0.25);
}

TEST(WorldTest, AHeldFreedomStaysHeld) {
  // On rails: a block on a slope that may not turn or move sideways falls straight down beside it.
  std::vector<Body> bodies{block("b", rectangle(0, 0, 1, 1)), fixed("f", rectangle(-5, -3, 10, 1))};
  bodies[0].held = {.x = true, .spin = true};
  bodies[0].forces.push_back({.at = {0, 1}, .force = {1e5, 0}});
  auto world = World::make(bodies, law(0.3), {.step = 1e-3});
  ASSERT_TRUE(world.has_value());
  run(*world, 0.2);
  EXPECT_EQ(world->displacement(0).x, 0);
  EXPECT_EQ(world->rotation(0), 0);
  EXPECT_NEAR(world->displacement(0).y, -0.5 * g * 0.04, 1e-12);
}

TEST(WorldTest, StepsFollowTheErrorAskedFor) {
  // A free block under F cos(w t): x = F / (m w^2) (1 - cos w t).
  const double w = 20, force = 1e5;
  double error_before = 1;
  std::size_t steps_before = 0;
  for (const double wanted : {1e-5, 1e-7}) {
    std::vector<Body> bodies{block("b", rectangle(0, 0, 1, 1))};
    bodies[0].forces.push_back(
        {.at = {0.5, 0.5}, .force = {force, 0}, .factor = [w](double t) { return std::cos(w * t); }});
    auto world =
        World::make(bodies, {}, {.gravity = {0, 0}, .step = 0.05, .displacement = 10, .position_error = wanted});
    ASSERT_TRUE(world.has_value());
    std::size_t steps = 0;
    while (world->time() < 1) {
      ASSERT_TRUE(world->step(1 - world->time()).has_value());
      ++steps;
      ASSERT_LT(steps, 100000U);
      if (1 - world->time() < 1e-12) break;
    }
    const double exact = force / (2600 * w * w) * (1 - std::cos(w));
    const double error = std::abs(world->displacement(0).x - exact);
    std::printf("error asked %g: %zu steps, error %g\n", wanted, steps, error);
    EXPECT_LT(error, 0.2 * error_before);
    EXPECT_GT(steps, 2 * steps_before);
    error_before = error;
    steps_before = steps;
  }
}

}  // namespace
}  // namespace cleave::dbem
