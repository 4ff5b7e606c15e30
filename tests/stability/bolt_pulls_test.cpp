// What a bolt can pull between the pieces of rock that it goes through, all at once.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/stability/support.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;
using Owner = std::optional<std::uint32_t>;

/// Through one block after the other, by the metres at which it leaves each; `owners` by block.
BoltResult through(const BoltType& type, const std::vector<double>& leaves) {
  BoltResult out{.bolt = {.collar = {0, 0, 0}, .direction = {0, 0, 1}, .length = metres(leaves.back()), .type = type}};
  double from = 0;
  for (std::uint32_t k = 0; k < leaves.size(); ++k) {
    out.pierced.push_back({BlockId{k}, from, leaves[k]});
    from = leaves[k];
  }
  return out;
}
std::vector<BoltPull> pulls(const BoltResult& bolt, const std::vector<Owner>& owners) {
  return pulls_of(bolt, [&](BlockId id) -> std::optional<Owner> { return owners.at(id.index()); });
}

BoltType bar(double tendon, double plate, double bond, double anchorage = 0) {
  return {.tendon = newtons(tendon),
          .plate = newtons(plate),
          .anchorage = metres(anchorage),
          .kind = GroutedBar{.bond = newtons_per_metre(bond)}};
}

// Windsor and Thompson (1992): min(tendon, plate + bond t, bond (L - t)).
TEST(BoltPulls, OneBlockIsHeldByTheBoltDiagram) {
  for (const auto& [t, force] : {std::pair{0.2, 30.0}, {1.2, 80.0}, {1.5, 75.0}, {2.6, 20.0}}) {
    const auto got = pulls(through(bar(100, 20, 50), {t, 3}), {0U, std::nullopt});
    ASSERT_EQ(got.size(), 1U) << t;
    EXPECT_NEAR(got[0].force.si(), force, 1e-12) << t;
    EXPECT_EQ(got[0].body, Owner{0U});
    EXPECT_EQ(got[0].other, Owner{});
    EXPECT_EQ(got[0].held, 0) << "by its plate";
    EXPECT_NEAR(got[0].leaves, t, 1e-12);
    EXPECT_NEAR(got[0].anchored, 0.5 * (t + 3), 1e-12);
  }
  const auto bare = pulls(through(bar(100, 0, 50), {1.2, 3}), {0U, std::nullopt});
  ASSERT_EQ(bare.size(), 1U);
  EXPECT_NEAR(bare[0].force.si(), 60, 1e-12);
  EXPECT_NEAR(bare[0].held, 0.6, 1e-12);
}

TEST(BoltPulls, NothingIsTiedToItself) {
  EXPECT_TRUE(pulls(through(bar(100, 20, 50), {1, 3}), {0U, 0U}).empty());
  EXPECT_TRUE(pulls(through(bar(100, 20, 50), {3}), {0U}).empty());
  EXPECT_TRUE(pulls(through(bar(100, 20, 50), {1, 3}), {std::nullopt, std::nullopt}).empty());
  // Not gripped enough on either side.
  EXPECT_TRUE(pulls(through(bar(100, 20, 50, 0.5), {2.6, 3}), {0U, std::nullopt}).empty());
  EXPECT_TRUE(pulls(through(bar(100, 0, 50, 0.5), {0.4, 3}), {0U, std::nullopt}).empty());
}

// Rock that stays in front of a block takes nothing from it of what holds it to the rock behind.
TEST(BoltPulls, BodiesComeBeforeRockThatStays) {
  const auto got = pulls(through(bar(1000, 500, 50), {1, 2, 5}), {std::nullopt, 0U, std::nullopt});
  const auto behind = std::ranges::find(got, Owner{0U}, &BoltPull::body);
  ASSERT_NE(behind, got.end());
  EXPECT_NEAR(behind->force.si(), 50, 1e-12);
}

// Two blocks one behind the other on a bolt whose tendon is the weakest: what hangs on it in all is the tendon.
TEST(BoltPulls, TheTendonIsSharedOut) {
  const auto got = pulls(through(bar(70, 60, 50), {1, 2, 6}), {0U, 1U, std::nullopt});
  double at_the_rock = 0;
  for (const BoltPull& pull : got) at_the_rock += pull.other ? 0 : pull.force.si();
  EXPECT_NEAR(at_the_rock, 70, 1e-12);
  EXPECT_EQ(got.front().body, Owner{0U});
  EXPECT_NEAR(got.front().force.si(), 70, 1e-12);
}

TEST(BoltPulls, AllOfThemAreCarriedAtOnce) {
  Rng rng{7};
  std::size_t found = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<double> leaves;
    std::vector<Owner> owners;
    for (std::int64_t k = rng.between(1, 6); k > 0; --k) {
      leaves.push_back((leaves.empty() ? 0 : leaves.back()) + 0.1 + rng.uniform());
      owners.push_back(rng.between(0, 2) == 0 ? Owner{} : Owner{static_cast<std::uint32_t>(rng.between(0, 2))});
    }
    const double plate = rng.between(0, 1) == 0 ? 0 : 50 * rng.uniform();
    const BoltType type = bar(100 * rng.uniform(), plate, 100 * rng.uniform(), 0.3 * rng.uniform());
    const double bond = std::get<GroutedBar>(type.kind).bond.si();
    const auto got = pulls(through(type, leaves), owners);
    found += got.size();
    for (const double at : leaves) {
      double crossing = 0;
      for (const BoltPull& pull : got) crossing += pull.leaves <= at && at < pull.anchored ? pull.force.si() : 0;
      EXPECT_LE(crossing, type.tendon.si() * (1 + 1e-12)) << trial;
    }
    // By body, and all rock that stays: no more than bond and plate there.
    for (const Owner owner : std::set<Owner>(owners.begin(), owners.end())) {
      double taken = 0, most = 0, from = 0;
      for (std::size_t k = 0; k < leaves.size(); from = leaves[k++]) {
        if (owners[k] == owner) most += bond * (leaves[k] - from) + (k == 0 ? plate : 0);
      }
      for (const BoltPull& pull : got) taken += pull.body == owner || pull.other == owner ? pull.force.si() : 0;
      EXPECT_LE(taken, most * (1 + 1e-12)) << trial;
    }
    for (const BoltPull& pull : got) {
      EXPECT_NE(pull.body, pull.other) << trial;
      EXPECT_GT(pull.force.si(), 0) << trial;
      EXPECT_LT(pull.held, pull.leaves) << trial;
      EXPECT_LT(pull.leaves, pull.anchored) << trial;
    }
  }
  EXPECT_GT(found, 2000U);
}

TEST(BoltPulls, AnAngleLawAsksForADirection) {
  Bolt bolt{.collar = {}, .direction = {0, 0, 1}, .length = metres(3), .type = bar(100, 20, 50)};
  EXPECT_EQ(share_at_angle(bolt, {1, 0, 0}), 1.0);
  bolt.type.angle = AngleLaw::cosine;
  EXPECT_NEAR(share_at_angle(bolt, {std::sqrt(3), 0, -1}).value(), 0.5, 1e-12);
  EXPECT_EQ(share_at_angle(bolt, {0, 0, 1}), std::nullopt);
  EXPECT_EQ(share_at_angle(bolt, {}), std::nullopt);
  bolt.type.angle = AngleLaw::linear;
  EXPECT_NEAR(share_at_angle(bolt, {std::sqrt(3), 0, -1}).value(), 1.0 / 3, 1e-12);
}

}  // namespace
}  // namespace cleave::stability
