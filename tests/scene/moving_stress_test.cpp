// Stress on the boundary of bodies in motion, as scenes ask for it.

#include <gtest/gtest.h>

#include <cmath>

#include "cleave/scene2d/bodies.hpp"
#include "plane_runs.hpp"

namespace cleave::scene {
namespace {

using plane_runs::ran;

const std::string rock = "[rock]\nyoung = 1e6\npoisson = 0.25\ndensity = 1\n";

TEST(MovingStress, PulledColumnAtRestCarriesItsLoad) {
  const BodiesResult r =
      ran(rock +
          "[elastic]\ntime = { end = 20, step = 1, scheme = \"backward_euler\", frames = 2 }\n[[body]]\n"
          "outline = [[0, 0], [1, 0], [1, 2], [0, 2]]\nsupport = [{ side = 1, kind = \"roller\" }, { side = 4, kind = "
          "\"roller\" }]\nload = [{ side = 3, traction = [0, 100] }]\n");
  ASSERT_EQ(r.bodies[0].stress_frames.size(), r.times.size());
  for (const bem::Sym2 s : r.bodies[0].stress_frames.back()[0]) {
    EXPECT_NEAR(s.yy, 100, 0.5);
    EXPECT_NEAR(s.xx, 0, 0.5);
    EXPECT_NEAR(s.xy, 0, 0.5);
  }
  // Uniaxial in plane strain: von Mises sqrt(1 - nu + nu^2).
  for (const double v : r.bodies[0].mises_frames.back()[0]) EXPECT_NEAR(v, 100 * std::sqrt(1 - 0.25 + 0.0625), 1);
}

TEST(MovingStress, TurnsWithTheBody) {
  // Pulled along its length by loads that follow; a quarter turn later the pull is along y.
  const BodiesResult r =
      ran(rock +
          "[elastic]\ntime = { end = 1, step = 0.01, frames = 2, modes = 1000, damping = { share = 1 } }\n[[body]]\n"
          "outline = [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]\nangular_velocity = 1.5707963267948966\n"
          "load = [{ side = 2, traction = [1000, 0], time = { kind = \"step\", follows = true } },\n"
          "        { side = 4, traction = [-1000, 0], time = { kind = \"step\", follows = true } }]\n");
  EXPECT_NEAR(r.bodies[0].rotation, 1.5707963267948966, 1e-6);
  for (const bem::Sym2 s : r.bodies[0].stress_frames.back()[0]) {
    EXPECT_NEAR(s.yy, 1000, 20);
    EXPECT_NEAR(s.xx, 0, 20);
    EXPECT_NEAR(s.xy, 0, 20);
  }
}

TEST(MovingStress, LeftOutWhenNothingAsksForIt) {
  const std::string head = rock +
                           "[elastic]\nstress = false\ntime = { end = 1, step = 0.1, frames = 2 }\n[[body]]\n"
                           "outline = [[0, 0], [1, 0], [1, 2], [0, 2]]\n";
  EXPECT_TRUE(ran(head).bodies[0].stress_frames.empty());
  const auto scene = parse_bodies(head, "s.toml");
  bool said = false;
  for (const PlannedStep& planned : make_plan(*scene).steps) {
    said = said || planned.why.find("no stress on the boundary: nothing asks for it") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

TEST(MovingBodies, WhatIsNotFollowedIsRefusedWithItsReason) {
  const std::string time = rock + "[elastic]\ntime = { end = 1, step = 0.1 }\n[[body]]\n";
  const std::string square = "outline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n";
  const std::vector<std::pair<std::string, std::string>> refused{
      {time + square + "support = [{ side = 1, kind = \"bonded\" }]\n",
       "bonded bodies are solved in static scenes only"},
      {time + "extent = \"plane\"\nround_holes = [{ centre = [0, 0], radius = 1 }]\n",
       "an infinite body is solved in static scenes only"},
      {time + square + "in_situ = { stress = [1, 0, 0] }\n", "stress before loading is part of static scenes only"},
      {time + square + "support = [{ side = 1, kind = \"displacement\", value = [1, 0] }]\n", "moving supports"},
      {time + square + "support = [{ side = 1, kind = \"fixed\" }, { kind = \"pin\", at = [1, 1] }]\n",
       "pins hold bodies that turn"},
  };
  for (const auto& [text, want] : refused) {
    const auto scene = parse_bodies(text, "s.toml");
    ASSERT_FALSE(scene.has_value()) << want;
    EXPECT_NE(describe(scene.error().front()).find(want), std::string::npos) << describe(scene.error().front());
  }
}

TEST(MovingBodies, SpringsRollersAndObliqueSupports) {
  // Lowest frequency of a stiff block on springs along the normal, from the time of its greatest drop under weight:
  // half a period pi sqrt(m / k), twice the static drop m g / k.
  const BodiesResult r =
      ran("[rock]\nyoung = 1e9\npoisson = 0.25\ndensity = 1000\n[elastic]\ngravity = 10\npoints = [{ at = [0.5, 1] }]\n"
          "time = { end = 1, step = 0.002, frames = 500, rho = 1 }\n[[body]]\n"
          "outline = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsupport = [{ side = 1, kind = \"spring\", normal = 1e5, along = "
          "1e5 }]\n");
  double lowest = 0, when = 0;
  for (std::size_t f = 0; f < r.times.size(); ++f) {
    if (r.points[0].displacement[f].y < lowest) {
      lowest = r.points[0].displacement[f].y;
      when = r.times[f];
    }
  }
  EXPECT_NEAR(lowest, -0.2, 2e-3);
  EXPECT_NEAR(when, 3.14159265 * 0.1, 6e-3);
  // The same column on a roller whose direction is oblique: it can only slide along it, with g sin(angle).
  const BodiesResult slide =
      ran("[rock]\nyoung = 1e9\npoisson = 0.25\ndensity = 1000\n[elastic]\ngravity = 10\npoints = [{ at = [0.5, 1] }]\n"
          "time = { end = 0.5, step = 0.002, frames = 10 }\n[[body]]\noutline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n"
          "support = [{ sides = [1, 2, 3, 4], kind = \"roller\", angle = 120 }]\n");
  // Held along 120 degrees, free along 30: g sin 30 down it.
  const bem::Vec2 u = slide.points[0].displacement.back();
  EXPECT_NEAR(norm(u), 0.5 * 5 * 0.25, 5e-3);
  EXPECT_NEAR(u.y / u.x, std::tan(3.14159265358979 / 6), 1e-3);
}

}  // namespace
}  // namespace cleave::scene
