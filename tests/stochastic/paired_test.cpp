#include "cleave/stochastic/paired.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {
namespace {

Record with(std::uint64_t k, double volume, std::uint64_t count = 1) {
  Record r;
  r.realization = k;
  r.joints = 5;
  r.blocks = 10;
  r.rock_m3 = 100;
  r.all.volume_m3 = volume;
  r.all.count = count;
  return r;
}

const PairedEstimate& row(const std::vector<PairedEstimate>& rows, std::string_view name) {
  const auto found = std::ranges::find(rows, name, &PairedEstimate::name);
  EXPECT_NE(found, rows.end()) << name;
  return *found;
}

// By hand: (1, 2), (2, 4), (6, 6): differences 1, 2, 0.
TEST(PairedTest, DifferencesByHand) {
  PairedComparison pairs;
  pairs.add(with(0, 1), with(0, 2));
  pairs.add(with(1, 2), with(1, 4));
  pairs.add(with(2, 6), with(2, 6));
  const auto rows = pairs.estimates(0.95);
  const PairedEstimate& volume = row(rows, "key_block_volume_m3");
  EXPECT_EQ(volume.pairs, 3U);
  EXPECT_DOUBLE_EQ(volume.first, 3);
  EXPECT_DOUBLE_EQ(volume.second, 4);
  EXPECT_DOUBLE_EQ(volume.difference, 1);
  EXPECT_NEAR(volume.standard_error, 1 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(volume.interval.high, 1 + 4.302652729911275 / std::sqrt(3.0), 1e-9);
  // Variances 7 and 4, covariance 5; difference 1.
  EXPECT_NEAR(volume.correlation, 5 / std::sqrt(28.0), 1e-12);
  ASSERT_TRUE(volume.gain.has_value());
  EXPECT_NEAR(*volume.gain, 11, 1e-9);
  // Nothing differs: no gain to speak of.
  EXPECT_EQ(row(rows, "key_block_count").difference, 0);
  EXPECT_FALSE(row(rows, "key_block_count").gain.has_value());
  // Neither design has a support.
  EXPECT_TRUE(std::ranges::none_of(rows, [](const auto& r) { return r.name.starts_with("support_blocks"); }));
}

// What one design alone was asked for is not compared with nothing; load cases are compared by themselves.
TEST(PairedTest, OnlyWhatBothWereAskedFor) {
  PairedComparison pairs, under;
  for (std::uint64_t k = 0; k < 4; ++k) {
    Record bare = with(k, 1), bolted = with(k, 1);
    bolted.support = Supported{.needing = 3, .not_held = k};
    bare.cases.resize(1);
    bare.cases[0].count = 2;
    bare.cases[0].volume = cubic_metres(5);
    bolted.cases.resize(2);
    bolted.cases[1].count = 1;
    bolted.cases[1].volume = cubic_metres(2);
    pairs.add(bare, bolted);
    under.add(under_case(bare, 0), under_case(bolted, 1));
  }
  const auto rows = pairs.estimates(0.95);
  EXPECT_TRUE(std::ranges::none_of(rows, [](const auto& r) { return r.name.starts_with("support_blocks"); }));
  const PairedComparison::OnlyInOne only = pairs.only_in_one();
  const auto has = [](const std::vector<std::string>& names, std::string_view name) {
    return std::ranges::find(names, name) != names.end();
  };
  EXPECT_TRUE(only.first.empty());
  EXPECT_TRUE(has(only.second, "support_blocks_not_held"));
  EXPECT_FALSE(has(only.second, "support_groups_not_held"));
  const auto cases = under.estimates(0.95, true);
  EXPECT_EQ(row(cases, "key_block_volume_m3").difference, -3);
  EXPECT_EQ(row(cases, "probability_of_failure").first, 1);
  EXPECT_TRUE(std::ranges::none_of(cases, [](const auto& r) { return r.name == "joint_count"; }));
}

// A pressure over the area of excavations is not compared with that of a scene that has none.
TEST(PairedTest, PressuresOverAreaNeedExcavationsInBoth) {
  PairedComparison pairs, both;
  for (std::uint64_t k = 0; k < 3; ++k) {
    Record opened = with(k, 1), bare = with(k, 1);
    opened.free_m2 = 10;
    for (Record* r : {&opened, &bare}) r->all.support_transferred_n = 100 * static_cast<double>(k);
    pairs.add(opened, bare);
    both.add(opened, opened);
  }
  const auto of_area = [](const auto& row) { return row.name == "support_pressure_pa"; };
  EXPECT_TRUE(std::ranges::none_of(pairs.estimates(0.95), of_area));
  EXPECT_EQ(pairs.only_in_one().first, std::vector<std::string>{"support_pressure_pa"});
  EXPECT_EQ(row(both.estimates(0.95), "support_pressure_pa").first, 10);
}

// Known answer of e^{1.1 u} - e^{u}: its variance is 0.571 with independent u and 0.0066 with common ones.
// Pairs that never differ say nothing of how much they may.
TEST(PairedTest, NoIntervalWhereNoPairDiffers) {
  PairedComparison pairs;
  for (std::uint64_t k = 0; k < 5; ++k) {
    pairs.add(with(k, static_cast<double>(k + 1), k == 2 ? 2 : 1), with(k, static_cast<double>(k + 1)));
  }
  const auto rows = pairs.estimates(0.95);
  EXPECT_EQ(row(rows, "key_block_volume_m3").difference, 0);
  EXPECT_EQ(row(rows, "key_block_volume_m3").interval.high, std::numeric_limits<double>::infinity());
  EXPECT_EQ(row(rows, "key_block_volume_m3").interval.low, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(row(rows, "key_block_count").interval.high));
}

TEST(PairedTest, RoundingIsNoDifference) {
  PairedComparison pairs, others;
  for (std::uint64_t k = 0; k < 5; ++k) {
    const double volume = 0.1 * static_cast<double>(k + 1), off = k % 2 == 0 ? 1 + 4e-16 : 1 - 4e-16;
    pairs.add(with(k, volume), with(k, volume * off));
    others.add(with(k, volume), with(k, volume * (1 + 1e-9)));
  }
  const auto rows = pairs.estimates(0.95), apart = others.estimates(0.95);
  const PairedEstimate& volume = row(rows, "key_block_volume_m3");
  EXPECT_EQ(volume.difference, 0);
  EXPECT_EQ(volume.standard_error, 0);
  EXPECT_TRUE(std::isinf(volume.interval.high)) << "no pair differs";
  EXPECT_FALSE(volume.gain.has_value());
  EXPECT_GT(row(apart, "key_block_volume_m3").difference, 0) << "more than rounding";
}

TEST(PairedTest, CommonNumbersShrinkTheVarianceOfADifference) {
  PairedComparison pairs;
  for (std::uint64_t k = 0; k < 20000; ++k) {
    const double u = Rng{{.seed = 1, .realization = k}}.uniform();
    pairs.add(with(k, std::exp(u)), with(k, std::exp(1.1 * u)));
  }
  const auto rows = pairs.estimates(0.95);
  const PairedEstimate& volume = row(rows, "key_block_volume_m3");
  EXPECT_NEAR(volume.standard_error * std::sqrt(20000.0), std::sqrt(0.0066), 0.002);
  EXPECT_NEAR(*volume.gain, 0.571 / 0.0066, 5);
}

TEST(PairedTest, UnitsAreGeometriesAndFailuresAreLeftOut) {
  PairedComparison pairs{2};
  const std::array<double, 6> first{1, 3, 5, 7, 2, 2}, second{2, 2, 9, 9, 0, 0};
  for (std::uint64_t k = 0; k < 6; ++k) {
    Record a = with(k, first[k]), b = with(k, second[k]);
    if (k == 4) b.outcome = Outcome::refused;
    if (k == 1) b.joints = 6;
    pairs.add(a, b);
  }
  EXPECT_EQ(pairs.left_out(), 1U);
  EXPECT_EQ(pairs.other_joints(), 1U);
  const auto rows = pairs.estimates(0.95);
  const PairedEstimate& volume = row(rows, "key_block_volume_m3");
  EXPECT_EQ(volume.pairs, 2U);  // means 2 and 2, 6 and 9
  EXPECT_DOUBLE_EQ(volume.difference, 1.5);
  EXPECT_DOUBLE_EQ(volume.standard_error, 1.5);
}

}  // namespace
}  // namespace cleave::stochastic
