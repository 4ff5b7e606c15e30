#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "cleave/scene/run.hpp"
#include "parse_support.hpp"

// What must not pass in silence: blocks that only the border of the domain holds.

namespace cleave::scene::test {
namespace {

std::expected<RunResult, std::vector<Problem>> try_run(const std::string& text) {
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  return run(scene, {.threads = 1}, timer, progress);
}
RunResult run_of(const std::string& text) {
  auto result = try_run(text);
  if (!result) {
    for (const Problem& problem : result.error()) ADD_FAILURE() << describe(problem);
  }
  return std::move(result).value();
}
std::size_t notes_with(const RunResult& result, std::string_view words) {
  std::size_t found = 0;
  for (const std::string& note : result.notes) found += note.contains(words) ? 1U : 0U;
  return found;
}

/// A slice of a slope: its east side is free, a joint dips out of it through the box from side to side.
std::string slice(double dip) {
  return with_box("[[joint]]\nplane = { through = [8, 4, 1], dip = " + std::to_string(dip) +
                  ", dip_direction = 90 }\n[joints.default]\nfriction = 30\n"
                  "[stability]\nfree = [\"top\", \"east\"]\n");
}

TEST(HeldByTheBorder, ASliceOfASlopeThatIsHeldByItsOwnSidesIsTold) {
  const RunResult result = run_of(slice(40));
  EXPECT_EQ(result.figures.key_blocks->count, 0U);
  // Above the joint: the box less the prism below, which reaches the top where 1 + x' tan 40 = 6.
  const double tangent = 0.83909963117728, run = 5 / tangent;
  const double below = 8 * (1 * 8 + run * 5 / 2 + (8 - run) * 5);
  // Free: all of the east side above 1 m, and of the top what lies above the joint.
  EXPECT_EQ(
      notes_with(result, fmt::format("1 block at free faces ({:.4g} m3, {:.3g} % of the free area) is held only by",
                                     384 - below, 100 * (8 * 5 + 8 * run) / (8 * 6 + 8 * 8))),
      1U);
}

TEST(HeldByTheBorder, WhatFrictionHoldsIsNotTold) { EXPECT_EQ(notes_with(run_of(slice(20)), "held only by"), 0U); }

TEST(HeldByTheBorder, RockBelowHoldsWhatStandsOnIt) {
  // The column in front of an upright joint stands on the bottom of the domain; an earthquake moves nothing there.
  const std::string column = with_box(
      "[[joint]]\nplane = { through = [6, 4, 1], dip = 90, dip_direction = 90 }\n[joints.default]\nfriction = 30\n"
      "[stability]\nfree = [\"top\", \"east\"]\nseismic = [0.3, 0, 0]\n");
  EXPECT_EQ(notes_with(run_of(column), "held only by"), 0U);
}

TEST(HeldByTheBorder, ABlockInsideIsAKeyBlockAsBefore) {
  // Two upright joints free the slice of the domain's sides: the block between them leaves, two beside it stay.
  const RunResult result =
      run_of(slice(40) + "[[joint]]\nplane = { through = [0, 2, 0], dip = 90, dip_direction = 0 }\n" +
             "[[joint]]\nplane = { through = [0, 6, 0], dip = 90, dip_direction = 0 }\n");
  EXPECT_EQ(result.figures.key_blocks->count, 1U);
  EXPECT_EQ(notes_with(result, "2 blocks at free faces"), 1U);
}

}  // namespace
}  // namespace cleave::scene::test
