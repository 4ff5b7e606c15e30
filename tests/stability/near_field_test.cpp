/// Key blocks found without cutting more than their neighbourhood are those of the whole scene.

#include "cleave/stability/near_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "cleave/core/rng.hpp"
#include "statics.hpp"
#include "trials.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;

/// Squares of side `size`, turned at random about three directions, in a box of 40 m with a tunnel of 4 m through it.
topology::CutInput network(std::uint64_t seed, std::size_t joints, double size, bool through) {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {80, 40, 40}).value()};
  input.excavations.push_back(
      geometry::make_box({18, through ? -1.0 : 12.0, 18}, {22, through ? 41.0 : 28.0, 22}).value());
  Rng rng{{.seed = seed, .realization = 0, .purpose = 1, .index = 0}};
  const auto within = [&](double lo, double hi) { return lo + (hi - lo) * rng.uniform(); };
  for (std::size_t j = 0; j < joints; ++j) {
    Vec3 normal{within(-0.3, 0.3), within(-0.3, 0.3), within(-0.3, 0.3)};
    (j % 3 == 0 ? normal.x : j % 3 == 1 ? normal.y : normal.z) += 1;
    normal = geometry::normalized(normal);
    const Vec3 u = geometry::normalized(geometry::cross(normal, j % 3 == 2 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}));
    const Vec3 v = geometry::cross(normal, u);
    const Vec3 c{within(0, 40), within(0, 40), within(0, 40)};
    const double h = size / 2;
    input.joints.emplace_back(topology::Joint{
        {geometry::Polygon::make({c - h * u - h * v, c + h * u - h * v, c + h * u + h * v, c - h * u + h * v})
             .value()}});
  }
  return input;
}

Settings weak_rock() {
  Settings with = statics::settings({statics::strength(20, 0)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(2700)).value();
  with.loads = Loads::make({0, 0, -9.81}).value();
  return with;
}

/// What the analysis says of the blocks that would move, in an order of their own.
using Row = std::tuple<std::uint32_t, double, double, double, double, double>;
std::vector<Row> rows(const topology::BlockComplex& complex, const Analysis& analysis) {
  std::vector<Row> out;
  for (const Judgement& j : analysis.judgements) {
    if (!j.key) continue;
    const topology::Block& block = complex.blocks()[j.block];
    out.emplace_back(j.batch.value_or(0), block.centroid.x, block.centroid.y, block.centroid.z, j.net.si(),
                     j.transferred ? j.transferred->net.si() : 0.0);
  }
  std::ranges::sort(out);
  return out;
}
std::vector<topology::BlockId> leaving(const Analysis& analysis) {
  std::vector<topology::BlockId> out;
  for (const Batch& batch : analysis.batches) out.insert(out.end(), batch.blocks.begin(), batch.blocks.end());
  return out;
}

TEST(NearFieldTest, GivesTheKeyBlocksOfTheWholeScene) {
  unsigned windows = 0, grown = 0, found = 0;
  const auto settings = weak_rock();
  const int scenes = testing::trials(12, 8);
  for (int trial = 0; trial < scenes; ++trial) {
    const auto seed = static_cast<std::uint64_t>(trial);
    const auto input = network(seed, 90 + 15 * seed, trial % 2 == 0 ? 30 : 18, trial % 4 < 2);
    const auto whole = topology::audit(topology::cut(input).value());
    ASSERT_TRUE(whole.has_value());
    const Analysis expected = analyse(*whole, settings);
    StageTimer timer;
    const auto near = analyse_near_field(input, settings, {}, timer);
    ASSERT_TRUE(near.has_value());
    EXPECT_TRUE(expected.undecided.empty());
    const auto a = rows(whole->complex(), expected), b = rows(near->complex.complex(), near->analysis);
    ASSERT_EQ(a.size(), b.size()) << "seed " << seed;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(std::get<0>(a[i]), std::get<0>(b[i]));
      EXPECT_NEAR(std::get<1>(a[i]), std::get<1>(b[i]), 1e-6);
      EXPECT_NEAR(std::get<4>(a[i]), std::get<4>(b[i]), 1e-6 * (1 + std::abs(std::get<4>(a[i]))));
      EXPECT_NEAR(std::get<5>(a[i]), std::get<5>(b[i]), 1e-6 * (1 + std::abs(std::get<5>(a[i]))));
    }
    EXPECT_EQ(topology::canonical_hash(whole->complex(), leaving(expected)),
              topology::canonical_hash(near->complex.complex(), leaving(near->analysis)));
    ASSERT_EQ(expected.batches.size(), near->analysis.batches.size());
    windows += near->window ? 1U : 0U;
    grown += near->rounds > 1 ? 1U : 0U;
    found += static_cast<unsigned>(leaving(expected).size());
  }
  // The test must have met what it is about.
  EXPECT_GT(windows, 0U);
  EXPECT_GT(grown, 0U);
  EXPECT_GT(found, 10U);
}

// One block on the roof that reaches far up: a window that cuts through it must not call it stable, nor cut it short.
TEST(NearFieldTest, FollowsATallBlock) {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {40, 40, 40}).value()};
  input.excavations.push_back(geometry::make_box({18, -1, 4}, {22, 41, 8}).value());
  const auto square = [&](std::array<Vec3, 4> corners) {
    input.joints.emplace_back(topology::Joint{{geometry::Polygon::make({corners.begin(), corners.end()}).value()}});
  };
  square({{{19, 19, 7}, {19, 21, 7}, {19, 21, 30}, {19, 19, 30}}});
  square({{{21, 19, 7}, {21, 21, 7}, {21, 21, 30}, {21, 19, 30}}});
  square({{{19, 19, 7}, {21, 19, 7}, {21, 19, 30}, {19, 19, 30}}});
  square({{{19, 21, 7}, {21, 21, 7}, {21, 21, 30}, {19, 21, 30}}});
  square({{{18, 18, 29}, {22, 18, 29}, {22, 22, 29}, {18, 22, 29}}});
  // Sheets elsewhere, which make a small window look good enough.
  for (int i = 0; i < 40; ++i) {
    const double z = 10 + 0.7 * i;
    square({{{0.5, 0.5, z}, {16.5, 0.5, z}, {16.5, 39.5, z}, {0.5, 39.5, z}}});
    square({{{24.5, 0.5, z}, {79.5, 0.5, z}, {79.5, 39.5, z}, {24.5, 39.5, z}}});
  }
  StageTimer timer;
  const auto near = analyse_near_field(input, weak_rock(), {}, timer);
  ASSERT_TRUE(near.has_value());
  ASSERT_EQ(leaving(near->analysis).size(), 1U);
  EXPECT_NEAR(near->complex.complex().blocks()[leaving(near->analysis)[0]].volume.si(), 2 * 2 * 21, 1e-9);
  EXPECT_GT(near->rounds, 1U);
}

TEST(NearFieldTest, IsNotUsedWithoutFreeFaces) {
  EXPECT_FALSE(NearField::around_free_faces({.domain = geometry::make_box({0, 0, 0}, {1, 1, 1}).value()}).has_value());
}

}  // namespace
}  // namespace cleave::stability
