#include "cleave/bem/antiplane.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace cleave::bem {
namespace {

/// Circular hole of radius 1 in shear tau along x: potential (r + 1/r) cos t.
Vec2 around_hole(Vec2 x) {
  const double r2 = dot(x, x), c = x.x * x.x - x.y * x.y, s = 2 * x.x * x.y;
  return {1 - c / (r2 * r2), -s / (r2 * r2)};
}

TEST(Antiplane, CircularHole) {
  const auto error = [](std::size_t n) {
    const Antiplane field = Antiplane::make({circle({0, 0}, 1, true, 0, n)}, std::nullopt, {}, {1, 0}).value();
    double worst = 0;
    for (const double t : {0.1, 0.8, 1.5, 2.9}) {
      for (const double r : {1.2, 1.5, 2.0, 5.0}) {
        const Vec2 x = r * Vec2{std::cos(t), std::sin(t)};
        worst = std::max(worst, norm(field.shear(x) - around_hole(x)));
      }
    }
    return worst;
  };
  EXPECT_LT(error(128), 1e-3);
  EXPECT_GT(testing::rate(error(32), error(64)), 1.8);  // away from the wall second order
}

TEST(Antiplane, FreeSurfaceCarriesNothingAndDeepHolesDoNotFeelIt) {
  const Antiplane shallow = Antiplane::make({circle({0, -2}, 1, true, 0, 96)}, 0.0, {}, {1, 0}).value();
  for (const double x : {-3.0, 0.0, 0.7}) EXPECT_NEAR(shallow.shear({x, -1e-9}).y, 0, 1e-9);
  EXPECT_GT(std::abs(shallow.shear({0, -0.5}).x - around_hole({0, 1.5}).x), 0.05);
  const Antiplane deep = Antiplane::make({circle({0, -200}, 1, true, 0, 96)}, 0.0, {}, {1, 0}).value();
  EXPECT_LT(norm(deep.shear({0.9, -198.6}) - around_hole({0.9, 1.4})), 1e-3);
}

TEST(Antiplane, CrossingOpeningsAreRefused) {
  EXPECT_FALSE(
      Antiplane::make({circle({0, 0}, 1, true, 0, 8), circle({1, 0}, 1, true, 0, 8)}, std::nullopt, {}, {1, 0}));
}

}  // namespace
}  // namespace cleave::bem
