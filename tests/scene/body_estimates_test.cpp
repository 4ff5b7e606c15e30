#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

#include "cleave/scene2d/bodies.hpp"

// What is said of the error of elastic bodies where meshes are too coarse to tell.
namespace cleave::scene::body_estimates_test {
namespace {

using bem::Vec2;

BodiesResult ran(const std::string& text) {
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto scene = parse_bodies(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  if (!scene) return {};
  auto result = run(*scene, 1, timer, progress);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return result ? *std::move(result) : BodiesResult{};
}

/// A beam on the left side of which it is held, with its tip as a point.
std::string beam(double length, std::string_view elastic, std::string_view load, std::string_view support = "fixed") {
  return fmt::format(
      "[rock]\ndensity = 2700\nyoung = 1e10\npoisson = 0.25\n[elastic]\nstress = false\n{1}\npoints = [{{ name = "
      "\"tip\", at = [{0}, 0] }}]\n[[body]]\noutline = [[0, 0], [{0}, 0], [{0}, 1], [0, 1]]\nsupport = [{{ side = 4, "
      "kind = \"{3}\" }}]\n{2}\n",
      length, elastic, load, support);
}
std::string push_at_tip(double length) { return fmt::format("load = [{{ at = [{}, 1], force = [0, -1e5] }}]", length); }
constexpr std::string_view sheared = "load = [{ side = 2, traction = [0, -1e5] }]";

// Within three elements of a point force nothing was compared: where that was all of the body, nothing differed.
TEST(BodyEstimates, NoMeshIsGoodWhereAllOfItLiesUnderAPointForce) {
  for (const auto& [length, tip] : {std::pair{20.0, -0.300}, {4.0, -2.4985e-3}}) {
    for (const std::string_view order : {"linear", "quadratic"}) {
      const BodiesResult coarse =
          ran(beam(length, fmt::format("element = {}\norder = \"{}\"", length, order), push_at_tip(length)));
      EXPECT_FALSE(coarse.bodies[0].error) << length << ' ' << order;
      EXPECT_NE(coarse.bodies[0].no_estimate.find("point force"), std::string::npos);
      const BodiesResult r = ran(beam(
          length, fmt::format("element = {}\norder = \"{}\"\ntolerance = 1e-3", length, order), push_at_tip(length)));
      const double wrong = std::abs(r.points[0].displacement[0].y / tip - 1);
      EXPECT_LT(r.converged ? wrong : 0, 5e-3) << length << ' ' << order;
      EXPECT_GT(r.trials.size(), 0U);
    }
  }
  // The first mesh that can be compared, at few places, is not enough.
  const BodiesResult near = ran(beam(4, "element = 4\ntolerance = 3e-2", push_at_tip(4)));
  EXPECT_TRUE(near.converged);
  EXPECT_EQ(near.trials.size(), 2U);
  EXPECT_GT(near.bodies[0].error.value_or(0), 1e-3);
  // A mesh that cannot be compared at all is not one that meets a tolerance.
  const BodiesResult thin = ran(beam(400, "element = 400\ntolerance = 1e-3", push_at_tip(400)));
  EXPECT_FALSE(thin.converged);
}

// On one, two and four elements a side no order shows: a change that fell eightfold by chance was taken for one.
TEST(BodyEstimates, CoarseMeshesShowNoOrder) {
  for (const auto& [load, gravity, tip] :
       {std::tuple{sheared, "", -2.50958e-3}, std::tuple{std::string_view{}, "gravity = 9.81", -1.0130e-3}}) {
    for (const double element : {4.0, 2.0, 1.0, 0.5}) {
      const BodiesResult r = ran(beam(4, fmt::format("element = {}\n{}", element, gravity), load));
      const double wrong = std::abs(r.points[0].displacement[0].y / tip - 1);
      std::printf("element %g: wrong by %.2e, estimate %.2e\n", element, wrong, r.bodies[0].error.value_or(-1));
      EXPECT_GT(r.bodies[0].error.value_or(1), wrong) << element;
    }
  }
}

// Sides of one element are no coarser on half the elements.
TEST(BodyEstimates, AMovingMeshThatCannotBeHalvedHasNone) {
  for (const auto& [element, has] : {std::pair{1.0, false}, {0.25, true}}) {
    const BodiesResult r =
        ran(beam(1, fmt::format("element = {}\ngravity = 9.81\ntime = {{ end = 0.2, step = 1e-3 }}", element), ""));
    const BodyResult& body = r.bodies[0];
    EXPECT_EQ(body.no_estimate.find("cannot be halved") == std::string::npos, has) << element << body.no_estimate;
    EXPECT_TRUE(has || !body.error);
  }
}

// Held in its middle a side does not hold the body against turning; on two elements it does.
TEST(BodyEstimates, OneConstantElementOnASupportIsHalved) {
  const BodiesResult r = ran(beam(4, "element = 4\norder = \"constant\"", sheared));
  ASSERT_EQ(r.bodies.size(), 1U);
  EXPECT_GE(r.bodies[0].elements, 16U);
}

}  // namespace
}  // namespace cleave::scene::body_estimates_test
