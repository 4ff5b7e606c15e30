#include <gtest/gtest.h>

#include <array>

#include "scenes.hpp"

namespace cleave::dbem::motion_test {
namespace {

using namespace scenes;

double slid(double phi) { return phi >= 30 ? 0.0 : g * (0.5 - std::cos(radians(30)) * std::tan(radians(phi))); }

TEST(SliderTest, SlidesAsTheClosedForm) {
  for (const double phi : {0.0, 5.0, 10.0, 15.0, 20.0, 25.0}) {
    World world = make(slider(radians(30)), law(std::tan(radians(phi))), {.step = 5e-3});
    run(world, 0.9);
    const double exact = slid(phi) * 0.405;
    EXPECT_NEAR(norm(world.displacement(1)), exact, 1e-9 * exact) << phi;
    EXPECT_NEAR(world.rotation(1), 0, 1e-10);
  }
}

TEST(SliderTest, AnyStepGivesTheSame) {
  for (const double step : {1e-1, 3e-2, 1e-2, 1e-3}) {
    World world = make(slider(radians(30)), law(std::tan(radians(10))), {.step = step});
    run(world, 0.9);
    EXPECT_NEAR(norm(world.displacement(1)), 1.379825785, 1e-8) << step;
  }
  World tiny = make(slider(radians(30)), law(std::tan(radians(10))), {.step = 1e-6});
  run(tiny, 3e-4);
  EXPECT_NEAR(norm(tiny.displacement(1)), slid(10) * 0.5 * 9e-8, 1e-12);
}

TEST(DampingTest, SpeedsFollowTheClosedFormAtAnyStep) {
  const double rate = 3;
  for (const double step : {1e-1, 1e-2, 1e-3}) {
    std::vector<Body> falling{fixed("floor", rectangle(-5, -100, 10, 1)), block("block", rectangle(0, 0, 1, 2))};
    falling[1].velocity = {2, 0};
    falling[1].spin = 0.4;
    World world = make(falling, law(0), {.step = step, .mass_damping = rate});
    run(world, 0.7);
    EXPECT_NEAR(world.velocity(1).y, -g / rate * (1 - std::exp(-rate * 0.7)), 1e-11) << step;
    EXPECT_NEAR(world.velocity(1).x, 2 * std::exp(-rate * 0.7), 1e-12) << step;
    EXPECT_NEAR(world.spin(1), 0.4 * std::exp(-rate * 0.7), 1e-12) << step;
    World slope = make(slider(radians(30)), law(std::tan(radians(10))), {.step = step, .mass_damping = rate});
    run(slope, 0.7);
    EXPECT_NEAR(norm(slope.velocity(1)), slid(10) / rate * (1 - std::exp(-rate * 0.7)), 1e-8) << step;
  }
}

TEST(DampingTest, TheWayFollowsWithTheSquareOfTheStepAndTheLossIsAccountedFor) {
  const double rate = 3, t = 0.8, a = slid(10);
  const double way = a / rate * (t - (1 - std::exp(-rate * t)) / rate);
  double before = 0;
  for (const double step : {2e-2, 1e-2, 5e-3}) {
    World world = make(slider(radians(30)), law(std::tan(radians(10))), {.step = step, .mass_damping = rate});
    run(world, t);
    const double error = std::abs(norm(world.displacement(1)) - way);
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.2) << step;
    }
    before = error;
    // Lost: the integral of rate * mass * velocity squared.
    const double e1 = std::exp(-rate * t), v = a / rate;
    const double lost = rate * world.mass(1) * v * v * (t - 2 * (1 - e1) / rate + (1 - e1 * e1) / (2 * rate));
    EXPECT_NEAR(world.energy().lost, lost, 2e-2 * lost) << step;
  }
}

TEST(DampingTest, WhatRestsPressesWithItsWeight) {
  World world = make(stack(5), law(0.5), {.step = 1e-2, .sleep = false, .mass_damping = 20});
  run(world, 0.3);
  double sum = 0, weight = 0;
  for (const Contact& c : world.contacts()) {
    if (c.edge_body == 0 || c.vertex_body == 0) sum += c.normal_force;
  }
  for (std::size_t b = 1; b < world.size(); ++b) weight += world.mass(b) * g;
  EXPECT_NEAR(sum / weight, 1, 1e-9);
}

TEST(SliderTest, RestsBelowTheFrictionAngle) {
  for (const double phi : {30.01, 35.0, 89.0}) {
    World world = make(slider(radians(30)), law(std::tan(radians(phi))), {.step = 5e-3});
    run(world, 0.9);
    EXPECT_LT(norm(world.displacement(1)), 1e-9) << phi;
  }
}

TEST(SliderTest, FarFromTheOriginNothingIsLost) {
  World near = make(slider(radians(30)), law(std::tan(radians(10))), {.step = 5e-3});
  World far = make(slider(radians(30), 1, 0.5, {1e6, -1e6}), law(std::tan(radians(10))), {.step = 5e-3});
  run(near, 0.9);
  run(far, 0.9);
  EXPECT_NEAR(far.displacement(1).x, near.displacement(1).x, 1e-9);
  EXPECT_NEAR(far.displacement(1).y, near.displacement(1).y, 1e-9);
  EXPECT_NEAR(norm(far.displacement(1)), 1.379825785, 1e-8);
}

TEST(SliderTest, CohesionDecidesWithinAPercent) {
  const double need = 2600 * 0.5 * slid(10);  // N/m on a base of 1 m
  for (const double factor : {0.99, 1.01}) {
    Laws laws = law(std::tan(radians(10)));
    laws.otherwise.cohesion = factor * need;
    World world = make(slider(radians(30)), laws, {.step = 5e-3});
    run(world, 0.5);
    if (factor > 1) {
      EXPECT_LT(norm(world.displacement(1)), 1e-9);
    } else {
      EXPECT_NEAR(norm(world.displacement(1)), slid(10) * 0.125, 0.03 * slid(10) * 0.125);
    }
  }
}

TEST(StackTest, FiftyStandOnTheirWeight) {
  World world = make(stack(50), law(0.6), {.step = 5e-3});
  for (int k = 0; k < 20; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_LT(report->max_speed, 1e-6);
  }
  double base = 0;
  for (const Contact& c : world.contacts()) {
    if (c.vertex_body == 0 || c.edge_body == 0) base += c.normal_force;
  }
  EXPECT_NEAR(base / (50 * 2600 * g), 1, 1e-8);
}

// Where four corners meet, those that lie across are no contact while nothing moves: their line would be a guess that
// changes from step to step, and with it all forces.
TEST(StackTest, StacksSideBySideKeepTheirForces) {
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 30, 1))};
  for (int k = 0; k < 4; ++k) {
    for (int r = 0; r < 20; ++r) bodies.push_back(block("b", rectangle(k, r, 1, 1)));
  }
  World world = make(bodies, law(0.6), {.step = 1e-2, .sleep = false});
  for (int k = 0; k < 20; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_LT(report->max_speed, 1e-6);
    if (k > 2) {
      EXPECT_LE(report->iterations, 10U) << k;
    }
  }
  for (const Contact& c : world.contacts()) {
    const double rows = std::abs(c.normal.x) > 0.5 ? 0 : 20 - c.point.y;
    EXPECT_LT(c.normal_force, (rows + 1) * 2600 * g) << c.point.y;
  }
}

TEST(ArchTest, FallsOrStandsAsLimitAnalysisSays) {
  struct Case {
    std::size_t count;
    double thickness;
    bool stands;
  };
  for (const Case c : {Case{12, 0.112, true}, Case{12, 0.100, false}, Case{21, 0.112, true}, Case{21, 0.100, false},
                       Case{7, 0.100, true}}) {
    World world = make(arch(c.count, c.thickness), law(1.2), {.step = 5e-3});
    run(world, 0.5);
    const double drop = -world.displacement(c.count / 2 + 1).y;
    std::printf("N=%zu t=%g drop %g\n", c.count, c.thickness, drop);
    if (c.stands) {
      EXPECT_LT(drop, 1e-4) << c.count << ' ' << c.thickness;
    } else {
      EXPECT_GT(drop, 0.05) << c.count << ' ' << c.thickness;
    }
  }
}

TEST(DropTest, ReboundsByTheSquareOfRestitution) {
  for (const double e : {0.0, 0.5, 1.0}) {
    World world = make({fixed("floor", rectangle(-5, -1, 10, 1)), block("b", rectangle(-0.5, 1, 1, 1))}, law(0.5, e),
                       {.step = 5e-4});
    const double start = world.energy().total();
    bool hit = false;
    double highest = 0, gain = 0;
    while (world.time() < 1.25) {
      const auto report = world.step();
      ASSERT_TRUE(report.has_value());
      hit = hit || report->impact;
      if (hit) highest = std::max(highest, world.displacement(1).y + 1);
      gain = std::max(gain, world.energy().total() - start);
    }
    std::printf("e=%g rebound %g gain %g\n", e, highest, gain / (2600 * g));
    EXPECT_NEAR(highest, e * e, 3e-3 + (e == 0 ? 0.0 : 1e-3)) << e;
    EXPECT_LT(gain / (2600 * g), e == 1 ? 4e-3 : 1e-12) << e;
  }
}

TEST(CollisionTest, KeepsMomentumAndAngularMomentum) {
  for (const double ratio : {1.0, 1e3, 1e6}) {
    for (const double e : {0.0, 0.7}) {
      std::vector<Body> bodies{block("a", rectangle(0, 0, 1, 1)),
                               block("b", turned(rectangle(1.2, 0.4, 1, 1.3), 0.1), 2600 * ratio)};
      bodies[0].velocity = {2, 0.3};
      bodies[0].spin = 0.5;
      World world = make(bodies, law(0.4, e), {.gravity = {0, 0}, .step = 2e-3});
      const Vec2 p = world.momentum();
      const double l = world.angular_momentum();
      const double energy = world.energy().total();
      bool hit = false;
      while (world.time() < 0.8) {
        const auto report = world.step();
        ASSERT_TRUE(report.has_value());
        hit = hit || report->impact;
        ASSERT_LE(world.energy().total(), energy * (1 + 1e-10));
      }
      EXPECT_TRUE(hit);
      EXPECT_LT(norm(world.momentum() - p), 1e-12 * norm(p));
      EXPECT_NEAR(world.angular_momentum(), l, 1e-10 * std::abs(l));
    }
  }
}

TEST(SpinTest, FreePairKeepsItsAngularMomentum) {
  std::vector<Body> bodies{block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1, 0, 1, 1))};
  for (std::size_t k = 0; k < 2; ++k) {
    bodies[k].spin = 0.5;
    bodies[k].velocity = {0, k == 0 ? -0.25 : 0.25};
  }
  World world = make(bodies, law(0.6), {.gravity = {0, 0}, .step = 1e-3});
  const double l = world.angular_momentum();
  run(world, 0.5);
  EXPECT_NEAR(world.angular_momentum(), l, 1e-11 * l);
}

TEST(ToppleTest, SlidesOrTopplesByTheSigns) {
  struct Case {
    double phi, width, height;
    bool slides, topples;
  };
  for (const Case c : {Case{40, 0.5, 0.5, false, false}, Case{20, 0.5, 0.5, true, false}, Case{40, 0.5, 1, false, true},
                       Case{20, 0.3, 1, true, true}, Case{20, 0.5, 1, true, false}}) {
    World world = make(slider(radians(30), c.width, c.height), law(std::tan(radians(c.phi))), {.step = 2e-3});
    run(world, 0.2);
    const Vec2 moved = rotated(world.displacement(1), -radians(30));
    std::printf("phi %g b/h %g: slid %g turned %g\n", c.phi, c.width / c.height, -moved.x, world.rotation(1));
    EXPECT_EQ(world.rotation(1) > 1e-3, c.topples);
    if (!c.topples) {
      EXPECT_NEAR(-moved.x, c.slides ? 0.5 * slid(c.phi) * 0.04 : 0.0, 1e-8);
    }
  }
}

TEST(RodTest, PainleveDoesNotStopIt) {
  std::vector<Body> bodies{fixed("floor", rectangle(-20, -1, 40, 1)),
                           block("rod", turned(rectangle(0, 0, 2, 0.05), radians(60)))};
  bodies[1].velocity = {-3, 0};
  World world = make(bodies, law(2), {.step = 1e-3});
  const double start = world.energy().total();
  for (int k = 0; k < 200; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    ASSERT_LT(world.energy().total(), start + 1e-3 * std::abs(start));
  }
}

}  // namespace
}  // namespace cleave::dbem::motion_test
