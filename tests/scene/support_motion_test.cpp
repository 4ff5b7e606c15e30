#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "cleave/scene2d/contact.hpp"

// Fixed bodies that are moved.
namespace cleave::scene::support_motion_test {
namespace {

constexpr double g = 9.81;

std::string first_problem(const std::string& text) {
  const auto scene = parse_contact(text, "s.toml");
  return scene ? "" : describe(scene.error().front());
}

ContactResult ran(const std::string& text, const ContactRun& how = {}) {
  auto scene = parse_contact(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  if (!scene) return {};
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(*scene, 1, timer, progress, how);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return result ? *std::move(result) : ContactResult{};
}

std::string scene_of(const std::string& motion, const std::string& settings = "duration = 0.5\nstep = 0.005\n") {
  return "[joints.default]\nfriction = 20\n[contact]\n" + settings +
         "points = [{ name = \"plate\", at = [0, 0], body = \"plate\" }, { name = \"block\", at = [0, 0.5], body = "
         "\"block\" }]\n[[body]]\nname = \"plate\"\nfixed = true\nrectangle = { corner = [-9, -1], width = 18, height "
         "= 1 }\nmotion = " +
         motion + "\n[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0], width = 1, height = 0.5 }\n";
}

TEST(SupportMotionTest, ABlockOnAPlateSlipsWhereItsAccelerationIsMoreThanFriction) {
  const double mu = std::tan(20 * std::numbers::pi / 180), t = 0.5;
  for (const double share : {0.9, 1.5}) {
    const double a = share * mu * g;
    const ContactResult result = ran(scene_of("{ acceleration = [" + std::to_string(a) + ", 0] }"));
    const ContactHistory& last = result.history.back();
    EXPECT_NEAR(last.points[0].x, 0.5 * a * t * t, 1e-6);  // by the digits of the scene
    EXPECT_NEAR(last.points[1].x, 0.5 * std::min(a, mu * g) * t * t, 1e-6) << share;
    EXPECT_NEAR(last.points[1].y, 0, 1e-9);
    // The plate's work is the block's motion and what slips.
    const double m = 0.5 * 2700, slip = 0.5 * std::max(0.0, a - mu * g) * t * t;
    EXPECT_NEAR(last.friction, mu * m * g * slip, 1e-4 * m * g);
    EXPECT_NEAR(last.work, last.kinetic + last.friction, 1e-4 * m * g);
  }
}

TEST(SupportMotionTest, ABlockIsTakenAlongByABeltThatRunsUp) {
  // A belt that is brought to 3 m/s at once: the block slips until it has its speed.
  const double mu = std::tan(20 * std::numbers::pi / 180), v = 1;
  const ContactResult result = ran(scene_of("{ velocity = [1, 0] }"));
  EXPECT_NEAR(result.history.back().points[1].x, v * 0.5 - 0.5 * v * v / (mu * g), 5e-3);
  // Stopped again: harmonic velocity of 1 Hz, less than friction holds: it rides along and comes back.
  const ContactResult swings = ran(scene_of("{ velocity = [0.5, 0], time = { kind = \"harmonic\", frequency = 1 } }",
                                            "duration = 1\nstep = 0.002\n"));
  EXPECT_NEAR(swings.history.back().points[1].x, 0, 1e-5);
  double most = 0;
  for (const ContactHistory& row : swings.history) most = std::max(most, row.points[1].x);
  EXPECT_NEAR(most, 0.5 / std::numbers::pi, 1e-4);
}

TEST(SupportMotionTest, APlateThatDropsFasterThanItFallsLeavesTheBlock) {
  const ContactResult result = ran(scene_of("{ acceleration = [0, -15] }", "duration = 0.3\nstep = 0.002\n"));
  EXPECT_NEAR(result.history.back().points[0].y, -0.5 * 15 * 0.09, 1e-9);
  EXPECT_NEAR(result.history.back().points[1].y, -0.5 * g * 0.09, 5e-3);
  // Lifted, it goes with it; nothing falls asleep on what will move.
  const ContactResult lifted =
      ran(scene_of("{ record = { step = 0.5, x = [0, 0, 0], y = [0, 0, 2] } }", "duration = 1\nstep = 0.005\n"));
  EXPECT_NEAR(lifted.history.back().points[0].y, 2 * 0.5 * 0.5 / 6, 1e-4);
  EXPECT_NEAR(lifted.history.back().points[1].y, lifted.history.back().points[0].y, 1e-6);
}

// The same shaking, of the ground and of the support: what has moved has moved off the support.
TEST(SupportMotionTest, WhatRidesOnASupportStands) {
  const auto verdict = [](double a, const std::string& more = {}) {
    const std::string motion = "{ acceleration = [" + std::to_string(a) + ", 0] }";
    return std::string{name_of(verdict_of(ran(scene_of(motion) + more)))};
  };
  const std::string second = "[[body]]\nrectangle = { corner = [-0.5, 0.5], width = 1, height = 0.5 }\n";
  EXPECT_EQ(verdict(3), "stands");  // 0.37 m along, with the plate
  EXPECT_EQ(verdict(3, second), "stands");
  EXPECT_EQ(verdict(5), "slides");
  // What touches a wall beside the plate leaves one of the two.
  EXPECT_EQ(verdict(-3, "[[body]]\nfixed = true\nrectangle = { corner = [0.5, 0], width = 1, height = 0.5 }\n"),
            "slides");
  // Harmonic: it swings with the plate.
  const std::string swings = "{ velocity = [0.5, 0], time = { kind = \"harmonic\", frequency = 1 } }";
  EXPECT_EQ(name_of(verdict_of(ran(scene_of(swings, "duration = 1\nstep = 0.002\n")))), "stands");
}

TEST(SupportMotionTest, ARunThatWasStoppedKeepsIt) {
  const std::string text = scene_of("{ acceleration = [5, 0], time = { kind = \"harmonic\", frequency = 3 } }");
  const ContactResult whole = ran(text);
  const ContactResult half = ran(text, {.stop = [asked = 0]() mutable { return asked++ >= 40; }});
  const ContactResult rest = ran(text, {.from = SavedRun{"half", half.state}});
  EXPECT_TRUE(rest.state == whole.state);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto other =
      parse_contact(scene_of("{ acceleration = [5, 0], time = { kind = \"harmonic\", frequency = 4 } }"), "s.toml");
  EXPECT_FALSE(run(*other, 1, timer, progress, {.from = SavedRun{"half", half.state}}).has_value());
}

TEST(SupportMotionTest, WhatIsWrongIsSaid) {
  const std::string block = "[[body]]\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n";
  const std::string time = "[contact]\nduration = 1\nstep = 0.01\n";
  EXPECT_NE(first_problem(time + block + "motion = { velocity = [1, 0] }\n").find("is that of a fixed body"),
            std::string::npos);
  EXPECT_NE(first_problem(time + block + "fixed = true\nmotion = { speed = [1, 0] }\n").find("body[1].motion"),
            std::string::npos);
  EXPECT_NE(first_problem(scene_of("{ velocity = [1, 0] }", "static = true\n")).find("knows no time"),
            std::string::npos);
}

}  // namespace
}  // namespace cleave::scene::support_motion_test
