#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cleave/core/rng.hpp"
#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

/// Four walls.
std::vector<Body> room(double size) {
  return {fixed("floor", rectangle(-1, -1, size + 2, 1)), fixed("ceiling", rectangle(-1, size, size + 2, 1)),
          fixed("left", rectangle(-1, 0, 1, size)), fixed("right", rectangle(size, 0, 1, size))};
}

/// Runs and checks that no step brings energy in but what the parting of penetrating bodies is charged with.
void never_gains(World world, std::size_t steps) {
  const double start = world.energy().total();
  double weight = start;  // against a fall of a metre
  for (std::size_t b = 0; b < world.size(); ++b) weight += world.body(b).held.all() ? 0.0 : world.mass(b) * g;
  double highest = 0, before = start, projected = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    const double now = world.energy().total();
    highest = std::max(highest, now - before);
    ASSERT_LE(now, start + 1e-10 * weight) << k;
    ASSERT_LE(now - before, 1e-10 * weight + 1.01 * (world.energy().projected - projected)) << k;
    projected = world.energy().projected;
    before = now;
  }
  std::printf("energy %g -> %g, largest gain of a step %g, projected %g\n", start, before, highest,
              world.energy().projected);
}

TEST(EnergyTest, NeverGrowsInARoomWithoutGravity) {
  Rng rng{5};
  for (const double e : {0.0, 0.9}) {
    std::vector<Body> bodies = room(4);
    for (int k = 0; k < 4; ++k) {
      bodies.push_back(block("b", turned(rectangle(-0.4, -0.3, 0.8, 0.6), 3 * rng.uniform())));
      bodies.back().origin = {1 + 2 * (k % 2) + 0.01 * k, 1.0 + 2 * (k / 2)};
      bodies.back().velocity = {3 * rng.normal(), 3 * rng.normal()};
      bodies.back().spin = rng.normal();
    }
    auto world = World::make(bodies, law(0.3, e), {.gravity = {0, 0}, .step = 2e-3, .sleep = false});
    ASSERT_TRUE(world.has_value()) << describe(world.error());
    never_gains(*std::move(world), 250000);
  }
}

TEST(EnergyTest, NeverGrowsUnderGravity) {
  std::vector<Body> bodies{fixed("floor", turned(rectangle(-30, -1, 60, 1), 0.02)),
                           fixed("stop", rectangle(-31, -1, 1, 9))};
  for (int k = 0; k < 6; ++k) {
    bodies.push_back(block("b", turned(rectangle(-0.5, -0.3, 1, 0.6), 0.2 * k)));
    bodies.back().origin = {-20 + 0.7 * k, 1.2 + 1.3 * k};
  }
  auto world = World::make(bodies, law(0.4, 0.2), {.step = 2e-3, .sleep = false});
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  never_gains(*std::move(world), 500000);
}

/// Five layers of bricks with open joints over an opening 12 m wide.
std::vector<Body> roof(double gap) {
  std::vector<Body> bodies{fixed("left", {{-11, 0}, {-6, 0}, {-6, 4}, {-9, 4}, {-9, 9}, {-11, 9}}),
                           fixed("right", {{6, 0}, {11, 0}, {11, 9}, {9, 9}, {9, 4}, {6, 4}}),
                           fixed("floor", rectangle(-6, -1, 12, 1))};
  for (int layer = 0; layer < 5; ++layer) {
    const bool odd = layer % 2 == 1;
    const double y = 4.0 + layer;
    if (odd) bodies.push_back(block("end", rectangle(-9, y, 0.75 - gap / 2, 1)));
    for (int k = 0; k < (odd ? 11 : 12); ++k) {
      bodies.push_back(block("brick", rectangle((odd ? -8.25 : -9) + gap / 2 + 1.5 * k, y, 1.5 - gap, 1)));
    }
    if (odd) bodies.push_back(block("end", rectangle(8.25 + gap / 2, y, 0.75 - gap / 2, 1)));
  }
  return bodies;
}

// Sixty bricks slide on each other and land: the last resorts of the cascade were made for what happens here.
TEST(LooseTest, ARoofOfLooseBricksFallsToTheEnd) {
  auto world = World::make(roof(0.01), law(std::tan(radians(35))), {.step = 4e-3});
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  double weight = 0;
  for (std::size_t b = 3; b < world->size(); ++b) weight += world->mass(b) * g;
  double before = world->energy().total(), projected = 0;
  while (world->time() < 1) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    EXPECT_LE(report->residual, 1e-8);
    const double now = world->energy().total();
    EXPECT_LE(now - before, 1e-10 * weight + 1.01 * (world->energy().projected - projected)) << world->time();
    projected = world->energy().projected;
    before = now;
  }
  EXPECT_LT(world->displacement(8).y, -3.9);  // the middle of the lowest layer lies on the floor
}

}  // namespace
}  // namespace cleave::dbem
