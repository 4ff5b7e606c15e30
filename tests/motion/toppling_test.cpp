#include <cmath>

#include "worlds.hpp"

namespace cleave::motion {
namespace {

using namespace worlds;

/// Gravity on a plane of this dip, seen in its axes; downhill at an angle from x.
Vec3 tilted(double dip, double toward) {
  return 9.81 * Vec3{std::sin(dip * degree) * std::cos(toward * degree),
                     std::sin(dip * degree) * std::sin(toward * degree), -std::cos(dip * degree)};
}

/// Accelerations of a prism from rest, by one step.
std::pair<Vec3, Vec3> start(double dip, double toward, double friction) {
  const double step = 1e-3;
  World w = world({floor(), body(moved(block(1, 1, 3), {0, 0, 1.5}))}, friction,
                  {.gravity = tilted(dip, toward), .step = step, .theta = 1});
  EXPECT_TRUE(w.step(step).has_value());
  return {w.velocity(1) / step, w.spin(1) / step};
}

TEST(Toppling, OverSideEdgeAndCorner) {
  EXPECT_NEAR(start(18.6, 0, 5).second.y, 0.013404656, 1e-8);
  EXPECT_NEAR(norm(start(25.3, 45, 5).second), 0.0048015893, 1e-8);
  EXPECT_NEAR(start(20, 22.5, 5).second.y, 0.012159902, 1e-8);
  for (const auto& [dip, toward] : {std::pair{18.3, 0.0}, {25.2, 45.0}, {19.0, 22.5}}) {
    EXPECT_LT(norm(start(dip, toward, 5).second), 1e-8);
  }
}

TEST(Toppling, SlidesAndTopplesAtOnce) {
  const auto expect = [](double toward, double friction, Vec3 a, Vec3 spin) {
    const auto [got, turned] = start(40, toward, friction);
    expect_near(got, a, 1e-6);
    expect_near(turned, spin, 1e-6);
  };
  expect(45, 0.6, {1.2268491, 1.2268491, 0.81789938}, {-0.81789938, 0.81789938, 0});
  expect(30, 0.6, {2.1132386, 0.14966228, 0.75430029}, {-0.44426193, 1.0643387, 1.0334612});
  expect(0, 0.6, {2.5655273, 0, 0.85517575}, {0, 1.7103515, 0});
  expect(45, 0.45, {2.0676108, 2.0676108, 0}, {0, 0, 0});
}

TEST(Toppling, PathAndItsOrder) {
  for (const double theta : {1.0, 0.5}) {
    std::vector<double> error;
    for (const double step : {0.02, 0.01, 0.005, 0.0025}) {
      const double past = 3 * degree + std::atan2(1.0, 2.0);
      const Turn turn = turn_by({0, past, 0});
      World w = world({floor(), body(moved(block(1, 1, 2), turn * Vec3{-0.5, 0, 1}, turn))}, 5,
                      {.step = step, .theta = theta});
      ASSERT_TRUE(run(w, 0.4));
      const Vec3 axis = w.turn(1) * (turn * Vec3{0, 0, 1});
      error.push_back(std::atan2(axis.x, axis.z) - std::atan2(1.0, 2.0) - 0.082412283189);
    }
    EXPECT_NEAR(std::log2(error[0] / error[3]) / 3, 1, 0.1);
    EXPECT_LT(std::abs(2 * error[3] - error[2]), 5e-6);
  }
}

TEST(Toppling, HousnersRatioWithAllCornersClosed) {
  const double w0 = 0.5258;
  World w =
      world({floor(), body(moved(block(0.5, 1, 2), {0, 0, 1}), cross(Vec3{0, w0, 0}, Vec3{0.25, 0, 1}), {0, w0, 0})}, 5,
            {.gravity = {}, .step = 1e-6, .theta = 1});
  ASSERT_TRUE(w.step(1e-6).has_value());
  EXPECT_NEAR(w.spin(1).y / w0, 0.91176471, 1e-8);
}

TEST(Toppling, RockingBlock) {
  const Turn turn = turn_by({0, 0.1, 0});
  World w = world({floor(), body(moved(block(0.5, 1, 2), turn * Vec3{-0.25, 0, 1}, turn))}, 5, {.step = 1e-3});
  double quarter = 0, peak = 0;
  while (w.time() < 0.9) {
    ASSERT_TRUE(w.step().has_value());
    const Vec3 axis = w.turn(1) * (turn * Vec3{0, 0, 1});
    const double angle = std::atan2(axis.x, axis.z);
    if (angle > 0) quarter = w.time();
    peak = std::min(peak, angle);
  }
  EXPECT_NEAR(quarter, 0.41854866, 2e-3);
  EXPECT_NEAR(peak, -0.078909326, 2.5e-3);
}

}  // namespace
}  // namespace cleave::motion
