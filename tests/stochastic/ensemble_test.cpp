#include "cleave/stochastic/ensemble.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/stochastic/statistics.hpp"

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

// The alarm that the domain is too small goes by area: it does not ring where little is held, and says how long the
// tunnel should be where the ends are.
TEST(EnsembleTest, AreaAtTheEndsTellsTheGuardLength) {
  const auto figures_of = [](double fixed, double middle_fixed) {
    Ensemble ensemble{options()};  // 50 m of tunnel
    for (std::uint64_t k = 0; k < 3; ++k) {
      Record r = record(k, {2});
      r.surface_blocks = 100;
      r.surface_blocks_fixed = 90;
      r.free_m2 = 1000;
      r.free_fixed_m2 = fixed;
      r.middle_m2 = 500;
      r.middle_fixed_m2 = middle_fixed;
      ensemble.add(r, "x");
    }
    return ensemble.figures();
  };
  const auto said = [](const Figures& f, std::string_view what) {
    return std::ranges::any_of(f.notes, [&](const std::string& note) { return note.contains(what); });
  };
  EXPECT_FALSE(said(figures_of(90, 0), "fixed sides of the domain"));
  const Figures ends = figures_of(240, 0);  // six metres at each end
  EXPECT_DOUBLE_EQ(ends.free_area_fixed_share.value(), 0.24);
  EXPECT_DOUBLE_EQ(ends.guard_length_m.value(), 6);
  EXPECT_TRUE(said(ends, "about 6 m at each end of the tunnel are lost"));
  EXPECT_TRUE(said(ends, "120 m long"));
  const Figures sides = figures_of(300, 150);
  EXPECT_DOUBLE_EQ(sides.guard_length_m.value(), 0);
  EXPECT_TRUE(said(sides, "more room to the sides"));
}

TEST(EnsembleTest, FactorsAndPressuresAreDistributed) {
  Ensemble ensemble{options()};
  for (std::uint64_t k = 0; k < 4; ++k) {
    Record r = record(k, k == 0 ? std::vector<double>{} : std::vector<double>{2});
    r.free_m2 = 200;
    r.all.support_transferred_n = 1000.0 * static_cast<double>(k);
    r.largest_pressure_pa = static_cast<double>(k);
    r.factors.resize(factor_bins);
    r.factors[0] = 1;                // below 0.1
    r.factors[9] = k;                // 0.9 to 1
    r.factors[factor_bins - 1] = 2;  // 3 and more
    ensemble.add(r, "x");
  }
  const Figures f = ensemble.figures();
  EXPECT_DOUBLE_EQ(find(f, "probability_of_failure").mean, 0.75);
  EXPECT_DOUBLE_EQ(find(f, "support_pressure_pa").mean, 7.5);
  EXPECT_DOUBLE_EQ(find(f, "largest_support_pressure_pa").mean, 1.5);
  ASSERT_EQ(f.factors.size(), factor_bins - 1);
  EXPECT_DOUBLE_EQ(f.factors[0].factor, 0.1);
  EXPECT_DOUBLE_EQ(f.factors[0].share_below, 4.0 / 18);
  EXPECT_DOUBLE_EQ(f.factors[9].share_below, 10.0 / 18);
  EXPECT_DOUBLE_EQ(f.factors.back().share_below, 10.0 / 18);
  EXPECT_DOUBLE_EQ(f.factors[9].number_below, 2.5);
  // All four realizations have a block below 0.1; the share has the interval of a share of blocks.
  EXPECT_DOUBLE_EQ(f.factors[0].probability, 1);
  EXPECT_DOUBLE_EQ(f.factors[0].interval.low, clopper_pearson(4, 4, f.confidence).low);
  EXPECT_LT(f.factors[0].share_interval.low, 4.0 / 18);
  EXPECT_GT(f.factors[0].share_interval.high, 4.0 / 18);
  EXPECT_LT(f.factors[0].share_interval.high, 1);
}

// The least factor of a realization and the pressures it needs are exceeded as often as they are, with exact intervals.
TEST(EnsembleTest, LeastFactorAndPressuresAreExceededAsOftenAsTheyAre) {
  Ensemble ensemble{options()};
  for (std::uint64_t k = 0; k < 10; ++k) {
    Record r = record(k, {2});
    r.free_m2 = 100;
    r.all.support_transferred_n = k < 3 ? 30'000 : 100'000;  // 300 Pa, 1 kPa
    r.largest_pressure_pa = k < 6 ? 3e3 : 3e4;
    r.factors.resize(factor_bins);
    ++r.factors[k < 7 ? 5 : 12];  // 0.5 to 0.6, 1.2 to 1.3
    ensemble.add(r, "x");
  }
  const Figures f = ensemble.figures();
  const auto at = [&](double factor) {
    return *std::ranges::find_if(f.factors, [&](const FactorPoint& p) { return std::abs(p.factor - factor) < 1e-9; });
  };
  EXPECT_DOUBLE_EQ(at(0.5).probability, 0);
  EXPECT_DOUBLE_EQ(at(0.6).probability, 0.7);
  EXPECT_DOUBLE_EQ(at(1.3).probability, 1);
  EXPECT_DOUBLE_EQ(at(0.6).interval.low, clopper_pearson(7, 10, f.confidence).low);
  EXPECT_DOUBLE_EQ(at(0.6).interval.high, clopper_pearson(7, 10, f.confidence).high);
  // From the last that all exceed to the first that none does.
  std::vector<double> pressures, areas, blocks;
  for (const PressureExceedance& row : f.pressures) {
    pressures.push_back(row.pressure.si());
    areas.push_back(row.probability.value());
    blocks.push_back(row.block_probability);
  }
  EXPECT_EQ(pressures, (std::vector<double>{200, 500, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4}));
  EXPECT_EQ(areas, (std::vector<double>{1, 0.7, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(blocks, (std::vector<double>{1, 1, 1, 1, 0.4, 0.4, 0.4, 0}));
  EXPECT_DOUBLE_EQ(f.pressures[1].interval->high, clopper_pearson(7, 10, f.confidence).high);
}

// Without excavations there is no area that a pressure would be over: none is said, not 0. With one and no key block it
// is 0.
TEST(EnsembleTest, NoPressureOverAreaWithoutExcavations) {
  EnsembleOptions slope = options();
  slope.openings = false;
  Ensemble bare{slope}, opened{options()};
  for (std::uint64_t k = 0; k < 3; ++k) {
    Record r = record(k, {2});
    r.largest_pressure_pa = 150;
    bare.add(r, "x");
    Record none = record(k, {});
    none.free_m2 = 10;
    opened.add(none, "x");
  }
  const Figures f = bare.figures(), zero = opened.figures();
  const auto of_area = [](const auto& row) { return row.name == "support_pressure_pa"; };
  EXPECT_TRUE(std::ranges::none_of(f.estimates, of_area));
  EXPECT_TRUE(std::ranges::none_of(f.quantiles, of_area));
  EXPECT_DOUBLE_EQ(find(f, "largest_support_pressure_pa").mean, 150);
  ASSERT_EQ(f.pressures.size(), 2U);  // 100 Pa, which all blocks exceed, and 200 Pa
  for (const PressureExceedance& row : f.pressures) {
    EXPECT_FALSE(row.probability.has_value());
    EXPECT_FALSE(row.interval.has_value());
  }
  EXPECT_EQ(f.pressures[0].block_probability, 1);
  EXPECT_FALSE(f.free_area_fixed_share.has_value());
  const auto said = [](const Figures& of) {
    return std::ranges::count_if(of.notes, [](const std::string& note) { return note.starts_with("no opening over"); });
  };
  EXPECT_EQ(said(f), 1);
  EXPECT_EQ(find(zero, "support_pressure_pa").mean, 0);
  EXPECT_EQ(zero.pressures.at(0).probability, 0);
  EXPECT_EQ(zero.free_area_fixed_share, 0);
  EXPECT_EQ(said(zero), 0);
}

// The mean volume of all blocks is a mean over realizations, not a ratio of sums.
TEST(EnsembleTest, MeanVolumesOfBlocksAreAveragedOverRealizations) {
  Ensemble ensemble{options()};
  for (const std::uint64_t blocks : {10U, 100U}) {
    Record r = record(0, {});
    r.blocks = blocks;
    ensemble.add(r, "x");
  }
  const Figures f = ensemble.figures();
  EXPECT_DOUBLE_EQ(find(f, "block_mean_volume_m3").mean, (500 + 50) / 2.0);
  EXPECT_EQ(find(f, "block_mean_volume_m3").method, Method::mean);
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
  Tail tail;
  for (const double v : {6, 0, 12, 1}) tail.add(v);
  const Interval moved = with_tail(skew_interval(volume.mean, volume.standard_error, volume.skewness, 4, 0.95, 0.5),
                                   volume.mean, tail, 4, 0.95);
  EXPECT_DOUBLE_EQ(volume.high, moved.high);
  EXPECT_EQ(volume.low, std::max(0.0, moved.low));
  // No realization in which they lift is not a share of 0 for certain: three of four have blocks, 2 + 1 + 2 of them.
  EXPECT_EQ(find(f, "share_lifting").mean, 0);
  EXPECT_EQ(find(f, "share_lifting").low, 0);
  EXPECT_NEAR(find(f, "share_lifting").high, clopper_pearson_effective(0, 25.0 / 9, 0.95).high, 1e-12);
  EXPECT_NEAR(find(f, "probability_of_failure").low, clopper_pearson(3, 4, 0.95).low, 1e-9);
  EXPECT_NEAR(find(f, "probability_of_failure").high, clopper_pearson(3, 4, 0.95).high, 1e-9);
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

/// Blocks of 1 and of 10 m3, which start the bins 48 and 56.
Record sized_record(std::uint64_t k, float ones, float tens) {
  Record r = record(k, {2});
  r.whole = WholeBlocks{static_cast<std::uint64_t>(ones + tens),
                        cubic_metres(static_cast<double>(ones + 10 * tens)),
                        {static_cast<double>(ones), static_cast<double>(tens), 0, 0},
                        {{48, ones, ones}, {56, tens, 10 * tens}}};
  r.rock_m3 = 100;
  r.sets = {{k, 0.5, 0.25, 0.125 * static_cast<double>(k)}, {7, 1, 2, 3}};
  return r;
}

// 40 blocks of 1 m3 and 10 of 10 m3 in two realizations of 100 m3.
TEST(EnsembleTest, BlockSizesByHand) {
  EnsembleOptions with = options();
  with.sets = {"a", "b"};
  with.size_levels = {0.4, 0.8, 0.9};
  Ensemble ensemble{with};
  ensemble.add(sized_record(0, 30, 5), "x");
  EXPECT_FALSE(ensemble.figures().block_sizes->by_number[0].high.has_value());  // one realization has no interval
  ensemble.add(sized_record(1, 10, 5), "y");
  const Figures f = ensemble.figures();
  const BlockSizeFigures& sizes = *f.block_sizes;
  EXPECT_EQ(sizes.blocks, 50U);
  EXPECT_FALSE(sizes.corrected);
  EXPECT_DOUBLE_EQ(sizes.mean_volume.mean, 140.0 / 50);
  EXPECT_DOUBLE_EQ(sizes.met_share.mean, 140.0 / 200);
  EXPECT_DOUBLE_EQ(sizes.shapes[0].mean, 0.8);
  EXPECT_EQ(sizes.shapes[1].name, "platy");
  EXPECT_DOUBLE_EQ(sizes.shapes[1].mean, 0.2);
  // Within the bin from 1 m3 on, half of its share is reached at the middle of its logarithm.
  EXPECT_NEAR(sizes.by_number[0].volume_m3, std::pow(10.0, 1.0 / 16), 1e-12);
  EXPECT_NEAR(sizes.by_number[1].volume_m3, std::pow(10.0, 1.0 / 8), 1e-12);
  EXPECT_NEAR(sizes.by_number[2].volume_m3, std::pow(10.0, 1 + 1.0 / 16), 1e-12);
  // By volume 40 of 140 m3 lie in the small ones.
  EXPECT_NEAR(sizes.by_volume[0].volume_m3, std::pow(10.0, 1 + (0.4 - 40.0 / 140) / (100.0 / 140) / 8), 1e-12);
  for (const SizeLevel& level : sizes.by_number) {
    ASSERT_TRUE(level.low.has_value());
    EXPECT_LE(*level.low, level.volume_m3);
    EXPECT_GE(level.high.value_or(INFINITY), level.volume_m3);
  }
  ASSERT_EQ(f.sets.size(), 2U);
  EXPECT_EQ(f.sets[0].name, "a");
  EXPECT_DOUBLE_EQ(f.sets[0].joints.mean, 0.5);
  EXPECT_DOUBLE_EQ(f.sets[0].p21.mean, 0.0625);
  EXPECT_DOUBLE_EQ(f.sets[1].p32.mean, 1);
  EXPECT_DOUBLE_EQ(f.jv->mean, 2.25);
}

// Where two draws of strengths share a geometry, its blocks count once for both in shares, means and sets.
TEST(EnsembleTest, BlockSizesOfANestedDesign) {
  EnsembleOptions with = options();
  with.sets = {"a", "b"};
  with.size_levels = {0.5};
  Ensemble plain{with};
  with.strengths_per_geometry = 2;
  Ensemble nested{with};
  for (const float tens : {5.0F, 3.0F, 8.0F}) {
    plain.add(sized_record(2, 30, tens), "x");
    for (int draw = 0; draw < 2; ++draw) nested.add(sized_record(2, 30, tens), "x");
  }
  const Figures a = plain.figures(), b = nested.figures();
  EXPECT_DOUBLE_EQ(b.block_sizes->mean_volume.low, a.block_sizes->mean_volume.low);
  EXPECT_DOUBLE_EQ(b.block_sizes->by_volume[0].volume_m3, a.block_sizes->by_volume[0].volume_m3);
  EXPECT_DOUBLE_EQ(b.sets[0].joints.mean, 2);
  EXPECT_DOUBLE_EQ(b.jv->mean, 2.25);
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
  for (std::uint64_t k = 0; k < 60; ++k) {  // a third of the realizations has a block
    heavy.add(record(k, k % 3 == 0 ? std::vector<double>{std::exp(2 * rng.normal())} : std::vector<double>{}), "h");
    light.add(record(k, {10 + rng.uniform()}), "l");
  }
  const Figures h = heavy.figures(), l = light.figures();
  const Estimate& volume = find(h, "key_block_volume_m3");
  EXPECT_TRUE(volume.optimistic);
  ASSERT_TRUE(volume.bootstrap.has_value());
  EXPECT_GT(volume.high, volume.mean + 2.0 * volume.standard_error);
  EXPECT_LE(volume.bootstrap->low, volume.low);
  EXPECT_GE(volume.bootstrap->high, volume.high);
  EXPECT_GE(volume.low, 0);
  EXPECT_TRUE(std::ranges::any_of(h.notes, [](const std::string& n) { return n.contains("optimistic"); }));
  EXPECT_FALSE(find(l, "key_block_volume_m3").optimistic);
  EXPECT_FALSE(find(l, "key_block_volume_m3").bootstrap.has_value());
}

// A lognormal tail seen in few realizations has no end; the rock has.
TEST(EnsembleTest, NoMeanOfVolumesIsAboveTheRockThereIs) {
  EnsembleOptions bounded = options();
  bounded.rock = Volume::from_si(5000);
  Ensemble free{options()}, ends{bounded};
  const auto add = [](Ensemble& ensemble) {
    std::uint64_t k = 0;
    for (const double volume : {0.002, 0.001, 300.0, 0.004, 2000.0}) ensemble.add(record(k++, {volume}), "r");
  };
  add(free);
  add(ends);
  const Figures f = free.figures(), e = ends.figures();
  for (const std::string_view name : {"key_block_volume_m3", "key_block_largest_m3", "key_block_mean_volume_m3",
                                      "key_block_mean_volume_per_realization_m3"}) {
    EXPECT_GT(find(f, name).high, 5000) << name;
    EXPECT_EQ(find(e, name).high, 5000) << name;
    EXPECT_EQ(find(e, name).low, find(f, name).low) << name;
  }
  EXPECT_EQ(find(e, "support_force_n").high, find(f, "support_force_n").high);
  EXPECT_GT(find(f, "key_block_volume_m3_per_metre").high, 5000.0 / 50);
  EXPECT_EQ(find(e, "key_block_volume_m3_per_metre").high, 5000.0 / 50);
}

// So of the forces that its blocks lack, where nothing but weight and earthquakes pulls at them.
TEST(EnsembleTest, NoMeanOfForcesIsAboveWhatPullsAtAllRock) {
  EnsembleOptions bounded = options();
  bounded.cases = {"quake", "water"};
  EnsembleOptions known = bounded;
  known.pull = newtons(5000);
  known.cases_pull = {newtons(6000), std::nullopt};
  Ensemble free{bounded}, ends{known};
  const auto add = [](Ensemble& ensemble) {
    std::uint64_t k = 0;
    for (const double force : {0.002, 0.001, 300.0, 0.004, 2000.0}) {
      Record r = record(k++, {1});
      r.all.support_n = r.first.support_n = force;
      r.cases.resize(2);
      for (CaseTally& c : r.cases) c.net = newtons(force);
      ensemble.add(r, "r");
    }
  };
  add(free);
  add(ends);
  const Figures f = free.figures(), e = ends.figures();
  for (const std::string_view name : {"support_force_n", "first_batch_support_force_n"}) {
    EXPECT_GT(find(f, name).high, 6000) << name;
    EXPECT_EQ(find(e, name).high, 5000) << name;
  }
  EXPECT_EQ(find(e, "support_force_n_per_metre").high, 5000.0 / 50);
  const auto high = [](const Figures& figures, std::size_t k) {
    return std::ranges::find(figures.cases[k].estimates, "support_force_n", &Estimate::name)->high;
  };
  EXPECT_EQ(high(e, 0), 6000);
  EXPECT_EQ(high(e, 1), high(f, 1));
  EXPECT_GT(high(e, 1), 6000);
  known.cases.clear();
  known.cases_pull.clear();
  Ensemble none{known};
  for (std::uint64_t k = 0; k < 30; ++k) none.add(record(k, {}), "n");
  const double met = 1 - std::pow(0.025, 1.0 / 30);
  EXPECT_NEAR(find(none.figures(), "support_force_n").high, 5000 * met, 1e-5);
}

// A mean of nothing but zeros has no interval of its own: of volumes the chance to meet one bounds it, of what has no
// largest size nothing does.
TEST(EnsembleTest, WhatNoRealizationHasMayBeMetAllTheSame) {
  EnsembleOptions bounded = options();
  bounded.rock = Volume::from_si(5000);
  Ensemble none{bounded}, one{bounded};
  for (std::uint64_t k = 0; k < 30; ++k) {
    none.add(record(k, {}), "n");
    one.add(record(k, k == 3 ? std::vector<double>{2} : std::vector<double>{}), "o");
  }
  const Figures f = none.figures(), some = one.figures();
  const double met = 1 - std::pow(0.025, 1.0 / 30);
  EXPECT_NEAR(find(f, "probability_of_failure").high, met, 1e-9);
  for (const std::string_view name : {"key_block_volume_m3", "key_block_largest_m3"}) {
    EXPECT_EQ(find(f, name).low, 0) << name;
    EXPECT_NEAR(find(f, name).high, 5000 * met, 1e-5) << name;
  }
  EXPECT_EQ(find(f, "key_block_count").high, std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::ranges::find(f.estimates, "key_block_mean_volume_per_realization_m3", &Estimate::name),
            f.estimates.end());
  const auto says = [](const Figures& figures, std::string_view name) {
    return std::ranges::any_of(figures.notes, [&](const std::string& n) {
      return n.starts_with("seen in none of 30 samples") && n.contains(name);
    });
  };
  EXPECT_TRUE(says(f, "key_block_count"));
  EXPECT_FALSE(says(f, "block_mean_volume"));
  EXPECT_FALSE(says(some, "key_block_count"));
  // What no load can lift is known to be 0.
  EXPECT_TRUE(says(f, "lifted_count"));
  bounded.lifts = false;
  bounded.cases = {"dry", "wet"};
  bounded.cases_lift = {false, true};
  Ensemble dry{bounded};
  for (std::uint64_t k = 0; k < 30; ++k) {
    Record r = record(k, {});
    r.cases.resize(2);
    dry.add(r, "d");
  }
  const Figures without = dry.figures();
  EXPECT_FALSE(says(without, "lifted_count"));
  EXPECT_TRUE(says(without, "key_block_count"));
  EXPECT_EQ(find(without, "lifted_count").high, 0);
  const auto under = [&](std::size_t load) {
    return std::ranges::find(without.cases.at(load).estimates, "lifted_count", &Estimate::name)->high;
  };
  EXPECT_EQ(under(0), 0);
  EXPECT_EQ(under(1), std::numeric_limits<double>::infinity());
  EXPECT_LT(find(some, "key_block_count").high, 1);
}

// The largest pressure on a block hangs on the thinnest sliver met: its mean is no figure to go by, and says so.
TEST(EnsembleTest, MeansOverSliversAreNotEstimable) {
  Ensemble slivers{options()}, none{options()};
  for (std::uint64_t k = 0; k < 30; ++k) {
    Record r = record(k, {2});
    r.largest_pressure_pa = 1e3 * static_cast<double>(k + 1);
    slivers.add(r, "s");
    none.add(record(k, {}), "n");
  }
  const auto says = [](const Figures& f) {
    return std::ranges::any_of(f.notes, [](const std::string& n) {
      return n.starts_with("largest_support_pressure_pa has no mean that realizations would show");
    });
  };
  const Figures s = slivers.figures(), n = none.figures();
  EXPECT_FALSE(find(s, "largest_support_pressure_pa").estimable);
  EXPECT_TRUE(find(s, "largest_support_pressure_pa").optimistic);
  EXPECT_TRUE(find(s, "support_pressure_pa").estimable);
  EXPECT_TRUE(says(s));
  EXPECT_TRUE(find(n, "largest_support_pressure_pa").estimable);
  EXPECT_FALSE(says(n));
}

// A share is of the same shapes whether of all batches or of the first.
TEST(EnsembleTest, SharesOfTheFirstBatchAreOfTheSameShapes) {
  Ensemble ensemble{options()};
  for (std::uint64_t k = 0; k < 4; ++k) {
    Record r = record(k, {1, 2, 3, 4, 5});
    r.all.shapes = {1, 1, 1, 1, 1};
    r.first.shapes = r.all.shapes;
    ensemble.add(r, "s");
  }
  const Figures f = ensemble.figures();
  for (const std::string_view shape : shape_names) {
    const std::string name = "share_" + std::string{shape};
    EXPECT_DOUBLE_EQ(find(f, "first_batch_" + name).mean, 0.2) << name;
    EXPECT_DOUBLE_EQ(find(f, name).mean, 0.2) << name;
  }
}

// The running mean with its band is that of the first n realizations, ever further apart, and ends with all of them.
TEST(EnsembleTest, RunningMeansAreThoseOfTheFirstRealizations) {
  Ensemble ensemble{options()};
  Rng rng{5};
  std::vector<double> volumes;
  for (std::uint64_t k = 0; k < 203; ++k) {
    volumes.push_back(rng.uniform());
    ensemble.add(record(k, {volumes.back()}), "r");
  }
  const Figures f = ensemble.figures();
  ASSERT_GT(f.running.size(), 20U);
  EXPECT_EQ(f.running_quantity, "key_block_volume_m3");
  EXPECT_EQ(f.running.front().realizations, 10U);
  EXPECT_EQ(f.running.back().realizations, 203U);
  std::uint64_t before = 0;
  for (const RunningPoint& p : f.running) {
    EXPECT_GT(p.realizations, before);
    before = p.realizations;
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < p.realizations; ++k) sum += volumes[k];
    const auto n = static_cast<double>(p.realizations);
    for (std::size_t k = 0; k < p.realizations; ++k) squares += std::pow(volumes[k] - sum / n, 2);
    const double error = std::sqrt(squares / (n - 1) / n);
    EXPECT_NEAR(p.mean, sum / n, 1e-12);
    EXPECT_NEAR(p.half_width, sum / n - t_interval(sum / n, error, p.realizations, 0.95).low, 1e-12);
  }
}

// Realizations with many key blocks that have larger ones, batches that were not all taken away: said where they are,
// and only there.
TEST(EnsembleTest, WhatBiasesTheFiguresIsNoted) {
  const auto says = [](const Ensemble& ensemble, std::string_view words) {
    const Figures f = ensemble.figures();
    return std::ranges::any_of(f.notes, [&](const std::string& n) { return n.contains(words); });
  };
  Ensemble unequal{options()}, equal{options()};
  for (std::uint64_t k = 0; k < 40; ++k) {
    unequal.add(k % 2 == 0 ? record(k, {1}) : record(k, {9, 9, 9, 9}), "u");
    Record stopped = k % 2 == 0 ? record(k, {2}) : record(k, {2, 2, 2, 2});
    stopped.stopped_at_max_batches = k == 3;
    stopped.free_m2 = 10;
    stopped.free_fixed_m2 = 2;
    equal.add(stopped, "e");
  }
  EXPECT_TRUE(says(unequal, "7.4 m3 as ratio of sums, 5 m3 as mean over realizations"));
  EXPECT_FALSE(says(equal, "as ratio of sums"));
  EXPECT_TRUE(says(equal, "1 of 40 realizations stopped at max_batches"));
  EXPECT_FALSE(says(unequal, "stopped at max_batches"));
  EXPECT_TRUE(
      says(equal, "20.0 % of the area of excavations belongs to blocks that only fixed sides of the domain hold"));
  EXPECT_FALSE(says(unequal, "fixed sides"));
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

// Three geometries with two strengths each, by hand: volumes (2, 4), (12, 14), (0, 0).
TEST(EnsembleTest, NestedDesignsCountGeometries) {
  EnsembleOptions nested = options();
  nested.strengths_per_geometry = 2;
  Ensemble ensemble{nested};
  ensemble.add(record(0, {2}), "a");
  ensemble.add(record(1, {4}), "b");
  ensemble.add(record(2, {12}), "c");
  ensemble.add(record(3, {14}), "d");
  ensemble.add(record(4, {}), "e");
  ensemble.add(record(5, {}), "f");
  const Figures f = ensemble.figures();
  EXPECT_EQ(f.realizations, 6U);
  const Estimate& volume = find(f, "key_block_volume_m3");
  EXPECT_EQ(volume.realizations, 3U);
  EXPECT_DOUBLE_EQ(volume.mean, 16.0 / 3);
  const double s2 = (std::pow(3 - 16.0 / 3, 2) + std::pow(13 - 16.0 / 3, 2) + std::pow(16.0 / 3, 2)) / 2;
  EXPECT_NEAR(volume.standard_error, std::sqrt(s2 / 3), 1e-12);
  const auto share = std::ranges::find(f.variances, "key_block_volume_m3", &VarianceShare::name);
  ASSERT_NE(share, f.variances.end());
  EXPECT_NEAR(share->strength, (2 + 2 + 0) / 3.0, 1e-12);
  EXPECT_NEAR(share->geometry, s2 - share->strength / 2, 1e-12);
  EXPECT_DOUBLE_EQ(find(f, "key_block_mean_volume_m3").mean, 32.0 / 4);
  // Two of three geometries have a block above 1 m3, both of their draws: 4 of 6, but no more than 3 independent
  // trials.
  EXPECT_DOUBLE_EQ(f.exceedances[0].probability, 4.0 / 6);
  EXPECT_EQ(f.exceedances[0].realizations, 4U);
  EXPECT_NEAR(f.exceedances[0].interval.low, clopper_pearson(2, 3, 0.95).low, 1e-9);
  EXPECT_NEAR(f.exceedances[0].interval.high, clopper_pearson(2, 3, 0.95).high, 1e-9);
  // Quantiles are of independent values: the first draw of each geometry.
  const auto median = std::ranges::find_if(
      f.quantiles, [](const QuantileEstimate& e) { return e.name == "key_block_volume_m3" && e.p == 0.5; });
  EXPECT_DOUBLE_EQ(median->value, 2);
  EXPECT_EQ(f.worst.front().realization, 3U);
}

// 95 % intervals of a nested design hold the mean, and the two variances come back; taking the draws for independent
// would cover far less. Volumes e^(g + s/2), g and s normal; 300 ensembles of 40 geometries with 5 strengths each.
TEST(EnsembleTest, NestedIntervalsCover) {
  EnsembleOptions nested = options();
  nested.strengths_per_geometry = 5;
  int covers = 0;
  Moments geometry, strength;
  for (std::uint64_t r = 0; r < 300; ++r) {
    Ensemble ensemble{nested};
    Rng rng{{.seed = 5, .realization = r}};
    for (std::uint64_t g = 0; g < 40; ++g) {
      const double centre = 20 + 3 * rng.normal();
      for (std::uint64_t j = 0; j < 5; ++j) ensemble.add(record(5 * g + j, {centre + 2 * rng.normal()}), "");
    }
    const Figures f = ensemble.figures();
    const Estimate& volume = find(f, "key_block_volume_m3");
    covers += volume.low <= 20 && 20 <= volume.high ? 1 : 0;
    const auto share = std::ranges::find(f.variances, "key_block_volume_m3", &VarianceShare::name);
    geometry.add(share->geometry);
    strength.add(share->strength);
  }
  EXPECT_NEAR(covers, 285, 4 * std::sqrt(300 * 0.95 * 0.05));
  EXPECT_NEAR(geometry.mean(), 9, 4 * geometry.standard_error());
  EXPECT_NEAR(strength.mean(), 4, 4 * strength.standard_error());
}

// Orders of excavation: paired differences by hand.
TEST(EnsembleTest, OrdersAreComparedWithinEachRealization) {
  EnsembleOptions with_orders = options();
  with_orders.orders = 2;
  Ensemble ensemble{with_orders};
  const std::array<double, 3> first{5, 9, 2}, second{4, 9, 4};
  for (std::uint64_t k = 0; k < 3; ++k) {
    Record r = record(k, {1});
    r.orders = {{2, first[k]}, {k, second[k]}};
    ensemble.add(r, "");
  }
  const Figures f = ensemble.figures();
  ASSERT_EQ(f.orders.size(), 2U);
  EXPECT_DOUBLE_EQ(f.orders[0].key_m3.mean, 16.0 / 3);
  EXPECT_DOUBLE_EQ(f.orders[1].key_blocks.mean, 1);
  EXPECT_DOUBLE_EQ(f.orders[1].key_m3_minus_first.mean, 1.0 / 3);  // -1, 0, 2
  EXPECT_NEAR(f.orders[1].key_m3_minus_first.standard_error, std::sqrt((16 + 1 + 25) / 9.0 / 2 / 3), 1e-12);
  EXPECT_DOUBLE_EQ(f.orders[0].key_m3_minus_first.mean, 0);
  EXPECT_NEAR(f.orders[0].share_best, 0.5, 1e-12);  // of 0, 1/2 (a tie) and 1
  EXPECT_NEAR(f.orders[1].share_best, 0.5, 1e-12);
}

// Load cases: the quantities of each, from the same realizations.
TEST(EnsembleTest, LoadCasesHaveFiguresOfTheirOwn) {
  EnsembleOptions with_cases = options();
  with_cases.cases = {"quake", "blast"};
  with_cases.support = with_cases.at_parts = true;
  with_cases.volumes_m3 = {0.5, 1};
  Ensemble ensemble{with_cases};
  for (std::uint64_t k = 0; k < 4; ++k) {
    Record r = record(k, {});
    CaseTally quake{.count = k,
                    .volume = cubic_metres(2.0 * static_cast<double>(k)),
                    .largest = cubic_metres(1),
                    .net = newtons(5),
                    .support = {},
                    .groups = {},
                    .border = {},
                    .tapered = Staying{2, cubic_metres(3)}};
    quake.support = Supported{.needing = k, .not_held = k / 3};
    quake.border = Staying{7, cubic_metres(1)};
    quake.at_parts = {{k, cubic_metres(3)}, {}, {}, {}};
    r.cases = {quake, {}};
    ensemble.add(r, "");
  }
  const Figures f = ensemble.figures();
  ASSERT_EQ(f.cases.size(), 2U);
  EXPECT_EQ(f.cases[0].name, "quake");
  EXPECT_EQ(f.cases[1].name, "blast");
  const auto of = [&](std::size_t k, std::string_view name) {
    const auto it = std::ranges::find(f.cases[k].estimates, name, &Estimate::name);
    EXPECT_NE(it, f.cases[k].estimates.end()) << name;
    return *it;
  };
  EXPECT_DOUBLE_EQ(of(0, "key_block_count").mean, 1.5);
  EXPECT_DOUBLE_EQ(of(0, "key_block_volume_m3").mean, 3);
  EXPECT_DOUBLE_EQ(of(0, "key_block_largest_m3").mean, 1);
  EXPECT_DOUBLE_EQ(of(0, "support_force_n").mean, 5);
  EXPECT_DOUBLE_EQ(of(0, "domain_held_count").mean, 7);
  EXPECT_DOUBLE_EQ(of(0, "slight_taper_count").mean, 2);
  EXPECT_DOUBLE_EQ(of(0, "slight_taper_volume_m3").mean, 3);
  EXPECT_DOUBLE_EQ(of(0, "support_fails").mean, 0.25);
  const Estimate failing = of(0, "probability_of_failure");
  const Interval exact = clopper_pearson(3, 4, f.confidence);
  EXPECT_DOUBLE_EQ(failing.mean, 0.75);
  EXPECT_DOUBLE_EQ(failing.low, exact.low);
  EXPECT_DOUBLE_EQ(failing.high, exact.high);
  EXPECT_EQ(of(1, "probability_of_failure").mean, 0);
  EXPECT_DOUBLE_EQ(of(0, "probability_of_failure_roof").mean, 0.75);
  EXPECT_DOUBLE_EQ(of(0, "probability_of_failure_roof").low, exact.low);
  EXPECT_DOUBLE_EQ(of(0, "key_block_volume_roof_m3").mean, 3);
  EXPECT_EQ(of(0, "probability_of_failure_walls").mean, 0);
  // The largest block has 1 m3 in every realization.
  ASSERT_EQ(f.cases[0].exceedances.size(), 2U);
  EXPECT_DOUBLE_EQ(f.cases[0].exceedances[0].volume.si(), 0.5);
  EXPECT_DOUBLE_EQ(f.cases[0].exceedances[0].probability, 1);
  EXPECT_DOUBLE_EQ(f.cases[0].exceedances[0].interval.low, clopper_pearson(4, 4, f.confidence).low);
  EXPECT_EQ(f.cases[0].exceedances[1].probability, 0);
  EXPECT_EQ(f.cases[1].exceedances[0].probability, 0);
  // What is given of the base case alone.
  EXPECT_EQ(std::ranges::find(f.cases[0].estimates, "first_batch_count", &Estimate::name), f.cases[0].estimates.end());
}

TEST(EnsembleTest, SupportFiguresOnlyWhereThereIsASupport) {
  EnsembleOptions supported = options();
  supported.support = true;
  Ensemble with{supported}, without{options()};
  Record r = record(0, {1});
  r.support = Supported{.needing = 3, .not_held = 1, .not_held_m3 = 0.5, .missing_n = 1e4};
  Record held = record(1, {1});
  held.support = Supported{.needing = 1};
  Record sound = record(2, {1});
  sound.support = Supported{};
  for (Ensemble* e : {&with, &without}) {
    for (const Record& each : {r, held, sound, sound}) e->add(each, "");
  }
  const Figures f = with.figures(), plain = without.figures();
  EXPECT_DOUBLE_EQ(find(f, "support_blocks_needing").mean, 1);
  EXPECT_DOUBLE_EQ(find(f, "support_needed").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(f, "support_fails").mean, 0.25);
  EXPECT_DOUBLE_EQ(find(f, "support_missing_force_n").mean, 2.5e3);
  EXPECT_TRUE(std::ranges::none_of(plain.estimates, [](const Estimate& e) { return e.name == "support_fails"; }));
  EXPECT_TRUE(
      std::ranges::none_of(f.estimates, [](const Estimate& e) { return e.name == "support_fails_at_a_stage"; }));
  // What fails at the end, or after a stage before it.
  supported.stages = true;
  Ensemble staged{supported};
  r.supported_stages = SupportedStages{.judged = 3};
  held.supported_stages = SupportedStages{.judged = 3, .failing = 2};
  sound.supported_stages = SupportedStages{.judged = 3};
  for (const Record& each : {r, held, sound, sound}) staged.add(each, "");
  const Figures of_stages = staged.figures();
  EXPECT_DOUBLE_EQ(find(of_stages, "support_fails").mean, 0.25);
  EXPECT_DOUBLE_EQ(find(of_stages, "support_fails_at_a_stage").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(of_stages, "support_fails_at_a_stage").low, clopper_pearson(2, 4, of_stages.confidence).low);
}

// By part of the openings: only where there are openings, pressures only with a support.
TEST(EnsembleTest, PartsOfOpeningsHaveFigures) {
  EnsembleOptions asked = options(), cuts = options();
  asked.support = asked.at_parts = cuts.support = true;
  Ensemble with{asked}, without{cuts};
  for (std::uint64_t k = 0; k < 10; ++k) {
    Record r = record(k, {1});
    r.support = Supported{.needing = 1, .pressures = {pascals(1e3 * static_cast<double>(k)), {}, {}, pascals(5)}};
    r.at_parts = {{}, {k / 9, cubic_metres(2)}, {}, {}};
    for (Ensemble* e : {&with, &without}) e->add(r, "");
  }
  const Figures f = with.figures(), plain = without.figures();
  EXPECT_DOUBLE_EQ(find(f, "required_pressure_roof_pa").mean, 4500);
  EXPECT_DOUBLE_EQ(find(f, "required_pressure_faces_pa").mean, 5);
  EXPECT_EQ(find(f, "required_pressure_walls_pa").mean, 0);
  EXPECT_DOUBLE_EQ(find(f, "probability_of_failure_walls").mean, 0.1);
  EXPECT_EQ(find(f, "probability_of_failure_roof").mean, 0);
  EXPECT_DOUBLE_EQ(find(f, "key_block_volume_walls_m3").mean, 2);
  const auto nine_of_ten = std::ranges::find_if(
      f.quantiles, [](const QuantileEstimate& q) { return q.name == "required_pressure_roof_pa" && q.p == 0.9; });
  ASSERT_NE(nine_of_ten, f.quantiles.end());
  EXPECT_DOUBLE_EQ(nine_of_ten->value, 8000);
  EXPECT_DOUBLE_EQ(find(plain, "required_pressure_faces_pa").mean, 5);
  for (const Estimate& e : plain.estimates) {
    EXPECT_FALSE(e.name.contains("roof") || e.name.contains("walls") || e.name.contains("floor")) << e.name;
  }
}

// Joints that hang together and water in them: only where they are asked for.
TEST(EnsembleTest, JointsThatHangTogetherHaveFigures) {
  EnsembleOptions asked = options(), dry = options();
  asked.flow = asked.water = dry.flow = true;
  asked.sides = dry.sides = {"west", "east", "top"};
  Ensemble with{asked}, without{dry}, plain{options()};
  for (std::uint64_t k = 0; k < 20; ++k) {
    Record r = record(k, {1});
    r.flow = FlowTally{
        .clusters = k, .largest_share = 0.5, .opening_share = k == 0 ? 0.1 : 1.0, .backbone_share = k < 5 ? 0.25 : 0.0};
    if (k < 4) r.flow->connected.push_back(pair_of_sides(0, 1));
    if (k < 1) r.flow->connected.push_back(pair_of_sides(1, 2));
    const double inflow = k < 5 ? 1e-6 * static_cast<double>(k) : 0;
    r.flow->water = WaterTally{.inflow = FlowRate::from_si(inflow),
                               .low = FlowRate::from_si(0.9 * inflow),
                               .high = FlowRate::from_si(1.2 * inflow),
                               .wet_share = 0.75,
                               .settled = k != 7};
    for (Ensemble* e : {&with, &without, &plain}) e->add(r, "");
  }
  const Figures f = with.figures();
  EXPECT_DOUBLE_EQ(find(f, "cluster_count").mean, 9.5);
  EXPECT_DOUBLE_EQ(find(f, "largest_cluster_share").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(f, "opening_share").mean, 0.955);
  EXPECT_EQ(find(f, "opening_share").high, 1) << "a share is no more";
  EXPECT_DOUBLE_EQ(find(f, "backbone_share").mean, 0.0625);
  EXPECT_DOUBLE_EQ(find(f, "probability_of_connection").mean, 0.25);
  EXPECT_NEAR(find(f, "inflow_m3_s").mean, 0.5e-6, 1e-20);
  EXPECT_NEAR(find(f, "inflow_low_m3_s").mean, 0.45e-6, 1e-20);
  EXPECT_NEAR(find(f, "inflow_high_m3_s").mean, 0.6e-6, 1e-20);
  EXPECT_DOUBLE_EQ(find(f, "probability_of_inflow").mean, 0.2) << "of five that are connected one has no rate";
  EXPECT_DOUBLE_EQ(find(f, "wet_share").mean, 0.75);
  EXPECT_DOUBLE_EQ(find(f, "inflow_not_settled").mean, 0.05);
  ASSERT_EQ(f.percolation.size(), 3U);
  const Interval four = clopper_pearson(4, 20, 0.95), none = clopper_pearson(0, 20, 0.95);
  EXPECT_EQ(f.percolation[0].from + f.percolation[0].to, "westeast");
  EXPECT_DOUBLE_EQ(f.percolation[0].probability, 0.2);
  EXPECT_DOUBLE_EQ(f.percolation[0].interval.low, four.low);
  EXPECT_DOUBLE_EQ(f.percolation[0].interval.high, four.high);
  EXPECT_EQ(f.percolation[1].from + f.percolation[1].to, "westtop");
  EXPECT_EQ(f.percolation[1].probability, 0);
  EXPECT_DOUBLE_EQ(f.percolation[1].interval.high, none.high);
  EXPECT_DOUBLE_EQ(f.percolation[2].probability, 0.05);
  for (const Estimate& e : without.figures().estimates) EXPECT_FALSE(e.name.contains("inflow")) << e.name;
  EXPECT_EQ(without.figures().percolation.size(), 3U);
  for (const Estimate& e : plain.figures().estimates) EXPECT_FALSE(e.name.contains("cluster")) << e.name;
  EXPECT_TRUE(plain.figures().percolation.empty());
}

// Of many sides only the pairs that some realization connects; a mean share that was never seen has an upper end.
TEST(EnsembleTest, OfManySidesThePairsThatAreConnected) {
  EnsembleOptions asked = options();
  asked.flow = true;
  for (int k = 0; k < 9; ++k) asked.sides.push_back(std::to_string(k));
  Ensemble ensemble{asked};
  for (std::uint64_t k = 0; k < 10; ++k) {
    Record r = record(k, {1});
    r.flow = FlowTally{.clusters = 1, .connected = {pair_of_sides(3, 8)}};
    ensemble.add(r, "");
  }
  const Figures f = ensemble.figures();
  ASSERT_EQ(f.percolation.size(), 1U);
  EXPECT_EQ(f.percolation[0].from + f.percolation[0].to, "38");
  EXPECT_EQ(f.percolation[0].probability, 1);
  EXPECT_DOUBLE_EQ(find(f, "backbone_share").high, clopper_pearson(0, 10, 0.95).high);
}

// What could not be decided is a figure: it counts as stable otherwise.
TEST(EnsembleTest, KeyGroupsAreFiguresWhereTheyDecide) {
  EnsembleOptions deciding = options();
  deciding.groups = true;
  Ensemble with{deciding}, without{options()};
  Record moves = record(0, {1}), doubt = record(1, {}), many = record(2, {}), none = record(3, {});
  moves.groups = Grouped{.moving = 2, .in_doubt = 0, .moving_volume = cubic_metres(5)};
  doubt.groups = Grouped{.in_doubt = 1, .in_doubt_volume = cubic_metres(7)};
  many.groups = Grouped{.too_many = true};
  none.groups = Grouped{};
  for (Ensemble* e : {&with, &without}) {
    for (const Record* r : {&moves, &doubt, &many, &none}) e->add(*r, "");
  }
  const Figures f = with.figures(), plain = without.figures();
  EXPECT_DOUBLE_EQ(find(f, "key_group_count").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(f, "key_group_volume_m3").mean, 1.25);
  EXPECT_DOUBLE_EQ(find(f, "groups_in_doubt_count").mean, 0.25);
  EXPECT_DOUBLE_EQ(find(f, "groups_in_doubt_m3").mean, 1.75);
  EXPECT_DOUBLE_EQ(find(f, "groups_leave_doubt").mean, 0.5);
  EXPECT_TRUE(std::ranges::none_of(plain.estimates, [](const Estimate& e) { return e.name.contains("group"); }));
}

// A realization in which a group is not held fails as one in which a block is not; one in doubt is said.
TEST(EnsembleTest, SupportOfGroupsIsFiguresWhereTheyDecide) {
  EnsembleOptions deciding = options();
  deciding.groups = deciding.support = true;
  EnsembleOptions by_blocks = options();
  by_blocks.support = true;
  Ensemble with{deciding}, without{by_blocks};
  std::array<SupportedTogether, 4> groups;
  groups[0] = {.not_held = 2, .not_held_volume = cubic_metres(6)};
  groups[1] = {.in_doubt = 1};
  groups[2] = {.too_many = true};
  for (std::uint64_t k = 0; k < 4; ++k) {
    Record r = record(k, {1});
    r.groups = Grouped{};
    r.support = Supported{.groups = groups.at(k)};
    for (Ensemble* e : {&with, &without}) e->add(r, "");
  }
  const Figures f = with.figures(), plain = without.figures();
  EXPECT_DOUBLE_EQ(find(f, "support_groups_not_held").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(f, "support_groups_not_held_m3").mean, 1.5);
  EXPECT_DOUBLE_EQ(find(f, "support_leaves_doubt").mean, 0.5);
  EXPECT_DOUBLE_EQ(find(f, "support_fails").mean, 0.25);
  EXPECT_TRUE(
      std::ranges::none_of(plain.estimates, [](const Estimate& e) { return e.name == "support_groups_not_held"; }));
}

}  // namespace
}  // namespace cleave::stochastic
