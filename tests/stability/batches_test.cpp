#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "analyse_complex.hpp"
#include "cleave/core/rng.hpp"
#include "handmade.hpp"
#include "random_complex.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using handmade::Complex;
using handmade::upward;
using statics::find;
using statics::settings;
using statics::strength;
using topology::BlockId;

/// Three slabs in line on a plane of 30 degrees: integration scene of the theory, contact by contact. Lowest first.
struct Slabs {
  Complex complex;
  std::vector<BlockId> slabs;
};
Slabs three_slabs() {
  Slabs s;
  const Vec3 down_slope = handmade::dip_vector(30, 90);
  const auto base = s.complex.fixed_block(1500);
  for (int i = 0; i < 3; ++i) s.slabs.push_back(s.complex.block(500));
  for (const BlockId slab : s.slabs) {
    s.complex.contact(slab, base, upward(30, 90), 100, 0);
    s.complex.free_face(slab);
  }
  s.complex.contact(s.slabs[0], s.slabs[1], down_slope, 50, 1);
  s.complex.contact(s.slabs[1], s.slabs[2], down_slope, 50, 2);
  return s;
}

TEST(BatchesTest, SlabsLeaveOneAfterTheOther) {
  const Slabs s = three_slabs();
  const Analysis a = analyse_complex(s.complex.build(), settings({strength(20)}));
  ASSERT_EQ(a.batches.size(), 3U);
  for (std::uint32_t k = 0; k < 3; ++k) {
    EXPECT_EQ(a.batches[k].number, k + 1);
    EXPECT_EQ(a.batches[k].blocks, std::vector{s.slabs[k]});
    EXPECT_EQ(a.batches[k].volume, cubic_metres(500));
    EXPECT_EQ(find(a, s.slabs[k])->batch, k + 1);
  }
  EXPECT_FALSE(a.stopped_at_max_batches);
}

TEST(BatchesTest, MaxBatchesStopsAndSaysSo) {
  const Slabs s = three_slabs();
  for (std::uint32_t limit = 0; limit <= 4; ++limit) {
    Settings with = settings({strength(20)});
    with.max_batches = limit;
    const Analysis a = analyse_complex(s.complex.build(), with);
    EXPECT_EQ(a.batches.size(), std::min(limit, 3U));
    EXPECT_EQ(a.stopped_at_max_batches, limit < 3);
    if (limit < 3) {
      // The next one is judged in the final state: unstable, without batch.
      const Judgement* next = find(a, s.slabs[limit]);
      ASSERT_NE(next, nullptr);
      EXPECT_TRUE(next->key);
      EXPECT_FALSE(next->batch.has_value());
    }
  }
}

// Being a key block is not monotone: the wedge moves with both walls there, and would be safe on one.
TEST(BatchesTest, RemovalOfAWallCanStabilise) {
  const auto wedge = [](bool second_wall) {
    Complex complex;
    const auto rock = complex.fixed_block();
    const auto block = complex.block(100);
    complex.free_face(block);
    complex.contact(block, rock, upward(50, 0), 1, 0);
    if (second_wall) complex.contact(block, rock, upward(50, 90), 1, 1);
    return analyse_complex(complex.build(), settings({strength(51), strength(5)})).judgements.at(0);
  };
  const Judgement both = wedge(true);
  EXPECT_EQ(both.mode, Mode::wedge);
  EXPECT_TRUE(both.key);
  EXPECT_NEAR(both.driving.si(), 64.440048, 1e-6);
  EXPECT_NEAR(both.resistance.si(), 60.149144, 1e-6);
  EXPECT_NEAR(both.net.si(), 4.290903, 1e-6);
  const Judgement one = wedge(false);
  EXPECT_EQ(one.mode, Mode::sliding);
  EXPECT_FALSE(one.key);
  EXPECT_NEAR(one.driving.si(), 76.604444, 1e-6);
  EXPECT_NEAR(one.resistance.si(), 79.377659, 1e-6);
}

// So the wedge and its second wall, itself a key block, leave together: judged in one state, whatever the order.
TEST(BatchesTest, ABatchIsJudgedInOneState) {
  for (const bool wall_first : {false, true}) {
    Complex complex;
    const auto rock = complex.fixed_block();
    const auto a = complex.block(100);
    const auto b = complex.block(100);
    const auto [wedge, wall] = wall_first ? std::pair{b, a} : std::pair{a, b};
    complex.free_face(wedge);
    complex.free_face(wall);
    complex.contact(wedge, rock, upward(50, 0), 1, 0);
    complex.contact(wedge, wall, upward(50, 90), 1, 1);
    complex.contact(wall, rock, upward(60, 270), 1, 1);  // slides to the west on its own
    const Analysis analysis = analyse_complex(complex.build(), settings({strength(51), strength(5)}));
    ASSERT_EQ(analysis.batches.size(), 1U);
    EXPECT_EQ(analysis.batches[0].blocks, (std::vector{a, b}));
    EXPECT_EQ(find(analysis, wedge)->mode, Mode::wedge);
  }
}

// A face on two blocks, of which one leaves: the constraint stays, the area shrinks.
TEST(BatchesTest, FaceHoldsWhileOnePatchHasItsNeighbour) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto falling = complex.block(10);
  const auto slab = complex.block(100);
  complex.free_face(falling);
  complex.contact(falling, rock, {0, 0, -1}, 1, 0);
  complex.shared_contact(slab, falling, rock, upward(30, 90), 6, 4, 1);
  const Analysis a = analyse_complex(complex.build(), settings({strength(0), strength(10, 5)}));
  // Cohesion on 10 m2 would hold (T = 50, R = 15.27 + 50); on the 4 m2 left it does not (15.27 + 20).
  ASSERT_EQ(a.batches.size(), 2U);
  EXPECT_EQ(a.batches[0].blocks, std::vector{falling});
  const Judgement* j = find(a, slab);
  EXPECT_EQ(j->mode, Mode::sliding);
  EXPECT_EQ(j->batch, 2U);
  EXPECT_NEAR(j->resistance.si(), 100 * std::cos(handmade::radians(30)) * std::tan(handmade::radians(10)) + 20, 1e-9);
}

TEST(BatchesTest, FixedAndBuriedBlocksAreNotJudged) {
  Complex complex;
  const auto rock = complex.fixed_block();
  complex.free_face(rock);
  const auto buried = complex.block(1);
  for (const Vec3 n : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
    complex.contact(buried, rock, n, 1, 0);
  const auto tapered = complex.block(1);
  for (const Vec3 n : {Vec3{1, 1, -1}, {-1, 1, -1}, {0, -1, -1}, {0, 0, 1}}) complex.contact(tapered, rock, n, 1, 0);
  complex.free_face(tapered);
  const Analysis a = analyse_complex(complex.build(), settings({strength(0)}));
  EXPECT_TRUE(a.judgements.empty());
  EXPECT_TRUE(a.batches.empty());
  EXPECT_EQ(a.tapered, std::vector{tapered});  // said, though not judged
  EXPECT_FALSE(a.stopped_at_max_batches);
}

// Reference for the work list: every batch again as batch 1 of a complex in which what left is air.
TEST(BatchesTest, EveryBatchIsTheFirstOfWhatIsLeft) {
  int deepest = 0;
  int staying = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const testing_complex::Description description = testing_complex::random(seed, 40);
    const Settings with = testing_complex::random_settings(seed);
    const Analysis all = analyse_complex(description.build(), with);
    std::set<BlockId> gone;
    Settings once = with;
    once.max_batches = 1;
    for (const Batch& batch : all.batches) {
      const Analysis first = analyse_complex(description.build(gone), once);
      ASSERT_EQ(first.batches.size(), 1U);
      EXPECT_EQ(first.batches[0].blocks, batch.blocks);
      for (const BlockId id : batch.blocks) {
        EXPECT_EQ(find(first, id)->mode, find(all, id)->mode);
        EXPECT_EQ(find(first, id)->net, find(all, id)->net);
      }
      gone.insert(batch.blocks.begin(), batch.blocks.end());
    }
    // The blocks that stay are judged in the final state, and none of them moves.
    const Analysis last = analyse_complex(description.build(gone), once);
    EXPECT_TRUE(last.batches.empty());
    for (const Judgement& j : all.judgements) {
      if (j.batch) continue;
      ++staying;
      const Judgement* again = find(last, j.block);
      ASSERT_NE(again, nullptr);
      EXPECT_EQ(again->mode, j.mode);
      EXPECT_EQ(again->resistance, j.resistance);
    }
    EXPECT_TRUE(std::ranges::is_sorted(all.judgements, {}, &Judgement::block));
    EXPECT_LT(all.equilibrium_residual, 1e-12);
    deepest = std::max(deepest, static_cast<int>(all.batches.size()));
  }
  EXPECT_GT(deepest, 4);
  EXPECT_GT(staying, 100);
}

}  // namespace
}  // namespace cleave::stability
