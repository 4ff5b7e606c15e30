#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

// Friction and cohesion of 4,000 joints: laws of their own, and how they hang together.

namespace cleave::scene::test::strength_draws_test {
namespace {

struct Draws {
  std::vector<double> friction, cohesion;  ///< degrees, Pa
};

Draws draws_of(double correlation) {
  const std::string text = fmt::format(
      "schema = 1\nseed = 5\n[domain]\nbox = {{ min = [0, 0, 0], max = [20, 20, 20] }}\n[[joint_set]]\nname = \"A\"\n"
      "orientation = {{ dip = 30, dip_direction = 60 }}\nshape = \"square\"\nsize = 0.1\nintensity = {{ count = 4000 "
      "}}\n[joints.A]\nfriction = {{ distribution = \"uniform\", min = 15, max = 35 }}\ncohesion = {{ distribution = "
      "\"exponential\", mean = 2000 }}\nfriction_cohesion_correlation = {}\n",
      correlation);
  const auto drawn = sample(scene_of(text));
  EXPECT_TRUE(drawn.has_value());
  Draws all;
  for (const JointInfo& joint : drawn->joints) {
    all.friction.push_back(joint.strength.friction().degrees());
    all.cohesion.push_back(joint.strength.cohesion().si());
  }
  return all;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> rank(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<double>(k);
  return rank;
}
/// Spearman's.
double rank_correlation(const Draws& draws) {
  const auto a = ranks(draws.friction), b = ranks(draws.cohesion);
  const auto n = static_cast<double>(a.size());
  double square = 0;
  for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
  return 1 - 6 * square / (n * (n * n - 1));
}
/// Kolmogorov-Smirnov distance times sqrt n.
double distance(std::vector<double> values, double (*below)(double)) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double d = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double f = below(values[k]), i = static_cast<double>(k);
    d = std::max({d, f - i / n, (i + 1) / n - f});
  }
  return d * std::sqrt(n);
}

// A Gaussian copula of correlation r has Spearman's 6/pi asin(r/2); both laws stay what they are. Limits: 4.5 standard
// errors of independent ranks, and 2.4 for Kolmogorov-Smirnov (false alarms 7e-6 and 2e-5).
TEST(StrengthDraws, FrictionAndCohesionHangTogetherAsStated) {
  const Draws apart = draws_of(0);
  ASSERT_EQ(apart.friction.size(), 4000U);
  for (const double r : {0.0, 0.7, -0.5}) {
    const Draws draws = draws_of(r);
    EXPECT_NEAR(rank_correlation(draws), 6 / std::numbers::pi * std::asin(r / 2), 4.5 / std::sqrt(4000)) << r;
    EXPECT_LT(distance(draws.friction, [](double x) { return (x - 15) / 20; }), 2.4) << r;
    EXPECT_LT(distance(draws.cohesion, [](double x) { return -std::expm1(-x / 2000); }), 2.4) << r;
    EXPECT_EQ(draws.friction, apart.friction) << "cohesion alone is moved";
  }
  EXPECT_NEAR(rank_correlation(draws_of(1)), 1, 1e-12);
  EXPECT_NEAR(rank_correlation(draws_of(-1)), -1, 1e-12);
}

}  // namespace
}  // namespace cleave::scene::test::strength_draws_test
