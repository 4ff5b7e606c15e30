#pragma once

/// Random rock around a tunnel, cut as a whole and on demand: what both must agree on.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/stability/analyse.hpp"
#include "statics.hpp"

namespace cleave::stability::near_scenes {

using geometry::Vec3;

/// Squares of side `size`, turned at random about three directions, in a box of 40 m with a tunnel of 4 m through it.
inline topology::CutInput network(std::uint64_t seed, std::size_t joints, double size, bool through) {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {40, 40, 40}).value()};
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

inline Settings weak_rock() {
  Settings with = statics::settings({statics::strength(20, 0)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(2700)).value();
  with.loads = Loads::make({0, 0, -9.81}).value();
  return with;
}

/// What the analysis says of the blocks that would move, in an order of their own.
using Row = std::tuple<std::uint32_t, double, double, double, double, double>;
inline std::vector<Row> rows(const topology::BlockComplex& complex, const Analysis& analysis) {
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
inline std::vector<topology::BlockId> leaving(const Analysis& analysis) {
  std::vector<topology::BlockId> out;
  for (const Batch& batch : analysis.batches) out.insert(out.end(), batch.blocks.begin(), batch.blocks.end());
  return out;
}

/// What one scene was good for.
struct Met {
  unsigned windows = 0, grown = 0;
  std::size_t found = 0;
};

/// Key blocks on demand are those of the whole scene: batches, forces before and after transfer, hash.
inline void expect_same(const topology::CutInput& input, const Settings& settings, const std::string& what, Met& met) {
  const auto whole = topology::audit(topology::cut(input).value());
  ASSERT_TRUE(whole.has_value());
  const Analysis expected = analyse(*whole, settings);
  StageTimer timer;
  const auto near = analyse_near_field(input, settings, {}, timer);
  ASSERT_TRUE(near.has_value());
  EXPECT_TRUE(expected.undecided.empty());
  const auto a = rows(whole->complex(), expected), b = rows(near->complex.complex(), near->analysis);
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::get<0>(a[i]), std::get<0>(b[i])) << what;
    EXPECT_NEAR(std::get<1>(a[i]), std::get<1>(b[i]), 1e-6) << what;
    EXPECT_NEAR(std::get<4>(a[i]), std::get<4>(b[i]), 1e-6 * (1 + std::abs(std::get<4>(a[i])))) << what;
    EXPECT_NEAR(std::get<5>(a[i]), std::get<5>(b[i]), 1e-6 * (1 + std::abs(std::get<5>(a[i])))) << what;
  }
  EXPECT_EQ(topology::canonical_hash(whole->complex(), leaving(expected)),
            topology::canonical_hash(near->complex.complex(), leaving(near->analysis)))
      << what;
  ASSERT_EQ(expected.batches.size(), near->analysis.batches.size()) << what;
  met.windows += near->window ? 1U : 0U;
  met.grown += near->rounds > 1 ? 1U : 0U;
  met.found += leaving(expected).size();
}

}  // namespace cleave::stability::near_scenes
