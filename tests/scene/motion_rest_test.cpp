#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// When blocks of a scene are at rest, which of them stand against their verdict, and what becomes of their energy.

namespace cleave::scene::test::motion_rest_test {
namespace {

std::string box(const std::string& from, const std::string& to, const std::string& more = {}) {
  return "[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [" + from + "], max = [" + to + "] }\n" + more;
}

/// A block from `from` to `to` along x, from 1 to `top` above, alone on the level plane z = 1 of a domain `length`
/// long, of depth 1 and without cohesion.
struct OnAPlane {
  double length = 30, from = 14, to = 18, top = 1.5, friction = 20;
  std::string gravity = "[0, 0, -9.81]";
};

std::string scene_on(const OnAPlane& how, const std::string& motion) {
  const auto n = [](double x) { return std::to_string(x); };
  const std::string all = n(how.length + 1);
  return "[domain]\nbox = { min = [0, 0, 0], max = [" + n(how.length) +
         ", 1, 4.5] }\n[[joint]]\nplane = { through = [1, 0, 1], dip = 0, dip_direction = 0 }\n"
         "[joints.default]\nfriction = " +
         n(how.friction) + "\n[rock]\ndensity = 2600\n" + box("-1, -1, 1", n(how.from) + ", 2, 9") +
         box(n(how.to) + ", -1, 1", all + ", 2, 9") + box("-1, -1, " + n(how.top), all + ", 2, 9") +
         "[stability]\ngroups = \"off\"\nfree = [\"north\", \"south\", \"top\"]\ngravity = " + how.gravity +
         "\n[motion]\nrelease = \"all\"\nerror = false\nsurface_friction = " + n(how.friction) + "\n" + motion;
}

MotionResult moved(const std::string& text) { return run_of(text).motion.value(); }

/// Gravity on what is turned by so many degrees.
std::string tilted(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return fmt::format("[{:.16g}, 0, {:.16g}]", 9.81 * std::sin(angle), -9.81 * std::cos(angle));
}

TEST(MotionRest, NothingRestsBeforeTheGroundDoes) {
  const std::string rest = "until = \"rest\"\nduration = 4\nstep = 0.02\n";
  const auto with = [&](const std::string& ground) {
    return run_of(scene_on({.length = 60}, rest + "ground = { " + ground + " }\n"));
  };
  // Friction of 20 degrees holds 3.57 m/s2: the pulse passes it at 0.45 s and is over at 2 s.
  const RunResult pulse = with("acceleration = [8, 0, 0], time = { kind = \"pulse\", duration = 2 }");
  EXPECT_TRUE(pulse.motion->at_rest);
  EXPECT_GE(pulse.motion->end.si(), 2);
  EXPECT_EQ(pulse.motion->moved(), 1U);
  const RunResult late = with("record = { step = 1, x = [0, 0, 6, 0] }");
  EXPECT_TRUE(late.motion->at_rest);
  EXPECT_GE(late.motion->end.si(), 3);
  EXPECT_EQ(late.motion->moved(), 1U);
  for (const char* time :
       {"{ kind = \"ramp\", duration = 3 }", "{ kind = \"step\" }", "{ kind = \"harmonic\", frequency = 0.1 }"}) {
    const RunResult ever = with(std::string{"acceleration = [3, 0, 0], time = "} + time);
    EXPECT_FALSE(ever.motion->at_rest) << time;
    EXPECT_DOUBLE_EQ(ever.motion->end.si(), 4) << time;
    EXPECT_EQ(notes_with(ever, "not at rest after 4 s; the ground moves for ever"), 1U) << time;
    EXPECT_EQ(notes_with(ever, "set a longer motion.duration"), 0U) << time;
  }
}

TEST(MotionRest, WhatHasJustBegunToMoveDoesNotRest) {
  const std::string rest = "until = \"rest\"\nduration = 12\n";
  // A column of 1 x 3 m tips beyond atan(1 / 3).
  const double limit = std::atan(1.0 / 3) * 180 / std::numbers::pi;
  const OnAPlane column{.length = 40, .from = 2, .to = 3, .top = 4, .friction = 60};
  for (const double over : {0.001, -0.001}) {
    OnAPlane how = column;
    how.gravity = tilted(limit + over);
    const MotionResult motion = moved(scene_on(how, rest));
    EXPECT_TRUE(motion.converged) << motion.stopped_why;
    EXPECT_EQ(motion.moved(), over > 0 ? 1U : 0U) << over;
    EXPECT_TRUE(motion.at_rest) << over;
  }
  for (const double friction : {29.998, 30.002}) {
    const MotionResult motion = moved(scene_on({.friction = friction, .gravity = tilted(30)}, rest));
    EXPECT_EQ(motion.moved(), friction < 30 ? 1U : 0U) << friction;
    EXPECT_EQ(motion.at_rest, friction > 30) << friction;
  }
}

// Short steps between frames: twenty of them are no time to rest in.
TEST(MotionRest, RestTakesTime) {
  const MotionResult motion =
      moved(scene_on({.friction = 29.9, .gravity = tilted(30)}, "until = \"rest\"\nduration = 0.3\nframe = 0.0005\n"));
  EXPECT_FALSE(motion.at_rest);
  EXPECT_DOUBLE_EQ(motion.end.si(), 0.3);
  const MotionResult held =
      moved(scene_on({.friction = 31, .gravity = tilted(30)}, "until = \"rest\"\nduration = 0.3\nframe = 0.0005\n"));
  EXPECT_TRUE(held.at_rest);
  EXPECT_GE(held.end.si(), 0.1);
}

TEST(MotionRest, ALaterStageIsLetGoWhereTheFirstHasNoBlock) {
  const auto lift = [](const std::string& from, const std::string& to, const std::string& stage) {
    return box("10, -1, " + from, "41, 5, " + to, "stage = " + stage + "\n");
  };
  const auto run_with = [&](const std::string& joint, const std::string& duration) {
    return moved(
        "[domain]\nbox = { min = [0, 0, 0], max = [40, 4, 12] }\n"
        "[[joint]]\nplane = { through = [10, 2, 2], dip = 45, dip_direction = 90 }\n" +
        joint + "[joints.default]\nfriction = 20\n[rock]\ndensity = 2600\n" + lift("7", "13", "1") +
        lift("1", "7", "2") +
        "[stability]\ngroups = \"off\"\nfree = [\"north\", \"south\", \"top\"]\n"
        "[motion]\nrelease = \"stage\"\nerror = false\nduration = " +
        duration + "\n");
  };
  const MotionResult motion = run_with("", "1");
  EXPECT_TRUE(motion.converged) << motion.stopped_why;
  ASSERT_EQ(motion.blocks.size(), 1U);
  const double along = 9.81 * std::sqrt(0.5) * (1 - std::tan(20 * std::numbers::pi / 180));
  EXPECT_NEAR(motion.blocks[0].fall.si(), 0.5 * along * 0.25 * std::sqrt(0.5), 1e-3);
  EXPECT_GE(motion.blocks[0].first_motion->si(), 0.5);
  // Of two blocks that part as they slide what parting lifts is a row that the energies close with.
  const MotionResult two = run_with("[[joint]]\nplane = { through = [6, 2, 6], dip = 90, dip_direction = 90 }\n", "2");
  EXPECT_EQ(two.moved(), 2U);
  EXPECT_GT(two.lifted, 0);
  EXPECT_NEAR(two.potential_lost + two.lifted, two.dissipated + two.kinetic, 1e-12 * two.potential_lost);
}

// Out of the domain down a slope of 30 degrees: what it lost of its height is m g times its fall, whatever it took
// away of motion.
TEST(MotionRest, EnergyOfWhatLeavesIsARowOfItsOwn) {
  const RunResult result =
      run_of(scene_on({.length = 9, .from = 2, .to = 6, .friction = 10, .gravity = tilted(30)}, "duration = 4\n"));
  const MotionResult& motion = *result.motion;
  ASSERT_EQ(motion.left(), 1U);
  const MotionBlock& block = motion.blocks.at(0);
  const double mass = 2600 * 2, g = 9.81;
  const double down =
      g * (std::sin(std::numbers::pi / 6) * block.runout.si() + std::cos(std::numbers::pi / 6) * block.fall.si());
  EXPECT_NEAR(motion.potential_lost, mass * down, 1e-9 * mass * down);
  EXPECT_NEAR(motion.fastest_left(), block.fastest, 1e-12);
  EXPECT_GE(motion.carried_out, 0.5 * mass * block.leaving_speed * block.leaving_speed * (1 - 1e-12));
  EXPECT_EQ(motion.kinetic, 0);
  EXPECT_NEAR(motion.potential_lost + motion.lifted, motion.dissipated + motion.carried_out,
              1e-12 * motion.potential_lost);
  EXPECT_EQ(notes_with(result, "1 block left the domain and was followed no further; the fastest at"), 1U);
  EXPECT_GE(motion.front_runout().si(), block.runout.si() - 1e-9);
}

// The corner of a column that tips comes as far as its height, its centroid half as far.
TEST(MotionRest, TheFrontOfABlockComesFartherThanItsCentroid) {
  const OnAPlane column{.length = 40, .from = 20, .to = 21, .top = 4, .friction = 60, .gravity = tilted(20)};
  const MotionResult motion = moved(scene_on(column, "until = \"rest\"\nduration = 8\n"));
  EXPECT_TRUE(motion.at_rest);
  EXPECT_NEAR(motion.blocks.at(0).runout.si(), 2, 0.4);
  EXPECT_NEAR(motion.front_runout().si(), 4, 0.8);
  EXPECT_NEAR(motion.potential_lost + motion.lifted, motion.dissipated + motion.kinetic, 1e-9 * motion.potential_lost);
}

// Concave blocks with slivers of facets: a cut of theirs that was left out made neighbours overlap by 8 micrometres.
TEST(MotionRest, BlocksOfAnExactCutDoNotOverlapAtTheStart) {
  const auto set = [](const std::string& name, const std::string& place, const std::string& spacing) {
    return "[[joint_set]]\nname = \"" + name + "\"\nmodel = \"orthogonal\"\nsize = \"persistent\"\norientation = { " +
           place + ", distribution = \"fisher\" }\nintensity = { spacing = " + spacing + " }\n";
  };
  const MotionResult motion =
      moved("seed = 111\n[domain]\nbox = { min = [0, 0, 0], max = [20, 7, 20] }\n" +
            set("S0", "dip = 57.45, dip_direction = 339.31, kappa = 126", "2.11") +
            set("S1", "dip = 67.29, dip_direction = 143.13, kappa = 138", "2.40") +
            set("S2", "dip = 18.51, dip_direction = 61.07, kappa = 202", "2.06") +
            "[joints.default]\nfriction = 19.2\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"tunnel\"\n"
            "section = { shape = \"horseshoe\", width = 8.48, height = 7.63 }\naxis = [[10, 0, 7], [10, 7, 7]]\n"
            "[stability]\ngroups = \"off\"\n"
            "[motion]\nrelease = \"all\"\nduration = 0.01\nerror = false\n");
  EXPECT_TRUE(motion.converged) << motion.stopped_why;
  EXPECT_FALSE(motion.refused);
  EXPECT_EQ(motion.blocks.size(), 26U);
}

}  // namespace
}  // namespace cleave::scene::test::motion_rest_test
