// Blocks that hold one another, cut by the cutter: judged together.

#include "cleave/stability/key_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "near_scenes.hpp"
#include "slab_behind_toe.hpp"
#include "statics.hpp"

namespace cleave::stability::key_groups_test {
namespace {

using assembly::Verdict;
using geometry::norm;
using geometry::Vec3;
using statics::audited;
using statics::slab_behind_toe;
using statics::slope;
using statics::strength;
using topology::BlockId;

TEST(KeyGroupsTest, SlabBehindToe) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  const Analysis alone = analyse(complex, settings);
  EXPECT_TRUE(alone.batches.empty());
  const KeyGroups found = find_key_groups(complex, settings);
  ASSERT_EQ(found.groups.size(), 1U);
  const KeyGroup& group = found.groups[0];
  EXPECT_EQ(group.batch, 1U);
  // Held by what is locked in between the walls alone.
  EXPECT_EQ(group.verdict, Verdict::unsafe);
  ASSERT_EQ(group.blocks.size(), 2U);
  EXPECT_NEAR(group.volume.si(), 312 + 18.8620205076, 1e-6);
  EXPECT_NEAR(group.factor_move, 0.942790, 1e-6);
  // The slab turns about its toe, too.
  ASSERT_TRUE(group.factor_turning.has_value());
  EXPECT_NEAR(*group.factor_turning, 0.894759, 1e-5);
  EXPECT_EQ(group.least_factor(), *group.factor_turning);
  EXPECT_TRUE(std::isinf(group.factor_up));
  EXPECT_NEAR(norm(group.direction - Vec3{std::cos(std::atan(slope)), 0, -std::sin(std::atan(slope))}), 0, 1e-6);
  // The toe leaves its base, and the slab the wall: on 41 degrees of friction nothing moves.
  EXPECT_TRUE(find_key_groups(complex, statics::settings({strength(41)})).groups.empty());
}

TEST(KeyGroupsTest, OneBlockIsAsBefore) {
  // No toe: the slab alone is a key block.
  topology::CutInput input = slab_behind_toe();
  const auto complex = audited(input);
  Settings settings = statics::settings({strength(30)});
  const Analysis first = analyse(complex, settings);
  for (const BlockId id : complex.complex().blocks().ids()) {
    if (std::abs(complex.complex().blocks()[id].volume.si() - 18.8620205076) < 1e-3) settings.left_out = {id};
  }
  ASSERT_EQ(settings.left_out.size(), 1U);
  const Analysis alone = analyse(complex, settings);
  ASSERT_EQ(alone.batches.size(), 1U);
  const KeyGroups found = find_key_groups(complex, settings);
  ASSERT_EQ(found.groups.size(), 1U);
  EXPECT_EQ(found.groups[0].blocks, alone.batches[0].blocks);
  EXPECT_NEAR(found.groups[0].factor_move, std::tan(std::numbers::pi / 6) / slope, 1e-6);
  EXPECT_NEAR(alone.judgements[0].factor_of_safety, found.groups[0].factor_move, 1e-6);
  // It moves down its joint, under what friction leaves.
  EXPECT_NEAR(norm(found.groups[0].direction - alone.judgements[0].direction), 0, 1e-6);
  Analysis none;
  decide_by_groups(complex, settings, found, none);
  ASSERT_EQ(none.judgements.size(), 1U);
  EXPECT_NEAR(none.judgements[0].net / alone.judgements[0].net, 1, 1e-6);
  EXPECT_NEAR(norm(none.judgements[0].direction - alone.judgements[0].direction), 0, 1e-6);
}

// "decide": the group's blocks become key blocks of its batch.
TEST(KeyGroupsTest, BecomeKeyBlocks) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  Analysis analysis = analyse(complex, settings);
  const KeyGroups found = find_key_groups(complex, settings);
  decide_by_groups(complex, settings, found, analysis);
  ASSERT_EQ(analysis.batches.size(), 1U);
  EXPECT_EQ(analysis.batches[0].blocks, found.groups.at(0).blocks);
  EXPECT_NEAR(analysis.batches[0].volume.si(), 330.8620205076, 1e-6);
  for (const BlockId id : analysis.batches[0].blocks) {
    const auto it = std::ranges::find(analysis.judgements, id, &Judgement::block);
    ASSERT_NE(it, analysis.judgements.end());
    EXPECT_TRUE(it->key);
    EXPECT_EQ(it->batch, 1U);
    // The lesser of both.
    EXPECT_NEAR(it->factor_of_safety, 0.894759, 1e-5);
  }
}

// The largest block of a group starts to move at a factor of its own, a crumb beside it at less.
TEST(KeyGroupsTest, TheLargestBlockHasItsOwnFactor) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  KeyGroups found = find_key_groups(complex, settings);
  ASSERT_EQ(found.groups.size(), 1U);
  EXPECT_EQ(found.groups[0].factor_of_largest, found.groups[0].least_factor());
  found.groups[0].factor_of_largest = 0.95;
  Analysis analysis;
  decide_by_groups(complex, settings, found, analysis);
  ASSERT_EQ(analysis.judgements.size(), 2U);
  for (const Judgement& judgement : analysis.judgements) {
    const bool slab = complex.complex().blocks()[judgement.block].volume.si() > 300;
    EXPECT_EQ(judgement.factor_of_safety, slab ? 0.95 : found.groups[0].least_factor());
  }
}

// A block in translation may be found to move where one that may turn too is wedged: with moments the factor is no
// greater.
TEST(KeyGroupsTest, MomentsNeverRaiseAFactor) {
  const topology::CutInput input = near_scenes::network(3, 31, 30, true);
  const auto complex = audited(input);
  std::size_t several = 0, all = 0;
  for (const KeyGroup& group : find_key_groups(complex, near_scenes::weak_rock()).groups) {
    if (!group.factor_turning) continue;
    ++all;
    EXPECT_LE(*group.factor_turning, group.factor_move);
    if (!group.factor_of_largest) continue;
    ++several;
    EXPECT_GE(*group.factor_of_largest, group.least_factor());
    EXPECT_LE(*group.factor_of_largest, 1);
  }
  EXPECT_GT(all, 5U);
  EXPECT_GT(several, 0U);
}

// So does a block that no direction frees by itself: it has the factor of its group.
TEST(KeyGroupsTest, BecomeKeyBlocksWhereNothingWasSaidOfThemAlone) {
  const auto complex = audited(slab_behind_toe());
  const Settings settings = statics::settings({strength(30)});
  Analysis analysis;
  decide_by_groups(complex, settings, find_key_groups(complex, settings), analysis);
  ASSERT_EQ(analysis.judgements.size(), 2U);
  for (const Judgement& judgement : analysis.judgements) {
    EXPECT_EQ(judgement.mode, Mode::tapered);
    EXPECT_NEAR(judgement.factor_of_safety, 0.894759, 1e-5);
    EXPECT_GT(judgement.net.si(), 0);
  }
}

}  // namespace
}  // namespace cleave::stability::key_groups_test
