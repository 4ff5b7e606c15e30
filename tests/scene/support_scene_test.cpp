#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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

// A slip in the unit asks for more bolts than memory holds: they are counted before they are made.
TEST(SupportScene, PatternsOfTooManyBoltsAreRefusedBeforeTheyAreMade) {
  const std::string scene =
      "[domain]\nbox = { min = [0, 0, 0], max = [30, 20, 30] }\n[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\n"
      "section = { shape = \"rectangle\", width = 8, height = 8 }\naxis = [[15, 0, 15], [15, 20, 15]]\n[support]\n"
      "[[support.bolts]]\nlength = 3\ntendon_capacity = 2e5\nplate_capacity = 1e5\nbond_strength = 2e5\n"
      "anchorage = 0.5\n";
  const auto refused = [&](const std::string& pattern) { return test::errors_of(scene + pattern).front(); };
  EXPECT_TRUE(refused("tunnel = \"t\"\nspacing = [1e-5, 1e-5]\n").contains("spacing: makes 4800004400001 bolts"))
      << refused("tunnel = \"t\"\nspacing = [1e-5, 1e-5]\n");
  const std::string grid =
      "grid = { corner = [0, 0, 30], dip = 0, dip_direction = 0, width = 20, height = 20 }\nspacing = ";
  EXPECT_TRUE(refused(grid + "[1e-5, 1e-5]\n").contains("spacing: makes 4000004000001 bolts; space them wider"));
}

// Bolts into the roof of 4 m of rock: 1 m of each of two lies beyond the top, where rock is taken to go on.
TEST(SupportScene, BoltsThatLeaveTheDomainAreSaid) {
  const auto bolted = [](std::string_view free, std::string_view length) {
    return run_of(
        fmt::format("[domain]\nbox = {{ min = [-10, -10, 0], max = [10, 10, 4] }}\n{}[stability]\nfree = {}\n"
                    "[support]\n[[support.bolts]]\nat = [[1, 0.5, 0], [-1, 0.5, 0]]\ndirection = [0, 0, 1]\n"
                    "length = {}\ntendon_capacity = \"200 kN\"\nbond_strength = \"200 kN/m\"\n"
                    "anchorage = 0.5\n",
                    roof_tetrahedron, free, length));
  };
  EXPECT_EQ(notes_with(bolted("[\"bottom\"]", "5"),
                       "2 of 2 bolts leave the domain through a side that is not free: 2 m of them, up to 1 m of one, "
                       "lie outside"),
            1U);
  EXPECT_EQ(notes_with(bolted("[\"bottom\"]", "4"), "leave the domain"), 0U);
  EXPECT_EQ(notes_with(bolted("[\"bottom\", \"top\"]", "5"), "leave the domain"), 0U);
}

// The bolt lies some 2 m in the tetrahedron, held by its plate: gripped for less than the anchorage it is no dowel.
TEST(SupportScene, ShearThatDoesNotCountIsSaid) {
  const auto bolted = [](std::string_view direction, double anchorage, double shear) {
    return run_of(fmt::format(
        "[domain]\nbox = {{ min = [-10, -10, 0], max = [10, 10, 15] }}\n{}[stability]\nfree = [\"bottom\"]\n"
        "[support]\n[[support.bolts]]\nat = [[0.5, 0.2, 0]]\ndirection = {}\nlength = 8\n"
        "tendon_capacity = \"200 kN\"\nplate_capacity = \"100 kN\"\nbond_strength = \"200 kN/m\"\n"
        "anchorage = {}\nshear_capacity = {}\n",
        roof_tetrahedron, direction, anchorage, shear));
  };
  const std::string_view note = "1 of 1 bolts is gripped less than its anchorage in the block that it serves";
  EXPECT_EQ(notes_with(bolted("[0.3, 0, 1]", 2.8, 1e5), note), 1U);
  EXPECT_EQ(notes_with(bolted("[0.3, 0, 1]", 0.5, 1e5), note), 0U);
  EXPECT_EQ(notes_with(bolted("[0.3, 0, 1]", 2.8, 0), note), 0U);
  // Along the movement no shear is asked of it.
  EXPECT_EQ(notes_with(bolted("[0, 0, 1]", 2.8, 1e5), note), 0U);
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

/// A block of 1.5 m3 that can only slide to the east, down a plane of 45 degrees: stage 1 opens its side, stage 2 digs
/// away what it stands on, stage 3 is far away. One bolt along its way out holds it from stage 1 on, against falling it
/// has none before stage `hung_after`.
std::string undercut(int hung_after, std::string_view rest) {
  const std::string bolts =
      "length = 4\ntendon_capacity = {0}e3\nplate_capacity = 500e3\nbond_strength = 500e3\nanchorage = 0.5\n";
  return "[domain]\nbox = { min = [0, 0, 0], max = [12, 10, 12] }\n"
         "[[joint]]\npolygon = [[5, 4.5, 5], [6, 4.5, 4], [6, 5.5, 4], [5, 5.5, 5]]\n"
         "[[joint]]\npolygon = [[5, 4.5, 6], [6, 4.5, 6], [6, 5.5, 6], [5, 5.5, 6]]\n"
         "[[joint]]\npolygon = [[5, 4.5, 5], [5, 5.5, 5], [5, 5.5, 6], [5, 4.5, 6]]\n"
         "[[joint]]\npolygon = [[5, 4.5, 5], [6, 4.5, 4], [6, 4.5, 6], [5, 4.5, 6]]\n"
         "[[joint]]\npolygon = [[5, 5.5, 5], [6, 5.5, 4], [6, 5.5, 6], [5, 5.5, 6]]\n"
         "[joints.default]\nfriction = 40\n[rock]\ndensity = 2600\n"
         "[[excavation]]\nname = \"east\"\nkind = \"polyhedron\"\nstage = 1\n"
         "box = { min = [6, 2, 2], max = [9, 8, 8] }\n"
         "[[excavation]]\nname = \"under\"\nkind = \"polyhedron\"\nstage = 2\n"
         "corners = [[5, 4.5, 2], [6, 4.5, 2], [5, 5.5, 2], [6, 5.5, 2], [5, 4.5, 5], [6, 4.5, 4], [5, 5.5, 5], "
         "[6, 5.5, 4]]\n"
         "[[excavation]]\nname = \"far\"\nkind = \"polyhedron\"\nstage = 3\nbox = { min = [1, 1, 1], max = [2, 2, 2] "
         "}\n"
         "[stability]\ntarget = { falling = 1.5, sliding = 1.5 }\n"
         "[support]\n[[support.bolts]]\nat = [[6, 5, 5]]\ndirection = [-1, 0, 0]\nafter_stage = 1\n" +
         fmt::format(fmt::runtime(bolts), 60) + "[[support.bolts]]\nat = [[5.5, 5, 4.5]]\ndirection = [0, 0, 1]\n" +
         fmt::format(fmt::runtime(bolts), 500) + fmt::format("after_stage = {}\n{}", hung_after, rest);
}

std::vector<std::uint64_t> key_blocks_of_stages(const RunResult& run) {
  std::vector<std::uint64_t> out;
  for (const StageResult& row : run.sequence.value().stages) out.push_back(row.key_blocks.count);
  return out;
}

std::vector<bool> passing_stages(const RunResult& run) {
  std::vector<bool> out;
  for (const StageResult& row : run.sequence.value().stages) out.push_back(row.support.value().passes());
  return out;
}

// What bolts hold after one stage has not fallen before the next: there they must hold it, too. Weight 38.25 kN.
TEST(SupportScene, WhatIsHeldInOneStageIsThereInTheNext) {
  using Stages = std::vector<std::uint32_t>;
  for (const std::string_view fallen :
       {"", "[sequence]\ncompare_orders = \"all\"\n", "[sequence]\nfallen = \"put_back\"\n"}) {
    const RunResult late = run_of(undercut(3, fallen));
    EXPECT_EQ(late.sequence->fallen, Fallen::put_back);
    EXPECT_EQ(key_blocks_of_stages(late), (std::vector<std::uint64_t>{1, 1, 1}));
    EXPECT_EQ(passing_stages(late), (std::vector{true, false, true}));
    EXPECT_EQ(late.sequence->stages[1].support->not_held, 1U);
    EXPECT_EQ(late.sequence->stages[2].support->not_held_before, 1U);
    EXPECT_EQ(late.figures.support->failing_stages.value(), Stages{2});
    EXPECT_EQ(1U, notes_with(late, "after stage 2 the support installed by then leaves 1 of 1 block"));
    EXPECT_EQ(late.sequence->stages[0].new_key_blocks, 1U);
    EXPECT_EQ(late.sequence->stages[1].new_key_blocks, 0U) << "it left in stage 1";
    EXPECT_NEAR(late.sequence->stages[0].key_blocks.volume_m3, 1.5, 1e-9);
  }
  const RunResult soon = run_of(undercut(2, {}));
  EXPECT_EQ(passing_stages(soon), (std::vector{true, true, true}));
  EXPECT_EQ(soon.figures.support->failing_stages.value(), Stages{});
  const RunResult orders = run_of(undercut(3, "[sequence]\ncompare_orders = [[1, 2, 3], [2, 1, 3]]\n"));
  ASSERT_EQ(orders.sequence->orders.size(), 2U);
  // In the other order the rock of stage 1 holds it.
  EXPECT_EQ(orders.sequence->orders[1].new_key_blocks, (std::vector<std::uint64_t>{0, 1, 0}));
}

// So they must under a load that alone moves it, in groups and where blocks are let go stage by stage.
TEST(SupportScene, WhatIsHeldInOneStageIsThereUnderLoadsAndInGroups) {
  const std::string load = "[[load]]\nname = \"q\"\nseismic = [0.05, 0, 0]\n";
  const RunResult run = run_of(undercut(3, load + "[motion]\nrelease = \"stage\"\nduration = 0.01\n"));
  EXPECT_EQ(passing_stages(run), (std::vector{true, false, true}));
  for (std::size_t k = 0; k < 3; ++k) {
    const StageCase& under = run.sequence->stages[k].cases.at(0);
    EXPECT_EQ(under.key_blocks.count, 1U);
    EXPECT_EQ(under.not_held, k == 1 ? 1U : 0U);
    EXPECT_EQ(under.fails(), k == 1);
    ASSERT_TRUE(run.sequence->stages[k].groups.has_value());
  }
  EXPECT_EQ(run.figures.support->failing_stages.value(), std::vector<std::uint32_t>{2});
  ASSERT_TRUE(run.motion.has_value());
  std::string decided = undercut(3, {});
  decided.replace(decided.find("[stability]\n"), 12, "[stability]\ngroups = \"decide\"\n");
  EXPECT_EQ(run_of(decided).figures.support->failing_stages.value(), std::vector<std::uint32_t>{2});
}

TEST(SupportScene, BlocksThatFallBesideASupportAreRefused) {
  EXPECT_TRUE(
      error_of(undercut(3, "[sequence]\nfallen = \"stay_out\"\n"))
          .ends_with(": sequence.fallen: takes out after each stage what the support may hold, and what it holds "
                     "must be held later; remove it, or write \"put_back\"; for the blocks that fall without "
                     "support remove [support]"));
  std::string bare = undercut(3, "[sequence]\nfallen = \"stay_out\"\n");
  bare.erase(bare.find("[support]"), bare.find("[sequence]") - bare.find("[support]"));
  EXPECT_EQ(key_blocks_of_stages(run_of(bare)), (std::vector<std::uint64_t>{1, 0, 0}));
  bare.erase(bare.find("[sequence]"));
  EXPECT_EQ(run_of(bare).sequence->fallen, Fallen::stay_out);
}

// An ensemble takes no supported block out either; it counts at how many stages the support fails, as the replay says.
TEST(SupportScene, EnsemblesKeepWhatBoltsHoldAndReplaysJudgeEveryStage) {
  const Scene scene =
      scene_of(undercut(3, "[sequence]\ncompare_orders = [[1, 2, 3], [3, 1, 2]]\n[monte_carlo]\nrealizations = 2\n"));
  std::size_t seen = 0;
  StageTimer timer;
  realize(scene, nullptr, 0, 2, timer, [&](std::uint64_t, const Realization* made) {
    ASSERT_TRUE(made != nullptr && made->sequence.has_value());
    EXPECT_EQ(made->sequence->fallen, Fallen::put_back);
    for (const StageResult& row : made->sequence->stages) EXPECT_EQ(row.key_blocks.count, 1U);
    EXPECT_TRUE(made->support.value().passes());
    ++seen;
  });
  EXPECT_EQ(seen, 2U);
  Progress progress{ProgressStyle::quiet};
  const auto replayed = run(scene, {.threads = 1, .realization = 1}, timer, progress);
  ASSERT_TRUE(replayed.has_value());
  EXPECT_EQ(replayed->figures.support->failing_stages.value(), std::vector<std::uint32_t>{2});
  EXPECT_EQ(make_record(scene, shared_by_realizations(scene), 1).supported_stages,
            (stochastic::SupportedStages{.judged = 3, .failing = 1}));
  EXPECT_TRUE(ensemble_options_of(scene).stages);
  const std::string two = "[monte_carlo]\nrealizations = 2\n";
  const Scene soon = scene_of(undercut(2, two));
  EXPECT_EQ(make_record(soon, shared_by_realizations(soon), 1).supported_stages,
            (stochastic::SupportedStages{.judged = 3}));
  // A load that alone makes it fail after the stage counts, too; groups do where they decide.
  const Scene pushed = scene_of(undercut(2, "[[load]]\nname = \"q\"\nseismic = [0, 0, -9]\n" + two));
  EXPECT_GT(make_record(pushed, shared_by_realizations(pushed), 1).supported_stages->failing, 0U);
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

/// A tunnel from y = 0 to 24, a block of 2 x 2 x 1.5 m in its roof at the portal, and a ring of bolts there; turned
/// round the portal is at y = 24.
std::string at_a_portal(bool turned, std::string_view free) {
  const auto at = [&](double y) { return turned ? 24 - y : y; };
  std::string text = "[domain]\nbox = { min = [0, 0, 0], max = [24, 24, 24] }\n";
  for (const auto& [x0, y0, x1, y1] :
       {std::array{11.0, -1.0, 11.0, 2.0}, {13.0, -1.0, 13.0, 2.0}, {11.0, 2.0, 13.0, 2.0}}) {
    text += fmt::format("[[joint]]\npolygon = [[{0}, {1}, 12], [{2}, {3}, 12], [{2}, {3}, 15.5], [{0}, {1}, 15.5]]\n",
                        x0, at(y0), x1, at(y1));
  }
  text += fmt::format("[[joint]]\npolygon = [[11, {0}, 15.5], [13, {0}, 15.5], [13, {1}, 15.5], [11, {1}, 15.5]]\n",
                      at(-1), at(2));
  return text + fmt::format(
                    "[rock]\ndensity = 2500\n[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\n"
                    "section = {{ shape = \"rectangle\", width = 6, height = 4 }}\n"
                    "axis = [[12, {}, 12], [12, {}, 12]]\n[stability]\nfree = [{}]\ngroups = \"off\"\n"
                    "[support]\n[[support.bolts]]\ntunnel = \"t\"\nspacing = [30, 0.9]\noffset = [0, 0]\n"
                    "length = 4\ntendon_capacity = 150e3\nplate_capacity = 100e3\nbond_strength = 200e3\n"
                    "anchorage = 0.4\n",
                    at(0), at(24), free);
}

// A ring in the face of the portal is half in the air: it holds nothing, on whichever side the portal is. Where rock
// goes on beyond the side, the same bolts go through the block for 1.5 m, and are in the rock on both sides.
TEST(SupportScene, BoltsInAFreeFaceHoldNothing) {
  for (const bool turned : {false, true}) {
    const RunResult portal = run_of(at_a_portal(turned, turned ? "\"north\"" : "\"south\""));
    ASSERT_GE(portal.support->bolts.size(), 10U);
    for (const stability::BoltResult& bolt : portal.support->bolts) {
      EXPECT_EQ(bolt.status, stability::BoltStatus::off) << turned;
    }
    EXPECT_EQ(portal.figures.support->not_held, 1U) << turned;
    EXPECT_FALSE(portal.figures.support->passes()) << turned;
    const RunResult deep = run_of(at_a_portal(turned, ""));
    std::size_t through = 0;
    for (const stability::BoltResult& bolt : deep.support->bolts) {
      EXPECT_NE(bolt.status, stability::BoltStatus::off) << turned << ' ' << bolt.bolt.collar.x;
      if (bolt.bolt.direction.z < 0.9 || std::abs(bolt.bolt.collar.x - 12) >= 1) continue;
      ASSERT_EQ(bolt.pierced.size(), 2U) << turned;
      EXPECT_NEAR(bolt.pierced[0].to, 1.5, 1e-4) << turned;
      ++through;
    }
    EXPECT_GE(through, 2U) << turned;
  }
}

// Bolts at the corners of a section, where two walls meet, stand on rock whichever way the tunnel runs.
TEST(SupportScene, BoltsAtCornersOfASectionAreInTheRock) {
  for (const double turn : {0.0, 7.0, 31.0, 63.0, 80.0}) {
    const double c = 5 * std::cos(turn * std::numbers::pi / 180), s = 5 * std::sin(turn * std::numbers::pi / 180);
    const RunResult run = run_of(fmt::format(
        "[domain]\nbox = {{ min = [0, 0, 0], max = [24, 24, 24] }}\n[rock]\ndensity = 2700\n"
        "[joints.default]\nfriction = 30\n[[joint]]\nplane = {{ through = [12, 12, 20], dip = 10, dip_direction = 40 "
        "}}\n"
        "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\n"
        "section = {{ shape = \"trapezoid\", width = 7, height = 5, top_width = 5 }}\n"
        "axis = [[{}, {}, 11.7], [{}, {}, 12.1]]\n[stability]\ngroups = \"off\"\n[support]\n[[support.bolts]]\n"
        "tunnel = \"t\"\nspacing = [1.5, 1.2]\nlength = 3\ntendon_capacity = 150e3\nplate_capacity = 50e3\n"
        "bond_strength = 90e3\nanchorage = 0.4\n",
        12 - c, 12.3 - s, 12 + c, 12.3 + s));
    for (const stability::BoltResult& bolt : run.support->bolts) {
      EXPECT_NE(bolt.status, stability::BoltStatus::off)
          << turn << ' ' << bolt.bolt.collar.x << ' ' << bolt.bolt.collar.z;
    }
  }
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
