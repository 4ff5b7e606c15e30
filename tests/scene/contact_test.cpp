#include "cleave/scene2d/contact.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace cleave::scene::contact_test {
namespace {

using bem::Vec2;

const std::string motion = "[contact]\nduration = 1\nstep = 0.01\n";
const std::string ground =
    "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n";

std::string first_problem(const std::string& text) {
  const auto scene = parse_contact(text, "s.toml");
  return scene ? "" : describe(scene.error().front());
}

ContactScene parsed(const std::string& text) {
  auto scene = parse_contact(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  return scene ? *std::move(scene) : ContactScene{};
}

ContactResult ran(const std::string& text, unsigned threads = 1) {
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(parsed(text), threads, timer, progress);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return result ? *std::move(result) : ContactResult{};
}

TEST(ContactScene, BadInputIsNamed) {
  const std::string square = "outline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n";
  const std::vector<std::pair<std::string, std::string>> bad{
      {motion, "s.toml:1: body: there is no body"},
      {"[contact]\nstep = 0.1\n[[body]]\n" + square, "contact.duration: is missing"},
      {"[contact]\nduration = 1\nstep = 0\n[[body]]\n" + square, "contact.step: is 0"},
      {motion + "[joints.default]\nfriction = 20\ndilation = 25\ndilation_slip = 1\n[[body]]\n" + square,
       "joints.default.dilation: dilation of 25 degrees is more than the friction of 20"},
      {motion + "[joints.default]\ndilation = 5\n[[body]]\n" + square, "joints.default.dilation_slip: is missing"},
      {"[contact]\nstatic = true\ngravity = 0\nin_situ = { stress = [-1, 0, 0] }\n[rock]\nyoung = 1e9\npoisson = "
       "0\n[[body]]\n" +
           square,
       "in_situ: comes to rest by no weight"},
      {"[contact]\nstatic = true\nmass_damping = 3\n[[body]]\n" + square, "mass_damping: slows what moves"},
      {"[contact]\nduration = 1\nstep = 2\n[[body]]\n" + square, "longer than the whole time"},
      {"[contact]\nduration = 1\nstep = 0.1\nmax_step = 0.01\n[[body]]\n" + square, "max_step: is shorter"},
      {"[contact]\nduration = 1\nsolvr = \"lemke\"\n[[body]]\n" + square, "did you mean \"solver\""},
      {"[contact]\nduration = 1\nsolver = \"lemk\"\n[[body]]\n" + square, "did you mean \"lemke\""},
      {"[contact]\nduration = 1\nrigid = \"yes\"\n[[body]]\n" + square, "must be true, false or \"auto\""},
      {"[contact]\nduration = 1\nrigid = false\n[[body]]\n" + square, "no Young's modulus"},
      {motion + "[[body]]\ndensity = 0\n" + square, "body[1].density: a body that moves needs a mass"},
      {motion + "[[body]]\noutline = [[0, 0], [1, 1], [1, 0], [0, 1]]\n", "side 1 and side 3 meet"},
      {motion + "[[body]]\noutline = [[0, 0], [1, 0]]\n", "body[1].outline: has 2 corners"},
      {motion + "[[body]]\nname = \"a\"\n", "holds none of: outline, rectangle, polygon, circle, voussoir"},
      {motion + "[[body]]\nname = \"a\"\n" + square +
           "[[body]]\nname = \"a\"\nrectangle = { corner = [5, 0], width = 1, height = 1 }\n",
       "\"a\" is the name of the body of line 4, too"},
      {motion + "[[body]]\njoint = \"A\"\n" + square, "there is no [joints.A]"},
      {motion + "[joints.a]\ncohesion = 20\nresidual_cohesion = 25\n[[body]]\n" + square, "is more than cohesion"},
      {motion + "[joints.a]\nfriction = 20\nresidual_friction = 25\n[[body]]\n" + square, "is more than friction"},
      {motion + "ground = { time = { kind = \"step\" } }\n[[body]]\n" + square, "contact.ground"},
      {motion + "ground = { record = { step = 0.1 } }\n[[body]]\n" + square, "contact.ground.record.x: is missing"},
      {"[contact]\nstatic = true\nground = { acceleration = [1, 0] }\n[[body]]\n" + square, "knows no time"},
      {motion + "ground = { acceleration = [1, 0] }\n[[body]]\nsupport = [{ side = 1, kind = \"fixed\" }]\n" + square,
       "vibrates about a ground at rest"},
      {motion + "[joints.bedding]\n[[body]]\njoint = \"beding\"\n" + square, "did you mean \"bedding\""},
      {motion + "[[body]]\nname = \"\"\n" + square, "body[1].name: is empty"},
      {motion + "gravity = -9.81\n[[body]]\n" + square, "contact.gravity: is -9.81; give a number from 0"},
      {motion + "[joints.A]\nfriction = 95\n[[body]]\n" + square, "joints.A.friction: is 95"},
      {motion + "[joints.A]\n[[body]]\njoint = [\"A\", \"A\"]\n" + square, "a list of 4, one a side"},
      {motion + "[[body]]\nfixed = true\nangular_velocity = 1\n" + square, "the body is fixed"},
      {motion + "[[body]]\nload = [{ side = 5, pressure = 1 }]\n" + square, "there is no side 5"},
      {motion + "[[body]]\nload = [{ sides = [], pressure = 1 }]\n" + square, "load[1].sides: names no side"},
      {motion + "[[body]]\nload = [{ side = 1, at = [0, 0], force = [1, 0] }]\n" + square, "side: stands beside force"},
      {motion + "[[body]]\nload = [{ side = 1, at = [0, 0], pressure = 1 }]\n" + square, "at: stands beside pressure"},
      {motion + "[[body]]\nload = [{ at = [4, 4], force = [1, 0] }]\n" + square, "(4, 4) lies outside \"body 1\""},
      {"[rock]\nyoung = 1e9\npoisson = 0.2\n" + motion +
           "rigid = false\n[[body]]\nload = [{ at = [0.5, 0.4], force = [0, 1] }]\n" + square,
       "(0.5, 0.4) lies inside \"body 1\", which deforms"},
      {motion + "[[body]]\nload = [{ at = [0, 0], force = [1, 0], time = { kind = \"step\", duration = 1 } }]\n" +
           square,
       "time.duration: has no meaning for kind = \"step\""},
      {motion +
           "[[body]]\nload = [{ at = [0, 0], force = [1, 0], time = { kind = \"harmonic\", frequency = 1, duration = "
           "1 } }]\n" +
           square,
       "time.duration: has no meaning for kind = \"harmonic\""},
      {"[contact]\nstatic = true\n[[body]]\nvelocity = [1, 0]\n" + square, "static = true starts from rest"},
      {"[contact]\nstatic = true\n[[body]]\nload = [{ side = 1, pressure = 1, time = { kind = \"step\" } }]\n" + square,
       "loads change with time in moving scenes only"},
      {"[rock]\nyoung = 1e9\npoisson = 0.2\n" + motion +
           "[[body]]\nvelocity = [1, 0]\nsupport = [{ side = 1, kind = \"fixed\" }]\n" + square,
       "body[1].velocity: a clamped body starts at rest"},
      {motion + "[[body]]\nrepeat = { count = 2 }\n" + square, "repeat.shift: is missing"},
      {motion + "points = [{ at = [9, 9] }]\n[[body]]\n" + square,
       "points[1].at: (9, 9) lies in no body; the nearest is \"body 1\", 11.3 m away"},
      {motion + "points = [{ at = [9, 9], body = \"body 1\" }]\n[[body]]\n" + square,
       "points[1].at: (9, 9) lies outside \"body 1\", 11.3 m away; write a place on that body"},
      {motion + "points = [{ at = [3, 0.5], body = \"body 1\" }]\n[[body]]\n" + square +
           "[[body]]\nrectangle = { corner = [2.5, 0], width = 1, height = 1 }\n",
       "(3, 0.5) lies outside \"body 1\", 2 m away, in \"body 2\""},
      {motion + "points = [{ at = [2.3, 0.5], body = \"body 1\" }]\n[[body]]\n" + square +
           "[[body]]\nrectangle = { corner = [2.5, 0], width = 1, height = 1 }\n",
       "(2.3, 0.5) lies outside \"body 1\", 1.3 m away; the nearest is \"body 2\", 0.2 m away"},
      {motion + "max_displacement = 1e-300\n[[body]]\n" + square,
       "contact.max_displacement: is 1e-300; give a number from 1e-08 to 1"},
      {"[rock]\nyoung = 1e9\npoisson = 0.2\n" + motion + "rigid = false\nelement = 1e-9\n[[body]]\n" + square,
       "s.toml:8: contact.element: makes 4e+09 elements of \"body 1\", more than the 500 that a body may have"},
      {"[rock]\nyoung = 1e9\npoisson = 0.2\n" + motion +
           "rigid = false\n[[body]]\npolygon = { centre = [0, 0], radius = 1, sides = 501 }\n",
       "body.outline: makes 501 elements of \"body 1\""},
      {motion + "points = [{ at = [0, 0], body = \"bode 1\" }]\n[[body]]\n" + square,
       "there is no body \"bode 1\"; did"},
      {motion + "points = [{ name = \"p\", at = [0, 0] }, { name = \"p\", at = [1, 0] }]\n[[body]]\n" + square,
       "points[2].name: \"p\" is the name of another point, too"},
      {motion + "[[body]]\nvoussoir = { centre = [0, 0], radius = 1, thickness = 3, from = 0, to = 10 }\n",
       "not less than twice the radius"},
      {motion + "[[body]]\n" + square +
           "[[body]]\nname = \"late\"\nrectangle = { corner = [0.5, 0.75], width = 1, height = 1 }\n",
       "s.toml:6: body[2]: \"late\" overlaps \"body 1\" by 0.25 m at "},
      {motion + "[[body]]\n" + square + "[[body]]\n" + square, "overlaps \"body 1\" by 0.5 m"},
      // A cross: no corner and no middle of one lies in the other.
      {motion + "[[body]]\nrectangle = { corner = [-1, 0], width = 10, height = 1 }\n[[body]]\nrectangle = { corner = "
                "[0, -1], width = 1, height = 10 }\n",
       "overlaps \"body 1\" by 0.5 m at "},
  };
  for (const auto& [text, want] : bad) {
    EXPECT_NE(first_problem(text).find(want), std::string::npos) << want << "\nbut: " << first_problem(text);
  }
}

// Of what a run will make; a rigid one makes none, whatever `element` says.
TEST(ContactScene, ThePlanCountsTheElements) {
  const auto text = [](const std::string& element, const std::string& rigid) {
    return "[rock]\nyoung = 1e9\npoisson = 0.2\n[contact]\nduration = 0.01\nstep = 0.01\nelement = " + element +
           "\nrigid = " + rigid +
           "\n[[body]]\nrectangle = { corner = [0, 0], width = 2, height = 1 }\nrepeat = { count = 3, shift = [3, 0] "
           "}\n"
           "[[body]]\nrectangle = { corner = [0, 3], width = 1, height = 1 }\n";
  };
  const auto said = [](const Plan& plan) {
    return std::ranges::find(plan.steps, Step::contact, &PlannedStep::step)->why;
  };
  const Plan coarse = make_plan(parsed(text("0.5", "false"))), fine = make_plan(parsed(text("0.02", "false")));
  EXPECT_TRUE(said(coarse).contains("; 20 boundary elements in 2 shapes")) << said(coarse);
  EXPECT_TRUE(said(fine).contains("; 500 boundary elements in 2 shapes")) << said(fine);
  EXPECT_GT(fine.estimate.memory_mb, 50 * coarse.estimate.memory_mb);
  EXPECT_GT(fine.estimate.seconds, 100 * coarse.estimate.seconds);
  const auto freedoms = ran(text("0.5", "false")).bodies[0].freedoms;
  EXPECT_EQ(freedoms, 60U);  // two nodes an element, two freedoms a node, 12 inner motions
  EXPECT_EQ(first_problem(text("1e-9", "true")), "");
}

TEST(ContactScene, AFixedBodyWithASupportIsOneProblem) {
  const auto scene = parse_contact(motion +
                                       "[[body]]\nfixed = true\nsupport = [{ side = 1, kind = \"fixed\" }]\n"
                                       "rectangle = { corner = [0, 0], width = 1, height = 1 }\n" +
                                       "[[body]]\nrectangle = { corner = [3, 0], width = 1, height = 1 }\n",
                                   "s.toml");
  ASSERT_FALSE(scene.has_value());
  ASSERT_EQ(scene.error().size(), 1U) << describe(scene.error().back());
  EXPECT_EQ(scene.error().front().what, "the whole body is fixed");
}

TEST(ContactScene, WhatIsLikelyASlipIsNoted) {
  const std::string square = "rectangle = { corner = [0, 0], width = 1, height = 1 }\n";
  const auto noted = [](const std::string& text, const std::string& want) {
    for (const std::string& note : ran(text).notes) {
      if (note.find(want) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(noted(motion + ground, "every body is fixed: nothing will move"));
  EXPECT_FALSE(noted(motion + ground + "[[body]]\n" + square, "nothing will move"));
  const std::string brief = "[contact]\nduration = 0.01\nstep = 0.01\n";
  const auto beside = [&](const std::string& at) {
    return brief + "points = [{ at = " + at + ", body = \"b\" }]\n[[body]]\nname = \"b\"\n" + square;
  };
  const std::string outside = "lies outside \"b\": it moves as if it were a part of it";
  EXPECT_TRUE(noted(beside("[1.01, 1]"), outside));  // in an open joint
  EXPECT_FALSE(noted(beside("[1, 1]"), outside));
  EXPECT_TRUE(first_problem(beside("[1.02, 1]")).contains("(1.02, 1) lies outside \"b\", 0.02 m away"));
  // A body that nothing weighs down or meets may be of anything; one with weight, or one of two, is of rock.
  const auto light = [&](const std::string& gravity, const std::string& more) {
    return noted("[rock]\nyoung = 1e5\npoisson = 0.25\ndensity = \"1 kg/m3\"\n" + brief + "gravity = " + gravity +
                     "\n[[body]]\n" + square + "load = [{ side = 3, traction = [1, 0] }]\n" + more,
                 "far from usual");
  };
  EXPECT_FALSE(light("0", ""));
  EXPECT_FALSE(light("0.0", ""));
  EXPECT_TRUE(light("9.81", ""));
  EXPECT_TRUE(light("0", ground));
  const auto soft = [&](const std::string& young) {
    return "[rock]\npoisson = 0.2\nyoung = " + young + "\n" + brief + "rigid = false\n[[body]]\n" + square;
  };
  EXPECT_TRUE(noted(soft("50"), "is young in Pa"));  // 50 GPa without its zeros
  EXPECT_FALSE(noted(soft("50e9"), "is young in Pa"));
}

TEST(ContactScene, TouchingIsNoOverlapAndRoundingIsLetPass) {
  const std::string a = motion + "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n";
  EXPECT_EQ(first_problem(a + "[[body]]\nrectangle = { corner = [1, 0.3], width = 1, height = 1 }\n"), "");
  EXPECT_EQ(first_problem(a + "[[body]]\nrectangle = { corner = [0.999999, 0], width = 1, height = 1 }\n"), "");
  EXPECT_EQ(first_problem(a + "[[body]]\nrectangle = { corner = [1, 1], width = 1, height = 1 }\n"), "");
  EXPECT_NE(first_problem(a + "[[body]]\nrectangle = { corner = [0.9999, 0], width = 1, height = 1 }\n"), "");
}

TEST(ContactScene, OverlapsAreFoundInPilesAndInRows) {
  for (const std::string shift : {"[0, 1]", "[1, 0]", "[0.6, 1]", "[1, 0.6]"}) {
    const std::string pile = motion +
                             "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n" +
                             "repeat = { count = 9, shift = " + shift + " }\n";
    EXPECT_EQ(first_problem(pile), "");
    const std::string at =
        shift == "[0, 1]" || shift == "[0.6, 1]" ? "width = 0.5, height = 9" : "width = 9, height = 0.5";
    const auto scene = parse_contact(
        pile + "[[body]]\nname = \"through\"\nrectangle = { corner = [0.25, 0.25], " + at + " }\n", "s.toml");
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().size(), shift == "[0, 1]" || shift == "[1, 0]" ? 9U : 2U) << shift;
  }
}

TEST(ContactScene, OutlinesAreWhatTheySay) {
  const ContactScene s = parsed(
      motion +
      "[joints.A]\nfriction = 10\n[joints.B]\nfriction = 20\n"
      "[[body]]\nname = \"turned\"\noutline = [[0, 0], [0, 1], [2, 1], [2, 0]]\njoint = [\"A\", \"B\", \"B\", \"B\"]\n"
      "load = [{ side = 1, pressure = 5e3 }]\n"
      "[[body]]\nname = \"disc\"\ncircle = { centre = [9, 0], radius = 2, sides = 12 }\n"
      "[[body]]\nname = \"stone\"\nvoussoir = { centre = [20, 0], radius = 1, thickness = 0.2, from = 0, to = 30 }\n"
      "repeat = { count = 6, rotation = 30, centre = [20, 0] }\n");
  ASSERT_EQ(s.bodies.size(), 8U);
  // The side as written from (0, 0) to (0, 1) keeps its joint and load.
  const ContactBody& turned = s.bodies[0];
  const std::size_t side = *turned.loads.at(0).side;
  EXPECT_EQ(turned.corners[side], (Vec2{0, 1}));
  EXPECT_EQ(turned.corners[(side + 1) % 4], (Vec2{0, 0}));
  EXPECT_EQ(s.joints[turned.joint[side]].name, "A");
  EXPECT_EQ(s.notes.size(), 1U);
  double area = 0;
  const auto& disc = s.bodies[1].corners;
  for (std::size_t k = 0; k < disc.size(); ++k) area += cross(disc[k], disc[(k + 1) % disc.size()]) / 2;
  EXPECT_NEAR(area, 4 * std::numbers::pi, 1e-12);
  EXPECT_EQ(s.bodies[7].name, "stone 6");
  // The last stone ends at 180 degrees.
  double left = 1e9;
  for (const Vec2 p : s.bodies[7].corners) left = std::min(left, p.y);
  EXPECT_NEAR(left, 0, 1e-12);
}

TEST(ContactScene, PlanSaysRigidOrElasticAndWhy) {
  const std::string block = "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n";
  const auto why = [&](const std::string& head) { return rigidity_of(parsed(head + block)).why; };
  EXPECT_NE(why(motion).find("rigid blocks: no Young's modulus"), std::string::npos);
  EXPECT_NE(why("[rock]\nyoung = 20e9\npoisson = 0.2\n" + motion).find("strains of about 1.3e-06 stay below 1e-04"),
            std::string::npos);
  EXPECT_NE(why("[rock]\nyoung = 20e6\npoisson = 0.2\n" + motion).find("elastic blocks: strains of about 1.3e-03"),
            std::string::npos);
  EXPECT_NE(why("[rock]\nyoung = 20e6\npoisson = 0.2\n" + motion + "rigid = true\n").find("rigid = true"),
            std::string::npos);
  const Plan plan = make_plan(parsed(motion + block));
  EXPECT_TRUE(plan.runs(Step::contact));
  EXPECT_FALSE(plan.runs(Step::elastic));
  EXPECT_FALSE(plan.runs(Step::cut));
}

// Unsupported scenes are legal: the block falls, exactly.
TEST(ContactScene, PlanNamesTheFilesOfPointsOnlyWhereThereAreSome) {
  const std::string body = "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n";
  const auto files = [&](const std::string& text) {
    for (const PlannedStep& planned : make_plan(parsed(text)).steps) {
      if (planned.step == Step::write) return planned.why;
    }
    return std::string{};
  };
  EXPECT_EQ(files(motion + body).find("points.csv"), std::string::npos);
  EXPECT_NE(files(motion + "points = [{ at = [0, 0] }]\n" + body).find("points.csv"), std::string::npos);
}

TEST(ContactScene, WithoutSupportItFalls) {
  const ContactResult r = ran(
      motion +
      "max_displacement = 1\n"
      "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\nvelocity = [2, 0]\nangular_velocity = 1\n");
  EXPECT_TRUE(r.converged);
  EXPECT_EQ(r.steps, 100U);
  EXPECT_NEAR(r.bodies[0].centroid.y, 0.5 - 9.81 / 2, 1e-12);
  EXPECT_NEAR(r.bodies[0].centroid.x, 2.5, 1e-12);
  EXPECT_NEAR(r.bodies[0].rotation, 1, 1e-12);
  EXPECT_LT(r.drift_momentum, 1e-12);
}

// Strengths by side: the block slides on the side whose joint is smooth and not on the other.
TEST(ContactScene, ALoadShorterThanAStepKeepsItsImpulse) {
  // 520 kN/m in a triangle of 5 ms on 2,600 kg/m: 0.5 m/s, however long the step.
  const auto pulse = [](const std::string& step, const std::string& time) {
    return "[rock]\ndensity = 2600\n[contact]\nduration = 1\ngravity = 0\nframes = 1\nrigid = true\n" + step +
           "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n"
           "load = [{ at = [0.5, 0.5], force = [520000, 0], time = { " +
           time + " } }]\n";
  };
  for (const std::string step : {"step = 0.1\n", "step = 0.01\n", "step = 0.007\n", ""}) {
    const ContactResult result = ran(pulse(step, "kind = \"pulse\", duration = 0.005"));
    EXPECT_NEAR(result.history.back().kinetic, 0.5 * 2600 * 0.25, 1e-9) << step;
    const bool noted = !result.notes.empty() && result.notes.front().find("is long for a load") != std::string::npos;
    EXPECT_EQ(noted, !step.empty()) << step;
  }
  EXPECT_NEAR(ran(pulse("step = 0.1\n", "kind = \"ramp\", duration = 0.25")).history.back().kinetic,
              1300 * std::pow(200 * (1 - 0.125), 2), 1e-3);
  EXPECT_NEAR(ran(pulse("step = 0.1\n", "kind = \"harmonic\", frequency = 1.25")).history.back().kinetic,
              1300 * std::pow(200 / (2.5 * std::numbers::pi), 2), 1e-3);
}

// Loose blocks that land on each other and bounce with friction: while they do, no step gains energy, weight included.
TEST(ContactScene, BouncingWithFrictionGainsNothing) {
  const ContactResult result = ran(
      "[rock]\ndensity = 2600\n[contact]\nduration = 0.6\nstep = 0.005\nrestitution = 0.3\nrigid = true\n" + ground +
      "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0.05], width = 1, height = 0.4 }\nrepeat = { count = 5, "
      "shift "
      "= [0.02, 0.45] }\n");
  EXPECT_TRUE(result.converged) << result.stopped_why;
  EXPECT_LT(result.history.back().gravity, -5000);
  EXPECT_LT(result.energy_gain, 1e-9);  // of 7 kJ: it was 0.08 J
}

TEST(ContactScene, SidesHaveTheirOwnJoints) {
  const auto slid = [&](const std::string& joints) {
    const ContactResult r = ran(
        "[joints.default]\nfriction = 40\n[joints.smooth]\nfriction = 0\n[contact]\nduration = 0.5\nstep = 0.01\n" +
        ground +
        "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0], width = 1, height = 1 }\nvelocity = [1, 0]\njoint = " +
        joints + "\n");
    return r.bodies[1].centroid.x - 0.5;
  };
  EXPECT_NEAR(slid("[\"smooth\", \"default\", \"default\", \"default\"]"), 0.5, 1e-9);
  // v^2 / (2 mu g)
  EXPECT_NEAR(slid("[\"default\", \"smooth\", \"smooth\", \"smooth\"]"),
              1 / (2 * 9.81 * std::tan(40 * std::numbers::pi / 180)), 2e-3);
}

// Of two named joints the weaker strength counts.
TEST(ContactScene, WeakerOfTwoNamedJointsCounts) {
  for (const bool swapped : {false, true}) {
    const std::string rough = swapped ? "B" : "A", smooth = swapped ? "A" : "B";
    const ContactResult r =
        ran("[joints." + rough + "]\nfriction = 40\n[joints." + smooth +
            "]\nfriction = 0\n[contact]\nduration = 0.5\nstep = 0.01\n" + ground + "joint = \"" + rough +
            "\"\n[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\nvelocity = [1, "
            "0]\njoint = \"" +
            smooth + "\"\n");
    EXPECT_NEAR(r.bodies[1].centroid.x, 1, 1e-9);
  }
}

// A stack at rest: forces n, 2n, ... of the weight, the same rigid and elastic; the elastic one is shortened by its own
// weight, rho g H^2 / (2 E) for a column that may widen (plane stress), within the effect of its ends.
TEST(ContactScene, StackRestsRigidAndElastic) {
  const auto stack = [&](const std::string& rigid) {
    return ran(
        "[rock]\nyoung = 1e8\npoisson = 0\ndensity = 2000\n[joints.default]\nfriction = 30\n"
        "[contact]\nstatic = true\nrigid = " +
        rigid + "\npoints = [{ name = \"top\", at = [0.5, 4], body = \"b 4\" }]\n" + ground +
        "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0], width = 1, height = 1 }\nrepeat = { count = 4, shift = "
        "[0, 1] }\n");
  };
  const double weight = 2000 * 9.81;
  for (const std::string rigid : {"true", "false"}) {
    const ContactResult r = stack(rigid);
    EXPECT_TRUE(r.converged) << r.stopped_why;
    EXPECT_NEAR(r.bodies[0].force.y, -4 * weight, 1e-6 * weight);
    if (rigid == "true") continue;
    // Each block carries those above and half of itself: 3.5 + 2.5 + 1.5 + 0.5 weights.
    const double shortened = 8 * weight / 1e8;
    EXPECT_NEAR(r.history.back().points[0].y, -shortened, 0.01 * shortened);
    EXPECT_EQ(r.operators, 1U);  // bodies alike share one
    EXPECT_TRUE(r.notes.empty()) << r.notes.front();
  }
}

TEST(ContactScene, NoRestIsSaid) {
  const ContactResult r =
      ran("[contact]\nstatic = true\nduration = 1\nstep = 0.05\n[[body]]\nrectangle = { corner = [0, 0], width = 1, "
          "height = 1 }\n");
  EXPECT_FALSE(r.converged);
  EXPECT_NE(r.stopped_why.find("did not come to rest"), std::string::npos);
  EXPECT_FALSE(r.frames.empty());
}

TEST(ContactScene, ARunOutOfWorkStopsAndKeepsWhatIsDone) {
  const std::string stack =
      ground +
      "[[body]]\nrectangle = { corner = [0, 0.01], width = 1, height = 1 }\nrepeat = { count = 5, shift = "
      "[0.1, 1.01] }\n";
  const ContactResult whole = ran(motion + stack);
  EXPECT_TRUE(whole.converged);
  ASSERT_GT(whole.work, 0);
  const double half = 0.5e-9 * whole.work;
  const ContactResult stopped = ran(fmt::format("{}work = {:.17g}\n{}", motion, half, stack));
  EXPECT_FALSE(stopped.converged);
  EXPECT_NE(stopped.stopped_why.find("of contact.work at"), std::string::npos) << stopped.stopped_why;
  EXPECT_GE(stopped.work, 1e9 * half);
  EXPECT_LT(stopped.end_time, 1);
  EXPECT_GT(stopped.steps, 0U);
  // As far as it came it is the same run.
  ASSERT_GE(whole.history.size(), stopped.history.size());
  for (std::size_t k = 0; k + 1 < stopped.history.size(); ++k) {
    EXPECT_EQ(stopped.history[k].kinetic, whole.history[k].kinetic) << k;
  }
  EXPECT_TRUE(ran(fmt::format("{}work = {:.17g}\n{}", motion, 4 * half, stack)).converged);
}

/// Of a block on a floor that moves: Newmark's sliding block (1965), both ways, in small steps.
double newmark(const GroundMotion& motion_of_ground, Vec2 gravity, double friction, double end) {
  constexpr double dt = 2e-6;
  double v = 0, x = 0;
  for (double t = 0; t < end; t += dt) {
    const Vec2 field = gravity - motion_of_ground.at(t + 0.5 * dt);
    const double free = v + dt * field.x, grip = dt * friction * std::max(0.0, -field.y);
    v = std::copysign(std::max(0.0, std::abs(free) - grip), free);
    x += dt * v;
  }
  return x;
}

TEST(ContactScene, APushedJointRisesByItsDilationUpToItsSlip) {
  const auto moved = [&](const std::string& body_joint, const std::string& joints) {
    return ran("[contact]\nduration = 0.6\nstep = 2e-3\ngravity = [8, -9.81]\n" + joints + ground +
               "[[body]]\nname = \"block\"\nrectangle = { corner = [0, 0], width = 1, height = 0.4 }\n" + body_joint)
        .bodies[1]
        .centroid;
  };
  const double rise = std::tan(10 * std::numbers::pi / 180);
  const auto far = moved("", "[joints.default]\nfriction = 30\ndilation = 10\ndilation_slip = 5\n");
  EXPECT_GT(far.x - 0.5, 0.2);
  EXPECT_NEAR(far.y - 0.2, rise * (far.x - 0.5), 1e-6);
  const auto ends = moved("joint = \"rough\"\n",
                          "[joints.default]\nfriction = 30\n[joints.rough]\ndilation = 10\ndilation_slip = 0.03\n");
  EXPECT_NEAR(ends.y - 0.2, rise * 0.03, 1e-6);
}

TEST(ContactScene, WaterInAJointTakesAwayNormalForce) {
  const auto x = [&](const std::string& joints, const std::string& body_joint, const std::string& rigid,
                     const std::string& ground_joint = "") {
    return ran("[contact]\nduration = 0.4\nstep = 2e-3\n" + rigid + "gravity = [4, -9.81]\n" + joints +
               "[rock]\ndensity = 2600\nyoung = 1e10\npoisson = 0.2\n" + ground + ground_joint +
               "[[body]]\nname = \"block\"\nrectangle = { corner = [0, 0], width = 1, height = 0.5 }\n" + body_joint)
               .bodies[1]
               .centroid.x -
           0.5;
  };
  const double way = 0.08 * (4 - std::tan(30 * std::numbers::pi / 180) * (9.81 - 6000.0 / 1300));
  EXPECT_NEAR(x("[joints.default]\nwater_pressure = 6000\n", "", "rigid = true\n"), way, 1e-8);
  EXPECT_NEAR(x("[joints.default]\n[joints.wet]\nwater_pressure = 6000\n", "joint = \"wet\"\n", "rigid = false\n"), way,
              1e-3 * way);
  // The table lies 6000 / 9810 m above the joint.
  EXPECT_NEAR(x("[joints.default]\nwater_table = 0.6116207951070336\n", "", "rigid = true\n"), way, 1e-8);
  EXPECT_NEAR(x("[joints.default]\nfriction = 30\n", "", "rigid = true\n"), 0, 1e-9);
  // Of the waters of two names the higher one is there, whichever body has it.
  for (const auto& [high, low] : {std::pair{"water_pressure = 6000\n", "water_pressure = 3000\n"},
                                  std::pair{"water_table = 0.6116207951070336\n", "water_table = 0.3\n"},
                                  std::pair{"water_table = 0.6116207951070336\n", "friction = 30\n"}}) {
    const std::string both = fmt::format("[joints.default]\n[joints.deep]\n{}[joints.shallow]\n{}", high, low);
    for (const auto& [block, below] : {std::pair{"deep", "shallow"}, std::pair{"shallow", "deep"}}) {
      EXPECT_NEAR(
          x(both, fmt::format("joint = \"{}\"\n", block), "rigid = true\n", fmt::format("joint = \"{}\"\n", below)),
          way, 1e-8)
          << high << low << block;
    }
  }
}

/// A block of 2 x 1 m that holds a stress, among fixed bodies, smooth joints.
ContactResult locked(const std::string& how, const std::string& more, const std::string& stress) {
  return ran("[contact]\nrigid = false\nelement = 0.5\n" + how + "in_situ = { stress = " + stress +
             " }\n[joints.default]\nfriction = 0\n[rock]\ndensity = 2600\nyoung = 1e9\npoisson = 0.25\n" + ground +
             more + "[[body]]\nname = \"rock\"\nrectangle = { corner = [0, 0], width = 2, height = 1 }\n");
}

/// Farthest and highest place of a body at the end.
bem::Vec2 reach_of(const ContactResult& result, std::size_t body) {
  bem::Vec2 most{-1e300, -1e300};
  for (const bem::Vec2 p : corners_at(result, result.frames.size() - 1, body)) {
    most = {std::max(most.x, p.x), std::max(most.y, p.y)};
  }
  return most;
}

TEST(ContactScene, StressLockedInIsHeldByWallsAndLetGoWhereThereAreNone) {
  const std::string left =
      "[[body]]\nname = \"left\"\nfixed = true\nrectangle = { corner = [-1, 0], width = 1, height = 1 }\n";
  const std::string right =
      "[[body]]\nname = \"right\"\nfixed = true\nrectangle = { corner = [2, 0], width = 1, height = 1 }\n";
  const std::string roof =
      "[[body]]\nname = \"roof\"\nfixed = true\nrectangle = { corner = [-1, 1], width = 4, height = 1 }\n";
  const std::string stress = "[-2e6, -1e6, 0]";
  const ContactResult held = locked("duration = 0.01\nstep = 1e-3\ngravity = 0\n", left + right + roof, stress);
  EXPECT_TRUE(held.converged);
  EXPECT_LT(held.largest_displacement, 1e-9);
  EXPECT_NEAR(held.bodies[2].force.x, 2e6, 1);  // right
  EXPECT_NEAR(held.bodies[3].force.y, 2e6, 1);  // roof: 1 MPa on 2 m
  for (const NodeStress& node : held.frames.back().stress[4]) {
    EXPECT_NEAR(node.stress.xx, -2e6, 10);
    EXPECT_NEAR(node.stress.yy, -1e6, 10);
    EXPECT_NEAR(node.stress.xy, 0, 10);
  }
  // Let go, to the right and upwards, all of it goes, with the strains of plane strain; beside those of the weight.
  const std::string rest = "static = true\n", none = "[0, 0, 0]";
  const double e = 1e9, nu = 0.25;
  const double across = (1 - nu * nu) / e * 2e6 - nu * (1 + nu) / e * 1e6;
  const double up = (1 - nu * nu) / e * 1e6 - nu * (1 + nu) / e * 2e6;
  const ContactResult free = locked(rest, left, stress), bare = locked(rest, left, none);
  EXPECT_TRUE(free.converged);
  EXPECT_NEAR(reach_of(free, 2).x - reach_of(bare, 2).x, 2 * across, 1e-5 * across);
  EXPECT_NEAR(reach_of(free, 2).y - reach_of(bare, 2).y, up, 1e-5 * up);
  for (std::size_t k = 0; k < free.frames.back().stress[2].size(); ++k) {
    const bem::Sym2 with = free.frames.back().stress[2][k].stress, without = bare.frames.back().stress[2][k].stress;
    EXPECT_NEAR(with.xx, without.xx, 20);
    EXPECT_NEAR(with.yy, without.yy, 20);
  }
  // Upwards only: the walls keep what then is across, uniaxial in the height.
  const double kept =
      locked(rest, left + right, stress).bodies[2].force.x - locked(rest, left + right, none).bodies[2].force.x;
  EXPECT_NEAR(kept, 2e6 - nu / (1 - nu) * 1e6, 20);
}

TEST(ContactScene, StressLockedInGrowsWithDepthAndNeedsElasticBodies) {
  const std::string pile =
      ground +
      "[[body]]\nname = \"low\"\nrectangle = { corner = [0, 0], width = 2, height = 1 }\n"
      "[[body]]\nname = \"high\"\nrectangle = { corner = [0, 1], width = 2, height = 1 }\n"
      "[[body]]\nname = \"left\"\nfixed = true\nrectangle = { corner = [-1, 0], width = 1, height = 2 }\n"
      "[[body]]\nname = \"right\"\nfixed = true\nrectangle = { corner = [2, 0], width = 1, height = 2 }\n";
  const std::string rock = "[joints.default]\nfriction = 0\n[rock]\ndensity = 2600\nyoung = 1e9\npoisson = 0\n";
  const std::string in_situ = "in_situ = { stress = [-1e6, 0, 0], level = 2, gradient = [1e5, 0, 0] }\n";
  const ContactResult r =
      ran("[contact]\nduration = 0.01\nstep = 1e-3\nrigid = false\ngravity = 0\n" + in_situ + rock + pile);
  // Each as at its centroid: 1.05 and 1.15 MPa on 1 m.
  EXPECT_NEAR(r.bodies[4].force.x, 2.2e6, 1);
  EXPECT_NE(
      first_problem("[contact]\nduration = 1\nrigid = true\n" + in_situ + rock + pile).find("in_situ: is locked in"),
      std::string::npos);
}

TEST(ContactScene, MassDampingSlowsASlider) {
  const double rate = 4, t = 1.5, pull = 3 - std::tan(10 * std::numbers::pi / 180) * 9.81;
  const ContactResult result = ran(
      "[contact]\nduration = 1.5\nstep = 2e-3\nmass_damping = 4\ngravity = [3, -9.81]\n[joints.default]\nfriction = "
      "10\n" +
      ground + "[[body]]\nname = \"block\"\nrectangle = { corner = [0, 0], width = 1, height = 0.4 }\n");
  const double way = pull / rate * (t - (1 - std::exp(-rate * t)) / rate);
  EXPECT_NEAR(result.bodies[1].centroid.x - 0.5, way, 1e-5 * way);
}

TEST(ContactScene, ABlockOnAMovingGroundSlidesAsNewmarksBlock) {
  const std::string block =
      ground + "[[body]]\nname = \"block\"\nrectangle = { corner = [0, 0], width = 1, height = 0.4 }\n";
  const std::string strength = "[joints.default]\nfriction = 20\n";
  const double friction = std::tan(20 * std::numbers::pi / 180);
  const auto moved = [&](const std::string& more, double step) {
    const ContactResult result =
        ran(fmt::format("[contact]\nduration = 1.5\nstep = {}\n{}\n{}{}", step, more, strength, block));
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.bodies[1].centroid.y, 0.2, 1e-6);
    return result.bodies[1].centroid.x - 0.5;
  };
  // Constant: closed form.
  const double left = -0.5 * (0.5 * 9.81 - friction * 9.81) * 1.5 * 1.5;
  EXPECT_NEAR(moved("ground = { acceleration = [4.905, 0] }", 1e-2), left, 1e-7);
  // Less than friction holds: it goes with the ground.
  EXPECT_NEAR(moved("ground = { acceleration = [3.5, 0] }", 1e-2), 0, 1e-9);
  // A ground that shakes upwards lightens the block.
  GroundMotion shaken;
  shaken.amplitude = {5, -4};
  shaken.time = {.kind = TimeFunction::Kind::harmonic, .duration = {}, .frequency = Rate::from_si(2)};
  const double steep = newmark(shaken, {1.5, -9.7}, friction, 1.5);
  const std::string harmonic =
      "gravity = [1.5, -9.7]\nground = { acceleration = [5, -4], time = { kind = \"harmonic\", frequency = 2 } }";
  EXPECT_GT(std::abs(steep), 0.01);
  EXPECT_NEAR(moved(harmonic, 1e-3), steep, 5e-4 * std::abs(steep));
  // The same triangle as a pulse and as a record whose values lie where no step ends.
  GroundMotion pulse;
  pulse.amplitude = {-8, 0};
  pulse.time = {.kind = TimeFunction::Kind::pulse, .duration = seconds(0.7), .frequency = {}};
  const double thrown = newmark(pulse, {0, -9.81}, friction, 1.5);
  EXPECT_GT(thrown, 0.1);
  const double by_pulse =
      moved("ground = { acceleration = [-8, 0], time = { kind = \"pulse\", duration = 0.7 } }", 1e-3);
  const double by_record = moved("ground = { record = { step = 0.35, x = [0, 4, 0], scale = -2 } }", 1e-3);
  EXPECT_NEAR(by_pulse, thrown, 1e-3 * thrown);
  EXPECT_NEAR(by_record, by_pulse, 1e-9);
}

TEST(ContactScene, MeansOfARecordAreThoseOfItsLines) {
  const ContactScene scene =
      parsed(motion + "ground = { record = { step = 0.25, x = [0, 4, -2], y = [1], scale = 0.5 } }\n" + ground +
             "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n");
  ASSERT_TRUE(scene.settings.ground.has_value());
  const GroundMotion& g = *scene.settings.ground;
  EXPECT_EQ(g.at(0.25), (Vec2{2, 0}));
  EXPECT_EQ(g.at(0.125), (Vec2{1, 0.25}));
  EXPECT_EQ(g.at(0.6), (Vec2{}));
  for (const auto& [from, to] : {std::pair{0.0, 0.1}, {0.1, 0.45}, {0.2, 0.9}, {0.6, 0.7}, {0.0, 0.5}}) {
    Vec2 sum;
    constexpr int parts = 20000;
    for (int k = 0; k < parts; ++k) sum += 1.0 / parts * g.at(from + (to - from) * (k + 0.5) / parts);
    EXPECT_NEAR(norm(g.mean(from, to) - sum), 0, 1e-4) << from << ' ' << to;
  }
}

TEST(ContactScene, WhatHasSlippedKeepsTheWeakerResidualCohesion) {
  const ContactResult result =
      ran("[contact]\nduration = 0.8\nstep = 0.001\ngravity = [4.905, -8.495709]\n"
          "[joints.a]\nfriction = 0\ncohesion = 5000\nresidual_cohesion = 3000\n"
          "[joints.b]\nfriction = 0\ncohesion = 5000\nresidual_cohesion = 1000\n"
          "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
          "joint = \"a\"\n[[body]]\nrectangle = { corner = [-3, 0], width = 1, height = 0.4 }\njoint = \"b\"\n");
  ASSERT_TRUE(result.converged);
  // Against 1 kN/m on 1,080 kg/m, from the start.
  EXPECT_NEAR(result.bodies[1].centroid.x + 2.5, 0.32 * (4.905 - 1000.0 / 1080), 1e-6);
}

// A joint that has slipped holds by its residual friction only; one that has not keeps all it had.
TEST(ContactScene, WhatHasSlippedHoldsLess) {
  const auto moved = [&](const std::string& joints, const std::string& more = "") {
    const ContactResult result =
        ran("[contact]\nduration = 0.8\nstep = 0.001\ngravity = [4.905, -8.495709]\n" + joints + ground +
            "[[body]]\nrectangle = { corner = [-3, 0], width = 1, height = 0.4 }\n" + more);
    EXPECT_TRUE(result.converged);
    return result.bodies[1].centroid.x + 2.5;
  };
  const auto slid = [](double degrees) {
    return 0.5 * 0.64 * (4.905 - 8.495709 * std::tan(degrees * std::numbers::pi / 180));
  };
  EXPECT_NEAR(moved("[joints.default]\nfriction = 31\nresidual_friction = 10\n"), 0, 1e-9);
  EXPECT_NEAR(moved("[joints.default]\nfriction = 28\n"), slid(28), 1e-6);
  EXPECT_NEAR(moved("[joints.default]\nfriction = 28\nresidual_friction = 10\n"), slid(10), 1e-6);
  // The weaker of two joints counts here, too.
  const std::string two =
      "[joints.a]\nfriction = 28\nresidual_friction = 20\n[joints.b]\nfriction = 35\nresidual_friction = 10\n";
  const std::string floor =
      "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\njoint = "
      "\"a\"\n";
  const ContactResult result =
      ran("[contact]\nduration = 0.8\nstep = 0.001\ngravity = [4.905, -8.495709]\n" + two + floor +
          "[[body]]\nrectangle = { corner = [-3, 0], width = 1, height = 0.4 }\njoint = \"b\"\n");
  EXPECT_NEAR(result.bodies[1].centroid.x + 2.5, slid(10), 1e-6);
}

// A block of 2 m on a joint, pushed at its foot; elastic ones share the joint among nine nodes.
TEST(ContactScene, JointsCloseAndShearByTheirStiffness) {
  const double weight = 2000 * 2 * 9.81;
  for (const std::string mode : {"rigid = true\n", "rigid = false\nelement = 0.5\n"}) {
    const ContactResult r =
        ran("[rock]\ndensity = 2000\nyoung = 1e14\npoisson = 0.2\n[joints.default]\nfriction = 60\nnormal_stiffness = "
            "1e9\n[joints.soft]\nshear_stiffness = 2e8\n[contact]\nduration = 100\nstatic = true\n" +
            mode +
            "[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
            "[[body]]\nname = \"b\"\njoint = \"soft\"\nrectangle = { corner = [0, 0], width = 2, height = 1 }\n"
            "load = [{ force = [10000, 0], at = [0, 0] }]\n");
    ASSERT_TRUE(r.converged);
    const ContactBodyResult& b = r.bodies[1];
    EXPECT_NEAR((0.5 - b.centroid.y) / (weight / (1e9 * 2)), 1, 2e-3) << mode;
    EXPECT_NEAR((corners_at(r, r.frames.size() - 1, 1)[0].x) / (10000 / (2e8 * 2)), 1, 2e-3) << mode;
  }
  // Of two named joints the softer one counts, and one that is rigid is not softer.
  const ContactResult two =
      ran("[rock]\ndensity = 2000\n[joints.a]\nnormal_stiffness = 1e9\n[joints.b]\nnormal_stiffness = 5e8\n"
          "[joints.c]\nfriction = 40\n[contact]\nduration = 100\nstatic = true\nrigid = true\n"
          "[[body]]\nname = \"floor\"\njoint = \"a\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 20, "
          "height = 1 }\n"
          "[[body]]\nname = \"b\"\njoint = \"b\"\nrectangle = { corner = [0, 0], width = 2, height = 1 }\n"
          "[[body]]\nname = \"c\"\njoint = \"c\"\nrectangle = { corner = [5, 0], width = 2, height = 1 }\n");
  EXPECT_NEAR((0.5 - two.bodies[1].centroid.y) / (weight / (5e8 * 2)), 1, 1e-3);
  EXPECT_NEAR((0.5 - two.bodies[2].centroid.y) / (weight / (1e9 * 2)), 1, 1e-3);
}

// A brick on another one tips over the end of its side: its spring, pressed by a millimetre, is handed from one edge to
// the next and stands for more of the joint there.
TEST(ContactScene, SpringsThatChangeTheirEdgeMakeNoEnergy) {
  for (const double step : {1e-3, 5e-4}) {
    const ContactResult r = ran(
        "[rock]\ndensity = 2600\nyoung = 6378788802.382604\npoisson = 0.25\n[joints.default]\nfriction = 30\n"
        "normal_stiffness = 499651669.4645712\nshear_stiffness = 249825834.7322856\n[contact]\nduration = 0.14\nrigid "
        "= false\nelement = 0.5\nground = { acceleration = [-0.7806293732982956, 1.8967447730370215] }\nstep = " +
        fmt::format("{}", step) +
        "\n[[body]]\nfixed = true\noutline = [[-20, -1], [30, -1], [30, 0], [-20, 0]]\n"
        "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 0.5 }\n"
        "[[body]]\nrectangle = { corner = [0.5, 0.5], width = 1, height = 0.5 }\n");
    ASSERT_TRUE(r.converged);
    EXPECT_LT(r.energy_gain, 1e-6) << step;  // it was 28.9 J
    EXPECT_GT(r.history.back().lost, 0) << step;
  }
}

// A block of 2 m on springs under its weight, let go: what a swing loses in a period is what the note says.
TEST(ContactScene, StepsThatDampSpringsAreSaid) {
  const double period = 2 * std::numbers::pi * std::sqrt(2000.0 / 1e7);
  const auto let_go = [&](double step, bool at_rest) {
    return ran(
        fmt::format("[rock]\ndensity = 2000\n[joints.default]\nfriction = 30\nnormal_stiffness = 1e7\n[contact]\n"
                    "rigid = true\n{}duration = {}\nstep = {}\n[[body]]\nfixed = true\nrectangle = {{ corner = "
                    "[-5, -1], width = 10, height = 1 }}\n[[body]]\nrectangle = {{ corner = [0, 0], width = 2, "
                    "height = 1 }}\n",
                    at_rest ? "static = true\n" : "", at_rest ? 100.0 : 2 * period, step));
  };
  const auto note_of = [](const ContactResult& r) {
    for (const std::string& note : r.notes) {
      if (note.contains("swing on joints with stiffness")) return note;
    }
    return std::string{};
  };
  const ContactResult coarse = let_go(period / 100, false);
  const std::string note = note_of(coarse);
  EXPECT_TRUE(note.contains("with periods of 0.089 to 0.089 s, and steps of 0.00089 s take 26 to 26 %")) << note;
  EXPECT_TRUE(note.contains("with step = 3e-05 it is")) << note;
  // Of half the weight's sag times the weight; what it would give to the swing and to gravity stays otherwise.
  const double swing = 0.5 * std::pow(2 * 2000 * 9.81, 2) / (2 * 1e7);
  EXPECT_NEAR(coarse.history.back().lost / swing, 1 - (1 - 0.256) * (1 - 0.256), 0.01);
  EXPECT_EQ(note_of(let_go(period / 100, true)), "");
  EXPECT_EQ(note_of(let_go(period / 3200, false)), "");
}

// Bricks that turn about one another while friction holds them: no slip, and none that gives anything back.
TEST(ContactScene, FrictionTakesAndNeverGives) {
  std::string bricks;
  for (int course = 0; course < 4; ++course) {
    for (const double x : {0.0, 1.0}) {
      bricks += fmt::format("[[body]]\nrectangle = {{ corner = [{}, {}], width = 1, height = 0.5 }}\n",
                            x + 0.5 * (course % 2), 0.5 * course);
    }
  }
  const ContactResult r =
      ran("[rock]\ndensity = 2600\n[joints.default]\nfriction = 55\n[contact]\nduration = 0.4\nstep = 0.005\nrigid = "
          "true\nground = { acceleration = [7.145169212064729, -1.423441990069751] }\n"
          "[[body]]\nfixed = true\noutline = [[-20, -1], [30, -1], [30, 0], [-20, 0]]\n" +
          bricks);
  ASSERT_TRUE(r.converged);
  for (std::size_t k = 1; k < r.history.size(); ++k) {
    ASSERT_GE(r.history[k].friction, r.history[k - 1].friction) << r.history[k].time;
  }
  const ContactHistory& last = r.history.back();
  EXPECT_NEAR(last.kinetic + last.gravity + last.friction + last.lost, last.work, 1e-9 * last.work);
}

TEST(ContactScene, ErrorOfTheStepsIsEstimatedOrNot) {
  // A block of 0.4 x 1 m rocks on its base; the answer of a hundredth of the step is the exact one.
  const auto rocking = [](double step, bool asked) {
    return "[rock]\ndensity = 2000\n[joints.default]\nfriction = 60\n[contact]\nduration = 0.6\nrigid = true\nstep = " +
           fmt::format("{}", step) + (asked ? "\nestimate = true" : "") +
           "\n[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
           "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0], width = 0.4, height = 1, angle = 8 }\n";
  };
  const ContactResult fine = ran(rocking(2e-5, false));
  EXPECT_FALSE(fine.error.has_value());
  EXPECT_NE(fine.no_estimate.find("contact.estimate"), std::string::npos);
  std::size_t given = 0;
  for (const double step : {4e-3, 2e-3, 1e-3, 5e-4}) {
    const ContactResult r = ran(rocking(step, true));
    ASSERT_TRUE(r.converged);
    const auto own = corners_at(r, r.frames.size() - 1, 1), exact = corners_at(fine, fine.frames.size() - 1, 1);
    double wrong = 0;
    for (std::size_t k = 0; k < own.size(); ++k) wrong = std::max(wrong, norm(own[k] - exact[k]));
    wrong /= r.largest_displacement;
    EXPECT_NE(r.error.has_value(), !r.no_estimate.empty());
    if (!r.error) continue;
    ++given;
    EXPECT_GT(*r.error, wrong / 3) << step;
    EXPECT_LT(*r.error, 10 * wrong + 1e-6) << step;
  }
  EXPECT_GE(given, 1U);
}

/// Estimated over true error of the final height of a block; nothing without an estimate.
std::optional<double> estimate_over_error(const std::string& contact, double height, double exact) {
  const ContactResult r =
      ran("[rock]\ndensity = 2600\nyoung = 1e8\npoisson = 0.25\n[contact]\nestimate = true\n" + contact +
          "[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
          "[[body]]\nname = \"b\"\nrectangle = { corner = [0, " +
          fmt::format("{}", height) + "], width = 1, height = 1 }\n");
  EXPECT_TRUE(r.converged);
  EXPECT_NE(r.error.has_value(), !r.no_estimate.empty());
  if (!r.error) return std::nullopt;
  return *r.error * r.largest_displacement / std::abs(r.bodies[1].centroid.y - exact);
}

// Two changes that were small by chance gave a thirtieth of the error; steps that damp all vibrations agree on a motion
// that has none, and gave 10^-9 where the answer was wrong by half.
TEST(ContactScene, ChanceIsNoEstimateOfTheError) {
  // A bounce without loss from 1 m: down and up again in the time a fall of 1 m takes, each.
  const double fall = std::sqrt(2 / 9.81), late = 1.2 - 2 * fall;
  const double exact = 1.5 - 0.5 * 9.81 * late * late;
  std::size_t given = 0;
  for (const double step : {1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 6e-3}) {
    const auto share =
        estimate_over_error(fmt::format("duration = 1.2\nrigid = true\nrestitution = 1\nstep = {}\n", step), 1, exact);
    if (!share) continue;
    EXPECT_GT(*share, 0.33) << step;
    EXPECT_LT(*share, 30) << step;
    ++given;
  }
  EXPECT_GE(given, 3U);
  // Its slowest vibration takes 13 ms.
  for (const double step : {2e-3, 8e-3}) {
    EXPECT_FALSE(estimate_over_error(fmt::format("duration = 0.6\nrigid = false\nstep = {}\n", step), 0.3, 0.6));
  }
}

TEST(ContactScene, StressOfAStackIsItsWeightAndSafetyThatOfItsStrength) {
  // Two blocks of 1 x 2 m on a floor at rest, Poisson's ratio 0: -rho g (4 - y) up the stack. Mohr and Coulomb without
  // confinement: 2 c cos(phi) / (1 - sin(phi)) over it.
  for (const double angle : {0.0, 90.0}) {
    const std::string turned = angle == 0 ? "rectangle = { corner = [0, 0], width = 1, height = 2 }\n"
                                          : "rectangle = { corner = [1, 0], width = 2, height = 1, angle = 90 }\n";
    const ContactResult r =
        ran("[rock]\ndensity = 2000\nyoung = 1e9\npoisson = 0\n[contact]\nstatic = true\nduration = 100\nstep = 0.05\n"
            "gravity = 10\nrigid = false\nstrength = { cohesion = 1e5, friction = 30, tension = 1e4 }\n[[body]]\nname "
            "= \"floor\"\nfixed = true\n"
            "rectangle = { corner = [-2, -1], width = 5, height = 1 }\n[[body]]\nname = \"b\"\n" +
            turned + "repeat = { count = 2, shift = [0, 2] }\n");
    ASSERT_TRUE(r.converged);
    const ContactFrame& last = r.frames.back();
    EXPECT_TRUE(last.stress[0].empty());
    for (std::size_t b = 1; b < 3; ++b) {
      ASSERT_EQ(last.stress[b].size(), last.corners[b].size());
      ASSERT_GE(last.stress[b].size(), 16U);
      for (std::size_t v = 0; v < last.stress[b].size(); ++v) {
        const double weight = 2e4 * (4 - last.corners[b][v].y);
        const NodeStress& node = last.stress[b][v];
        EXPECT_NEAR(node.stress.yy, -weight, 1500) << angle << ' ' << b << ' ' << v;
        EXPECT_NEAR(node.stress.xx, 0, 1500);
        EXPECT_NEAR(node.stress.xy, 0, 1500);
        if (weight < 1e4) continue;
        EXPECT_NEAR(node.von_mises / weight, 1, 0.15);
        EXPECT_NEAR(*node.safety * weight / (2e5 * std::sqrt(3.0)), 1, 0.15);
      }
    }
  }
}

// Chapter 6 and 7 agree: a turned, repeated elastic body has the modes of its shape turned.
TEST(ContactScene, TurnedElasticBodiesShareAnOperator) {
  const std::string head =
      "[rock]\nyoung = 1e7\npoisson = 0.25\n[contact]\ngravity = 0\nduration = 0.05\nstep = 1e-3\nrigid = false\n";
  const ContactResult r = ran(head +
                              "[[body]]\nname = \"b\"\nrectangle = { corner = [1, 0], width = 2, height = 1 }\n"
                              "load = [{ side = 2, pressure = 1e5 }, { side = 4, pressure = 1e5 }]\n"
                              "repeat = { count = 3, rotation = 90, centre = [0, 0] }\n");
  EXPECT_EQ(r.operators, 1U);
  EXPECT_GT(r.bodies[0].largest, 1e-3);
  EXPECT_NEAR(r.bodies[1].largest, r.bodies[0].largest, 1e-9 * r.bodies[0].largest);
  EXPECT_NEAR(r.bodies[2].largest, r.bodies[0].largest, 1e-9 * r.bodies[0].largest);
}

TEST(ContactScene, ThreadsChangeNothing) {
  const std::string text = "[rock]\nyoung = 1e7\npoisson = 0.25\n" + motion + "rigid = false\n" + ground +
                           "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0.1], width = 1, height = 1 }\nrepeat = "
                           "{ count = 3, shift = [0.2, 1] }\n";
  const ContactResult a = ran(text, 1), b = ran(text, 3);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].centroid, b.bodies[k].centroid);
    EXPECT_EQ(a.bodies[k].rotation, b.bodies[k].rotation);
  }
}

}  // namespace
}  // namespace cleave::scene::contact_test
