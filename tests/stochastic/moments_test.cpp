#include "cleave/stochastic/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {
namespace {

// {1,2,3,4,8}: m 3.6, M2 29.2, M3 63.36 by hand.
TEST(MomentsTest, WorkedExample) {
  Moments m;
  for (const double x : {1.0, 2.0, 3.0, 4.0, 8.0}) m.add(x);
  EXPECT_DOUBLE_EQ(m.mean(), 3.6);
  EXPECT_NEAR(m.variance(), 29.2 / 4, 1e-13);
  EXPECT_NEAR(m.skewness(), std::sqrt(5.0) * 63.36 / std::pow(29.2, 1.5), 1e-13);
  EXPECT_EQ(m.smallest(), 1);
  EXPECT_EQ(m.largest(), 8);
}

TEST(MomentsTest, AgreeWithTwoPassesFarFromZero) {
  Moments m;
  std::vector<double> values;
  Rng rng{5};
  for (int i = 0; i < 1000; ++i) {
    values.push_back(1e6 + std::exp(rng.normal()));
    m.add(values.back());
  }
  double mean = 0, m2 = 0, m4 = 0;
  for (const double v : values) mean += v / 1000;
  for (const double v : values) {
    m2 += std::pow(v - mean, 2);
    m4 += std::pow(v - mean, 4);
  }
  EXPECT_NEAR(m.variance(), m2 / 999, 1e-6 * m2 / 999);
  EXPECT_NEAR(m.excess_kurtosis(), 1000 * m4 / (m2 * m2) - 3, 1e-5 * m4);
}

// The ratio's standard error against its true spread over many groups; taking blocks as independent would be 3 times
// too small here because all blocks of one realization share a factor.
TEST(MomentsTest, RatioErrorIsThatOfRealizations) {
  Moments ratios;
  double mean_error = 0;
  constexpr int groups = 400;
  for (int g = 0; g < groups; ++g) {
    PairMoments pair;
    Rng rng{{.seed = 1, .realization = static_cast<std::uint64_t>(g)}};
    for (int k = 0; k < 60; ++k) {
      const auto n = static_cast<double>(rng.between(1, 40));
      pair.add(n * std::exp(0.5 * rng.normal()), n);
    }
    ratios.add(pair.ratio());
    mean_error += pair.ratio_standard_error() / groups;
  }
  EXPECT_NEAR(mean_error, ratios.std(), 0.12 * ratios.std());
}

}  // namespace
}  // namespace cleave::stochastic
