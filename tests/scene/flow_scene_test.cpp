#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// [flow] in scenes: levels, sides that openings cut, apertures, what is refused. Domain: 8 x 8 x 6 m.

namespace cleave::scene::test::flow_scene_test {
namespace {

constexpr double cubic = 9.81 / (12 * 1.004e-6);

std::string level_joint(double z, std::string_view more = "") {
  return "[[joint]]\nplane = { through = [4, 4, " + std::to_string(z) + "], dip = 0, dip_direction = 0 }\n" +
         std::string{more};
}
const std::string aperture = "[joints.default]\naperture = 1e-3\n";
const std::string across = "[[flow.side]]\nface = \"west\"\nlevel = 9\n[[flow.side]]\nface = \"east\"\nlevel = 7\n";

const FlowSurface& surface(const RunResult& result, std::string_view name) {
  for (const FlowSurface& row : result.flow->surfaces) {
    if (row.name == name) return row;
  }
  throw std::runtime_error{"no such surface"};
}

TEST(FlowScene, ALevelJointIsTheCubicLaw) {
  const auto result = run_of(with_box(level_joint(3) + aperture + "[flow]\n" + across));
  ASSERT_TRUE(result.flow && result.flow->flow);
  const double exact = cubic * 1e-9 * (9 - 7);  // as wide as long
  EXPECT_NEAR(surface(result, "east").passed->out.si(), exact, 1e-12 * exact);
  EXPECT_NEAR(surface(result, "west").passed->out.si(), -exact, 1e-12 * exact);
  EXPECT_EQ(surface(result, "south").condition, "closed");
  EXPECT_DOUBLE_EQ(surface(result, "west").level->si(), 9);
  ASSERT_EQ(result.flow->joints.size(), 1U);
  EXPECT_DOUBLE_EQ(result.flow->joints[0].transmissivity->si(), cubic * 1e-9);
  EXPECT_DOUBLE_EQ(result.flow->joints[0].wet_area.si(), 64);
  EXPECT_FALSE(result.flow->joints[0].backbone) << "there is no opening";
  EXPECT_EQ(result.complex.value().complex().blocks().size(), 2U);
  EXPECT_FALSE(result.complex.value().complex().dangling().has_value());
  // Twice the aperture lets eight times as much through, half the viscosity twice as much.
  const auto wide =
      run_of(with_box(level_joint(3) + "[joints.default]\naperture = 2e-3\n[flow]\nviscosity = 0.502e-6\n" + across));
  EXPECT_NEAR(surface(wide, "east").passed->out.si(), 16 * exact, 1e-11 * exact);
  const auto lying = run_of(with_box(level_joint(3) + level_joint(3) + aperture + "[flow]\n" + across));
  EXPECT_NEAR(surface(lying, "east").passed->out.si(), 2 * exact, 1e-12 * exact) << "joints on one another add up";
}

TEST(FlowScene, SetsHaveTheirOwnAperturesAndLawsDrawOneAJoint) {
  const std::string two = level_joint(2, "set = \"A\"\n") + level_joint(4, "set = \"B\"\n");
  const auto own = run_of(with_box(two + aperture + "[joints.B]\naperture = 3e-3\n[flow]\n" + across));
  EXPECT_NEAR(surface(own, "east").passed->out.si(), 2 * cubic * (1e-9 + 27e-9), 1e-12);
  const std::string law =
      "[joints.default]\naperture = { distribution = \"lognormal\", mean = 1e-3, std = 5e-4 }\n[flow]\n";
  const auto drawn = run_of(with_box(two + law + across));
  const auto& joints = drawn.flow->joints;
  ASSERT_EQ(joints.size(), 2U);
  EXPECT_NE(*joints[0].aperture, *joints[1].aperture);
  EXPECT_NEAR(surface(drawn, "east").passed->out.si(),
              2 * cubic * (std::pow(joints[0].aperture->si(), 3) + std::pow(joints[1].aperture->si(), 3)), 1e-11);
  EXPECT_NE(*run_of("seed = 2\n" + with_box(two + law + across)).flow->joints[0].aperture, *joints[0].aperture);
  const auto alike = run_of(with_box(level_joint(2) + level_joint(4) + law + across));
  EXPECT_NE(*alike.flow->joints[0].aperture, *alike.flow->joints[1].aperture) << "of one set, too";
  // Strengths do not hang on whether apertures are drawn.
  EXPECT_EQ(drawn.joints[topology::JointId{0U}].strength, run_of(with_box(two)).joints[topology::JointId{0U}].strength);
}

const std::string tunnel =
    "[[excavation]]\nname = \"adit\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 2, height = 2 }\n"
    "axis = [[4, -1, 3], [4, 9, 3]]\n";

TEST(FlowScene, SidesThatATunnelCutsAreClosedAndSaid) {
  const auto result = run_of(with_box(level_joint(3) + aperture + tunnel + "[flow]\nlevel = 20\n"));
  const flow::Rate inflow = result.flow->flow->drained;
  // From 3 m on either side, over 8 m; head 20 against 3.
  const double exact = 2 * cubic * 1e-9 * 8 * (20 - 3) / 3;
  EXPECT_NEAR(inflow.value, exact, 1e-12 * exact);
  EXPECT_NEAR(inflow.high - inflow.low, 0, 1e-9 * exact);
  EXPECT_EQ(surface(result, "south").condition, "closed");
  EXPECT_EQ(surface(result, "west").condition, "standing water");
  EXPECT_EQ(surface(result, "adit").condition, "drained");
  EXPECT_EQ(notes_with(result, "an opening cuts below the water: south, north"), 1U);
  EXPECT_NEAR(result.flow->joints[0].into_openings.si(), exact, 1e-12 * exact);
  EXPECT_TRUE(result.flow->joints[0].backbone);
  EXPECT_DOUBLE_EQ(result.flow->share_at_openings(), 1);
  // The same heads at its ends are refused: any amount would pass.
  const auto refused = try_run(with_box(level_joint(3) + aperture + tunnel +
                                        "[flow]\nlevel = 20\n[[flow.side]]\nface = \"south\"\nlevel = 20\n"));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().front().key, "flow");
  EXPECT_TRUE(describe(refused.error().front()).contains("closed = true")) << describe(refused.error().front());
  // Above the water nothing comes in, and the ends need not be closed.
  const auto dry = run_of(with_box(level_joint(3) + aperture + tunnel + "[flow]\nlevel = 1\n"));
  EXPECT_DOUBLE_EQ(dry.flow->flow->drained.value, 0);
  EXPECT_EQ(notes_with(dry, "no joint reaches standing water"), 1U);
}

TEST(FlowScene, WithoutALevelOnlyWhatHangsTogether) {
  const auto result = run_of(with_box(level_joint(3) + tunnel + "[flow]\n"));
  EXPECT_FALSE(result.flow->flow.has_value());
  EXPECT_EQ(result.flow->connectivity.clusters.size(), 2U) << "the tunnel parts the joint";
  EXPECT_DOUBLE_EQ(result.flow->share_of_backbone(), 1);
  EXPECT_FALSE(result.flow->joints[0].aperture.has_value());
}

TEST(FlowScene, WhatIsWrongIsSaid) {
  const auto wrong = [](const std::string& text) { return error_of(with_box(level_joint(3) + text)); };
  EXPECT_TRUE(wrong("[flow]\nlevel = 20\n").contains("joints.default.aperture: is missing"));
  EXPECT_TRUE(wrong(aperture + "[[flow.side]]\nface = \"wset\"\nlevel = 1\n").contains("did you mean \"west\"?"));
  EXPECT_TRUE(wrong(aperture + "[[flow.side]]\nface = \"west\"\n").contains("give either level"));
  EXPECT_TRUE(
      wrong(aperture + "[[flow.side]]\nface = \"west\"\nlevel = 1\nclosed = true\n").contains("beside a level"));
  EXPECT_TRUE(wrong(aperture + across + across).contains("named twice"));
  EXPECT_TRUE(wrong("[joints.default]\naperture = 0\n[flow]\nlevel = 2\n").contains("aperture"));
  EXPECT_EQ(scene_of(with_box(level_joint(3) + "[joints.default]\naperture = 1\n[flow]\nlevel = 2\n")).notes.size(), 1U)
      << "a metre: perhaps millimetres were meant";
}

TEST(FlowScene, EnsemblesLeaveItOutAndThePlanSaysSo) {
  const Scene scene =
      scene_of(with_box(level_joint(3) + aperture + "[flow]\nlevel = 9\n[monte_carlo]\nrealizations = 4\n"));
  EXPECT_FALSE(make_plan(scene).runs(Step::flow));
  EXPECT_TRUE(plan_of_realization(scene).runs(Step::flow));
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  EXPECT_TRUE(run(scene, {.threads = 1}, timer, progress).value().flow.has_value()) << "as cleave replay runs it";
  const Plan without = make_plan(scene_of(with_box(level_joint(3))));
  EXPECT_TRUE(std::ranges::none_of(without.steps, [](const PlannedStep& s) { return s.step == Step::flow; }));
}

}  // namespace
}  // namespace cleave::scene::test::flow_scene_test
