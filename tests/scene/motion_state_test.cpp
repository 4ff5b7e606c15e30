#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "cleave/core/archive.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

// Runs of blocks in motion that are stopped and gone on with.

namespace cleave::scene::test::motion_state_test {
namespace {

/// A block on a plane that dips 40 degrees east, open at its foot and its top. Groups, which take most of the time of
/// the analysis, are not looked for: nothing here asks for them.
std::string slab(const std::string& joints, const std::string& motion, const std::string& more = {}) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [30, 6, 14] }\n"
         "[[joint]]\nplane = { through = [14, 3, 6], dip = 40, dip_direction = 90 }\n"
         "[[joint]]\nplane = { through = [9, 3, 8], dip = 80, dip_direction = 270 }\n"
         "[[joint]]\nplane = { through = [12, 2, 6], dip = 89, dip_direction = 180 }\n"
         "[[joint]]\nplane = { through = [12, 4, 6], dip = 89, dip_direction = 0 }\n"
         "[joints.default]\n" +
         joints +
         "[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
         "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n" +
         more + "[stability]\ngroups = \"off\"\n[motion]\n" + motion;
}

std::expected<RunResult, std::vector<Problem>> ran(const std::string& text, MovingRun how = {}, unsigned threads = 1) {
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  return run(scene, {.threads = threads, .motion = std::move(how)}, timer, progress);
}

/// Stops before step `steps` + 1.
MovingRun until(std::uint64_t steps) {
  return {.stop = [steps, asked = std::uint64_t{0}]() mutable { return asked++ >= steps; }};
}

void expect_same(const MotionResult& a, const MotionResult& b) {
  EXPECT_TRUE(a.state == b.state);
  EXPECT_EQ(a.converged, b.converged);
  EXPECT_EQ(a.stopped_why, b.stopped_why);
  EXPECT_EQ(a.at_rest, b.at_rest);
  EXPECT_EQ(a.end, b.end);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.walls, b.walls);
  EXPECT_EQ(a.potential_lost, b.potential_lost);
  EXPECT_EQ(a.dissipated, b.dissipated);
  EXPECT_EQ(a.carried_out, b.carried_out);
  EXPECT_EQ(a.lifted, b.lifted);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.determined, b.determined);
  EXPECT_EQ(a.notes, b.notes);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t k = 0; k < a.frames.size(); ++k) EXPECT_EQ(a.frames[k].time, b.frames[k].time);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t k = 0; k < a.blocks.size(); ++k) {
    EXPECT_EQ(a.blocks[k].block, b.blocks[k].block);
    EXPECT_EQ(a.blocks[k].centroid, b.blocks[k].centroid);
    EXPECT_EQ(a.blocks[k].first_motion, b.blocks[k].first_motion);
    EXPECT_EQ(a.blocks[k].left, b.blocks[k].left);
    EXPECT_EQ(a.blocks[k].front, b.blocks[k].front);
    EXPECT_EQ(a.blocks[k].leaving_speed, b.blocks[k].leaving_speed);
  }
}

void expect_goes_on(const std::string& text, std::uint64_t steps_at_least, const std::vector<double>& stops) {
  const auto whole = ran(text);
  ASSERT_TRUE(whole.has_value());
  ASSERT_TRUE(whole->motion.has_value());
  ASSERT_GE(whole->motion->steps, steps_at_least);
  EXPECT_FALSE(whole->motion->interrupted);
  const std::uint64_t steps = whole->motion->steps;
  for (const double share : stops) {
    const auto at = static_cast<std::uint64_t>(share * static_cast<double>(steps));
    const auto half = ran(text, until(at));
    ASSERT_TRUE(half.has_value());
    ASSERT_TRUE(half->motion->interrupted);
    EXPECT_FALSE(half->motion->converged);
    EXPECT_TRUE(half->motion->stopped_why.starts_with("interrupted at "));
    EXPECT_EQ(half->motion->steps, at);
    EXPECT_FALSE(half->motion->frames.empty());
    const auto rest = ran(text, {.from = SavedRun{"half", half->motion->state}}, 2);
    ASSERT_TRUE(rest.has_value()) << describe(rest.error().front());
    expect_same(*rest->motion, *whole->motion);
  }
}

TEST(MotionStateTest, ARunThatWasStoppedIsTheRunThatWasNot) {
  expect_goes_on(slab("friction = 20\n", "duration = 0.3\nstep = 0.01\nframe = 0.04\nerror = false\n"), 20,
                 {0, 0.4, 0.999});
}

TEST(MotionStateTest, SoItIsOfBlocksThatComeToRest) {
  expect_goes_on(slab("friction = 45\n", "until = \"rest\"\nrelease = \"all\"\nduration = 0.5\nerror = false\n"), 20,
                 {0.5});
}

TEST(MotionStateTest, SoItIsOfBlocksThatLeave) {
  const auto box = [](const std::string& corners) {
    return "[[excavation]]\nkind = \"polyhedron\"\nbox = { " + corners + " }\n";
  };
  expect_goes_on(
      "[domain]\nbox = { min = [0, 0, 0], max = [9, 1, 4.5] }\n"
      "[[joint]]\nplane = { through = [1, 0, 1], dip = 0, dip_direction = 0 }\n"
      "[joints.default]\nfriction = 10\n[rock]\ndensity = 2600\n" +
          box("min = [-1, -1, 1], max = [2, 2, 9]") + box("min = [6, -1, 1], max = [10, 2, 9]") +
          box("min = [-1, -1, 1.5], max = [10, 2, 9]") +
          "[stability]\ngroups = \"off\"\nfree = [\"north\", \"south\", \"top\"]\ngravity = [5, 0, -8.5]\n"
          "[motion]\nrelease = \"all\"\nsurface_friction = 10\nduration = 3\nerror = false\n",
      200, {0.3, 0.95});
}

TEST(MotionStateTest, SoItIsWithCohesionThatBreaks) {
  expect_goes_on(
      slab("friction = 20\ncohesion = 1000\n", "release = \"all\"\nduration = 0.2\nstep = 0.01\nerror = false\n"), 15,
      {0.3});
}

TEST(MotionStateTest, SoItIsOnGroundThatMoves) {
  expect_goes_on(slab("friction = 45\n",
                      "release = \"all\"\nduration = 0.3\nstep = 0.01\nerror = false\n"
                      "ground = { record = { step = 0.1, x = [0, -6, 0], z = [1, -1] } }\n"),
                 20, {0.3, 0.9});
}

TEST(MotionStateTest, AStopWhileTheErrorIsSoughtKeepsTheRun) {
  const std::string text = slab("friction = 20\n", "duration = 0.2\nstep = 0.01\n");
  const auto whole = ran(text);
  ASSERT_TRUE(whole.has_value());
  const auto stopped = ran(text, until(whole->motion->steps + 2));
  ASSERT_TRUE(stopped.has_value());
  EXPECT_TRUE(stopped->motion->interrupted);
  EXPECT_FALSE(stopped->motion->error.has_value());
  EXPECT_EQ(stopped->motion->steps, whole->motion->steps);
  const auto rest = ran(text, {.from = SavedRun{"half", stopped->motion->state}});
  ASSERT_TRUE(rest.has_value());
  expect_same(*rest->motion, *whole->motion);
}

TEST(MotionStateTest, ALongerRunGoesOnFromAShorterOne) {
  const std::string more = "step = 0.01\nframe = 0.05\nerror = false\n";
  const auto shorter = ran(slab("friction = 20\n", "duration = 0.1\n" + more));
  const auto longer = ran(slab("friction = 20\n", "duration = 0.3\n" + more));
  ASSERT_TRUE(shorter.has_value() && longer.has_value());
  const auto rest =
      ran(slab("friction = 20\n", "duration = 0.3\n" + more), {.from = SavedRun{"short", shorter->motion->state}});
  ASSERT_TRUE(rest.has_value());
  expect_same(*rest->motion, *longer->motion);
  const auto back =
      ran(slab("friction = 20\n", "duration = 0.1\n" + more), {.from = SavedRun{"long", longer->motion->state}});
  ASSERT_FALSE(back.has_value());
  EXPECT_EQ(back.error().front().key, "motion.duration");
}

/// 64 times one push, early or late.
std::string pushes(bool late) {
  std::string values;
  for (int k = 0; k <= 256; ++k) values += k % 4 == (late ? 3 : 1) ? "0.5, " : "0, ";
  return "ground = { record = { step = 0.0005, x = [" + values + "] } }\n";
}

TEST(MotionStateTest, OtherGroundIsRefusedWhateverItsMeansAre) {
  const std::string motion = "duration = 0.1\nstep = 0.01\nerror = false\n";
  const auto early = ran(slab("friction = 20\n", pushes(false) + motion), until(3));
  ASSERT_TRUE(early.has_value());
  EXPECT_TRUE(ran(slab("friction = 20\n", pushes(false) + motion), {.from = SavedRun{"half", early->motion->state}}));
  const auto late =
      ran(slab("friction = 20\n", pushes(true) + motion), {.from = SavedRun{"half", early->motion->state}});
  ASSERT_FALSE(late.has_value());
  EXPECT_NE(describe(late.error().front()).find("is of another scene"), std::string::npos);
}

TEST(MotionStateTest, AnotherSceneOrADamagedStateIsRefused) {
  const std::string motion = "duration = 0.1\nstep = 0.01\nerror = false\n";
  const auto one = ran(slab("friction = 20\n", motion), until(3));
  ASSERT_TRUE(one.has_value());
  const std::string& state = one->motion->state;
  const auto refused = [](const std::string& text, const std::string& bytes, const std::string& why) {
    const auto got = ran(text, {.from = SavedRun{"old/motion.state", bytes}});
    ASSERT_FALSE(got.has_value()) << why;
    const std::string said = describe(got.error().front());
    EXPECT_TRUE(said.starts_with("old/motion.state:1: state: " + why)) << said;
  };
  refused(slab("friction = 20\n", motion), "", "is no state of a run of blocks in motion");
  refused(slab("friction = 20\n", motion), "cleave-contact-state 1\n", "is no state of a run of blocks in motion");
  refused(slab("friction = 20\n", motion), sealed("cleave-motion-state", 99, "x"), "was written by another version");
  refused(slab("friction = 20\n", motion), state.substr(0, state.size() / 2), "is cut short or damaged");
  refused(slab("friction = 21\n", motion), state, "is of another scene");
  std::string heavier = slab("friction = 20\n", motion);
  heavier.replace(heavier.find("2600"), 4, "2700");
  refused(heavier, state, "is of another scene");
  refused(slab("friction = 20\n", "frame = 0.03\n" + motion), state, "is of another scene");
  refused(slab("friction = 20\n", "ground = { acceleration = [0.1, 0, 0] }\n" + motion), state, "is of another scene");
  const std::string inside{unsealed("cleave-motion-state", 4, state).value()};
  refused(slab("friction = 20\n", motion), sealed("cleave-motion-state", 4, inside.substr(0, inside.size() - 9)),
          "is cut short or damaged");
}

}  // namespace
}  // namespace cleave::scene::test::motion_state_test
