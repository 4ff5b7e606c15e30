// The removal sequence, done again: what has left is taken out of the rock itself, the blocks of what remains are found
// anew, and their first batch must be the next one of the analysis.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/sequence.hpp"
#include "statics.hpp"

namespace cleave::stability::replay_test {
namespace {

using geometry::Vec3;

topology::CutInput network(std::uint64_t seed) {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {30, 30, 30}).value()};
  input.excavations.push_back(geometry::make_box({13, -1, 13}, {17, 31, 17}).value());
  Rng rng{{.seed = seed, .realization = 0, .purpose = 41, .index = 0}};
  const auto within = [&](double lo, double hi) { return lo + (hi - lo) * rng.uniform(); };
  for (std::size_t j = 0; j < 60; ++j) {
    Vec3 normal{within(-0.4, 0.4), within(-0.4, 0.4), within(-0.4, 0.4)};
    (j % 3 == 0 ? normal.x : j % 3 == 1 ? normal.y : normal.z) += 1;
    normal = geometry::normalized(normal);
    const Vec3 u = geometry::normalized(geometry::cross(normal, j % 3 == 2 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}));
    const Vec3 v = geometry::cross(normal, u);
    const Vec3 c{within(5, 25), within(0, 30), within(8, 26)};
    input.joints.emplace_back(topology::Joint{
        {geometry::Polygon::make({c - 8 * u - 8 * v, c + 8 * u - 8 * v, c + 8 * u + 8 * v, c - 8 * u + 8 * v})
             .value()}});
  }
  return input;
}

/// Centroid and volume tell a block in another state of the rock.
using Mark = std::array<double, 4>;
std::vector<Mark> marks(const topology::BlockComplex& complex, const std::vector<topology::BlockId>& blocks) {
  std::vector<Mark> out;
  for (const topology::BlockId id : blocks) {
    const topology::Block& b = complex.blocks()[id];
    out.push_back({b.centroid.x, b.centroid.y, b.centroid.z, b.volume.si()});
  }
  std::ranges::sort(out);
  return out;
}

TEST(ReplayTest, TakingTheBatchesOutOneByOneFindsThemAgain) {
  std::size_t replayed = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto cut = topology::SequentialCut::make(network(seed));
    ASSERT_TRUE(cut.has_value());
    topology::WorkState state{.excavated = {1}, .fallen = {}};
    const auto all = cut->blocks(state);
    ASSERT_TRUE(all.has_value());
    Settings with = statics::settings({statics::strength(20)});
    with.force_transfer = false;
    const auto whole = topology::audit(topology::BlockComplex{all->complex});
    ASSERT_TRUE(whole.has_value());
    const Analysis analysis = analyse(*whole, with);
    for (std::size_t k = 0; k + 1 < analysis.batches.size(); ++k) {
      const std::set<topology::BlockId> gone(analysis.batches[k].blocks.begin(), analysis.batches[k].blocks.end());
      for (std::size_t cell = 0; cell < all->block_of_cell.size(); ++cell) {
        const auto block = all->block_of_cell[cell];
        if (block && gone.contains(*block)) state.fallen.push_back(topology::CellId{cell});
      }
      const auto rest = cut->blocks(state);
      ASSERT_TRUE(rest.has_value());
      const auto audited = topology::audit(topology::BlockComplex{rest->complex});
      ASSERT_TRUE(audited.has_value());
      const Analysis again = analyse(*audited, with);
      ASSERT_FALSE(again.batches.empty());
      EXPECT_EQ(again.batches.size(), analysis.batches.size() - k - 1);
      const auto expected = marks(whole->complex(), analysis.batches[k + 1].blocks);
      const auto found = marks(audited->complex(), again.batches[0].blocks);
      ASSERT_EQ(found.size(), expected.size()) << "seed " << seed << " batch " << k + 2;
      for (std::size_t i = 0; i < found.size(); ++i) {
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(found[i][c], expected[i][c], 1e-9 * (1 + expected[i][c]));
      }
      ++replayed;
    }
  }
  EXPECT_GT(replayed, 5U);
}

}  // namespace
}  // namespace cleave::stability::replay_test
