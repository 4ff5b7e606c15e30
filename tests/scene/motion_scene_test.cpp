#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Blocks of a scene in motion.

namespace cleave::scene::test::motion_scene_test {
namespace {

/// A block of 10 m3 on a plane that dips 40 degrees east, open at its foot and its top.
std::string slab(double friction, const std::string& more) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [30, 6, 14] }\n"
         "[[joint]]\nplane = { through = [14, 3, 6], dip = 40, dip_direction = 90 }\n"
         "[[joint]]\nplane = { through = [9, 3, 8], dip = 80, dip_direction = 270 }\n"
         "[[joint]]\nplane = { through = [12, 2, 6], dip = 89, dip_direction = 180 }\n"
         "[[joint]]\nplane = { through = [12, 4, 6], dip = 89, dip_direction = 0 }\n"
         "[joints.default]\nfriction = " +
         std::to_string(friction) +
         "\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
         "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n[stability]\n[motion]\n" +
         more;
}

/// Without the search for groups: where all blocks are let go nothing asks for them.
std::string without_groups(std::string text) {
  const std::string table = "[stability]\n";
  return text.insert(text.find(table) + table.size(), "groups = \"off\"\n");
}

RunResult moved(const std::string& text) {
  RunResult result = run_of(text);
  EXPECT_TRUE(result.motion.has_value());
  return result;
}

TEST(MotionScene, KeyBlockSlidesAsItsAccelerationSays) {
  const RunResult result = moved(slab(20, "duration = 0.3\nstep = 0.005\n"));
  const MotionResult& motion = *result.motion;
  EXPECT_TRUE(motion.converged) << motion.stopped_why;
  ASSERT_EQ(motion.blocks.size(), result.figures.key_blocks->count);
  ASSERT_GE(motion.blocks.size(), 1U);
  const double dip = 40 * std::numbers::pi / 180, friction = 20 * std::numbers::pi / 180;
  const double a = 9.81 * (std::sin(dip) - std::cos(dip) * std::tan(friction));
  const double path = std::hypot(motion.blocks[0].fall.si(), motion.blocks[0].runout.si());
  EXPECT_NEAR(path, 0.5 * a * 0.09, 1e-3);
  EXPECT_TRUE(motion.blocks[0].moved);
  EXPECT_LT(motion.energy_error, 1e-9);
  EXPECT_LE(motion.overlap, 1e-6);
  ASSERT_TRUE(motion.error.has_value());
  EXPECT_LT(motion.error->si(), 0.01);
}

/// The record of examples/shaken_slope: its steps and its accelerations.
std::string record_of_example() {
  const std::string text = example("shaken_slope");
  const std::size_t from = text.find("step = 0.02"), to = text.find(']', text.find("x = [", from)) + 1;
  return text.substr(from, to - from) + "\n";
}

/// The block on a plane of 20 degrees that only the ground moves.
std::string shaken(const std::string& motion) {
  std::string text = without_groups(slab(25, "release = \"all\"\nerror = false\n" + motion));
  return text.replace(text.find("dip = 40"), 8, "dip = 20");
}

// Newmark's equation of motion integrated in steps of 5e-6 s, as of the same block in two dimensions. The rows of
// the balance of energy are of the block as seen from the ground.
// 0 of n blocks that moved is no answer while they still begin to.
TEST(MotionScene, ATimeTooShortToSeeMotionIsSaid) {
  const auto says = [](const RunResult& result) { return notes_with(result, "set a longer motion.duration"); };
  EXPECT_EQ(says(moved(slab(20, "duration = 0.01\nstep = 0.005\n"))), 1U);
  EXPECT_EQ(says(moved(slab(20, "duration = 0.3\nstep = 0.005\n"))), 0U);
  EXPECT_EQ(says(moved(slab(45, "release = \"all\"\nduration = 0.3\nstep = 0.005\n"))), 0U);
}

// The verdict of a block that has not moved is not taken back; what motion leaves out is named.
TEST(MotionScene, KeyBlocksThatStandAreSaid) {
  const RunResult soon = moved(slab(20, "duration = 0.01\nstep = 0.005\n"));
  ASSERT_GE(soon.figures.key_blocks->count, 1U);
  EXPECT_EQ(soon.motion->key_blocks_standing, soon.figures.key_blocks->count);
  EXPECT_EQ(notes_with(soon, "alone or in groups, did not move by a millimetre: block "), 1U);
  EXPECT_EQ(notes_with(soon, "The verdict stays, motion is no proof"), 1U);
  // They begin to move: no locked forces are said where none are counted.
  EXPECT_EQ(soon.motion->may_be_locked + notes_with(soon, "forces locked"), 0U);
  const RunResult late = moved(slab(20, "duration = 0.3\nstep = 0.005\n"));
  EXPECT_EQ(late.motion->key_blocks_standing, 0U);
  EXPECT_EQ(notes_with(late, "The verdict stays"), 0U);
  // It is stable but for the push: the factor is below 1, and motion has no push.
  std::string pushed = without_groups(slab(45, "duration = 0.3\nstep = 0.005\nerror = false\n"));
  pushed.insert(pushed.find("[motion]"), "seismic = [0.4, 0, 0]\n[[load]]\nname = \"harder\"\nseismic = [0.5, 0, 0]\n");
  const RunResult stands = moved(pushed);
  EXPECT_GE(stands.motion->key_blocks_standing, 1U);
  EXPECT_TRUE(stands.motion->at_rest);
  EXPECT_EQ(stands.motion->may_be_locked + notes_with(stands, "forces locked"), 0U);
  EXPECT_EQ(notes_with(stands, "loads of the verdict that motion leaves out: seismic"), 1U);
  EXPECT_EQ(notes_with(stands, "are left out: seismic. A block that only these bring down stands"), 1U);
  EXPECT_EQ(notes_with(stands, "not the load cases \"harder\" (seismic)"), 1U);
}

// Blocks of a slope that move by the verdict of their group, and stand in motion by forces between them: figures, marks
// and notes say the same.
TEST(MotionScene, WhatStandsByLockedForcesIsMarked) {
  std::string scene = "[domain]\nbox = { min = [0, 0, 0], max = [30, 12, 14] }\n";
  for (const auto& [through, dip, direction] :
       {std::tuple{"12, 6, 6.2", 28.85, 103.87}, std::tuple{"9, 6, 8", 67.53, 278.19},
        std::tuple{"12, 3.2, 6", 62.39, 15.56}, std::tuple{"12, 8.6, 6", 74.18, 187.09},
        std::tuple{"11.462, 5.562, 8.719", 79.35, 144.97}, std::tuple{"11.455, 7.036, 9.103", 58.61, 170.76},
        std::tuple{"12.733, 6.904, 8.989", 35.34, 293.12}}) {
    scene +=
        fmt::format("[[joint]]\nplane = {{ through = [{}], dip = {}, dip_direction = {} }}\n", through, dip, direction);
  }
  const RunResult result =
      moved(scene +
            "[joints.default]\nfriction = 26\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
            "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n[stability]\n"
            "groups = \"decide\"\n[motion]\nrelease = \"all\"\nduration = 0.02\nframe = 0.02\nerror = false\n");
  const MotionResult& motion = *result.motion;
  ASSERT_TRUE(motion.converged);
  ASSERT_GE(motion.key_blocks_standing, 1U);
  EXPECT_EQ(motion.locked(), motion.blocks.size());
  EXPECT_GE(motion.locked(), motion.key_blocks_standing);
  EXPECT_GE(motion.may_be_locked, motion.locked());
  EXPECT_EQ(notes_with(result, "forces locked between them may hold; an answer that moves"), 1U);
  EXPECT_EQ(notes_with(result, "forces locked between blocks may hold"), 1U);
  EXPECT_EQ(notes_with(result, "not shown to be safe: block "), 1U);
}

TEST(MotionScene, SlidesUnderARecordAsNewmarkSays) {
  const RunResult result = moved(shaken("duration = 4\nstep = 0.002\n[motion.ground.record]\n" + record_of_example()));
  const MotionResult& motion = *result.motion;
  ASSERT_TRUE(motion.converged) << motion.stopped_why;
  ASSERT_EQ(motion.blocks.size(), 1U);
  constexpr double path = 0.2460462066;
  EXPECT_NEAR(std::hypot(motion.blocks[0].fall.si(), motion.blocks[0].runout.si()), path, 1e-4 * path);
  EXPECT_NEAR(motion.blocks[0].fall.si(), path * std::sin(20 * std::numbers::pi / 180), 1e-4 * path);
  ASSERT_TRUE(motion.work_of_ground.has_value());
  EXPECT_GT(*motion.work_of_ground, 0.1 * motion.potential_lost);
  EXPECT_NEAR(*motion.work_of_ground + motion.potential_lost, motion.dissipated, 1e-9 * motion.dissipated);
  EXPECT_EQ(notes_with(result, "long for ground that moves") + notes_with(result, "the ground moves for"), 0U);
}

TEST(MotionScene, GroundIsReadAxisByAxis) {
  const auto ground = [](const std::string& text) {
    return scene_of(shaken("ground = { " + text + " }\n")).motion->ground;
  };
  const auto record = ground("record = { step = 0.1, x = [0, 1, 1], y = [0, 2], z = [0, -3], scale = 2 }");
  EXPECT_LT(norm(record->at(0.05) - geometry::Vec3{1, 2, -3}), 1e-12);
  EXPECT_LT(norm(record->at(0.15) - geometry::Vec3{2, 2, -3}), 1e-12);
  EXPECT_LT(norm(record->mean(0, 0.2) - geometry::Vec3{1.5, 2, -3}), 1e-12);
  EXPECT_EQ(record->at(0.21), geometry::Vec3{});
  EXPECT_DOUBLE_EQ(record->end().si(), 0.2);
  EXPECT_DOUBLE_EQ(record->largest(), 2 * std::sqrt(14.0));
  const auto pulse = ground("acceleration = [1, 2, -3], time = { kind = \"pulse\", duration = 0.4 }");
  EXPECT_LT(norm(pulse->at(0.1) - geometry::Vec3{0.5, 1, -1.5}), 1e-12);
  EXPECT_DOUBLE_EQ(pulse->end().si(), 0.4);
  EXPECT_DOUBLE_EQ(pulse->largest(), std::sqrt(14.0));
}

TEST(MotionScene, GroundInGIsAskedAbout) {
  const auto meant = [](const std::string& ground) {
    std::string out;
    for (const Problem& note : scene_of(shaken("ground = { " + ground + " }\n")).notes) out += note.remedy + '\n';
    return out;
  };
  EXPECT_TRUE(meant("acceleration = [-0.2, 0, 0.1]").contains("write \"-0.2 g\""));
  EXPECT_TRUE(meant("record = { step = 0.1, x = [0, -0.3, 0], z = [0, 0.1, 0] }").contains("write scale = 9.81"));
  EXPECT_FALSE(meant("acceleration = [\"-0.2 g\", 0, 0]").contains(" g"));
  EXPECT_FALSE(meant("record = { step = 0.1, x = [0, -0.3, 0], scale = 9.81 }").contains("scale"));
}

TEST(MotionScene, WhatHasNoMeaningIsSaid) {
  const auto noted = [](const std::string& text, std::string_view words) {
    const auto notes = scene_of(text).notes;
    return std::ranges::count_if(notes, [&](const Problem& note) { return describe(note).contains(words); });
  };
  EXPECT_EQ(noted(slab(20, "duration = 0.3\nstep = 0.5\n"), "longer than the duration of 0.3 s"), 1);
  EXPECT_EQ(noted(slab(20, "duration = 0.3\nstep = 0.3\n"), "longer than the duration"), 0);
  EXPECT_EQ(noted(slab(20, "[monte_carlo]\nrealizations = 3\n"), "motion: is not run in an ensemble"), 1);
  EXPECT_EQ(noted(slab(20, ""), "ensemble"), 0);
  for (const std::string record : {"x = []", "z = [1]", "x = [], y = [0.5]"}) {
    const auto errors = errors_of(shaken("ground = { record = { step = 0.1, " + record + " } }\n"));
    ASSERT_EQ(errors.size(), 1U) << record;
    EXPECT_TRUE(errors[0].contains("motion.ground.record: has ")) << errors[0];
  }
}

// A bench whose faces are fixed lies before the slope: a block that comes down falls on it, not through it.
TEST(MotionScene, FixedSidesBeforeABlockBarIt) {
  std::string corners, loops = "g rock\nf";
  const std::vector<std::pair<double, double>> profile{{0, 0}, {30, 0}, {30, 4}, {15, 4}, {11, 12}, {0, 12}};
  const std::size_t n = profile.size();
  for (const double y : {0.0, 6.0}) {
    for (const auto& [x, z] : profile) corners += fmt::format("v {} {} {}\n", x, y, z);
  }
  for (std::size_t k = 1; k <= n; ++k) loops += fmt::format(" {}", k);
  loops += "\nf";
  for (std::size_t k = n; k >= 1; --k) loops += fmt::format(" {}", n + k);
  for (std::size_t k = 1; k <= n; ++k) {
    const std::size_t next = k % n + 1;
    loops += fmt::format("\ng {}\nf {} {} {} {}", k >= 4 && k <= 5 ? "slope" : "rock", k, n + k, n + next, next);
  }
  std::string text = slab(20, "duration = 2.5\nerror = false\n");
  text.replace(text.find("box ="), text.find("[[joint]]") - text.find("box ="), "mesh = \"rock.obj\"\n");
  text.erase(text.find("[[excavation]]"), text.find("[stability]") - text.find("[[excavation]]"));
  text.insert(text.find("[motion]"), "free = [\"slope\"]\ngroups = \"off\"\n");
  text.insert(text.find("[[joint]]"), "[[joint]]\nplane = { through = [15.2, 3, 2], dip = 90, dip_direction = 90 }\n");
  const RunResult result = run_of(text, {{"rock.obj", corners + loops + "\n"}});
  ASSERT_TRUE(result.motion.has_value());
  ASSERT_GE(result.motion->blocks.size(), 1U);
  EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
  for (const MotionBlock& block : result.motion->blocks) {
    EXPECT_GT(block.runout.si(), 3);
    EXPECT_GT(block.centroid.z, 4);
  }
}

// Written at 50 times of a short run, steps end there: those of the finer run are shorter all the same.
TEST(MotionScene, TheErrorOfShortRunsIsSeen) {
  const auto error = [](const std::string& step) {
    std::string text = shaken(
        "duration = 0.6\nframe = 0.02\nground = { acceleration = [-4, 0, 0], time = { kind = \"harmonic\", frequency = "
        "1.3 } }\nstep = " +
        step + "\n");
    const RunResult result = moved(text.erase(text.find("error = false"), 13));
    EXPECT_TRUE(result.motion->error.has_value());
    return result.motion->error.value_or(metres(0)).si();
  };
  const double long_steps = error("0.2");
  EXPECT_GT(long_steps, 1e-4);
  EXPECT_NEAR(long_steps / error("0.02"), 1, 1e-6);
}

TEST(MotionScene, GroundThatPushesAndDropsLetsABlockSlide) {
  const auto path = [](const std::string& ground) {
    const RunResult result = moved(shaken("duration = 0.5\nstep = 0.005\nground = { " + ground + " }\n"));
    EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
    return result.motion->blocks.at(0).runout.si();
  };
  EXPECT_LT(path("acceleration = [0, 0, 0]"), 1e-9);
  // Pushed at a under the slope, and dropped by b, it weighs g - b and slides by what friction leaves of both.
  const double dip = 20 * std::numbers::pi / 180, mu = std::tan(25 * std::numbers::pi / 180), a = 2;
  for (const double b : {0.0, 3.0}) {
    const double g = 9.81 - b;
    const double along = a * std::cos(dip) + g * std::sin(dip) - mu * (g * std::cos(dip) - a * std::sin(dip));
    const std::string ground = "acceleration = [-2, 0, " + std::to_string(-b) + "]";
    EXPECT_NEAR(path(ground), 0.5 * along * 0.25 * std::cos(dip), 1e-4) << b;
  }
  // A ramp to the same in 0.5 s, and its two halves: the mean over each step acts.
  const double up = path("record = { step = 0.25, x = [0, -2, -4], z = [0, 0, 0] }");
  EXPECT_NEAR(up, path("record = { step = 0.5, x = [0, -1], scale = 4 }"), 1e-9);
  EXPECT_NEAR(up, path("acceleration = [-4, 0, 0], time = { kind = \"ramp\", duration = 0.5 }"), 1e-9);
}

TEST(MotionScene, GroundThatTheRunDoesNotSeeWholeIsSaid) {
  const auto notes = [](const std::string& motion, const std::string& words) {
    const std::vector<Problem> said = scene_of(shaken(motion)).notes;
    return std::ranges::count_if(said, [&](const Problem& note) { return note.what.contains(words); });
  };
  const std::string pulse = "acceleration = [1, 0, 0], time = { kind = \"pulse\", duration = 0.04 }";
  EXPECT_EQ(notes("duration = 0.05\nstep = 0.01\nground = { " + pulse + " }\n", "long for ground that moves within"),
            1);
  EXPECT_EQ(notes("duration = 0.05\nstep = 0.008\nground = { " + pulse + " }\n", "long for ground that moves"), 0);
  EXPECT_EQ(notes("duration = 0.03\nstep = 0.005\nground = { " + pulse + " }\n", "the ground moves for 0.04 s"), 1);
  EXPECT_EQ(notes("duration = 0.04\nstep = 0.005\nground = { " + pulse + " }\n", "the ground moves for"), 0);
  const std::string sine = "acceleration = [0.1, 0, 0], time = { kind = \"harmonic\", frequency = 4 }";
  EXPECT_EQ(notes("until = \"rest\"\nduration = 0.02\nground = { " + sine + " }\n", "moves for ever"), 1);
  // Milliseconds for seconds, and frames that never come.
  const auto record = [](double step) {
    return "duration = 80\nground = { record = { step = " + std::to_string(step) + ", x = [0, 1, 0] } }\n";
  };
  EXPECT_EQ(notes(record(20), "is 20 s between two values"), 1);
  EXPECT_EQ(notes(record(0.02), "between two values"), 0);
  EXPECT_EQ(notes("duration = 0.05\nframe = 1\n", "longer than the duration of 0.05 s"), 1);
  EXPECT_EQ(notes("duration = 0.05\nframe = 0.05\n", "longer than the duration"), 0);
  const auto wrong = [](const std::string& ground) { return error_of(shaken("ground = { " + ground + " }\n")); };
  EXPECT_NE(wrong("record = { step = 0.1 }").find("motion.ground.record.x: is missing"), std::string::npos);
  EXPECT_NE(wrong("acceleration = [1, 0]").find("motion.ground.acceleration"), std::string::npos);
  EXPECT_NE(wrong("time = { kind = \"step\" }").find("motion.ground"), std::string::npos);
  EXPECT_NE(wrong("acceleration = [1, 0, 0], time = { kind = \"step\", follows = true }").find("follows no body"),
            std::string::npos);
}

TEST(MotionScene, WhatFrictionHoldsRests) {
  const std::string text = slab(45, "release = \"all\"\nuntil = \"rest\"\nduration = 2\nerror = false\n");
  const RunResult result = moved(without_groups(text));
  EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
  EXPECT_TRUE(result.motion->at_rest);
  EXPECT_EQ(result.motion->moved(), 0U);
  EXPECT_FALSE(result.motion->error.has_value());
}

TEST(MotionScene, CohesionHoldsUntilItIsLess) {
  // The slab weighs about a tenth of a meganewton on some ten square metres.
  for (const auto& [cohesion, moves] : {std::pair{"1e6", false}, {"10", true}}) {
    std::string text = without_groups(slab(20, "release = \"all\"\nduration = 0.2\nerror = false\n"));
    text.insert(text.find("\n[rock]"), std::string{"\ncohesion = "} + cohesion);
    EXPECT_EQ(moved(text).motion->moved() > 0, moves) << cohesion;
  }
}

// A block that hangs over the edge of its base, pulled along the edge: its cohesion has to hold it against
// twisting about the middle of the base, as balance with moments says (no group moves), until there is too little of
// it.
TEST(MotionScene, CohesionHoldsAgainstTwisting) {
  const auto run_of = [](const std::string& cohesion) {
    return moved(
        "[domain]\nbox = { min = [0, 0, 0], max = [4, 3.8, 2] }\n"
        "[[joint]]\nplane = { through = [0, 0, 1], dip = 0, dip_direction = 0 }\n"
        "[joints.default]\nfriction = 2\ncohesion = " +
        cohesion +
        "\n[rock]\ndensity = 2600\n"
        "[[excavation]]\nname = \"below\"\nkind = \"polyhedron\"\nbox = { min = [-1, 2.6, -1], max = [5, 9, 1] }\n"
        "[[excavation]]\nname = \"west\"\nkind = \"polyhedron\"\nbox = { min = [-1, -1, 1], max = [1, 9, 3] }\n"
        "[[excavation]]\nname = \"east\"\nkind = \"polyhedron\"\nbox = { min = [3, -1, 1], max = [5, 9, 3] }\n"
        "[[excavation]]\nname = \"south\"\nkind = \"polyhedron\"\nbox = { min = [-1, -1, 1], max = [5, 0.4, 3] }\n"
        "[stability]\nfree = [\"top\", \"north\"]\ngravity = [4, 0, -9]\n"
        "[motion]\nrelease = \"all\"\nduration = 0.2\nerror = false\n");
  };
  const RunResult held = run_of("2e5");
  EXPECT_EQ(held.motion->blocks.size(), 1U);
  EXPECT_EQ(held.motion->moved(), 0U);
  EXPECT_TRUE(held.key_groups->groups.empty());
  EXPECT_EQ(run_of("3e3").motion->moved(), 1U);
}

// A block of 0.7 m3 whose roof is rock over a square metre, 0.2 m off its middle: it bears 1 / 2.2 of its tension.
TEST(MotionScene, ABlockHangsFromItsRoofOffTheMiddle) {
  const double needed = 2600 * 9.81 * 0.7 * 2.2;
  for (const auto& [tension, cohesion, moves] :
       {std::tuple{1.01 * needed, "1e6", 0U}, {0.99 * needed, "1e6", 1U}, {1e9, "0", 1U}}) {
    const auto box = [](const std::string& name, const std::string& corners) {
      return "[[excavation]]\nname = \"" + name + "\"\nkind = \"polyhedron\"\nbox = { " + corners + " }\n";
    };
    const RunResult result = moved(
        "[domain]\nbox = { min = [0, 0, 0], max = [4, 3, 2] }\n"
        "[[joint]]\nplane = { through = [0, 0, 1], dip = 0, dip_direction = 0 }\n"
        "[joints.default]\nfriction = 30\ncohesion = " +
        std::string{cohesion} + "\ntension = " + std::to_string(tension) + "\n[rock]\ndensity = 2600\n" +
        box("below", "min = [-1, -1, -1], max = [5, 4, 0.5]") + box("west", "min = [-1, -1, 0.5], max = [1, 4, 1]") +
        box("east", "min = [2.4, -1, 0.5], max = [5, 4, 1]") + box("south", "min = [-1, -1, 0.5], max = [5, 1, 1]") +
        box("north", "min = [-1, 2, 0.5], max = [5, 4, 1]") + box("over", "min = [2, -1, 1], max = [5, 4, 1.5]") +
        "[stability]\ngroups = \"off\"\n[motion]\nrelease = \"all\"\nduration = 0.2\nerror = false\n");
    EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
    ASSERT_EQ(result.motion->blocks.size(), 1U);
    EXPECT_EQ(result.motion->moved(), moves) << tension;
  }
}

TEST(MotionScene, WhatCannotBeIsRefused) {
  const auto refused = [](std::string text, const std::string& from, const std::string& to) {
    if (const auto at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
    return !parse_text(text).has_value();
  };
  EXPECT_TRUE(refused(slab(20, "release = \"stage\"\n"), "", ""));
  EXPECT_TRUE(refused(slab(20, "release = \"groups\"\n"), "[stability]\n", "[stability]\ngroups = \"off\"\n"));
  EXPECT_TRUE(refused(slab(20, "until = \"tea\"\n"), "", ""));
  EXPECT_TRUE(refused(slab(20, "restitution = 1.5\n"), "", ""));
}

}  // namespace
}  // namespace cleave::scene::test::motion_scene_test
