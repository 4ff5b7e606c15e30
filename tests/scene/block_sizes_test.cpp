#include "cleave/realize/block_sizes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

// Sizes of blocks and how much of each set is in the rock, against boxes by hand and products of exponential gaps.

namespace cleave::scene::test::block_sizes_test {
namespace {

RunResult run_of(const std::string& text) {
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(scene, {.threads = 1}, timer, progress);
  if (!result) {
    for (const Problem& problem : result.error()) ADD_FAILURE() << describe(problem);
  }
  return std::move(result).value();
}

std::string box_of_sides(double x, double y, double z) {
  return fmt::format("schema = 1\n[domain]\nbox = {{ min = [0, 0, 0], max = [{}, {}, {}] }}\n", x, y, z);
}

double level(const Percentiles& p, std::string_view name) { return p.at(name); }

TEST(BlockSizes, PercentilesByHand) {
  const std::vector<double> volumes{4, 1, 2, 3, 90};
  EXPECT_DOUBLE_EQ(level(percentiles_by_number(volumes), "p50"), 3);
  EXPECT_DOUBLE_EQ(level(percentiles_by_number(volumes), "p25"), 2);
  EXPECT_DOUBLE_EQ(level(percentiles_by_number(volumes), "p90"), 4 + 0.6 * 86);
  EXPECT_DOUBLE_EQ(level(percentiles_by_volume(volumes), "p10"), 4);  // 1 + 2 + 3 + 4 of 100
  EXPECT_DOUBLE_EQ(level(percentiles_by_volume(volumes), "p20"), 90);
  EXPECT_DOUBLE_EQ(level(percentiles_by_number({7}), "p90"), 7);
  EXPECT_DOUBLE_EQ(level(percentiles_by_volume({7}), "p10"), 7);
}

TEST(BlockSizes, ShapesByTheAxesOfInertia) {
  const auto shape_of = [](double x, double y, double z) {
    const RunResult result = run_of(box_of_sides(x, y, z));
    const ShapeClasses s = result.figures.blocks->sizes->shapes;
    return s.cubic == 1 ? "cubic" : s.platy == 1 ? "platy" : s.elongated == 1 ? "elongated" : "bladed";
  };
  EXPECT_STREQ(shape_of(3, 3, 3), "cubic");
  EXPECT_STREQ(shape_of(3, 2.1, 2.1), "cubic");
  EXPECT_STREQ(shape_of(3, 1.9, 1.9), "elongated");
  EXPECT_STREQ(shape_of(1.9, 3, 3), "platy");
  EXPECT_STREQ(shape_of(1, 9, 4), "bladed");
}

// Few blocks lie inside: all count, and that is said.
TEST(BlockSizes, AllBlocksWhereFewAreInner) {
  std::string text = box_of_sides(4, 4, 4);
  for (const double z : {1.0, 2.0}) {
    text += fmt::format("[[joint]]\nplane = {{ through = [0, 0, {}], dip = 0, dip_direction = 0 }}\n", z);
  }
  const RunResult result = run_of(text);
  const BlockSizes& sizes = *result.figures.blocks->sizes;
  EXPECT_FALSE(sizes.inner);
  EXPECT_EQ(sizes.count, 3U);
  EXPECT_NEAR(level(sizes.by_number, "p50"), 16, 1e-9);
  EXPECT_NEAR(level(sizes.by_volume, "p75"), 32, 1e-9);
  EXPECT_NEAR(sizes.d50.si(), std::cbrt(16.0), 1e-9);
  EXPECT_NEAR(sizes.d80.si(), std::cbrt(32.0), 1e-9);
  // Two level planes in 4 m: P10 and P32 are 0.5; no trace on a level plane.
  ASSERT_EQ(result.figures.input.sets.size(), 1U);
  EXPECT_NEAR(result.figures.input.sets[0].p32, 0.5, 1e-12);
  EXPECT_NEAR(result.figures.input.sets[0].p10, 0.5, 1e-12);
  EXPECT_NEAR(result.figures.input.sets[0].p21, 0, 1e-12);
  EXPECT_NEAR(result.figures.blocks->sizes->jv, 0.5, 1e-12);
}

// Of a joint that reaches out of the domain the part within it counts, holes not.
TEST(BlockSizes, JointsAreClippedToTheBox) {
  const RunResult result =
      run_of(box_of_sides(4, 4, 4) +
             "[[joint]]\nset = \"up\"\npolygon = [[2, -2, 0.5], [2, 2, 0.5], [2, 2, 2.5], [2, -2, 2.5]]\n"
             "[[joint]]\nset = \"holed\"\npolygon = [[0, 0, 3], [4, 0, 3], [4, 4, 3], [0, 4, 3]]\n"
             "holes = [[[1, 1, 3], [3, 1, 3], [3, 3, 3], [1, 3, 3]]]\n");
  ASSERT_EQ(result.figures.input.sets.size(), 2U);
  const SetFigures &up = result.figures.input.sets[0], &holed = result.figures.input.sets[1];
  EXPECT_EQ(up.name, "up");
  EXPECT_NEAR(up.p32, 4.0 / 64, 1e-12);
  EXPECT_NEAR(up.p21, 4.0 / 64, 1e-12);
  EXPECT_NEAR(holed.p32, 12.0 / 64, 1e-12);
  EXPECT_NEAR(holed.p10, 12.0 / 64, 1e-12);
}

// Three orthogonal Poisson sets of spacing 1: V is a product of three exponential gaps. In a box of side L a gap x is
// seen whole in L - x places, so its density there is that of (1 - x/L) e^-x.
TEST(BlockSizes, ThreePoissonSetsGiveProductsOfExponentials) {
  constexpr double side = 14;
  constexpr int runs = 20;
  std::vector<double> truth;
  Rng rng{{.seed = 81}};
  const auto gap = [&] {
    for (;;) {
      const double x = -std::log(rng.uniform());
      if (x < side && rng.uniform() < 1 - x / side) return x;
    }
  };
  for (int i = 0; i < 400'000; ++i) truth.push_back(gap() * gap() * gap());
  std::ranges::sort(truth);
  std::vector<std::vector<double>> volumes;
  std::vector<double> pooled;
  for (int k = 0; k < runs; ++k) {
    std::string text = fmt::format("seed = {}\n", k) + box_of_sides(side, side, side);
    for (const auto& [dip, direction] : {std::pair{0, 0}, std::pair{90, 0}, std::pair{90, 90}}) {
      text += fmt::format(
          "[[joint_set]]\nname = \"{}_{}\"\norientation = {{ dip = {}, dip_direction = {} }}\nsize = \"persistent\"\n"
          "intensity = {{ spacing = 1 }}\n",
          dip, direction, dip, direction);
    }
    const RunResult result = run_of(text);
    const topology::BlockComplex& complex = result.complex->complex();
    std::vector<double>& own = volumes.emplace_back();
    for (const topology::Block& block : complex.blocks()) {
      if (!block.fixed) own.push_back(block.volume.si());
    }
    ASSERT_GE(own.size(), 30U);
    EXPECT_TRUE(result.figures.blocks->sizes->inner);
    EXPECT_EQ(result.figures.blocks->sizes->count, own.size());
    EXPECT_EQ(result.figures.blocks->sizes->by_number.values, percentiles_by_number(own).values);
    pooled.insert(pooled.end(), own.begin(), own.end());
  }
  for (const auto& [name, p] : Percentiles::levels) {
    const double volume = level(percentiles_by_number(pooled), name);
    const auto below = std::ranges::lower_bound(truth, volume) - truth.begin();
    const double share = static_cast<double>(below) / static_cast<double>(truth.size());
    // Standard error of the share below: runs are independent, blocks of one are not.
    double square = 0;
    for (const std::vector<double>& own : volumes) {
      const auto count = static_cast<double>(std::ranges::count_if(own, [&](double v) { return v <= volume; }));
      square += std::pow(count - p * static_cast<double>(own.size()), 2);
    }
    EXPECT_NEAR(share, p, 4 * std::sqrt(square) / static_cast<double>(pooled.size())) << name;
  }
}

}  // namespace
}  // namespace cleave::scene::test::block_sizes_test
