#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/archive.hpp"
#include "cleave/scene2d/contact.hpp"

// Runs in contact that are stopped and gone on with.
namespace cleave::scene {
namespace {

const std::string head = "[rock]\nyoung = 1e8\npoisson = 0.25\n";
const std::string ground =
    "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n";
const std::string block = "[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n";
const std::string above =
    "[[body]]\nname = \"above\"\nvelocity = [0.3, 0]\nrectangle = { corner = [-0.4, 1.01], width = 0.8, height = 0.5 "
    "}\n";
const std::string points = "points = [{ name = \"p\", at = [0.5, 1] }]\nframes = 7\n";

ContactScene parsed(const std::string& text) {
  auto scene = parse_contact(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  return scene ? *std::move(scene) : ContactScene{};
}

std::expected<ContactResult, std::vector<Problem>> ran(const std::string& text, const ContactRun& how = {},
                                                       unsigned threads = 1) {
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  return run(parsed(text), threads, timer, progress, how);
}

/// Stops before step `steps` + 1.
ContactRun until(std::uint64_t steps) {
  return {.stop = [steps, asked = std::uint64_t{0}]() mutable { return asked++ >= steps; }};
}

/// Nothing but what a run costs tells one that was stopped from one that was not.
void expect_same(const ContactResult& a, const ContactResult& b) {
  EXPECT_TRUE(a.state == b.state);  // the world, all frames and rows, all figures that add up
  EXPECT_EQ(a.converged, b.converged);
  EXPECT_EQ(a.stopped_why, b.stopped_why);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.no_estimate, b.no_estimate);
  ASSERT_EQ(a.solvers.size(), b.solvers.size());
  for (std::size_t k = 0; k < a.solvers.size(); ++k) {
    EXPECT_EQ(a.solvers[k].groups, b.solvers[k].groups);
    EXPECT_EQ(a.solvers[k].iterations, b.solvers[k].iterations);
  }
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].moved_at, b.bodies[k].moved_at);
    EXPECT_EQ(a.bodies[k].touched, b.bodies[k].touched);
    EXPECT_EQ(a.bodies[k].turned, b.bodies[k].turned);
    EXPECT_EQ(a.bodies[k].goes_on, b.bodies[k].goes_on);
    EXPECT_EQ(a.bodies[k].force, b.bodies[k].force);
    EXPECT_EQ(a.bodies[k].outline, b.bodies[k].outline);
    EXPECT_EQ(a.bodies[k].name, b.bodies[k].name);
  }
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.frames.size(), b.frames.size());
  EXPECT_EQ(a.points.size(), b.points.size());
}

void expect_goes_on(const std::string& text, std::uint64_t steps_at_least) {
  const auto whole = ran(text);
  ASSERT_TRUE(whole.has_value()) << describe(whole.error().front());
  ASSERT_GE(whole->steps, steps_at_least);
  for (const std::uint64_t at : {std::uint64_t{0}, whole->steps / 3, whole->steps / 2, whole->steps - 1}) {
    const auto half = ran(text, until(at));
    ASSERT_TRUE(half.has_value());
    ASSERT_TRUE(half->interrupted);
    EXPECT_FALSE(half->converged);
    EXPECT_EQ(half->steps, at);
    EXPECT_FALSE(half->frames.empty());
    const auto rest = ran(text, {.from = SavedRun{"half", half->state}}, 2);
    ASSERT_TRUE(rest.has_value()) << describe(rest.error().front());
    expect_same(*rest, *whole);
  }
}

TEST(ContactStateTest, ARunThatWasStoppedIsTheRunThatWasNot) {
  const std::string time = "[contact]\nduration = 0.3\nstep = 0.005\n" + points;
  // Rigid; with friction that is lost, cohesion left, and bonds that break.
  expect_goes_on("[joints.default]\nfriction = 35\nresidual_friction = 20\ncohesion = 3e3\nresidual_cohesion = 1e3\n" +
                     time + ground + block + above,
                 30);
  // Steps that grow.
  expect_goes_on(time + "max_step = 0.05\n" + ground + block + above, 10);
  // Asleep in the end.
  expect_goes_on("[contact]\nduration = 1\nstep = 0.005\n" + points + ground + block, 30);
  // Dilation on springs, water, pushed.
  expect_goes_on(
      "[joints.default]\nfriction = 35\ndilation = 8\ndilation_slip = 0.01\nnormal_stiffness = "
      "1e8\nwater_pressure = 2e3\n" +
          time + ground + block + "load = [{ side = 4, pressure = 2.5e4 }]\n",
      30);
  // A ground that moves.
  expect_goes_on(
      time +
          "ground = { acceleration = [3, 0], time = { kind = \"harmonic\", frequency = 4 } }\nmass_damping = "
          "2\n" +
          ground + block + above,
      30);
  // To rest.
  expect_goes_on(head + "[contact]\nstatic = true\nrigid = false\n" + points + ground + block, 5);
}

TEST(ContactStateTest, ElasticBodiesGoOnWithTheirStressAndTheirEstimate) {
  const std::string bodies = ground + block + above;
  const std::string time = "[contact]\nduration = 0.06\nstep = 0.001\nrigid = false\ndamping = 0.05\n" + points;
  expect_goes_on(head + time + "strength = { cohesion = 1e5, friction = 30, tension = 1e4 }\n" + bodies, 60);
  expect_goes_on("[contact]\nduration = 0.3\nstep = 0.002\nestimate = true\n" + points + bodies, 60);
  // Stopped in the runs that estimate the error: nothing is left to do but those.
  const std::string text = "[contact]\nduration = 0.3\nstep = 0.002\nestimate = true\n" + points + bodies;
  const auto whole = ran(text), almost = ran(text, until(whole->steps + 3));
  ASSERT_TRUE(almost->interrupted);
  EXPECT_EQ(almost->steps, whole->steps);
  const auto rest = ran(text, {.from = SavedRun{"almost", almost->state}});
  ASSERT_TRUE(rest.has_value());
  expect_same(*rest, *whole);
}

TEST(ContactStateTest, ARunGoesOnFromItsEndAndFromTheWorkItMayTake) {
  const auto text = [](const std::string& settings) {
    return "[contact]\nstep = 0.0078125\n" + settings + points + ground + block + above;
  };
  const auto whole = ran(text("duration = 0.5\n"));
  const auto some = ran(text("duration = 0.5\nwork = " + std::to_string(0.4e-9 * whole->work) + "\n"));
  ASSERT_TRUE(some.has_value());
  EXPECT_FALSE(some->converged);
  EXPECT_LT(some->steps, whole->steps);
  const auto rest = ran(text("duration = 0.5\n"), {.from = SavedRun{"some", some->state}});
  ASSERT_TRUE(rest.has_value()) << describe(rest.error().front());
  expect_same(*rest, *whole);
  const auto first = ran(text("duration = 0.25\n"));
  const auto then = ran(text("duration = 0.5\n"), {.from = SavedRun{"first", first->state}});
  ASSERT_TRUE(then.has_value()) << describe(then.error().front());
  EXPECT_EQ(then->steps, whole->steps);
  for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(then->bodies[b].centroid, whole->bodies[b].centroid);
  // Shorter than it was is no way to go on.
  const auto back = ran(text("duration = 0.1\n"), {.from = SavedRun{"first", first->state}});
  ASSERT_FALSE(back.has_value());
  EXPECT_EQ(
      describe(back.error().front()),
      "s.toml:1: contact.duration: ends at 0.1 s, but first is of 0.25 s; give a longer duration, or begin again");
}

std::string refusal(const std::string& text, const std::string& bytes) {
  const auto result = ran(text, {.from = SavedRun{"old/contact.state", bytes}});
  return result ? "none" : describe(result.error().front());
}

TEST(ContactStateTest, WhatIsNoStateOfTheSceneIsRefused) {
  const std::string time = "[contact]\nduration = 0.1\nstep = 0.005\n";
  const std::string text = time + points + ground + block;
  const std::string state = ran(text)->state;
  EXPECT_EQ(refusal(text, state), "none");
  const std::string foreign = "old/contact.state:1: state: is no state of a run in contact; ";
  EXPECT_TRUE(refusal(text, "").starts_with(foreign));
  EXPECT_TRUE(refusal(text, text).starts_with(foreign));
  EXPECT_TRUE(refusal(text, sealed("cleave-contact-state", 7, "")).contains("another version of cleave"));
  for (std::size_t size = 30; size < state.size(); size += 97) {
    EXPECT_TRUE(refusal(text, state.substr(0, size)).contains("is cut short or damaged")) << size;
  }
  for (std::size_t k = 120; k < state.size(); k += 97) {
    std::string wrong = state;
    wrong[k] = static_cast<char>(wrong[k] ^ 4);
    EXPECT_TRUE(refusal(text, wrong).contains("is cut short or damaged")) << k;
  }
  const std::string another = "is of another scene";
  EXPECT_TRUE(refusal(text + above, state).contains(another));
  EXPECT_TRUE(refusal(time + ground + block, state).contains(another));  // points
  EXPECT_TRUE(refusal("[joints.default]\nfriction = 20\n" + text, state).contains(another));
  EXPECT_TRUE(refusal(text + "density = 2600\n", state).contains(another));
  EXPECT_TRUE(refusal(text + "load = [{ at = [0, 0.5], force = [1, 0] }]\n", state).contains(another));
  EXPECT_TRUE(refusal(time + "gravity = 5\n" + points + ground + block, state).contains(another));
  EXPECT_TRUE(
      refusal(time + "ground = { acceleration = [1, 0] }\n" + points + ground + block, state).contains(another));
}

/// What is drawn of a run says nothing about it: a block that falls off and comes to lie on the ground has fallen, seen
/// once or a hundred times; 1 % of its size (0.01414 m) is fallen in 0.0537 s.
TEST(ContactStateTest, TheVerdictIsThatOfTheStepsWhateverIsDrawn) {
  const std::string high = "[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0.3], width = 1, height = 1 }\n";
  const std::string tips =
      "[[body]]\nname = \"rod\"\nangular_velocity = 3\nrectangle = { corner = [3, 2], width = 0.2, height = 0.2 }\n";
  std::optional<ContactResult> first;
  for (const int frames : {120, 60, 7, 2, 1}) {
    const auto result = ran("[contact]\nduration = 0.6\nstep = 0.001\nframes = " + std::to_string(frames) + "\n" +
                            ground + high + tips);
    ASSERT_TRUE(result.has_value());
    const ContactVerdict verdict = verdict_of(*result);
    EXPECT_EQ(verdict.motion, BodyMotion::topples) << frames;  // the rod is the first: smaller, and it turns
    EXPECT_EQ(verdict.bodies, (std::array<std::uint64_t, 3>{0, 1, 1})) << frames;
    EXPECT_EQ(enum_name(*verdict.motion), "topples");
    EXPECT_NEAR(result->bodies[1].moved_at.value().si(), std::sqrt(2 * 0.01 * std::sqrt(2) / 9.81), 1e-3);
    if (!first) {
      first = *result;
      continue;
    }
    EXPECT_EQ(verdict.since, verdict_of(*first).since) << frames;
    EXPECT_EQ(result->largest_displacement, first->largest_displacement) << frames;
    for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(result->bodies[b].largest, first->bodies[b].largest) << frames;
  }
}

/// Whoever makes the sum right again can still make no result that cannot be drawn.
TEST(ContactStateTest, ForgedStatesAreRefusedOrRun) {
  const std::string text = "[contact]\nduration = 0.05\nstep = 0.01\nframes = 2\n" + ground + block;
  const std::string whole{unsealed("cleave-contact-state", 3, ran(text)->state).value()};
  std::size_t refused = 0;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    std::string bytes = whole;
    bytes[k] = static_cast<char>(bytes[k] ^ 0x81);
    const auto result = ran(text, {.from = SavedRun{"forged", sealed("cleave-contact-state", 3, bytes)}});
    if (!result) {
      ++refused;
      continue;
    }
    for (std::size_t f = 0; f < result->frames.size(); ++f) {
      for (std::size_t b = 0; b < result->bodies.size(); ++b) (void)corners_at(*result, f, b);
    }
    (void)verdict_of(*result);
  }
  EXPECT_GT(refused, whole.size() / 3);
}

}  // namespace
}  // namespace cleave::scene
