#include "cleave/realize/block_sizes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Sizes of blocks and how much of each set is in the rock, against boxes by hand and products of exponential gaps.

namespace cleave::scene::test::block_sizes_test {
namespace {

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

// A set whose joints lie every way has the same mean axis in every order of its joints.
TEST(BlockSizes, MeanAxesDoNotHangOnTheOrderOfJoints) {
  std::vector<std::string> joints;
  for (const auto& [dip, direction] : {std::pair{65, 320}, {48, 215}, {74, 197}, {83, 179}, {78, 299}}) {
    joints.push_back(
        fmt::format("[[joint]]\nplane = {{ through = [2, 2, 2], dip = {}, dip_direction = {} }}\n", dip, direction));
  }
  std::ranges::sort(joints);
  std::vector<double> seen;
  do {
    std::string text = box_of_sides(4, 4, 4);
    for (const std::string& joint : joints) text += joint;
    seen.push_back(run_of(text).figures.input.sets[0].p10);
  } while (std::ranges::next_permutation(joints).found);
  ASSERT_EQ(seen.size(), 120U);
  const auto [least, most] = std::ranges::minmax(seen);
  EXPECT_NEAR(least, most, 1e-12 * most);
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

/// Three orthogonal Poisson sets of spacing 1 in a box, as an ensemble.
std::string orthogonal_sets(double side, int realizations) {
  std::string text = box_of_sides(side, side, side);
  for (const auto& [dip, direction] : {std::pair{0, 0}, std::pair{90, 0}, std::pair{90, 90}}) {
    text += fmt::format(
        "[[joint_set]]\nname = \"{}_{}\"\norientation = {{ dip = {}, dip_direction = {} }}\nsize = \"persistent\"\n"
        "intensity = {{ spacing = 1 }}\n",
        dip, direction, dip, direction);
  }
  return text + fmt::format("[monte_carlo]\nrealizations = {}\n", realizations);
}

stochastic::Figures figures_of(const Scene& scene) {
  stochastic::Ensemble ensemble{ensemble_options_of(scene)};
  const Shared shared = shared_by_realizations(scene);
  for (std::uint64_t k = 0; k < scene.monte_carlo->realizations; ++k) {
    ensemble.add(make_record(scene, shared, k), "");
  }
  return ensemble.figures();
}

double mean_errors(const stochastic::Estimate& e, double truth) { return std::abs(e.mean - truth) / e.standard_error; }

// V is a product of three unit exponentials, whatever the size of the box: mean 1; by volume a product of three gamma
// laws of shape 2. Without the weights the mean volume of whole blocks would be ((1 - 2/L)/(1 - 1/L))^3, 0.70 here.
TEST(BlockSizes, WeightsTakeTheBordersBiasAway) {
  constexpr double side = 10;
  const stochastic::Figures f = figures_of(scene_of(orthogonal_sets(side, 60)));
  const stochastic::BlockSizeFigures& sizes = *f.block_sizes;
  EXPECT_TRUE(sizes.corrected);
  EXPECT_LT(mean_errors(sizes.mean_volume, 1), 3.5);
  EXPECT_LT(sizes.mean_volume.standard_error, 0.1);
  EXPECT_LT(sizes.met_share.high, 0.65);
  std::vector<double> truth;
  std::array<double, 4> shapes{};
  Rng rng{{.seed = 82}};
  constexpr int draws = 200'000;
  for (int i = 0; i < draws; ++i) {
    std::array<double, 3> gap{};
    for (double& x : gap) x = -std::log(rng.uniform());
    truth.push_back(gap[0] * gap[1] * gap[2]);
    std::ranges::sort(gap, std::greater{});
    shapes.at((3 * gap[1] <= 2 * gap[0] ? 2U : 0U) + (3 * gap[2] <= 2 * gap[1] ? 1U : 0U)) += 1.0 / draws;
  }
  std::ranges::sort(truth);
  const double all = std::accumulate(truth.begin(), truth.end(), 0.0);
  for (const stochastic::SizeShare& point : sizes.curve) {
    double number = 0, volume = 0;
    for (const double v : truth) {
      if (v >= point.volume.si()) break;
      number += 1.0 / draws;
      volume += v / all;
    }
    if (number < 0.02 || volume > 0.98) continue;
    const auto half = [](const stochastic::Interval& i) { return (i.high - i.low) / 2; };
    EXPECT_NEAR(point.by_number, number, 1.8 * half(point.by_number_interval)) << point.volume.si();
    EXPECT_NEAR(point.by_volume, volume, 1.8 * half(point.by_volume_interval)) << point.volume.si();
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) EXPECT_LT(mean_errors(sizes.shapes.at(i), shapes.at(i)), 3.5) << i;
  ASSERT_EQ(f.sets.size(), 3U);
  for (const stochastic::SetEstimates& set : f.sets) {
    EXPECT_LT(mean_errors(set.p32, 1), 3.5) << set.name;
    EXPECT_LT(mean_errors(set.p10, 1), 3.5) << set.name;
  }
  EXPECT_LT(mean_errors(*f.jv, 3), 3.5);
}

// With an opening or a free side it is not known how rare whole blocks are: they count as they are met, and that is
// said. Where only the rock near free faces is cut there are no sizes.
TEST(BlockSizes, OnlyABoxOfRockIsCorrected) {
  EXPECT_TRUE(questions_of(scene_of(orthogonal_sets(4, 2))).undisturbed.has_value());
  const Scene free = scene_of(orthogonal_sets(4, 2) + "[stability]\nfree = [\"top\"]\n");
  EXPECT_FALSE(questions_of(free).undisturbed.has_value());
  const stochastic::Figures f = figures_of(free);
  ASSERT_TRUE(f.block_sizes.has_value());
  EXPECT_FALSE(f.block_sizes->corrected);
  const Scene near = scene_of(orthogonal_sets(4, 2) + "[stability]\nfree = [\"top\"]\n[output]\nblocks = \"key\"\n");
  const stochastic::Figures g = figures_of(near);
  EXPECT_FALSE(g.block_sizes.has_value());
  EXPECT_EQ(g.sets.size(), 3U);
  std::string tunnel = orthogonal_sets(4, 2);
  tunnel +=
      "[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 1, height = 1 }\n"
      "axis = [[2, -1, 2], [2, 5, 2]]\n";
  EXPECT_FALSE(questions_of(scene_of(tunnel)).undisturbed.has_value());
}

}  // namespace
}  // namespace cleave::scene::test::block_sizes_test
