#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "cleave/motion/world.hpp"
#include "shapes.hpp"

/// Small worlds that tests run.
namespace cleave::motion::worlds {

using namespace shapes;

/// Body axes with z on the normal of a plane and y down its dip.
inline Turn slope(double dip, double dip_direction) {
  return turn_by({0, 0, -dip_direction * degree}) * turn_by({-dip * degree, 0, 0});
}
inline Vec3 downhill(double dip, double dip_direction) { return slope(dip, dip_direction) * Vec3{0, 1, 0}; }

/// A wall whose top is the plane z = 0 of the turned axes.
inline BodySpec floor(Turn turn = {}, double half = 20) {
  return {.shape = moved(box({-half, -half, -1}, {half, half, 0}), {}, turn), .fixed = true};
}
/// A body of unit density.
inline BodySpec body(Polyhedron shape, Vec3 velocity = {}, Vec3 spin = {}) {
  return {.shape = std::move(shape), .velocity = velocity, .spin = spin};
}
inline World world(std::vector<BodySpec> bodies, double friction, WorldOptions options = {}, double restitution = 0) {
  auto made = World::make({.bodies = std::move(bodies), .surfaces = {{friction, restitution}}}, options);
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}
/// Runs to a time; false when a step failed. Checks what every run holds.
inline bool run(World& world, double until) {
  while (world.time() < until - 1e-12) {
    const auto report = world.step(until - world.time());
    if (!report) {
      ADD_FAILURE() << describe(report.error());
      return false;
    }
    EXPECT_LE(report->residual, world.options().solver.accept);
    EXPECT_LE(report->overlap, world.options().overlap);
  }
  EXPECT_LT(world.energy().closing_error, 1e-10);
  EXPECT_LT(world.momentum_error(), 1e-10);
  return true;
}
inline void expect_near(Vec3 got, Vec3 want, double tolerance) {
  EXPECT_NEAR(got.x, want.x, tolerance);
  EXPECT_NEAR(got.y, want.y, tolerance);
  EXPECT_NEAR(got.z, want.z, tolerance);
}

}  // namespace cleave::motion::worlds
