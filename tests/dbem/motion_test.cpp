#include <gtest/gtest.h>

#include <array>

#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

World make(std::vector<Body> bodies, Laws laws, WorldOptions options) {
  auto world = World::make(std::move(bodies), std::move(laws), std::move(options));
  EXPECT_TRUE(world.has_value()) << describe(world.error());
  return *std::move(world);
}

TEST(SliderTest, SlidesAsTheClosedForm) {
  for (const double phi : {0.0, 5.0, 10.0, 15.0, 20.0, 25.0}) {
    World world = make(slider(radians(30)), law(std::tan(radians(phi))), {.step = 5e-3});
    run(world, 0.9);
    const double exact = g * (0.5 - std::cos(radians(30)) * std::tan(radians(phi))) * 0.405;
    EXPECT_NEAR(norm(world.displacement(1)), exact, 1e-8 * exact) << phi;
    EXPECT_NEAR(world.rotation(1), 0, 1e-9);
  }
}

TEST(SliderTest, RestsBelowTheFrictionAngle) {
  World world = make(slider(radians(30)), law(std::tan(radians(35))), {.step = 5e-3});
  run(world, 0.9);
  EXPECT_LT(norm(world.displacement(1)), 1e-9);
}

}  // namespace
}  // namespace cleave::dbem
