#include "cleave/stochastic/statistics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {
namespace {

TEST(StoppingTest, LooksGrowByHalf) {
  EXPECT_EQ(looks(400), (std::vector<std::uint64_t>{100, 150, 225, 338, 400}));
  EXPECT_EQ(looks(100), (std::vector<std::uint64_t>{100}));
  EXPECT_EQ(looks(7), (std::vector<std::uint64_t>{7}));
}

// Ratio of the always-valid half width to 1.96 s/sqrt n (Waudby-Smith et al. 2024, rho = 0.1).
TEST(StoppingTest, AlwaysValidWidthsByHand) {
  constexpr std::array expected{1.8655, 1.5499, 1.6699};
  std::size_t i = 0;
  for (const int n : {100, 1000, 10000}) {
    Moments m;
    for (int k = 0; k < n; ++k) m.add(k % 2 == 0 ? 1 : -1);
    const double fixed = half_width(m, {.rule = StopRule::fixed_looks});
    EXPECT_NEAR(half_width(m, {.rule = StopRule::always_valid}) / fixed, expected[i++], 2e-4) << n;
  }
}

TEST(StoppingTest, SkewedLawsWaitAndZeroNeverStops) {
  Moments zero;
  for (int i = 0; i < 1000; ++i) zero.add(0);
  EXPECT_FALSE(narrow_enough(zero, {}));
  Moments skewed;  // skewness far above 2, interval far below the limit
  for (int i = 0; i < 200; ++i) skewed.add(i == 0 ? 101 : 100);
  EXPECT_GT(skewed.skewness(), 2);
  EXPECT_FALSE(narrow_enough(skewed, {}));
  for (int i = 0; i < 100; ++i) skewed.add(100);
  EXPECT_TRUE(narrow_enough(skewed, {}));
}

// Coverage of the rule as a whole: stop at the first look whose interval is narrow, then ask whether it held the mean.
TEST(StoppingTest, FixedLooksCoverAsTheySay) {
  const Stop stop{.relative_half_width = 0.1, .max = 20000};
  int covers = 0;
  constexpr int runs = 400;
  for (int r = 0; r < runs; ++r) {
    Rng rng{{.seed = 9, .realization = static_cast<std::uint64_t>(r)}};
    Moments m;
    for (const std::uint64_t look : looks(stop.max)) {
      while (m.count() < look) m.add(-std::log(rng.uniform()));
      if (narrow_enough(m, stop)) break;
    }
    covers += std::abs(m.mean() - 1) <= half_width(m, stop) ? 1 : 0;
  }
  EXPECT_GE(covers, 0.92 * runs);  // 4 standard errors below 0.95 are 0.906
}

}  // namespace
}  // namespace cleave::stochastic
