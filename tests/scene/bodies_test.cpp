#include "cleave/scene2d/bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "plane_runs.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using plane_runs::ran;

const std::string rock = "[rock]\nyoung = 2.6\npoisson = 0.3\n";

std::string first_problem(const std::string& text) {
  const auto scene = parse_bodies(text, "s.toml");
  return scene ? "" : describe(scene.error().front());
}

std::string refusal(const std::string& text) {
  const auto scene = parse_bodies(text, "s.toml");
  if (!scene) return describe(scene.error().front());
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(*scene, 1, timer, progress);
  return result ? "" : describe(result.error().front());
}

TEST(BodiesScene, BadInputIsNamed) {
  const std::string square = "outline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n";
  const std::vector<std::pair<std::string, std::string>> bad{
      {"[[body]]\n" + square, "young: is missing"},
      {"[[body]]\nyoung = 1\npoisson = 0.5\n" + square, "poisson: is 0.5"},
      {rock + "[[body]]\noutline = [[0, 0], [1, 1], [1, 0], [0, 1]]\n", "side 1 and side 3 meet"},
      {rock + "[[body]]\noutline = [[0, 0], [1, 0]]\n", "fewer than three sides"},
      {rock + "[[body]]\noutline = [[0, 0], [1, 0], [1, 0]]\n", "has no length"},
      {rock + "[[body]]\n" + square + "[[body]]\noutline = [[0.5, 0.5], [2, 0.5], [2, 2]]\n", "overlaps \"body 1\""},
      {rock + "[elastic]\ntime = { end = 1, step = 0 }\n[[body]]\n" + square, "elastic.time.step: is 0"},
      {rock + "[elastic]\ntime = { end = 1, step = 0.1 }\n[[body]]\ndensity = 0\n" + square, "density above 0"},
      {rock + "[[body]]\nsupport = [{ side = 7, kind = \"fixed\" }]\n" + square, "there is no side 7"},
      {rock + "[[body]]\nsuport = []\n" + square, "support"},
      {rock + "[[body]]\nangular_velocity = 1\n" + square, "nothing moves without [elastic.time]"},
      {rock + "[elastic]\npoints = [{ at = [5, 5] }]\n[[body]]\n" + square, "lies in no body"},
      {rock + "[[body]]\nextent = \"plane\"\n", "needs at least one opening"},
      {rock + "[[body]]\nload = [{ side = 1, pressure = 1, time = { kind = \"step\" } }]\n" + square,
       "in moving scenes only"},
  };
  for (const auto& [text, want] : bad)
    EXPECT_NE(first_problem(text).find(want), std::string::npos) << first_problem(text);
  const std::string free = refusal(rock + "[[body]]\n" + square);
  EXPECT_NE(free.find("translation along (1, 0), translation along (0, 1), rotation about (0.5, 0.5)"),
            std::string::npos)
      << free;
  // Before anything is solved, of whatever its supports leave free.
  const auto checked = [&](const std::string& support) {
    const auto scene = parse_bodies(rock + "[[body]]\n" + square + "support = [" + support + "]\n", "s.toml");
    return scene ? "" : describe(scene.error().front());
  };
  EXPECT_TRUE(checked("").contains("s.toml:4: body[1]: the supports do not hold the body against translation along"))
      << checked("");
  EXPECT_TRUE(checked("{ side = 1, kind = \"roller\" }").contains("the body against translation along (1, 0);"))
      << checked("{ side = 1, kind = \"roller\" }");
  EXPECT_TRUE(checked("{ side = 1, kind = \"spring\" }").contains("translation along (0, 1), rotation"));
  EXPECT_EQ(checked("{ side = 1, kind = \"roller\" }, { side = 2, kind = \"roller\" }"), "");
  EXPECT_EQ(checked("{ side = 1, kind = \"spring\", normal = 1, along = 1 }"), "");
  // The first corner may stand at the end, too.
  const auto closed = parse_bodies(
      rock + "[[body]]\noutline = [[0, 0], [1, 0], [1, 1], [0, 0]]\nsupport = [{ side = 3, kind = \"fixed\" }]\n",
      "s.toml");
  ASSERT_TRUE(closed.has_value()) << describe(closed.error().front());
  EXPECT_EQ(closed->bodies[0].region.loops[0].size(), 3U);
  const auto turned = parse_bodies(
      rock + "[[body]]\noutline = [[0, 0], [0, 1], [1, 1], [1, 0]]\nsupport = [{ side = 4, kind = \"fixed\" }]\n",
      "s.toml");
  ASSERT_TRUE(turned.has_value());
  ASSERT_EQ(turned->notes.size(), 2U);  // the other one: young = 1 is far from usual
  EXPECT_NE(describe(turned->notes.back()).find("clockwise"), std::string::npos);
}

TEST(BodiesScene, KirschTunnel) {
  const BodiesResult r =
      ran(rock +
          "[elastic]\nelement = 0.1\npoints = [{ name = \"crown\", at = [0, 1] }, { name = \"wall\", at = [1, 0] }]\n"
          "[[body]]\nextent = \"plane\"\nround_holes = [{ centre = [0, 0], radius = 1 }]\n"
          "in_situ = { stress = [1, 0, 0] }\n");
  EXPECT_NEAR(r.points[0].displacement[0].y, -0.2, 1e-6);
  EXPECT_NEAR(r.points[1].displacement[0].x, 0.7, 1e-6);
  EXPECT_LT(*r.bodies[0].error, 1e-3);
}

TEST(BodiesScene, NaturalFrequenciesOfATaperedMembrane) {
  // NAFEMS FV32.
  const std::string scene =
      "[rock]\nyoung = 200e9\npoisson = 0.3\ndensity = 8000\n[elastic]\nplane = \"stress\"\nstress = false\nelement = "
      "0.9\nfrequencies = 6\nMOVING[[body]]\noutline = [[0, -2.5], [10, -0.5], [10, 0.5], [0, 2.5]]\nsupport = [{ side "
      "= 4, "
      "kind = \"fixed\" }]\n";
  const std::vector<double> nafems{44.623, 130.03, 162.70, 246.05, 379.90, 391.44};
  for (const std::string moving : {"", "time = { end = 1e-3, step = 1e-4 }\n"}) {
    std::string text = scene;
    text.replace(text.find("MOVING"), 6, moving);
    const BodiesResult r = ran(text);
    ASSERT_EQ(r.bodies[0].modes_hz.size(), nafems.size());
    for (std::size_t k = 0; k < nafems.size(); ++k) EXPECT_NEAR(r.bodies[0].modes_hz[k] / nafems[k], 1, 2e-3) << k;
  }
}

TEST(BodiesScene, AnEstimateThatIsNoneSaysWhy) {
  // A beam of 1,000 x 1 m on a few elements: what halving changes is no error any more.
  const BodiesResult r = ran(rock +
                             "[elastic]\nstress = false\n[[body]]\noutline = [[0, 0], [1000, 0], [1000, 1], [0, "
                             "1]]\nsupport = [{ side = 4, kind = "
                             "\"fixed\" }]\nload = [{ side = 2, traction = [0, -1] }]\n");
  const double beam = 4e9 * (1 - 0.3 * 0.3) / 2.6;  // P L^3 / 3 E I
  const double wrong = std::abs(r.bodies[0].largest / beam - 1);
  if (r.bodies[0].error) {
    EXPECT_GT(*r.bodies[0].error, wrong / 2);
  } else {
    EXPECT_FALSE(r.bodies[0].no_estimate.empty());
    EXPECT_FALSE(r.notes.empty());
  }
}

// Elements of fourth order were said to have ten times the error they have.
TEST(BodiesScene, AnEstimateAtRestIsAnErrorOfItsSize) {
  const double kappa = 3 - 4 * 0.3;  // plane strain; the shear modulus is 1
  for (const int elements : {2, 3, 6}) {
    const BodiesResult r =
        ran(rock + "[elastic]\nstress = false\n[[body]]\nextent = \"plane\"\nelements = " + std::to_string(elements) +
            "\nround_holes = [{ centre = [0, 0], radius = 1 }]\nin_situ = { stress = [1, 0, 0] }\n");
    const BodyResult& body = r.bodies[0];
    ASSERT_TRUE(body.error.has_value()) << elements;
    double worst = 0;
    for (std::size_t k = 0; k < body.outline[0].size(); ++k) {
      const Vec2 x = body.outline[0][k], u = body.frames[0][0][k] - x;
      const double t = std::atan2(x.y, x.x);
      const double ur = 0.25 * (1 + kappa * std::cos(2 * t)), ut = -0.25 * kappa * std::sin(2 * t);
      worst = std::max(worst, norm(u - Vec2{ur * std::cos(t) - ut * std::sin(t), ur * std::sin(t) + ut * std::cos(t)}));
    }
    EXPECT_GT(*body.error, worst / 0.7) << elements;
    EXPECT_LT(*body.error, 3 * worst / 0.7) << elements;
  }
}

TEST(BodiesScene, TurnedOutlineKeepsItsSides) {
  // The same column under its weight, written both ways round: base fixed by rollers, sides by rollers.
  const std::string head =
      rock + "[elastic]\ngravity = 1\npoints = [{ name = \"top\", at = [0.5, 2] }]\n[[body]]\ndensity = 1\n";
  const double modulus = 2.6 * 0.7 / (1.3 * 0.4);
  const BodiesResult a =
      ran(head + "outline = [[0, 0], [1, 0], [1, 2], [0, 2]]\nsupport = [{ sides = [1, 2, 4], kind = \"roller\" }]\n");
  const BodiesResult b =
      ran(head + "outline = [[0, 0], [0, 2], [1, 2], [1, 0]]\nsupport = [{ sides = [1, 3, 4], kind = \"roller\" }]\n");
  EXPECT_NEAR(a.points[0].displacement[0].y, -2 / modulus, 1e-10);
  EXPECT_NEAR(b.points[0].displacement[0].y, -2 / modulus, 1e-10);
}

TEST(BodiesScene, BondedBodiesActAsOne) {
  const std::string tip = "[elastic]\npoints = [{ name = \"tip\", at = [4, 1], body = \"B\" }]\n";
  const BodiesResult two =
      ran(rock + tip +
          "[[body]]\nname = \"A\"\noutline = [[0, 0], [2, 0], [2, 1], [0, 1]]\n"
          "support = [{ side = 4, kind = \"fixed\" }, { side = 2, kind = \"bonded\" }]\n"
          "[[body]]\nname = \"B\"\noutline = [[2, 0], [4, 0], [4, 1], [2, 1]]\n"
          "support = [{ side = 4, kind = \"bonded\" }]\nload = [{ side = 2, traction = [0, -0.01] }]\n");
  const BodiesResult one =
      ran(rock + tip +
          "[[body]]\nname = \"B\"\noutline = [[0, 0], [4, 0], [4, 1], [0, 1]]\n"
          "support = [{ side = 4, kind = \"fixed\" }]\nload = [{ side = 2, traction = [0, -0.01] }]\n");
  EXPECT_NEAR(two.points[0].displacement[0].y / one.points[0].displacement[0].y, 1, 5e-3);
}

TEST(BodiesScene, FreeFallAndVibration) {
  const BodiesResult r =
      ran("[rock]\nyoung = 1e8\npoisson = 0.25\n[elastic]\ngravity = 9.8\npoints = [{ at = [6, 0.5] }]\n"
          "time = { end = 0.5, step = 1e-3, frames = 10 }\n"
          "[[body]]\nname = \"stone\"\ncircle = { centre = [0, 5], radius = 0.5 }\nangular_velocity = 2\n"
          "[[body]]\nname = \"beam\"\noutline = [[3, 0], [6, 0], [6, 0.5], [3, 0.5]]\nsupport = [{ side = 4, kind = "
          "\"fixed\" }]\n");
  EXPECT_EQ(r.steps, 500U);
  EXPECT_NEAR(r.bodies[0].centroid.y, 5 - 4.9 * 0.25, 1e-9);
  EXPECT_NEAR(r.bodies[0].rotation, 1, 1e-9);
  EXPECT_LT(r.points[0].displacement.back().y, 0);
  EXPECT_EQ(r.times.size(), 11U);
  EXPECT_TRUE(r.converged);
}

TEST(BodiesScene, PlanSaysWhatIsLeftOut) {
  const auto scene = parse_bodies(
      rock + "[[body]]\noutline = [[0, 0], [1, 0], [1, 1]]\nsupport = [{ side = 1, kind = \"fixed\" }]\n", "s.toml");
  const Plan plan = make_plan(*scene);
  EXPECT_TRUE(plan.runs(Step::elastic));
  EXPECT_FALSE(plan.runs(Step::cut));
  const auto elastic = std::ranges::find(plan.steps, Step::elastic, &PlannedStep::step);
  EXPECT_NE(elastic->why.find("no mass, no inner points, no cells, no time steps"), std::string::npos);
}

}  // namespace
}  // namespace cleave::scene
