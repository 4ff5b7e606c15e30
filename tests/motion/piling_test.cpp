#include <cmath>

#include "worlds.hpp"

namespace cleave::motion {
namespace {

using namespace worlds;

/// Force of the floor (body 0) on what stands on it, upwards.
double reaction(const World& w) {
  double sum = 0;
  for (const Contact& c : w.contacts()) {
    if (c.other == 0) sum += c.force.z;
    if (c.body == 0) sum -= c.force.z;
  }
  return sum;
}

TEST(Piling, StacksOfCubesRest) {
  for (const auto& [count, top] : {std::pair{10, 1.0}, {30, 1.0}, {20, 1e3}, {20, 1e6}}) {
    std::vector<BodySpec> bodies{floor()};
    double weight = 0;
    for (int k = 0; k < count; ++k) {
      bodies.push_back(body(box({-0.5, -0.5, k + 0.0}, {0.5, 0.5, k + 1.0})));
      if (k + 1 == count) bodies.back().density = kilograms_per_cubic_metre(top);
      weight += bodies.back().density.si() * 9.81;
    }
    World w = world(std::move(bodies), 0.5, {.step = 0.01, .sleep = false});
    for (int k = 0; k < 5; ++k) {
      const auto report = w.step();
      // A million times the mass on top may be refused; it is never answered wrongly.
      if (!report && top > 1e5) return;
      ASSERT_TRUE(report.has_value()) << count << " " << top << describe(report.error());
      // Each contact may miss the law by the residual, 1e-8 of the speed of free fall in a step; under a million times
      // the mass it does, and the top comes down by what all of them miss.
      EXPECT_NEAR(reaction(w) / weight, 1, top > 1e5 ? count * 1e-8 : 1e-8) << count << " " << top;
    }
    for (int k = 1; k <= count; ++k) EXPECT_LT(norm(w.velocity(static_cast<std::size_t>(k))), 1e-7) << top;
  }
}

TEST(Piling, AHundredCubesThatBeginToToppleAreSolved) {
  // From no forces at all: their slowest mode is 1e-8 of their stiffest one.
  std::vector<BodySpec> bodies{floor()};
  for (int k = 0; k < 100; ++k) bodies.push_back(body(box({-0.5, -0.5, k + 0.0}, {0.5, 0.5, k + 1.0})));
  World w = world(std::move(bodies), 0.6, {.gravity = {0.8, 0.5, -9.81}, .step = 0.01, .cuts = 0});
  const auto report = w.step();
  ASSERT_TRUE(report.has_value());
  EXPECT_LE(report->residual, 1e-8);
  EXPECT_EQ(report->rough, 0U);
  EXPECT_GT(norm(w.velocity(100)), 1e-4);
}

TEST(Piling, RoughAnswersAreCounted) {
  // What rounding leaves is more than is accepted here: refused, or used and called rough where that is tolerated.
  for (const double tolerate : {0.0, 1e-4}) {
    World w = world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({0.1, 0.2, 1}, {1.1, 1.2, 2}))}, 0.5,
                    {.gravity = {3, 1, -9.81}, .cuts = 1, .solver = {.accept = 1e-30, .tolerate = tolerate}});
    const auto report = w.step();
    ASSERT_EQ(report.has_value(), tolerate > 0);
    if (!report) continue;
    EXPECT_EQ(report->rough, 2U);
    EXPECT_GT(report->residual, 0);
    EXPECT_LE(report->residual, tolerate);
  }
}

TEST(Piling, CubeDroppedFlat) {
  for (const double e : {0.0, 0.5, 1.0}) {
    World w = world({floor(), body(box({-0.5, -0.5, 1}, {0.5, 0.5, 2}))}, 0.5, {.step = 1e-3}, e);
    double highest = 0;
    bool bounced = false;
    while (w.time() < 1.2) {
      ASSERT_TRUE(w.step().has_value());
      if (w.velocity(1).z > -0.01 && w.time() > 0.4) bounced = true;
      if (bounced) highest = std::max(highest, w.centroid(1).z - 0.5);
      if (bounced && w.velocity(1).z < -0.5) break;
    }
    EXPECT_NEAR(highest, e * e, 5e-3);
    EXPECT_LT(w.energy().largest_gain, 2e-3 * 9.81);
  }
}

TEST(Piling, EqualCubeOnEqualCube) {
  World w = world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({0, 0, 2}, {1, 1, 3}))}, 0.5, {.step = 5e-3});
  ASSERT_TRUE(run(w, 1.5));
  expect_near(w.displacement(1), {0, 0, 0}, 1e-7);
  expect_near(w.displacement(2), {0, 0, -1}, 1e-7);
}

TEST(Piling, CornerExactlyOverCorner) {
  World w = world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({1, 1, 1}, {2, 2, 2}))}, 0.5, {.step = 5e-3});
  ASSERT_TRUE(run(w, 1));
}

TEST(Piling, EdgeExactlyOverEdge) {
  World w = world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({1, 0, 1.2}, {2, 1, 2.2}))}, 0.3, {.step = 5e-3});
  ASSERT_TRUE(run(w, 1));
}

TEST(Piling, BricksInBondRest) {
  std::vector<BodySpec> bodies{floor()};
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k < 4; ++k) {
      const double x = k + 0.5 * (row % 2);
      bodies.push_back(body(box({x, 0, 0.5 * row}, {x + 1, 0.5, 0.5 * row + 0.5})));
    }
  }
  World w = world(std::move(bodies), 0.5, {.step = 0.01, .sleep = false});
  ASSERT_TRUE(run(w, 0.2));
  for (std::size_t b = 1; b < w.size(); ++b) EXPECT_LT(norm(w.displacement(b)), 1e-8);
}

TEST(Piling, SlidesOverASeam) {
  // Two cubes side by side, equal tops: no ghost of the seam stops what slides over it.
  World w = world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({1, 0, 0}, {2, 1, 1})),
                   body(box({0.25, 0.25, 1}, {0.75, 0.75, 1.3}), {1.5, 0, 0})},
                  0.1, {.step = 5e-3});
  ASSERT_TRUE(run(w, 0.5));
  EXPECT_NEAR(w.displacement(3).x, 1.5 * 0.5 - 0.5 * 0.981 * 0.25, 2e-3);
  EXPECT_LT(norm(w.spin(3)), 1e-6);
}

TEST(Piling, FreePairKeepsMomentum) {
  for (const double ratio : {1.0, 1e3, 1e6}) {
    std::vector<BodySpec> bodies{body(moved(icosahedron(0.5), {0, 0, 1.1}), {0.3, 0, -1}, {0.5, 0.2, -0.3}),
                                 body(block(1, 1.2, 0.8), {0, 0.1, 0.2}, {0.1, -0.4, 0.2})};
    bodies[1].density = kilograms_per_cubic_metre(ratio);
    World w = world(std::move(bodies), 0.4, {.gravity = {}, .step = 0.01});
    const Vec3 p = w.momentum(), l = w.angular_momentum();
    ASSERT_TRUE(run(w, 1));
    EXPECT_GT(norm(w.velocity(0) - Vec3{0.3, 0, -1}), 0.1);
    EXPECT_LT(norm(w.momentum() - p), 1e-14 * ratio);
    EXPECT_LT(norm(w.angular_momentum() - l), 1e-14 * ratio);
    EXPECT_LT(w.energy().kinetic, w.energy().start);
  }
}

TEST(Piling, ACloudKeepsMomentumAlsoWhereBodiesAreParted) {
  // Each towards the middle.
  std::vector<BodySpec> bodies;
  for (int k = 0; k < 27; ++k) {
    const Vec3 at{0.62 * (k % 3 - 1) + 0.01 * (k % 5), 0.62 * (k / 3 % 3 - 1) - 0.01 * (k % 7), 0.64 * (k / 9 - 1)};
    bodies.push_back(body(moved(icosahedron(0.3), at, turn_by({0.1 * k, 0.2 * k, 0.3})), -2.0 * at));
  }
  World w = world(std::move(bodies), 0.4, {.gravity = {}, .step = 0.01});
  const Vec3 p = w.momentum(), l = w.angular_momentum();
  double energy = w.energy().kinetic, parted = 0;
  while (w.time() < 0.3) {
    const auto report = w.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    const double gained = w.energy().kinetic - w.energy().projected;
    EXPECT_LE(gained, energy + 1e-12);
    energy = gained;
    parted = std::max(parted, report->max_penetration);
  }
  EXPECT_GT(parted, 1e-8);
  EXPECT_LT(w.energy().kinetic, 0.5 * w.energy().start);
  EXPECT_LT(norm(w.momentum() - p), 1e-13);
  EXPECT_LT(norm(w.angular_momentum() - l), 1e-13);
  EXPECT_LT(w.energy().closing_error, 1e-12);
}

TEST(Piling, EveryBitIsTheSameOnAnyNumberOfThreads) {
  // Stacks, some of which topple over others, of blocks of several cells: many groups that come and go.
  const auto run_on = [](unsigned threads) {
    std::vector<BodySpec> bodies{floor()};
    for (int k = 0; k < 36; ++k) {
      const Vec3 at{1.6 * (k % 6), 1.6 * (k / 6), 0};
      bodies.push_back(body(moved(box({0, 0, 0}, {1, 1, 1}), at, {}), {0.1 * (k % 5), -0.1 * (k % 3), 0}));
      bodies.push_back(body(moved(box({0, 0, 0}, {0.8, 0.8, 0.8}), at + Vec3{0.4 + 0.01 * k, 0.1, 1.02}, {})));
      bodies.push_back(body(moved(icosahedron(0.3), at + Vec3{0.6, 0.5, 2.6}, turn_by({0.1 * k, 0.2, 0.3}))));
    }
    World w = world(std::move(bodies), 0.3, {.step = 0.01, .threads = threads});
    while (w.time() < 0.4) {
      const auto report = w.step();
      if (!report) {
        ADD_FAILURE() << describe(report.error());
        break;
      }
    }
    return w.saved();
  };
  const std::string one = run_on(1);
  EXPECT_EQ(run_on(2), one);
  EXPECT_EQ(run_on(8), one);
}

TEST(Piling, IcosahedraInABin) {
  std::vector<BodySpec> bodies{floor()};
  for (const double s : {-1.0, 1.0}) {
    bodies.push_back({.shape = box({1.5 * s - 0.5, -3, 0}, {1.5 * s + 0.5, 3, 6}), .fixed = true});
    bodies.push_back({.shape = box({-1, 1.5 * s - 0.5, 0}, {1, 1.5 * s + 0.5, 6}), .fixed = true});
  }
  for (int k = 0; k < 27; ++k) {
    const Vec3 at{0.6 * (k % 3 - 1) + 0.01 * (k % 5), 0.6 * (k / 3 % 3 - 1) - 0.01 * (k % 7), 0.5 + 0.7 * (k / 9)};
    bodies.push_back(body(moved(icosahedron(0.3), at, turn_by({0.1 * k, 0.2 * k, 0.3}))));
  }
  World w = world(std::move(bodies), 0.4, {.step = 5e-3});
  while (w.time() < 0.8) {
    const auto report = w.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    // Sides that come to lie on one another do so at several points at once, whatever edges cross there.
    EXPECT_EQ(report->cuts, 0U) << w.time();
  }
  EXPECT_LT(w.energy().largest_gain, 1e-9 * w.energy().start + 1e-9);
}

TEST(Piling, AGroupAtRestIsNotSearchedAgain) {
  // Cubes on a slope, then one that comes down on them. With little patience the search from motion ends in nothing,
  // and what it would have said stays said. What scenes accept is met by far, so nothing is solved at all.
  struct Way {
    double accept;
    std::size_t patience, locked;
  };
  for (const auto& [accept, patience, locked] : {Way{1e-8, 4000, 0}, Way{1e-5, 4000, 0}, Way{1e-8, 1, 8}}) {
    std::vector<BodySpec> bodies{floor()};
    for (int k = 0; k < 8; ++k) {
      const Vec3 at{k % 2 + 0.0, k / 2 % 2 + 0.0, k / 4 + 0.0};
      bodies.push_back(body(box(at, at + Vec3{1, 1, 1})));
    }
    bodies.push_back(body(box({0.2, 0.3, 2.1}, {0.9, 0.8, 2.6})));
    World w = world(std::move(bodies), 0.7,
                    {.gravity = {1.5, 0.5, -9.81},
                     .step = 0.01,
                     .theta = 1,
                     .sleep = false,
                     .solver = {.accept = accept, .patience = patience}});
    std::size_t first = 0, searched = 0;
    double upwards = 0;
    while (w.time() < (patience > 1 ? 0.5 : 0.1) - 1e-9) {
      const auto report = w.step();
      ASSERT_TRUE(report.has_value()) << describe(report.error());
      EXPECT_LE(report->residual, accept);
      EXPECT_LT(w.energy().closing_error, 1e-10);  // also of the picojoules that turn over at rest
      if (first == 0) {
        first = report->iterations;
        upwards = reaction(w);
        EXPECT_GT(first, 80U);  // factors: a search, not an answer taken again
      }
      if (w.time() < 0.12) {
        EXPECT_EQ(report->may_be_locked, locked);
        EXPECT_NEAR(reaction(w), upwards, accept * upwards);
        const bool begins = w.time() < 0.015;
        EXPECT_LE(report->iterations, begins ? first : accept > 1e-6 ? 0U : first / 2);
      } else {
        searched += report->iterations > first / 2 ? 1U : 0U;
      }
    }
    // The one that comes down: a few steps until it lies still.
    if (patience > 1) {
      EXPECT_GT(searched, 0U);
      EXPECT_LT(searched, 10U);
    }
    for (std::size_t b = 1; b < 9; ++b) EXPECT_LT(norm(w.velocity(b)), 1e-7);
  }
}

TEST(Piling, EveryStepIsLookedAtForOverlaps) {
  // What rounding leaves is more than is allowed here: such steps are refused, never accepted.
  std::vector<BodySpec> bodies{floor()};
  for (int k = 0; k < 4; ++k) {
    bodies.push_back(
        body(moved(icosahedron(0.3), {0.05 * k, 0.02 * k, 0.5 + 0.7 * k}, turn_by({0.1 * k, 0.2 * k, 0.3}))));
  }
  World w = world(std::move(bodies), 0.4, {.step = 5e-3, .cuts = 0, .overlap = 1e-15});
  std::string reason;
  while (w.time() < 0.6 && reason.empty()) {
    const auto report = w.step();
    if (report) {
      EXPECT_LE(report->overlap, 1e-15) << w.time();
    } else {
      reason = report.error().reason;
      EXPECT_EQ(report.error().bodies.size(), 2U);
    }
  }
  EXPECT_EQ(reason, "two bodies overlap");
}

TEST(Piling, BlocksBetweenParallelWallsFall) {
  // Forces locked in between rough walls could hold them; nothing is there to lock them in.
  for (const int count : {1, 2, 5}) {
    for (const double friction : {0.3, 1.0}) {
      std::vector<BodySpec> bodies{{.shape = box({-1, -2, -6}, {0, 3, 6}), .fixed = true},
                                   {.shape = box({count + 0.0, -2, -6}, {count + 1.0, 3, 6}), .fixed = true}};
      for (int k = 0; k < count; ++k) bodies.push_back(body(box({k + 0.0, 0, 0}, {k + 1.0, 1, 1 + 0.25 * (k % 2)})));
      World w = world(std::move(bodies), friction, {.step = 0.01});
      while (w.time() < 0.3 - 1e-12) {
        const auto report = w.step(0.3 - w.time());
        ASSERT_TRUE(report.has_value()) << count << " " << friction << describe(report.error());
      }
      for (int k = 0; k < count; ++k) {
        EXPECT_NEAR(w.displacement(static_cast<std::size_t>(k) + 2).z, -9.81 * 0.045, 1e-6) << count << " " << friction;
      }
    }
  }
}

TEST(Piling, AFastBodyDoesNotPassThroughAThinPlate) {
  for (const double speed : {20.0, 200.0}) {
    for (const double far : {1.0, 200.0}) {  // a body far away makes the scene large
      std::vector<BodySpec> bodies{
          {.shape = box({-2, -2, -0.02}, {2, 2, 0}), .fixed = true},
          body(moved(icosahedron(0.1), {0.01, 0.02, 1}, turn_by({0.1, 0.2, 0.3})), {0, 0, -speed}),
          body(box({far, 5, 5}, {far + 1, 6, 6}))};
      World w = world(std::move(bodies), 0.4, {.gravity = {}, .step = 0.01});
      while (w.time() < 2 / speed) {
        if (!w.step()) break;  // a run that stops says so
      }
      EXPECT_GT(w.centroid(1).z, 0) << speed << " " << far;
    }
  }
}

}  // namespace
}  // namespace cleave::motion
