// Where shotcrete is, and which blocks it holds there.

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "cleave/realize/run_result.hpp"
#include "run_scene.hpp"

namespace cleave::scene {
namespace {

using namespace test;

/// 51.0 kN from the roof of a tunnel to the free ground, on 4 m of edge in each; a layer that holds 11.48 kN/m.
std::string plug(std::string_view on, std::string_view more = "") {
  std::string text =
      "[domain]\nbox = { min = [0, 0, 0], max = [10, 10, 7] }\n"
      "[[joint]]\npolygon = [[4.5, 4.5, 4], [4.5, 5.5, 4], [4.5, 5.5, 8], [4.5, 4.5, 8]]\n"
      "[[joint]]\npolygon = [[5.5, 4.5, 4], [5.5, 5.5, 4], [5.5, 5.5, 8], [5.5, 4.5, 8]]\n"
      "[[joint]]\npolygon = [[4.5, 4.5, 4], [5.5, 4.5, 4], [5.5, 4.5, 8], [4.5, 4.5, 8]]\n"
      "[[joint]]\npolygon = [[4.5, 5.5, 4], [5.5, 5.5, 4], [5.5, 5.5, 8], [4.5, 5.5, 8]]\n"
      "[joints.default]\nfriction = 30\n[rock]\ndensity = 2600\n"
      "[[excavation]]\nname = \"drift\"\nkind = \"tunnel\"\n"
      "section = { shape = \"rectangle\", width = 6, height = 3 }\naxis = [[5, 0, 3.5], [5, 10, 3.5]]\n"
      "[stability]\nfree = [\"top\"]\ntarget = { falling = 1.5, sliding = 1.5 }\n";
  text += more;
  return text + "[support]\nshotcrete = { thickness = 0.0114777, strength = 1e6" + std::string{on} + " }\n";
}

constexpr double layer = 11477.7;           // N/m
constexpr double weight = 2 * 2600 * 9.81;  // N

// The ground is not sprayed, and the plug moves away from it: the roof alone holds 0.90 of it, in every check.
TEST(ShotcreteScene, ThePlugHangsOnTheRoofAlone) {
  for (const std::string_view on : {"", ", on = \"all\"", ", on = \"drift\"", ", on = [\"top\", \"drift\"]"}) {
    SCOPED_TRACE(on);
    const RunResult run = run_of(plug(on, "[[load]]\nname = \"quake\"\nseismic = [0, 0, -0.5]\n"));
    ASSERT_EQ(run.support->blocks.size(), 1U);
    const stability::SupportedBlock& block = run.support->blocks[0];
    EXPECT_EQ(block.held, stability::Held::not_held);
    EXPECT_NEAR(block.factor_with_shotcrete.value(), 0.90, 1e-3);
    EXPECT_NEAR(block.factor_with_support.value(), 4 * layer / weight, 1e-3);
    EXPECT_NEAR(block.required_pressure, 1.5 * weight, 1e-3 * weight);  // 76.5 kPa on 1 m2
    EXPECT_NEAR(run.figures.support->largest_required_pressure_pa, 76.5e3, 0.1e3);
    EXPECT_EQ(run.figures.support->groups->not_held, 1U);
    EXPECT_FALSE(run.figures.support->passes());
    const stability::SupportedBlock& shaken = run.support_cases.at(0).support.blocks.at(0);
    EXPECT_NEAR(shaken.factor_with_support.value(), 4 * layer / weight / 1.5, 1e-3);
    EXPECT_NEAR(shaken.required_pressure, 1.5 * 1.5 * weight, 1e-3 * weight);
  }
  const RunResult ground = run_of(plug(", on = \"top\""));
  EXPECT_EQ(ground.support->blocks.at(0).factor_with_shotcrete, 0.0);
  EXPECT_FALSE(ground.support->blocks.at(0).needed_thickness.has_value());
}

// A slab of 10 m in a bench: face 25.3 m and toe 10 m hold it, not the 18 m of edge on the crest.
TEST(ShotcreteScene, TheCrestOfASlopeHoldsNothing) {
  const std::string bench =
      "[domain]\nbox = { min = [0, 0, 0], max = [40, 20, 20] }\n"
      "[[joint]]\nplane = { through = [20, 10, 4], dip = 38, dip_direction = 90 }\nset = \"bedding\"\n"
      "[[joint]]\nplane = { through = [0, 5, 0], dip = 90, dip_direction = 0 }\n"
      "[[joint]]\nplane = { through = [0, 15, 0], dip = 90, dip_direction = 0 }\n"
      "[[joint]]\nplane = { through = [12, 10, 16], dip = 90, dip_direction = 90 }\n"
      "[joints.bedding]\nfriction = 35\ncohesion = 15e3\n[joints.default]\nfriction = 30\n"
      "[rock]\ndensity = 2651\n[[excavation]]\nname = \"bench\"\nkind = \"slope\"\n"
      "profile = { direction = 90, points = [[0, 16], [16, 16], [20, 4], [40, 4]] }\n"
      "[stability]\ngroups = \"off\"\ntarget = { falling = 1.5, sliding = 1.4 }\n"
      "[support]\nshotcrete = { thickness = 0.05, strength = 1e6 }\n";
  const RunResult run = run_of(bench);
  ASSERT_EQ(run.support->blocks.size(), 1U);
  const stability::SupportedBlock& block = run.support->blocks[0];
  const double dip = 38 * std::numbers::pi / 180;
  const double rear = 12 - 8 * std::tan(dip);          // height of the slab at its back
  const double area = 0.5 * (rear * 8 + 12 * 4);       // rear triangle, and that below the face
  const double load = 2651 * 9.81 * area * 10;         // N
  const double edge = 2 * std::hypot(12.0, 4.0) + 10;  // m
  const double bare =
      std::tan(35 * std::numbers::pi / 180) / std::tan(dip) + 15e3 * 10 * 8 / std::cos(dip) / (load * std::sin(dip));
  EXPECT_NEAR(block.factor_of_safety, bare, 1e-3);
  EXPECT_NEAR(block.factor_with_shotcrete.value(), bare + 50e3 * edge / (load * std::sin(dip)), 1e-3);
  EXPECT_EQ(block.held, stability::Held::not_held);
}

TEST(ShotcreteScene, IsNowhereUnlessItIsNamed) {
  const auto said = [](std::string_view more, std::string_view on) {
    return error_of(with_box(std::string{more} + "[support]\nshotcrete = { thickness = 0.1, strength = 1e6" +
                             std::string{on} + " }\n"));
  };
  const std::string_view free = "[stability]\nfree = [\"top\"]\n";
  EXPECT_TRUE(said(free, "").contains(
      "support.shotcrete.on: is missing; the walls of excavations are sprayed, and there are none: add on = \"all\""));
  EXPECT_TRUE(said(free, ", on = []").contains("support.shotcrete.on: names nothing"));
  EXPECT_TRUE(said(free, ", on = \"east\"").contains("\"east\" is a face of the domain that is not free; add it to "));
  EXPECT_TRUE(said(free, ", on = [\"top\", \"est\"]").contains("\"est\" is neither an excavation nor a face of the"));
  const Scene scene = scene_of(plug(", on = [\"drift\", \"top\"]"));
  const auto& on = scene.support->plan.shotcrete->on;
  ASSERT_EQ(on.size(), 2U);
  EXPECT_EQ(std::get<stability::ExcavationWall>(on[0]).excavation, 0U);
  EXPECT_EQ(std::get<stability::DomainSide>(on[1]).tag, 5U);
  EXPECT_TRUE(scene_of(plug("")).support->plan.shotcrete->on.empty());
}

}  // namespace
}  // namespace cleave::scene
