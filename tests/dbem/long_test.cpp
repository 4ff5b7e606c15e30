#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace cleave::dbem
