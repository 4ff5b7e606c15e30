#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cleave/linear/block_system.hpp"

/// The share of a Newton step that is taken.

namespace cleave::linear {
namespace {

/// max(-9 x, x), rounded within 0.1 of the corner: convex, its gradient is smallest on the long flat side.
Merit kink(double x) {
  constexpr double width = 0.1;
  if (x <= -width) return {-9 * x, 9};
  if (x >= width) return {x, 1};
  const double slope = -4 + 5 * x / width;
  return {-4 * x + 2.5 * x * x / width + 2.5 * width, std::abs(slope)};
}

TEST(LineSearch, AConvexFunctionNeverGrows) {
  // A step from the steep side far over to the flat one has a gradient nine times less, and twenty times the value.
  const Search how{.convex = true, .rounding = 1e-15, .halvings = 30};
  const Merit now = kink(-1);
  const double step = 200, slope = -9 * step;
  const double share = share_of_step(now, slope, how, [&](double part) { return kink(-1 + part * step); });
  ASSERT_GT(share, 0);
  EXPECT_LT(kink(-1 + share * step).value, now.value);
}

TEST(LineSearch, WhereTheValueHasNoDigitsLeftTheGradientLeads) {
  // All values are the same number; the gradient falls with the step.
  const Search how{.convex = true, .rounding = 1e-6, .halvings = 30};
  const double share =
      share_of_step({1e10, 1}, -1e-9, how, [](double part) { return Merit{1e10 + 1e-7 * part, 1 - part}; });
  EXPECT_EQ(share, 1);
}

TEST(LineSearch, WithoutAValueTheGradientAloneCounts) {
  const Search how{.convex = false, .halvings = 20};
  EXPECT_EQ(share_of_step({0, 1}, 0, how, [](double part) { return Merit{100 * part, 1 - 0.5 * part}; }), 1);
  EXPECT_EQ(share_of_step({0, 1}, 0, how, [](double) { return Merit{-1, 2}; }), 0);
}

}  // namespace
}  // namespace cleave::linear
