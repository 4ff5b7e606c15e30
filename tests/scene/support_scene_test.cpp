#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "cleave/realize/run_result.hpp"
#include "run_scene.hpp"

namespace cleave::scene {
namespace {

using namespace test;

/// Three planes that dip 60 degrees meet 3 m over the roof: a tetrahedron that falls.
constexpr std::string_view roof_tetrahedron =
    "[[joint]]\nplane = { through = [0, 0, 3], dip = 60, dip_direction = 7 }\n"
    "[[joint]]\nplane = { through = [0, 0, 3], dip = 60, dip_direction = 124 }\n"
    "[[joint]]\nplane = { through = [0, 0, 3], dip = 60, dip_direction = 240 }\n"
    "[joints.default]\nfriction = 35\n[rock]\ndensity = 2700\n";

/// Openings of two stages: the tetrahedron falls after the first and is taken out by the second.
std::string in_two_stages(std::string_view rest) {
  return fmt::format(
      "[domain]\nbox = {{ min = [-20, -20, -20], max = [20, 20, 20] }}\n{}"
      "[[excavation]]\nname = \"low\"\nkind = \"polyhedron\"\nstage = 1\n"
      "box = {{ min = [-8, -8, -6], max = [8, 8, 0] }}\n"
      "[[excavation]]\nname = \"up\"\nkind = \"polyhedron\"\nstage = 2\n"
      "box = {{ min = [-9, -9, -6], max = [9, 9, 4] }}\n{}",
      roof_tetrahedron, rest);
}

// Spot bolts that one load asks for stand under all of them, and are listed: given as they are listed, the same factors
// come out.
TEST(SupportScene, SpotBoltsAreThoseOfEveryLoad) {
  const std::string rock = fmt::format(
      "[domain]\nbox = {{ min = [-10, -10, 0], max = [10, 10, 15] }}\n{}[stability]\nfree = [\"bottom\"]\n"
      "groups = \"off\"\ntarget = {{ falling = 1.5 }}\n[[load]]\nname = \"q\"\nseismic = [0, 0, -2]\n",
      roof_tetrahedron);
  const std::string kind =
      "kind = \"cable\", free_length = 1, tendon_capacity = 150e3, plate_capacity = 100e3, bond_strength = 100e3, "
      "anchorage = 0.5";
  const RunResult run = run_of(rock + "[support]\nspot = { length = 6, " + kind + " }\n");
  ASSERT_EQ(run.support_cases.size(), 1U);
  const stability::SupportResult &base = *run.support, &under = run.support_cases[0].support;
  EXPECT_GT(base.spot_bolts, 6U);
  ASSERT_EQ(under.bolts.size(), base.bolts.size());
  EXPECT_EQ(under.spot_bolts, base.spot_bolts);
  EXPECT_TRUE(base.passes());
  EXPECT_TRUE(under.passes());
  std::string listed = rock + "[support]\n";
  std::string fields = kind;
  std::ranges::replace(fields, ',', '\n');
  for (const stability::BoltResult& b : base.bolts) {
    const geometry::Vec3 at = b.bolt.collar, to = b.bolt.direction;
    listed += fmt::format("[[support.bolts]]\nat = [[{}, {}, {}]]\ndirection = [{}, {}, {}]\nlength = 6\n{}\n", at.x,
                          at.y, at.z, to.x, to.y, to.z, fields);
  }
  const RunResult again = run_of(listed);
  ASSERT_EQ(again.support->bolts.size(), base.bolts.size());
  EXPECT_NEAR(again.support->blocks.at(0).factor_with_support.value(), base.blocks.at(0).factor_with_support.value(),
              1e-9);
  EXPECT_NEAR(again.support_cases[0].support.blocks.at(0).factor_with_support.value(),
              under.blocks.at(0).factor_with_support.value(), 1e-9);
}

// What stands for a stage before the last alone is bought as well.
TEST(SupportScene, SpotBoltsOfAStageAreListed) {
  const RunResult run = run_of(
      in_two_stages("[stability]\n[support]\nspot = { length = 6, tendon_capacity = 250e3, plate_capacity = 150e3, "
                    "bond_strength = 100e3, anchorage = 0.5 }\n"));
  ASSERT_EQ(run.sequence->stages.size(), 2U);
  const StageSupport& first = *run.sequence->stages[0].support;
  EXPECT_TRUE(first.passes());
  EXPECT_GT(first.spot_bolts, 0U);
  EXPECT_EQ(first.not_held_before, 1U);
  EXPECT_EQ(run.figures.support->spot_bolts, first.spot_bolts);
  ASSERT_EQ(run.support->bolts.size(), first.spot_bolts);
  for (const stability::BoltResult& bolt : run.support->bolts) {
    EXPECT_TRUE(bolt.spot);
    EXPECT_EQ(bolt.bolt.after_stage, 1U);
    EXPECT_EQ(bolt.status, stability::BoltStatus::off);  // with the rock that they were in
  }
  EXPECT_GT(first.spot_bolts, 1U);
  EXPECT_EQ(1U, notes_with(run, fmt::format("after stage 1 {} spot bolts are put in", first.spot_bolts)));
  const RunResult strong = run_of(
      in_two_stages("[stability]\n[support]\nspot = { length = 6, tendon_capacity = 250e4, plate_capacity = 250e4, "
                    "bond_strength = 100e4, anchorage = 0.5 }\n"));
  EXPECT_EQ(strong.sequence->stages[0].support->spot_bolts, 1U);
  EXPECT_EQ(1U, notes_with(strong, "after stage 1 1 spot bolt is put in"));
}

// A block beside the first cut stands, and slides in an earthquake; the second cut takes it away.
TEST(SupportScene, StagesAreJudgedUnderEveryLoad) {
  const RunResult run = run_of(
      "[domain]\nbox = { min = [-20, -20, 0], max = [20, 20, 20] }\n"
      "[[joint]]\nplane = { through = [4, 0, 9], dip = 20, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [0, 0, 9], dip = 85, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [0, -3, 5], dip = 90, dip_direction = 0 }\n"
      "[[joint]]\nplane = { through = [0, 3, 5], dip = 90, dip_direction = 180 }\n"
      "[joints.default]\nfriction = 35\n[rock]\ndensity = 2700\n"
      "[[excavation]]\nname = \"cut\"\nkind = \"polyhedron\"\nstage = 1\n"
      "box = { min = [4, -10, 8], max = [12, 10, 21] }\n"
      "[[excavation]]\nname = \"rest\"\nkind = \"polyhedron\"\nstage = 2\n"
      "box = { min = [-8, -10, 8], max = [12, 10, 21] }\n"
      "[stability]\nfree = [\"top\"]\n[[load]]\nname = \"quake\"\nseismic = [0.6, 0, 0]\n");
  EXPECT_EQ(run.sequence->stages[0].key_blocks.count, 0U);
  ASSERT_EQ(run.sequence->stages[0].cases.size(), 1U);
  const StageCase& quake = run.sequence->stages[0].cases[0];
  EXPECT_EQ(quake.name, "quake");
  EXPECT_EQ(quake.key_blocks.count, 1U);
  EXPECT_NEAR(quake.key_blocks.volume_m3, 277.7, 0.1);
  EXPECT_FALSE(quake.not_held.has_value());
  EXPECT_EQ(1U, notes_with(run, "after stage 1, load case quake: 1 block moves (277.7 m3) that would not without"));
  EXPECT_TRUE(quake.groups.has_value());
}

// The same block in a slab that slides the other way without the load: as many blocks move, and others.
TEST(SupportScene, LoadsThatMoveOneBlockAndHoldAnotherAreNoted) {
  const RunResult run = run_of(
      "[domain]\nbox = { min = [-20, -20, 0], max = [20, 20, 20] }\n"
      "[[joint]]\nplane = { through = [4, 0, 9], dip = 20, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [0, 0, 9], dip = 85, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [12, 0, 9], dip = 40, dip_direction = 270 }\n"
      "[[joint]]\nplane = { through = [16, 0, 9], dip = 85, dip_direction = 270 }\n"
      "[[joint]]\nplane = { through = [0, -3, 5], dip = 90, dip_direction = 0 }\n"
      "[[joint]]\nplane = { through = [0, 3, 5], dip = 90, dip_direction = 180 }\n"
      "[joints.default]\nfriction = 35\n[rock]\ndensity = 2700\n"
      "[[excavation]]\nname = \"cut\"\nkind = \"polyhedron\"\nstage = 1\n"
      "box = { min = [4, -10, 8], max = [12, 10, 21] }\n"
      "[[excavation]]\nname = \"rest\"\nkind = \"polyhedron\"\nstage = 2\n"
      "box = { min = [-8, -10, 8], max = [17, 10, 21] }\n"
      "[stability]\nfree = [\"top\"]\n[[load]]\nname = \"quake\"\nseismic = [0.6, 0, 0]\n");
  const StageResult& first = run.sequence->stages[0];
  EXPECT_EQ(first.key_blocks.count, 1U);
  EXPECT_EQ(first.cases.at(0).key_blocks.count, 1U);
  EXPECT_EQ(1U, notes_with(run, "after stage 1, load case quake: 1 block moves (277.7 m3) that would not without"));
}

TEST(SupportScene, ASupportThatFailsInAStageUnderALoadDoesNotPassEveryStage) {
  const auto with = [](double capacity) {
    return run_of(in_two_stages(fmt::format(
        "[stability]\n[[load]]\nname = \"q\"\nseismic = [0, 0, -0.6]\ntarget = {{ falling = 1.5 }}\n[support]\n"
        "[[support.bolts]]\nat = [[0, 0, 0], [0.5, 0.3, 0], [-0.5, 0.3, 0], [0.05, -0.6, 0]]\ndirection = [0, 0, 1]\n"
        "length = 6\ntendon_capacity = {0}\nplate_capacity = {0}\nbond_strength = 400e3\nanchorage = 0.3\n"
        "after_stage = 1\n",
        capacity)));
  };
  const RunResult weak = with(215e3);
  EXPECT_EQ(weak.sequence->stages[0].support->not_held, 0U);
  EXPECT_EQ(weak.sequence->stages[0].cases.at(0).not_held, 1U);
  EXPECT_FALSE(weak.sequence->stages[0].support->passes());
  EXPECT_EQ(weak.figures.support->failing_stages.value(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(1U, notes_with(weak, "after stage 1, load case q: the support installed by then leaves 1 block and 0"));
  const RunResult strong = with(430e3);
  EXPECT_TRUE(strong.sequence->stages[0].support->passes());
  EXPECT_TRUE(strong.figures.support->failing_stages.value().empty());
}

// A slab behind its toe, between side walls with cohesion that nothing presses. Bolts tilted towards a wall press it,
// and bring back none of it: the group needs what it needs without.
TEST(SupportScene, BoltsBringNoCohesionBackToGroups) {
  const auto slab = [](double cohesion) {
    const std::string walls =
        "20.425594098836477], [3.97, {0}, 15.365594098836478], [20, {0}, 0.94], [25.57526077778263, {0}, 0.94], "
        "[25.57526077778263, {0}, 20.425594098836477]]\n";
    std::string text =
        "[domain]\ncorners = [[-6, -6, -12], [29.57526077778263, -6, -12], [-6, 12, -12], [29.57526077778263, 12, "
        "-12], [-6, -6, 25.81659041060928], [29.57526077778263, -6, -4.0345977870636816], [-6, 12, "
        "25.81659041060928], [29.57526077778263, 12, -4.0345977870636816]]\n"
        "[[joint]]\nset = \"base\"\npolygon = [[3.97, -0.03, 15.450767087771796], [20.03, -0.03, 1.9748270110646793], "
        "[20.03, 6.03, 1.9748270110646793], [3.97, 6.03, 15.450767087771796]]\n"
        "[[joint]]\nset = \"base\"\npolygon = [[19.97, -0.03, 1], [25.57526077778263, -0.03, 1], [25.57526077778263, "
        "6.03, 1], [19.97, 6.03, 1]]\n"
        "[[joint]]\nset = \"mid\"\npolygon = [[20, -0.03, 0.97], [20, 6.03, 0.97], [20, 6.03, 5], [20, -0.03, 5]]\n"
        "[[joint]]\nset = \"back\"\npolygon = [[4, -0.03, 15.39559409883648], [4, 6.03, 15.39559409883648], [4, 6.03, "
        "18.425594098836477], [4, -0.03, 18.425594098836477]]\n";
    for (const int y : {0, 6}) {
      text +=
          fmt::format("[[joint]]\nset = \"walls\"\npolygon = [[3.97, {0}, ", y) + fmt::format(fmt::runtime(walls), y);
    }
    return text + fmt::format(
                      "[joints.default]\nfriction = 30\n[joints.mid]\nfriction = 20\n[joints.walls]\nfriction = 30\n"
                      "cohesion = {}\n[joints.back]\nfriction = 30\n[rock]\ndensity = 2700\n[stability]\n"
                      "free = [\"top\"]\ntarget = {{ sliding = 1.2, falling = 1.5 }}\n[support]\n[[support.bolts]]\n"
                      "at = [[8, 1.5, 14.06919557412736], [8, 2.5, 14.06919557412736], [8, 3.5, 14.06919557412736], "
                      "[12, 1.5, 10.712797049418239], [12, 2.5, 10.712797049418239], [12, 3.5, 10.712797049418239], "
                      "[16, 1.5, 7.356398524709119], [16, 2.5, 7.356398524709119], [16, 3.5, 7.356398524709119]]\n"
                      "direction = [-0.7631294127377695, 0.6427876096865393, -0.06676517241775073]\nlength = 8\n"
                      "tendon_capacity = 33333.333333333336\nplate_capacity = 300e3\nbond_strength = 5e6\n"
                      "anchorage = 0.5\n",
                      cohesion);
  };
  for (const double cohesion : {0.0, 60e3}) {
    const RunResult run = run_of(slab(cohesion));
    ASSERT_TRUE(run.group_support.has_value()) << cohesion;
    EXPECT_FALSE(run.figures.support->groups->all_held()) << cohesion;
    EXPECT_EQ(run.figures.support->groups->not_held, 1U) << cohesion;
    EXPECT_FALSE(run.figures.support->passes()) << cohesion;
  }
}

// On the crown line of a roof prism bolts leave it exactly through its edge: beside it they do the same.
TEST(SupportScene, BoltsThroughAnEdgeAreAsThoseBesideIt) {
  const RunResult run = run_of(
      "[domain]\nbox = { min = [-20, -20, -20], max = [20, 20, 20] }\n"
      "[[joint]]\nplane = { through = [0, 0, 3], dip = 60, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [0, 0, 3], dip = 60, dip_direction = 270 }\n"
      "[[joint]]\nplane = { through = [0, -4, 3], dip = 90, dip_direction = 0 }\n"
      "[[joint]]\nplane = { through = [0, 4, 3], dip = 90, dip_direction = 0 }\n"
      "[joints.default]\nfriction = 35\n"
      "[[excavation]]\nname = \"low\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 8, height = 5 }\n"
      "axis = [[0, -15, -2.5], [0, 15, -2.5]]\n[stability]\n[support]\n[[support.bolts]]\n"
      "at = [[0, 0, 0], [0, 1, 0], [0, 2.5, 0], [0.01, 2.5, 0], [0, -3.1, 0]]\ndirection = [0, 0, 1]\nlength = 6\n"
      "tendon_capacity = 160e3\nplate_capacity = 160e3\nbond_strength = 200e3\nanchorage = 0.3\n");
  ASSERT_EQ(run.support->bolts.size(), 5U);
  for (const stability::BoltResult& bolt : run.support->bolts) {
    // Beside the edge it goes through one more block.
    ASSERT_EQ(bolt.pierced.size(), bolt.bolt.collar.x > 0 ? 3U : 2U);
    EXPECT_NEAR(bolt.pierced[0].to, 3, 0.02);
    EXPECT_NEAR(bolt.capacity, 160e3, 1);
  }
  EXPECT_EQ(run.support->blocks.at(0).bolts, 5U);
}

// A wedge of 51.0 m3 on two planes under the top (29.2 m2) comes out of the east (39.3 m2). A pressure there alone, p
// over F like the strengths, leaves T = (sum of N tan(phi)) / F at 8529.1 Pa; on top as well it would be 10451.6 Pa.
TEST(SupportScene, PressureIsOnTheFaceThatAWedgeComesOutThrough) {
  const RunResult run = run_of(
      "[domain]\nbox = { min = [-15, -15, 0], max = [15, 15, 20] }\n"
      "[[joint]]\nplane = { through = [11.64, -1.25, 16.46], dip = 42.8, dip_direction = 0.3 }\nfriction = 33.6\n"
      "cohesion = 0\nset = \"s0\"\n"
      "[[joint]]\nplane = { through = [13.12, -2.87, 16.88], dip = 65.9, dip_direction = 104.6 }\nfriction = 16.8\n"
      "cohesion = 0\nset = \"s1\"\n[rock]\ndensity = 2650\n[stability]\nfree = [\"top\", \"east\"]\n"
      "partial = { friction = 1.18, cohesion = 1.16, weight = 1 }\ntarget = { falling = 1.58, sliding = 1.02 }\n"
      "[support]\nshotcrete = { thickness = 0.05, strength = 1e3, on = \"all\" }\n");
  ASSERT_EQ(run.support->blocks.size(), 1U);
  EXPECT_NEAR(run.support->blocks[0].required_pressure, 8529.1, 0.2);
}

}  // namespace
}  // namespace cleave::scene
