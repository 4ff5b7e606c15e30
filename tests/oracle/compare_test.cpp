/// The fast cutter against the oracle on small scenes that are degenerate on purpose. A difference is printed as a
/// scene file with as few joints as still show it.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "block_summary.hpp"
#include "cleave/core/rng.hpp"
#include "scene_to_toml.hpp"
#include "trials.hpp"

namespace cleave::testing {
namespace {

IntegerScene scene_of_trial(std::uint64_t seed, std::uint32_t trial, const SceneLimits& limits) {
  Rng rng{StreamKey{.seed = seed, .realization = 0, .purpose = 0, .index = trial}};
  return make_integer_scene(
      [&](std::int32_t lo, std::int32_t hi) { return static_cast<std::int32_t>(rng.between(lo, hi)); }, limits);
}

template <class Problem>
void expect_none(const Problem& problem_of, std::uint64_t seed, int trials, const SceneLimits& limits) {
  int shown = 0;
  for (int trial = 0; trial < trials && shown < 3; ++trial) {
    const IntegerScene scene = scene_of_trial(seed, static_cast<std::uint32_t>(trial), limits);
    if (problem_of(scene).empty()) continue;
    const IntegerScene small = minimised(scene, [&](const IntegerScene& s) { return !problem_of(s).empty(); });
    const std::string problem = problem_of(small);
    ADD_FAILURE() << "seed " << seed << ", trial " << trial << '\n' << scene_to_toml(small, problem);
    ++shown;
  }
}

TEST(CompareTest, CutterAgreesWithTheOracleOnFewJoints) {
  expect_none(difference_from_oracle, 1, trials(1500, 100), {.max_joints = 4, .max_excavations = 0});
}

TEST(CompareTest, CutterAgreesWithTheOracleOnManyJoints) {
  expect_none(difference_from_oracle, 2, trials(1500, 60), {.max_joints = 10, .max_excavations = 0});
}

TEST(CompareTest, CutterAgreesWithTheOracleOnExcavations) {
  expect_none(difference_from_oracle, 3, trials(1500, 60), {.max_joints = 6, .max_excavations = 2});
}

TEST(CompareTest, WhatMustNotMatterDoesNotMatter) {
  expect_none(broken_invariance, 4, trials(600, 40), {.max_joints = 10, .max_excavations = 0});
}

TEST(CompareTest, WhatMustNotMatterDoesNotMatterToExcavations) {
  expect_none(broken_invariance, 5, trials(600, 40), {.max_joints = 6, .max_excavations = 2});
}

TEST(CompareTest, WindowsShowTheBlocksOfTheWholeScene) {
  expect_none(broken_window, 6, trials(500, 40), {.max_joints = 8, .max_excavations = 2});
}

TEST(CompareTest, NetworksHaveTheAreasOfTheBlocks) {
  expect_none(broken_network, 7, trials(500, 60), {.max_joints = 12, .max_excavations = 2});
}

// The comparison itself must see a fault: a wrong count or volume on either side.
TEST(CompareTest, SummariesThatDifferDoNotAgree) {
  const BlockSummary one{{{8, 12, 6, 6, 1, 0}, {1.0, 2.0}}};
  EXPECT_TRUE(agree(one, one));
  EXPECT_FALSE(agree(one, {{{8, 12, 6, 6, 1, 0}, {1.0}}}));
  EXPECT_FALSE(agree(one, {{{8, 12, 6, 6, 1, 0}, {1.0, 2.0 + 1e-8}}}));
  EXPECT_FALSE(agree(one, {{{8, 12, 6, 6, 1, 1}, {1.0, 2.0}}}));
  EXPECT_FALSE(agree(one, {{{8, 12, 6, 6, 1, 0}, {1.0}}, {{9, 13, 6, 6, 1, 0}, {2.0}}}));
}

}  // namespace
}  // namespace cleave::testing
