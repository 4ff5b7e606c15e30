#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "cleave/core/rng.hpp"
#include "cleave/linear/fronts.hpp"
#include "compact_factor.hpp"
#include "elastic_body.hpp"
#include "natural_map.hpp"
#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

/// A running bond of bricks of 1 x 0.5 m with open head joints on a floor.
std::vector<Body> wall(std::size_t rows, std::size_t columns) {
  const auto n = static_cast<double>(columns);
  std::vector<Body> bodies{fixed("floor", rectangle(-20, -1, n + 40, 1))};
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t k = 0; k + r % 2 < columns; ++k) {
      bodies.push_back(block("b", rectangle(0, 0, 1, 0.5)));
      bodies.back().origin = {1.002 * static_cast<double>(k) + (r % 2 == 1 ? 0.5 : 0.0), 0.5 * static_cast<double>(r)};
    }
  }
  return bodies;
}

std::vector<Vec2> speeds(const ContactProblem& problem, const std::vector<Vec2>& impulse) {
  std::vector<Vec2> y = problem.b;
  problem.w.add_product(impulse, y);
  return y;
}

TEST(LargeGroupTest, FactorsOfBodiesAndOfContactsGiveOneMotion) {
  auto world = World::make(wall(8, 10), law(0.5), {.gravity = {3, -g}, .step = 2e-3});
  ASSERT_TRUE(world.has_value());
  const std::vector<ContactProblem> problems = world->problems(2e-3);
  ASSERT_EQ(problems.size(), 1U);
  ContactProblem problem = problems[0];
  ASSERT_GT(problem.contacts(), 200U);
  ASSERT_TRUE(problem.rigid.has_value());
  const ContactSolution by_bodies = solve(problem);
  problem.rigid.reset();
  const ContactSolution by_contacts = solve(problem);
  EXPECT_EQ(by_bodies.report.status, ContactReport::Status::converged);
  EXPECT_EQ(by_contacts.report.status, ContactReport::Status::converged);
  const std::vector<Vec2> a = speeds(problem, by_bodies.impulse), b = speeds(problem, by_contacts.impulse);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_LT(norm(a[k] - b[k]), 1e-7) << k;
}

TEST(LargeGroupTest, AWallPushedSidewaysKeepsTheBalanceOfForces) {
  // Some bricks slide, some rock, most stick: the floor carries the weight and the push less what is accelerated.
  const Vec2 field{0.3 * g, -g};
  auto world = World::make(wall(12, 16), law(0.4), {.gravity = field, .step = 2e-3, .sleep = false});
  ASSERT_TRUE(world.has_value());
  const double before = world->energy().total();
  double mass = 0;
  for (std::size_t b = 1; b < world->size(); ++b) mass += world->mass(b);
  for (int k = 0; k < 5; ++k) {
    const Vec2 old = world->momentum();
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    Vec2 floor{};
    for (const Contact& c : world->contacts()) {
      const Vec2 force = c.normal_force * c.normal + c.tangential_force * turned_left(c.normal);
      if (c.edge_body == 0) floor += force;
      if (c.vertex_body == 0) floor += -force;
    }
    const Vec2 expected = (world->momentum() - old) / report->step - mass * field;
    EXPECT_LT(norm(floor - expected), 1e-8 * mass * g) << k;
    EXPECT_LE(world->energy().total(), before + 1e-9 * mass * g);
  }
}

// Corners upon straight-angle corners are named anew from step to step: their forces are found again all the same, and
// a wall at rest costs a linear solve or two a step.
TEST(LargeGroupTest, AnElasticWallKeepsItsForcesFromStepToStep) {
  std::vector<Body> bodies = wall(6, 8);
  const Body brick = support::elastic_body(rectangle(0, 0, 1, 0.5), {.young = 1e10}, 1, 12);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const Vec2 at = bodies[b].origin;
    bodies[b] = brick;
    bodies[b].origin += at;
  }
  auto world = World::make(bodies, law(0.5), {.step = 1e-3, .sleep = false});
  ASSERT_TRUE(world.has_value());
  for (int k = 0; k < 3; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    if (k > 0) {
      EXPECT_LE(report->iterations, 2U) << k;
    }
  }
}

TEST(LargeGroupTest, AThousandBricksMoveOn) {
  auto world = World::make(wall(25, 40), law(0.5), {.gravity = {0.3 * g, -g}, .step = 1e-3});
  ASSERT_TRUE(world.has_value());
  for (int k = 0; k < 3; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_EQ(report->islands, 1U);
    EXPECT_LT(report->residual, 1e-8);
    EXPECT_LT(report->iterations, k == 0 ? 200U : 60U);
  }
}

// Given the speeds of slip the law is convex: from a cold start, with bricks that slide, stick and rock, interior
// points find the motion that the cascade finds.
TEST(InteriorTest, FindsTheMotionOfTheCascade) {
  for (const double friction : {0.0, 0.1, 0.5}) {
    auto world = World::make(wall(4, 5), law(friction), {.gravity = {3, -g}, .step = 2e-3});
    ASSERT_TRUE(world.has_value());
    const ContactProblem problem = world->problems(2e-3).front();
    const ContactSolution inside = solve(problem, {.method = Method::interior}), all = solve(problem);
    EXPECT_EQ(inside.report.status, ContactReport::Status::converged) << friction << ' ' << inside.report.residual;
    EXPECT_EQ(inside.report.method, Method::interior);
    const std::vector<Vec2> a = speeds(problem, inside.impulse), b = speeds(problem, all.impulse);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_LT(norm(a[k] - b[k]), 1e-7) << friction << ' ' << k;
  }
}

// A sliding wall: the first programme lets it dilate; the ones after it, each with the slip of the one before, do not.
TEST(InteriorTest, ReachesTheLawByItself) {
  auto world = World::make(wall(4, 5), law(0.1), {.gravity = {3, -g}, .step = 2e-3});
  ASSERT_TRUE(world.has_value());
  const ContactProblem problem = world->problems(2e-3).front();
  std::vector<double> residuals;
  std::size_t factors = 0;
  Work work;
  interior_point_solve(problem, 1000, work, factors, [&](const std::vector<Vec2>& impulses) {
    residuals.push_back(natural_residual(problem, impulses));
    return residuals.back() < 2e-4;  // the last digits are Newton's
  });
  ASSERT_GT(residuals.size(), 1U);
  EXPECT_GT(residuals.front(), 1e-2);
  EXPECT_LT(residuals.back(), 2e-4);
}

// Pushed by more than friction holds, hundreds of joints slip at once, and none of the other methods gets home:
// interior points do by themselves, in the freedoms of the bodies and in those of the contacts.
TEST(InteriorTest, AWallPastItsFrictionIsSolved) {
  auto world = World::make(wall(10, 10), law(0.5), {.gravity = {0.6 * g, -g}, .step = 1e-3});
  ASSERT_TRUE(world.has_value());
  ContactProblem problem = world->problems(1e-3).front();
  for (const bool bodies : {true, false}) {
    if (!bodies) problem.rigid.reset();
    double residual = 1;
    std::size_t factors = 0;
    Work work;
    interior_point_solve(problem, 1000, work, factors, [&](const std::vector<Vec2>& impulses) {
      residual = natural_residual(problem, impulses);
      return residual < 1e-8;
    });
    EXPECT_LT(residual, 1e-8) << bodies;
  }
}

TEST(InteriorTest, AWallPastItsFrictionSlidesOnItsFloor) {
  const Vec2 field{0.6 * g, -g};
  auto world = World::make(wall(10, 10), law(0.5), {.gravity = field, .step = 1e-3});
  ASSERT_TRUE(world.has_value());
  double mass = 0;
  for (std::size_t b = 1; b < world->size(); ++b) mass += world->mass(b);
  for (int k = 0; k < 3; ++k) {
    const Vec2 old = world->momentum();
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_EQ(report->cuts, 0U);
    EXPECT_LT(report->residual, 1e-8);
    Vec2 floor{};
    for (const Contact& c : world->contacts()) {
      const Vec2 force = c.normal_force * c.normal + c.tangential_force * turned_left(c.normal);
      if (c.edge_body == 0) floor += force;
      if (c.vertex_body == 0) floor += -force;
    }
    const Vec2 balance = (world->momentum() - old) / report->step - mass * field;
    EXPECT_LT(norm(floor - balance), 1e-7 * mass * g) << k;
    // All of the lowest course slides.
    EXPECT_NEAR(floor.x, -0.5 * floor.y, 1e-6 * mass * g) << k;
    EXPECT_NEAR(floor.y, mass * g, 0.05 * mass * g) << k;
  }
}

// Counted, not timed: the same step fails on any machine, and one that is given more is solved.
TEST(WorkTest, AStepThatTakesTooMuchWorkIsRefused) {
  WorldOptions options{.gravity = {0.6 * g, -g}, .step = 1e-3};
  double taken = 0;
  for (int run = 0; run < 2; ++run) {
    auto world = World::make(wall(6, 6), law(0.5), options);
    ASSERT_TRUE(world.has_value());
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_GT(report->work, 1e6);
    if (run > 0) {
      EXPECT_EQ(report->work, taken);
    }
    taken = report->work;
  }
  options.step_work = 1e-3 * taken;
  auto world = World::make(wall(6, 6), law(0.5), options);
  ASSERT_TRUE(world.has_value());
  const std::vector<Vec2> before = world->outline(1);
  const auto report = world->step();
  ASSERT_FALSE(report.has_value());
  EXPECT_EQ(std::get<StepFailed>(report.error()).reason,
            "the contact law was not met with the work that a step may take");
  EXPECT_EQ(world->outline(1), before);
  EXPECT_EQ(world->time(), 0);
  options.step_work = 0;
  EXPECT_FALSE(World::make(wall(6, 6), law(0.5), options).has_value());
}

TEST(FrontalFactorTest, KnowsTheSignOfItsDeterminant) {
  for (const double beside : {0.1, 10.0}) {
    linear::FrontalFactor factor{3, 1, {{0, 1}, {1, 2}}};
    factor.clear(false);
    for (std::size_t k = 0; k < 3; ++k) factor.block(k, k)(0, 0) = 1;
    factor.block(0, 1)(0, 0) = factor.block(1, 0)(0, 0) = beside;
    ASSERT_TRUE(factor.factorise());
    EXPECT_EQ(factor.sign(), beside < 1 ? 1 : -1);  // 1 - beside^2
  }
}

// The path turns many times, and passes close to itself: it comes to an answer of the law all the same, from wherever
// it begins, with friction and without.
TEST(TurningPathTest, EndsAtAnAnswerOfTheLaw) {
  for (const double friction : {0.0, 0.1, 0.5}) {
    for (const double push : {3.0, 0.6 * g}) {
      auto world = World::make(wall(8, 8), law(friction), {.gravity = {push, -g}, .step = 1e-3});
      ASSERT_TRUE(world.has_value());
      const ContactProblem problem = world->problems(1e-3).front();
      double residual = 1;
      std::size_t factors = 0;
      Work work;
      turning_path(problem, 4000, work, factors, [&](const std::vector<Vec2>& impulses) {
        residual = natural_residual(problem, impulses);
        return residual < 1e-6;
      });
      EXPECT_LT(residual, 1e-6) << friction << ' ' << push;
    }
  }
}

TEST(ResidualTest, ALightBlockBesideAHeavyOneCounts) {
  // 10^-9 of the heavy block's impulse taken from under a light one is nothing to the first and a fall to the second.
  auto world = World::make(stack(8, 1e6), law(0.6), {.step = 5e-3});
  ASSERT_TRUE(world.has_value());
  const ContactProblem problem = world->problems(5e-3).front();
  ContactSolution solution = solve(problem);
  ASSERT_EQ(solution.report.status, ContactReport::Status::converged);
  const double right = natural_residual(problem, solution.impulse);
  EXPECT_LT(right, 1e-8);
  double most = 0;
  for (const Vec2 p : solution.impulse) most = std::max(most, p.x);
  const auto most_at = std::ranges::max_element(solution.impulse, {}, [](Vec2 p) { return p.x; });
  most_at->x -= 1e-9 * most;
  const double light = 2600 * 5e-3 * g;
  EXPECT_GT(natural_residual(problem, solution.impulse), 0.01 * 1e-9 * most / light);
}

TEST(StackTest, FiftyUnderAMillionTimesTheirWeightStand) {
  auto world = World::make(stack(50, 1e6), law(0.6), {.step = 1e-3});
  ASSERT_TRUE(world.has_value());
  for (int k = 0; k < 200; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
  }
  for (std::size_t b = 0; b < world->size(); ++b) EXPECT_LT(norm(world->displacement(b)), 1e-5) << b;
}

/// Columns on steps of a slope against a toe, without friction.
std::vector<Body> columns() {
  const double up = radians(30);
  const std::vector<double> heights{1.2, 1.2, 6, 1.2, 1.2, 1.2, 7, 1.2, 1.2, 6.5, 1.2, 1.2, 1.2, 1.2};
  const auto at = [&](double x, double y) { return rotated(Vec2{x, y}, up); };
  std::vector<Body> bodies{fixed("slope", {at(-6, 0), {-5.2, -4}, {17.3, -4}, at(20, 0)}),
                           fixed("toe", turned(rectangle(0, 0, 1, 1.2), up))};
  for (std::size_t k = 0; k < heights.size(); ++k) {
    bodies.push_back(block("c", turned(rectangle(static_cast<double>(k) + 1, 0, 1, heights[k]), up)));
  }
  return bodies;
}

// Rows of blocks that fill the room between two walls and a little more: nothing can part them.
TEST(PartingTest, WhatIsWedgedIsNotSolvedForEver) {
  constexpr std::size_t columns = 12, rows = 12;
  constexpr double tight = 3e-7;
  std::vector<Body> bodies{fixed("floor", rectangle(-2, -1, columns + 4, 1)), fixed("left", rectangle(-1, 0, 1, rows)),
                           fixed("right", rectangle(columns - tight, 0, 1, rows))};
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t k = 0; k < columns; ++k) {
      bodies.push_back(block("b", rectangle(0, 0, 1, 1)));
      bodies.back().origin = {static_cast<double>(k), static_cast<double>(r)};
    }
  }
  auto world = World::make(bodies, law(0.5), {.step = 1e-3});
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  for (int k = 0; k < 5; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_LE(report->parting, 100U) << k;
    EXPECT_LE(report->max_penetration, 1.01 * tight) << k;
  }
}

TEST(LooseTest, FrictionlessColumnsFallAndSlideToTheEnd) {
  auto world = World::make(columns(), law(0), {.step = 5e-3});
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  const double start = world->energy().total();
  double before = start, gain = 0, projected = 0;
  double weight = 0;
  for (std::size_t b = 2; b < world->size(); ++b) weight += world->mass(b) * g;
  while (world->time() < 2.5) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    const double now = world->energy().total();
    gain = std::max(gain, now - before);
    EXPECT_LE(now - before, 1e-10 * weight + 1.01 * (world->energy().projected - projected)) << world->time();
    projected = world->energy().projected;
    before = now;
  }
  EXPECT_LT(world->energy().projected, 1e-9 * weight);  // 1,438 J when parting bodies costs no speed
  std::printf("largest gain of a step %g J of %g, projected %g\n", gain, weight, world->energy().projected);
}

/// Random links, blocks that are not symmetric, and what a full matrix makes of them.
TEST(CompactFactorTest, SolvesAsAFullMatrixDoes) {
  Rng rng{7};
  for (const std::size_t nodes : {1U, 2U, 5U, 17U, 63U, 64U, 65U, 128U}) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
    for (std::uint32_t k = 1; k < nodes; ++k) {
      for (int more = 0; more < 2; ++more) links.emplace_back(k, static_cast<std::uint32_t>(rng.between(0, k - 1)));
    }
    CompactFactor factor{nodes, links};
    for (int round = 0; round < 2; ++round) {  // the same factor for other values
      factor.clear();
      const auto size = 3 * static_cast<Eigen::Index>(nodes);
      Eigen::MatrixXd full = Eigen::MatrixXd::Zero(size, size);
      const auto fill = [&](std::uint32_t r, std::uint32_t c, double diagonal) {
        Block3& block = factor.block(r, c);
        for (std::size_t k = 0; k < 9; ++k) {
          block[k] = rng.normal() + (k % 4 == 0 ? diagonal : 0.0);
          full(3 * r + static_cast<Eigen::Index>(k / 3), 3 * c + static_cast<Eigen::Index>(k % 3)) = block[k];
        }
      };
      for (std::uint32_t k = 0; k < nodes; ++k) fill(k, k, 20);
      for (const auto& [a, b] : links) {
        fill(a, b, 0);
        fill(b, a, 0);
      }
      std::vector<Three> x(nodes);
      Eigen::VectorXd right(size);
      for (std::size_t k = 0; k < nodes; ++k) {
        for (std::size_t d = 0; d < 3; ++d) {
          right[static_cast<Eigen::Index>(3 * k + d)] = x[k][d] = rng.normal();
        }
      }
      ASSERT_TRUE(factor.factorise());
      factor.solve(x);
      const Eigen::VectorXd exact = full.partialPivLu().solve(right);
      for (std::size_t k = 0; k < nodes; ++k) {
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_NEAR(x[k][d], exact[static_cast<Eigen::Index>(3 * k + d)], 1e-12) << nodes;
        }
      }
    }
  }
  CompactFactor singular{2, std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}}};
  singular.clear();
  EXPECT_FALSE(singular.factorise());
}

}  // namespace
}  // namespace cleave::dbem
