#include "cleave/stochastic/statistics.hpp"
#include "heavy_rock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"

namespace cleave::stochastic {
namespace {

TEST(IntervalsTest, ClopperPearsonByHand) {
  const Interval three = clopper_pearson(3, 60, 0.95);
  EXPECT_NEAR(three.low, 0.010432, 5e-7);
  EXPECT_NEAR(three.high, 0.139243, 5e-7);
  EXPECT_EQ(clopper_pearson(0, 60, 0.95).low, 0);
  EXPECT_NEAR(clopper_pearson(0, 60, 0.9).high, 0.048703, 5e-7);  // one-sided 95 %
  EXPECT_NEAR(clopper_pearson(60, 60, 0.95).low, 1 - clopper_pearson(0, 60, 0.95).high, 1e-12);
}

// Exact: the ends are where the binomial tail is a/2.
TEST(IntervalsTest, ClopperPearsonEndsAreExact) {
  for (const std::uint64_t k : {1U, 5U, 30U, 99U}) {
    const Interval i = clopper_pearson(k, 100, 0.9);
    EXPECT_NEAR(1 - special::binomial_cdf(k - 1, 100, i.low), 0.05, 1e-9);
    EXPECT_NEAR(special::binomial_cdf(k, 100, i.high), 0.05, 1e-9);
  }
}

TEST(IntervalsTest, WilksSizesOfTheLiterature) {
  EXPECT_EQ(wilks_size(1, 0.90, 0.95), 29U);
  EXPECT_EQ(wilks_size(1, 0.95, 0.95), 59U);
  EXPECT_EQ(wilks_size(1, 0.99, 0.95), 299U);
  EXPECT_EQ(wilks_size(1, 0.95, 0.99), 90U);
  const std::vector<std::uint64_t> sizes{59, 93, 124, 153, 181};
  for (std::uint64_t k = 1; k <= 5; ++k) EXPECT_EQ(wilks_size(k, 0.95, 0.95), sizes[k - 1]) << k;
}

TEST(IntervalsTest, QuantileRanksHoldTheirConfidence) {
  for (const double p : {0.5, 0.9, 0.99}) {
    for (const std::uint64_t n : {10U, 60U, 500U, 2000U}) {
      const auto ranks = quantile_ranks(n, p, 0.95);
      const double outside_low = special::binomial_cdf(0, n, p);
      if (!ranks) {
        EXPECT_TRUE(outside_low > 0.025 || std::pow(p, static_cast<double>(n)) > 0.025) << p << ' ' << n;
        continue;
      }
      // P(x_(low) > q) and P(x_(high) < q), and one rank further in they would be too large.
      EXPECT_LE(special::binomial_cdf(ranks->low - 1, n, p), 0.025);
      EXPECT_GT(special::binomial_cdf(ranks->low, n, p), 0.025);
      EXPECT_LE(1 - special::binomial_cdf(ranks->high - 1, n, p), 0.025);
      EXPECT_GT(1 - special::binomial_cdf(ranks->high - 2, n, p), 0.025);
    }
  }
  EXPECT_FALSE(quantile_ranks(60, 0.99, 0.95).has_value());
}

TEST(IntervalsTest, StudentsTableValues) {
  const Interval i = t_interval(0, 1, 60, 0.95);
  EXPECT_NEAR(i.high, 2.000995, 1e-6);
  EXPECT_NEAR(t_interval(0, 1, 2, 0.95).high, 12.706205, 1e-6);
}

// BCa moves the interval towards the long tail: lognormal with sigma 1.
TEST(IntervalsTest, BootstrapShiftsToTheLongTail) {
  int shifted = 0, bca_covers = 0;
  constexpr int groups = 300;
  const double truth = std::exp(0.5);
  for (int g = 0; g < groups; ++g) {
    Rng rng{{.seed = 11, .realization = static_cast<std::uint64_t>(g)}};
    std::vector<double> x(40);
    double sum = 0, squares = 0;
    for (double& v : x) {
      v = std::exp(rng.normal());
      sum += v;
      squares += v * v;
    }
    const double mean = sum / 40, error = std::sqrt((squares / 40 - mean * mean) / 39);
    const Interval t = t_interval(mean, error, 40, 0.95);
    const auto b = bca_mean(x, 0.95, 1000, 1);
    ASSERT_TRUE(b.has_value());
    shifted += b->high > t.high && b->low > t.low ? 1 : 0;
    bca_covers += b->low <= truth && truth <= b->high ? 1 : 0;
  }
  EXPECT_GT(shifted, 0.95 * groups);
  EXPECT_GT(bca_covers, 0.87 * groups);
  EXPECT_FALSE(bca_mean(std::vector{1.0, 1.0, 1.0, 1.0}, 0.95, 100, 1).has_value());
}

TEST(IntervalsTest, SkewMovesStudentsInterval) {
  const Interval even = skew_interval(3, 0.5, 0, 60, 0.95, 0.5), t = t_interval(3, 0.5, 60, 0.95);
  EXPECT_DOUBLE_EQ(even.low, t.low);
  EXPECT_DOUBLE_EQ(even.high, t.high);
  // Nearly even: no jump where the closed form has lost its digits.
  EXPECT_NEAR(skew_interval(3, 0.5, 1e-4, 60, 0.95, 0.5).high, t.high, 1e-4);
  // Seen skewed to the right, the truth may lie farther to the right and not so far to the left.
  const Interval right = skew_interval(3, 0.5, 2, 60, 0.95, 0), left = skew_interval(3, 0.5, -2, 60, 0.95, 0);
  EXPECT_GT(right.high, t.high);
  EXPECT_GT(right.low, t.low);
  EXPECT_NEAR(right.high - 3, 3 - left.low, 1e-12);
}

// Realizations as those of tunnels: their number of key blocks scatters more than Poisson's, blocks of one are alike,
// volumes are lognormal with a coefficient of variation of 3.4 to 7.3. Sixty of them.
TEST(IntervalsTest, MeansRatiosAndSharesCoverAtSixty) {
  for (const support::RockKind& rock : support::rock_kinds) {
    const support::RockTruth truth = support::truth_of(rock);
    support::EnsembleCoverage covered;
    for (std::uint64_t k = 0; k < 300; ++k) covered.look(rock, truth, 60, k);
    for (const auto& [name, count] : covered.counts) {
      RecordProperty(std::string{rock.name} + "_" + name, count);
      // Rare kinds have exact intervals: they cover more than they say.
      EXPECT_GE(count, 300 * 0.90 - 3 * std::sqrt(300 * 0.9 * 0.1)) << rock.name << ' ' << name;
    }
  }
}

// A sample that met no large block looks as harmless as one of a light tail: neither the interval nor its mark may hang
// on what it met. With 0.8 key blocks a realization unmarked intervals held 65 to 83 % when the mark was the sample's
// own skewness, and bootstraps 80 %.
TEST(IntervalsTest, MarksOfLongTailsTellTheTruth) {
  constexpr int samples = 400;
  const support::RockKind& rock = support::rock_kinds.back();
  const support::RockTruth truth = support::truth_of(rock);
  support::EnsembleCoverage covered;
  for (std::uint64_t k = 0; k < samples; ++k) covered.look(rock, truth, 60, k);
  for (const std::string name : {"key_block_volume_m3", "key_block_mean_volume_m3", "support_force_per_block_n"}) {
    const int marked = covered.flagged[name], held = covered.counts[name], held_marked = covered.held_flagged[name];
    const int unmarked = samples - marked;
    EXPECT_GT(marked, 0.2 * samples) << name;
    RecordProperty(name + "_held", held);
    EXPECT_GE(held, samples * 0.93 - 2 * std::sqrt(samples * 0.93 * 0.07)) << name;
    EXPECT_GE(held_marked, marked * 0.9 - 3 * std::sqrt(marked * 0.09)) << name;
    EXPECT_GE(held - held_marked, unmarked * 0.93 - 3 * std::sqrt(unmarked * 0.93 * 0.07)) << name;
    RecordProperty(name + "_marked", marked);
    RecordProperty(name + "_held_unmarked", held - held_marked);
    EXPECT_GE(covered.held_by_bootstrap[name], covered.bootstraps[name] * 0.9) << name;
  }
  EXPECT_GT(covered.bootstraps["key_block_volume_m3"], samples / 2);
}

// By hand: a quarter of the weight is 0, the upper half lies at 1 and at 2 on the logarithm, the median at 0.
TEST(IntervalsTest, TailIsThatOfTheUpperHalf) {
  Tail tail;
  for (const double x : {0.0, 0.0, std::exp(-9.0), std::exp(-3.0), 1.0, 1.0, std::exp(1.0), std::exp(2.0)}) tail.add(x);
  EXPECT_DOUBLE_EQ(tail.parts(), 6);
  EXPECT_NEAR(tail.log_variance(), 5.0 / 3, 0.05);
  const double square = tail.log_variance();
  EXPECT_NEAR(tail.log_error_squared(), 1.0 / 3 / 8 + (square + square * square) / 6, 1e-12);
  EXPECT_TRUE(tail.long_from_few());
  const Interval plain{1, 2}, higher = with_tail(plain, 1.5, tail, 8, 0.95);
  EXPECT_EQ(higher.low, 1);
  EXPECT_NEAR(higher.high, 1.5 * std::exp(special::student_t_quantile(0.975, 7) * std::sqrt(tail.log_error_squared())),
              1e-9);
  // No tail: nothing moves; differences have none that is seen so.
  Tail light, both;
  for (const double x : {10.0, 10.1, 10.2, 10.3}) {
    light.add(x);
    both.add(x);
  }
  both.add(-1);
  EXPECT_EQ(with_tail(plain, 1.5, light, 4, 0.95).high, 2);
  both.add(1e9);
  EXPECT_EQ(with_tail(plain, 1.5, both, 6, 0.95).high, 2);
}

}  // namespace
}  // namespace cleave::stochastic
