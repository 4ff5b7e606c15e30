#include "cleave/stochastic/ensemble.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {
namespace {

Record record(std::uint64_t k, std::vector<double> volumes) {
  Record r;
  r.realization = k;
  r.blocks = 100;
  r.rock_m3 = 5000;
  r.joints = 10;
  r.above = {0, 0};
  for (const double v : volumes) {
    ++r.all.count;
    r.all.volume_m3 += v;
    r.all.largest_m3 = std::max(r.all.largest_m3, v);
    r.all.sizes.add(v);
    ++r.all.modes[2];
    ++r.all.shapes[0];
    r.above[0] += v > 1 ? 1U : 0U;
    r.above[1] += v > 10 ? 1U : 0U;
  }
  r.first = r.all;
  r.chainage_m3 = {r.all.largest_m3, 0};
  return r;
}

EnsembleOptions options() { return {.volumes_m3 = {1, 10}, .tunnel_length_m = 50, .chainage_parts = 2}; }

const Estimate& find(const Figures& figures, std::string_view name) {
  return *std::ranges::find(figures.estimates, name, &Estimate::name);
}

TEST(EnsembleTest, FiguresByHand) {
  Ensemble ensemble{options()};
  ensemble.add(record(0, {2, 4}), "a");
  ensemble.add(record(1, {}), "b");
  ensemble.add(record(2, {12}), "c");
  ensemble.add(record(3, {0.5, 0.5}), "d");
  const Figures f = ensemble.figures();
  EXPECT_EQ(f.realizations, 4U);
  const Estimate& volume = find(f, "key_block_volume_m3");
  EXPECT_DOUBLE_EQ(volume.mean, 19.0 / 4);
  const double m = 19.0 / 4;
  const double s2 = (std::pow(6 - m, 2) + m * m + std::pow(12 - m, 2) + std::pow(1 - m, 2)) / 3;
  EXPECT_NEAR(volume.standard_error, std::sqrt(s2 / 4), 1e-12);
  EXPECT_NEAR(volume.high - volume.mean, 3.182446 * volume.standard_error, 1e-5);
  // Two different quantities: 19/5 as ratio of sums, (3 + 12 + 0.5)/3 as mean over realizations that have one.
  EXPECT_DOUBLE_EQ(find(f, "key_block_mean_volume_m3").mean, 19.0 / 5);
  EXPECT_DOUBLE_EQ(find(f, "key_block_mean_volume_per_realization_m3").mean, 15.5 / 3);
  EXPECT_EQ(find(f, "key_block_mean_volume_per_realization_m3").realizations, 3U);
  EXPECT_DOUBLE_EQ(find(f, "share_sliding").mean, 1);
  ASSERT_EQ(f.exceedances.size(), 2U);
  EXPECT_EQ(f.exceedances[0].realizations, 2U);
  EXPECT_DOUBLE_EQ(f.exceedances[0].probability, 0.5);
  EXPECT_DOUBLE_EQ(f.exceedances[0].number, 3.0 / 4);
  EXPECT_DOUBLE_EQ(*f.exceedances[0].per_metre, 3.0 / 4 / 50);
  EXPECT_EQ(f.exceedances[1].realizations, 1U);
  EXPECT_EQ(f.exceedances[1].by_chainage, (std::vector<double>{0.25, 0}));
  EXPECT_EQ(f.worst.front().realization, 2U);
  EXPECT_EQ(f.best.front().realization, 1U);
  EXPECT_DOUBLE_EQ(f.sizes.back().share, 1);
}

TEST(EnsembleTest, FailuresAreListedNotCounted) {
  Ensemble ensemble{options()};
  Record bad;
  bad.realization = 4;
  bad.outcome = Outcome::certificate_failed;
  ensemble.add(bad, "x");
  ensemble.add(record(5, {1}), "y");
  const Figures f = ensemble.figures();
  EXPECT_EQ(f.realizations, 1U);
  EXPECT_EQ(f.failures, 1U);
  EXPECT_EQ(f.failed, (std::vector<std::uint64_t>{4}));
  EXPECT_TRUE(std::ranges::any_of(f.notes, [](const std::string& n) { return n.contains("could not be done"); }));
}

TEST(EnsembleTest, HeavyTailIsFlaggedWithABootstrap) {
  Ensemble heavy{options()}, light{options()};
  Rng rng{4};
  for (std::uint64_t k = 0; k < 60; ++k) {
    heavy.add(record(k, {std::exp(2 * rng.normal())}), "h");
    light.add(record(k, {10 + rng.uniform()}), "l");
  }
  const Figures h = heavy.figures(), l = light.figures();
  const Estimate& volume = find(h, "key_block_volume_m3");
  EXPECT_TRUE(volume.optimistic);
  ASSERT_TRUE(volume.bootstrap.has_value());
  EXPECT_GT(volume.bootstrap->high, volume.high);
  EXPECT_TRUE(std::ranges::any_of(h.notes, [](const std::string& n) { return n.contains("optimistic"); }));
  EXPECT_FALSE(find(l, "key_block_volume_m3").optimistic);
  EXPECT_FALSE(find(l, "key_block_volume_m3").bootstrap.has_value());
}

TEST(EnsembleTest, WordsOfScenesNameQuantities) {
  EXPECT_EQ(quantity_named("key_block_volume")->name, "key_block_volume_m3");
  EXPECT_EQ(quantity_named("block_count")->name, "block_count");
  EXPECT_EQ(quantity_named("support_force")->name, "support_force_n");
  EXPECT_EQ(quantity_named("volume"), nullptr);
}

// Quantiles by order statistics: over many ensembles the interval of the 90 % quantile holds the truth.
TEST(EnsembleTest, QuantileIntervalsCover) {
  int covers = 0;
  constexpr int runs = 200;
  const double truth = -std::log(0.1);
  for (int r = 0; r < runs; ++r) {
    Ensemble ensemble{options()};
    Rng rng{{.seed = 2, .realization = static_cast<std::uint64_t>(r)}};
    for (std::uint64_t k = 0; k < 100; ++k) ensemble.add(record(k, {-std::log(rng.uniform())}), "");
    const Figures f = ensemble.figures();
    const auto q = std::ranges::find_if(
        f.quantiles, [](const QuantileEstimate& e) { return e.name == "key_block_volume_m3" && e.p == 0.9; });
    ASSERT_TRUE(q->interval.has_value());
    covers += q->interval->low <= truth && truth <= q->interval->high ? 1 : 0;
  }
  EXPECT_GE(covers, 0.9 * runs);
}

}  // namespace
}  // namespace cleave::stochastic
