#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

World two_blocks() { return World::make(stack(2), law(0.5), {.step = 1e-3}).value(); }

TEST(DoorTest, StepsThatAreNoneAreErrorsAndLeaveTheWorldAsItWas) {
  World world = two_blocks();
  const Vec2 at = world.centroid(2);
  for (const double step : {0.0, -0.0, -1.0, -infinite, nan}) {
    EXPECT_FALSE(world.step(step).has_value()) << step;
    EXPECT_FALSE(world.set_step(step).has_value()) << step;
    EXPECT_TRUE(world.problems(step).empty()) << step;
    World other = world;
    EXPECT_FALSE(relax(other, {.step = step}).has_value()) << step;
  }
  EXPECT_FALSE(world.set_step(infinite).has_value());
  EXPECT_EQ(world.centroid(2), at);
  EXPECT_EQ(world.time(), 0);
  EXPECT_TRUE(world.step().has_value());
}

TEST(DoorTest, OptionsWithoutMeaningAreErrors) {
  const auto refused = [](auto&& change) {
    WorldOptions options;
    change(options);
    return !World::make(stack(1), law(0.5), options).has_value();
  };
  for (const double bad : {nan, -1.0}) {
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.step = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.longest_step = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.displacement = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.rotation = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.position_error = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.overlap = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.overlap_elastic = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.overlap_at_start = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.regularisation = bad; }));
    EXPECT_TRUE(refused([&](WorldOptions& o) { o.sleep_speed = bad; }));
  }
  EXPECT_TRUE(refused([&](WorldOptions& o) { o.solver.accept = nan; }));
  EXPECT_TRUE(refused([&](WorldOptions& o) { o.gravity = {nan, 0}; }));
  EXPECT_TRUE(refused([&](WorldOptions& o) { o.gravity = {0, infinite}; }));
}

TEST(DoorTest, BodiesWithoutMeaningAreErrors) {
  const auto refused = [](auto&& change) {
    std::vector<Body> bodies = stack(1);
    change(bodies[1]);
    return !World::make(bodies, law(0.5), {}).has_value();
  };
  for (const double bad : {nan, infinite}) {
    EXPECT_TRUE(refused([&](Body& b) { b.outline[1].x = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.origin.y = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.velocity.x = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.spin = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.density = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.mass = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.inertia = bad; }));
    EXPECT_TRUE(refused([&](Body& b) { b.forces.push_back({{0, 1}, {bad, 0}}); }));
    EXPECT_TRUE(refused([&](Body& b) { b.forces.push_back({{bad, 1}, {1, 0}}); }));
  }
  EXPECT_TRUE(refused([&](Body& b) { b.outline.clear(); }));
  EXPECT_TRUE(refused([&](Body& b) { b.density = -1; }));
}

// A load that is no number from some time on: the step is refused, the state stays finite.
TEST(DoorTest, LoadsThatAreNoNumbersAreNoMotion) {
  for (const bool ground : {false, true}) {
    const auto sick = [](double t) { return t > 0.01 ? nan : 1.0; };
    std::vector<Body> bodies = stack(2);
    WorldOptions options{.step = 1e-3, .sleep = false};
    if (ground) {
      options.ground = [=](double t) { return Vec2{sick(t), 0}; };
    } else {
      bodies[2].forces.push_back({{0.5, 2}, {1, 0}, sick});
    }
    World world = World::make(bodies, law(0.5), options).value();
    bool refused = false;
    for (int k = 0; k < 20 && !refused; ++k) refused = !world.step().has_value();
    EXPECT_TRUE(refused) << ground;
    for (std::size_t b = 0; b < world.size(); ++b) {
      EXPECT_TRUE(std::isfinite(world.centroid(b).x + world.centroid(b).y + world.rotation(b))) << ground;
    }
  }
}

TEST(DoorTest, VelocitiesThatAreNoneAreErrors) {
  World world = two_blocks();
  EXPECT_FALSE(world.set_velocity(1, {nan, 0}, 0).has_value());
  EXPECT_FALSE(world.set_velocity(1, {0, infinite}, 0).has_value());
  EXPECT_FALSE(world.set_velocity(1, {0, 0}, nan).has_value());
  EXPECT_FALSE(world.set_velocity(3, {0, 0}, 0).has_value());
  EXPECT_EQ(world.velocity(1), Vec2{});
  EXPECT_TRUE(world.set_velocity(1, {1, 0}, 0).has_value());
}

}  // namespace
}  // namespace cleave::dbem
