#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "cleave/stochastic/ensemble.hpp"
#include "poisson_rock.hpp"

// Block sizes over realizations against the exact law of rock cut by three orthogonal Poisson sets.

namespace cleave::stochastic {
namespace {

using support::poisson_rock;
using support::poisson_rock_figures;
using support::poisson_rock_truth;

bool holds(const SizeLevel& level, double truth) {
  return level.low && level.high && *level.low <= truth && truth <= *level.high;
}

/// An end that cannot be told lies anywhere beyond.
bool covers(const SizeLevel& level, double truth) {
  return level.low.value_or(0) <= truth && truth <= level.high.value_or(INFINITY);
}

// The quadrature is checked by drawing, so that nothing rests on one formula.
TEST(RockSizesTest, TheLawIsThatOfDrawnProducts) {
  Rng rng{{.seed = 92}};
  constexpr int draws = 400'000;
  const double small = poisson_rock_truth().by_number[5], large = poisson_rock_truth().by_volume[5];
  int below = 0;
  double volume = 0, volume_below = 0, squares = 0;
  for (int i = 0; i < draws; ++i) {
    const double v = -std::log(rng.uniform()) * std::log(rng.uniform()) * std::log(rng.uniform());
    below += v < small ? 1 : 0;
    volume += v;
    volume_below += v < large ? v : 0;
    squares += v * v;
  }
  EXPECT_NEAR(below / static_cast<double>(draws), 0.5, 4 * std::sqrt(0.25 / draws));
  EXPECT_NEAR(volume_below / volume, 0.5, 4 * std::sqrt(0.25 * squares) / draws);
}

TEST(RockSizesTest, LevelsHoldTheProductLaw) {
  const Figures f = poisson_rock_figures(9, 0, 400, 0.9999);
  ASSERT_TRUE(f.block_sizes.has_value());
  const BlockSizeFigures& sizes = *f.block_sizes;
  EXPECT_TRUE(sizes.corrected);
  EXPECT_GT(sizes.mean_weight, 1.2);
  for (std::size_t i = 0; i < size_levels.size(); ++i) {
    EXPECT_TRUE(holds(sizes.by_number[i], poisson_rock_truth().by_number.at(i))) << size_levels.at(i).first;
    EXPECT_TRUE(holds(sizes.by_volume[i], poisson_rock_truth().by_volume.at(i))) << size_levels.at(i).first;
    // Not so wide that it would hold anything: the standard error of the mean logarithm of three gaps, 8 of each a
    // realization, is sqrt(3 * 1.64/3200) = 0.039, so that the ends of the median are 8 * 0.039 apart, a factor 1.36.
    if (i == 5) {
      EXPECT_LT(*sizes.by_number[i].high, 1.5 * *sizes.by_number[i].low);
    }
  }
  ASSERT_EQ(f.sets.size(), 3U);
  EXPECT_EQ(f.sets[2].name, "level");
  for (const SetEstimates& set : f.sets) {
    EXPECT_LT(set.p32.low, 1);
    EXPECT_GT(set.p32.high, 1);
    EXPECT_NEAR(set.joints.mean, 9, 0.7);
  }
  EXPECT_LT(f.jv->low, 3);
  EXPECT_GT(f.jv->high, 3);
}

// Large blocks touch a side more often: counted once each they are too few, and the intervals would not say so.
TEST(RockSizesTest, WithoutTheCorrectionSizesAreTooSmall) {
  const Figures plain = poisson_rock_figures(5, 0, 400, 0.9999, false),
                mended = poisson_rock_figures(5, 0, 400, 0.9999);
  for (const std::size_t i : {5U, 10U}) {
    const double by_number = poisson_rock_truth().by_number.at(i), by_volume = poisson_rock_truth().by_volume.at(i);
    EXPECT_LT(*plain.block_sizes->by_number[i].high, by_number);
    EXPECT_LT(*plain.block_sizes->by_volume[i].high, by_volume);
    EXPECT_TRUE(holds(mended.block_sizes->by_number[i], by_number));
  }
}

TEST(RockSizesTest, IntervalsCover) {
  constexpr int samples = 300;
  std::array<int, size_levels.size()> by_number{}, by_volume{};
  int p32 = 0, open = 0;
  for (int k = 0; k < samples; ++k) {
    const Figures f = poisson_rock_figures(8, 1 + static_cast<std::uint64_t>(k), 60);
    for (std::size_t i = 0; i < size_levels.size(); ++i) {
      by_number.at(i) += covers(f.block_sizes->by_number[i], poisson_rock_truth().by_number.at(i)) ? 1 : 0;
      by_volume.at(i) += covers(f.block_sizes->by_volume[i], poisson_rock_truth().by_volume.at(i)) ? 1 : 0;
    }
    for (const SizeLevel& level : f.block_sizes->by_volume) open += level.low && level.high ? 0 : 1;
    p32 += f.sets[0].p32.low <= 1 && 1 <= f.sets[0].p32.high ? 1 : 0;
  }
  const double least = samples * 0.95 - 3 * std::sqrt(samples * 0.95 * 0.05);
  for (std::size_t i = 0; i < size_levels.size(); ++i) {
    EXPECT_GE(by_number.at(i), least) << size_levels.at(i).first;
    EXPECT_GE(by_volume.at(i), least) << size_levels.at(i).first;
  }
  EXPECT_GE(p32, least);
  // Not by leaving ends open.
  EXPECT_LT(open, samples * static_cast<int>(size_levels.size()) / 20);
}

// In a box of six spacings 5 % of the volume lies in blocks longer than the box, which no correction gives back.
TEST(RockSizesTest, SaysWhereIntervalsMayCoverLess) {
  const Figures small = poisson_rock_figures(6, 0, 20), large = poisson_rock_figures(12, 0, 20);
  EXPECT_LT(small.block_sizes->measured_share, 0.5);
  EXPECT_GT(large.block_sizes->measured_share, 0.5);
  for (std::size_t i = 0; i < size_levels.size(); ++i) {
    EXPECT_TRUE(small.block_sizes->by_volume[i].optimistic);
    EXPECT_FALSE(large.block_sizes->by_volume[i].optimistic);
    EXPECT_FALSE(small.block_sizes->by_number[i].optimistic);
  }
}

TEST(RockSizesTest, WhatCannotBeToldIsNot) {
  EXPECT_FALSE(poisson_rock_figures(8, 0, 1).block_sizes.has_value());
  Ensemble without{support::poisson_rock_options()};
  for (std::uint64_t k = 0; k < 3; ++k) {
    Record r;
    r.realization = k;
    without.add(r, "");
  }
  EXPECT_FALSE(without.figures().block_sizes.has_value());
  EXPECT_TRUE(without.figures().sets.empty());
  EXPECT_FALSE(without.figures().jv.has_value());
  // Two realizations say next to nothing of the tails.
  const Figures two = poisson_rock_figures(4, 0, 2);
  ASSERT_TRUE(two.block_sizes.has_value());
  EXPECT_FALSE(two.block_sizes->by_number[10].high.has_value());
}

TEST(RockSizesTest, RealizationsAreOneSampleEach) {
  Ensemble ensemble{support::poisson_rock_options()};
  double sum = 0;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const Record r = poisson_rock(6, 3, k);
    sum += r.sizes->by_number[5];
    ensemble.add(r, "");
  }
  const SizeLevel& median = ensemble.figures().block_sizes->by_number[5];
  EXPECT_EQ(median.name, "p50");
  EXPECT_EQ(median.alone.realizations, 20U);
  EXPECT_NEAR(median.alone.mean, sum / 20, 1e-12);
  EXPECT_LT(median.alone.low, median.alone.mean);
}

// What bends the sizes is said.
TEST(RockSizesTest, NotesSayWhatIsLeftOut) {
  EnsembleOptions options = support::poisson_rock_options();
  options.box_domain = false;
  Ensemble ensemble{options};
  for (std::uint64_t k = 0; k < 5; ++k) {
    Record r = poisson_rock(6, 3, k, false);
    r.sizes->at_openings_m3 = r.sizes->volume_m3;
    ensemble.add(r, "");
  }
  const Figures f = ensemble.figures();
  const auto said = [&](std::string_view what) {
    return std::ranges::any_of(f.notes, [&](const std::string& note) { return note.contains(what); });
  };
  EXPECT_FALSE(f.block_sizes->corrected);
  EXPECT_DOUBLE_EQ(f.block_sizes->at_openings_share, 0.5);
  EXPECT_TRUE(said("the domain is no box"));
  EXPECT_TRUE(said("50 % of the rock that no side"));
}

}  // namespace
}  // namespace cleave::stochastic
