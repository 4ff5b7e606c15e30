#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/stochastic/statistics.hpp"
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

/// By what is in the files alone: what leaves through a boundary, from connections and heads.
double sent_to(const FlowMesh& mesh, std::string_view file) {
  const auto boundary = std::ranges::find(mesh.boundaries, file, &FlowMeshBoundary::file);
  if (boundary == mesh.boundaries.end()) throw std::runtime_error{"no such file"};
  std::vector<std::uint8_t> in(mesh.cells.cells.size(), 0);
  for (const std::uint32_t h : boundary->held) in[mesh.cells.held[h].cell] = 1;
  double sum = 0;
  for (const flow::FlowConnection& c : mesh.cells.connections) {
    const double passes =
        c.conductance.si() * (mesh.cells.cells[c.cells[0]].head - mesh.cells.cells[c.cells[1]].head).si();
    sum += (in[c.cells[1]] - in[c.cells[0]]) * passes;
  }
  EXPECT_NEAR(sum, boundary->out.si(), 1e-12 * std::abs(sum));
  return sum;
}

TEST(FlowScene, HeadsThatMeetInAnEdgeOfTheDomainAreRefusedWithTheNamesOfItsSides) {
  const std::string upright =
      "[[joint]]\npolygon = [[0, 0, 0], [8, 8, 0], [8, 8, 6], [0, 0, 6]]\n" + aperture + "[flow]\n";
  const auto side = [](const std::string& face, const std::string& level) {
    return "[[flow.side]]\nface = \"" + face + "\"\n" + level + "\n";
  };
  const std::string east = side("east", "level = 7");
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto refused = run(scene_of(with_box(upright + side("west", "level = 9") + side("south", "level = 8") + east)),
                           {}, timer, progress);
  ASSERT_FALSE(refused.has_value());
  const std::string error = describe(refused.error().front());
  EXPECT_TRUE(error.contains("\"west\" (9 m)") && error.contains("\"south\" (8 m)")) << error;
  EXPECT_TRUE(error.contains("close one of the two")) << error;
  // Of a closed side and one with water the water counts.
  const double exact = cubic * 1e-9 * 6 * (9 - 7) / std::sqrt(128.0);
  for (const std::string high : {"west", "south"}) {
    const auto result = run_of(with_box(upright + side(high, "level = 9") + east));
    EXPECT_NEAR(surface(result, "east").passed->out.si(), exact, 1e-11 * exact) << high;
  }
}

TEST(FlowScene, MeshesForOtherProgramsPassWhatTheBoundsSay) {
  const std::string exports = "[flow]\nexports = [\"pflotran\"]\n";
  const auto result = run_of(with_box(level_joint(3) + aperture + exports + across));
  ASSERT_TRUE(result.flow && result.flow->mesh);
  const FlowMesh& mesh = *result.flow->mesh;
  const double exact = cubic * 1e-9 * (9 - 7);
  ASSERT_EQ(mesh.boundaries.size(), 2U);
  EXPECT_EQ(mesh.boundaries[0].file, "flow_mesh_standing_0.ex");
  EXPECT_EQ(mesh.boundaries[0].surfaces, std::vector<std::string>{"west"});
  EXPECT_DOUBLE_EQ(mesh.boundaries[0].level->si(), 9);
  EXPECT_NEAR(sent_to(mesh, mesh.boundaries[0].file), -exact, 1e-12 * exact);
  EXPECT_NEAR(sent_to(mesh, mesh.boundaries[1].file), exact, 1e-12 * exact);
  EXPECT_NEAR(mesh.volume().si(), 64e-3, 1e-15);
  EXPECT_NEAR(mesh.permeability.si(), 1e-6 / 12, 1e-19) << "of one aperture: that of parallel walls";
  EXPECT_NEAR(mesh.conductivity().si() * 1e-3, cubic * 1e-9, 1e-15);
  // Joints on one another hold both their waters. Apertures that differ: the mean over the water.
  const std::string both = level_joint(3, "set = \"A\"\n") + level_joint(3, "set = \"B\"\n") + aperture;
  const auto lying = run_of(with_box(both + "[joints.B]\naperture = 3e-3\n" + exports + across));
  EXPECT_NEAR(lying.flow->mesh->volume().si(), 64 * 4e-3, 1e-14);
  EXPECT_NEAR(lying.flow->mesh->permeability.si(), (1e-9 + 27e-9) / 4e-3 / 12, 1e-18);
  EXPECT_NEAR(sent_to(*lying.flow->mesh, "flow_mesh_standing_1.ex"), 28 * exact, 1e-11 * exact);
  const auto adit = run_of(with_box(level_joint(3) + aperture + tunnel + exports + "level = 20\n"));
  const FlowMesh& drawn = *adit.flow->mesh;
  EXPECT_EQ(drawn.boundaries.back().file, "flow_mesh_drained.ex");
  EXPECT_EQ(drawn.boundaries.back().surfaces, std::vector<std::string>{"adit"});
  EXPECT_FALSE(drawn.boundaries.back().level.has_value());
  const flow::Rate inflow = adit.flow->flow->drained;
  EXPECT_GE(sent_to(drawn, "flow_mesh_drained.ex"), inflow.low * (1 - 1e-9));
  EXPECT_LE(sent_to(drawn, "flow_mesh_drained.ex"), inflow.high * (1 + 1e-9));
  EXPECT_FALSE(run_of(with_box(level_joint(3) + aperture + exports + "level = 1\n")).flow->mesh.has_value());
  EXPECT_FALSE(run_of(with_box(level_joint(3) + aperture + "[flow]\n" + across)).flow->mesh.has_value());
}

TEST(FlowScene, MeshesForOtherProgramsHoldDrainedSurfacesWhereWaterComesOut) {
  // An upright joint through an adit: water comes out of its floor and lower walls alone.
  const std::string upright = "[[joint]]\nplane = { through = [4, 4, 3], dip = 90, dip_direction = 0 }\n";
  const auto result = run_of(with_box(upright + aperture + tunnel + "[flow]\nlevel = 3\nexports = [\"pflotran\"]\n"));
  const FlowMesh& mesh = result.flow->mesh.value();
  const flow::Rate& inflow = result.flow->flow->drained;
  const double found = sent_to(mesh, "flow_mesh_drained.ex");
  EXPECT_GT(surface(result, "adit").passed->dry_length.si(), 0);
  EXPECT_GT(found, 0);
  ASSERT_EQ(mesh.cells.negative, 0U);
  EXPECT_GE(found, inflow.low);
  EXPECT_LE(found, inflow.high);
  for (const flow::HeldCell& held : mesh.cells.held) {
    EXPECT_TRUE(result.flow->surfaces[held.surface].name != "adit" || held.out.si() > -1e-15) << "none goes in";
  }
}

TEST(FlowScene, MeshesWithoutSenseAreRefusedOrSaid) {
  const auto with = [](const std::string& text) { return with_box(level_joint(3) + aperture + text); };
  EXPECT_TRUE(error_of(with("[flow]\nexports = [\"pflotran\"]\n")).contains("no water stands anywhere"));
  EXPECT_TRUE(error_of(with("[flow]\nlevel = 9\nexports = [\"fehm\"]\n")).contains("\"fehm\" is not known"));
  const auto ensemble =
      scene_of(with("[flow]\nlevel = 9\nexports = [\"pflotran\"]\n[monte_carlo]\nrealizations = 2\n"));
  EXPECT_TRUE(
      std::ranges::any_of(ensemble.notes, [](const Problem& note) { return describe(note).contains("replay"); }));
  EXPECT_TRUE(ensemble.flow->pflotran) << "a replay writes it";
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
  EXPECT_EQ(scene_of(with_box(level_joint(3) + "[joints.default]\naperture = 1e-9\n[flow]\nlevel = 2\n")).notes.size(),
            1U)
      << "a nanometre";
  EXPECT_TRUE(wrong("[joints.default]\naperture = \"1 km\"\n[flow]\nlevel = 2\n").contains("at most 1 m"));
}

TEST(FlowScene, AWrongApertureIsWrongOnceAndItsNoteAsksForWhatIsTaken) {
  const auto law = [](const std::string& more) {
    return with_box(level_joint(3) + "[joints.default]\naperture = { distribution = \"normal\", mean = 1e-3, " + more +
                    " }\n[flow]\nlevel = 2\n");
  };
  for (const std::string more : {"std = -1", "std = 1e-4, min = 2"}) {
    const auto errors = errors_of(law(more));
    ASSERT_EQ(errors.size(), 1U) << more << ": and not that it is missing, too";
    EXPECT_TRUE(errors[0].contains("aperture")) << errors[0];
  }
  const auto notes_of = [](const std::string& text) {
    std::string all;
    for (const Problem& note : scene_of(text).notes) all += describe(note) + '\n';
    return all;
  };
  EXPECT_TRUE(notes_of(law("std = 1e-3")).contains("min = 0 says that the tail is to be cut"));
  EXPECT_EQ(notes_of(law("std = 1e-3, min = 0")), "") << "so it does";
  EXPECT_EQ(notes_of(law("std = 0")), "");
}

TEST(FlowScene, LevelsThatLeaveAllDryOrPressAsWaterNowhereDoesAreNoted) {
  const auto notes_of = [](const std::string& flow, const std::string& more) {
    std::string all;
    for (const Problem& note : scene_of(with_box(level_joint(3) + aperture + "[flow]\n" + flow + more)).notes) {
      if (describe(note).contains("flow.level")) all += describe(note) + '\n';
    }
    return all;
  };
  for (const std::string level : {"level = -3\n", "[[flow.side]]\nface = \"west\"\nlevel = 0\n"}) {
    EXPECT_TRUE(notes_of(level, tunnel).contains("below all of the rock (from 0 on)")) << level;
  }
  // The adit's floor lies at 2 m, the rock's at 0.
  EXPECT_TRUE(notes_of("level = 1.5\n", tunnel).contains("lowest opening or free face (2): no water comes out"));
  EXPECT_EQ(notes_of("level = 2.5\n", tunnel), "");
  EXPECT_EQ(notes_of("level = 1.5\n", ""), "") << "nothing is drained that could be dry";
  EXPECT_EQ(notes_of("level = 4000\n", tunnel), "");
  EXPECT_TRUE(notes_of("level = 1e6\n", tunnel).contains("the water there has 9.81e+03 MPa"));
  EXPECT_EQ(notes_of("level = 1\n[[flow.side]]\nface = \"west\"\nlevel = 9\n", tunnel), "") << "one is high enough";
}

/// Level planes without end, their number of Poisson's law; apertures are lognormal. From west to east heads of 9
/// and 7.
std::string level_planes(double p32, const std::string& more) {
  return with_box(
             "[[joint_set]]\nname = \"L\"\norientation = { dip = 0, dip_direction = 0 }\nsize = \"persistent\"\n"
             "intensity = { p32 = " +
             std::to_string(p32) + " }\n" +
             "[joints.default]\naperture = { distribution = \"lognormal\", mean = 1e-3, std = 3e-4 }\n") +
         more;
}
std::vector<stochastic::Record> records_of(const Scene& scene, std::uint64_t count) {
  const Shared shared = shared_by_realizations(scene);
  std::vector<stochastic::Record> records;
  for (std::uint64_t k = 0; k < count; ++k) records.push_back(make_record(scene, shared, k));
  return records;
}
double value(std::string_view quantity, const stochastic::Record& record) {
  return stochastic::quantity_named(quantity)->of(record);
}
std::vector<double> values(std::string_view quantity, const std::vector<stochastic::Record>& records) {
  std::vector<double> all;
  for (const stochastic::Record& record : records) all.push_back(value(quantity, record));
  return all;
}
void expect_mean(const std::vector<double>& values, double exact) {
  stochastic::Moments m;
  for (const double x : values) m.add(x);
  EXPECT_NEAR(m.mean(), exact, 4.5 * m.standard_error()) << m.standard_error();
}

// So many joints, each a cluster, that the mean is P32 times the height; each lets through what its aperture does.
TEST(FlowScene, EnsemblesHaveTheMeansOfTheirLaws) {
  const double number = 0.25 * 6, spread = std::log(1 + 0.09);  // variance of the logarithm
  const double cube = 1e-9 * std::exp(3 * spread);              // mean of the cube: mean^3 (1 + cv^2)^3
  const Scene scene = scene_of(level_planes(0.25, "[flow]\n" + across + "[monte_carlo]\nrealizations = 4\n"));
  const auto records = records_of(scene, 1500);
  expect_mean(values("cluster_count", records), number);
  expect_mean(values("wet_share", records), 1 - std::exp(-number));
  std::vector<double> connected, north_south, largest;
  for (const stochastic::Record& r : records) {
    ASSERT_TRUE(r.flow && r.flow->water);
    const auto tag = [&](std::string_view name) {
      return static_cast<std::uint64_t>(std::ranges::find(scene.domain.tags(), name) - scene.domain.tags().begin());
    };
    const auto has = [&](std::string_view a, std::string_view b) {
      return std::ranges::find(r.flow->connected,
                               stochastic::pair_of_sides(std::min(tag(a), tag(b)), std::max(tag(a), tag(b)))) !=
             r.flow->connected.end();
    };
    connected.push_back(has("west", "east") ? 1 : 0);
    EXPECT_EQ(has("north", "south"), has("west", "east"));
    EXPECT_FALSE(has("top", "bottom"));
    EXPECT_FALSE(has("top", "west"));
    if (r.flow->clusters > 0) {
      EXPECT_NEAR(r.flow->largest_share, 1 / static_cast<double>(r.flow->clusters), 1e-12);
    }
    EXPECT_TRUE(r.flow->water->settled);
    EXPECT_EQ(r.flow->backbone_share, 0) << "there is no opening";
  }
  expect_mean(connected, 1 - std::exp(-number));
  // Nothing is drained: the rates into an opening are those of a free east side.
  const Scene open = scene_of(level_planes(0.25,
                                           "[stability]\nfree = [\"east\"]\n[flow]\n[[flow.side]]\nface = "
                                           "\"west\"\nlevel = 9\n[monte_carlo]\nrealizations = 4\n"));
  const auto drained = records_of(open, 1500);
  // Head 9 against z, which is even over the height: mean drop 6 m, as wide as long.
  expect_mean(values("inflow_m3_s", drained), number * cubic * cube * 6);
  expect_mean(values("probability_of_connection", drained), 1 - std::exp(-number));
  for (const stochastic::Record& r : drained) {
    EXPECT_LE(r.flow->water->low, r.flow->water->inflow);
    EXPECT_LE(r.flow->water->inflow, r.flow->water->high);
    EXPECT_EQ(value("probability_of_inflow", r), r.flow->clusters > 0 ? 1 : 0);
  }
}

// Discs without a common direction percolate at 2.3 excluded volumes (pi^2 R^3) a disc (Mourzenko, Thovert and Adler
// 2005, in the limit of large domains; in one of 8 radii the change is blurred).
TEST(FlowScene, DiscsPercolateWhereTheyAreKnownTo) {
  constexpr double radius = 0.75;
  const auto share_at = [](double density) {
    const Scene scene = scene_of(with_box(
        "[[joint_set]]\nname = \"A\"\nmodel = \"baecher\"\nshape = \"disc\"\norientation = { dip = 45, "
        "dip_direction = 90, distribution = \"fisher\", kappa = 0 }\nsize = { distribution = \"constant\", mean = " +
        std::to_string(2 * radius) + " }\nintensity = { p32 = " +
        std::to_string(density / (std::numbers::pi * radius)) + " }\n[flow]\n[monte_carlo]\nrealizations = 4\n"));
    const auto tag = [&](std::string_view name) {
      return static_cast<std::uint64_t>(std::ranges::find(scene.domain.tags(), name) - scene.domain.tags().begin());
    };
    const auto [a, b] = std::minmax({tag("bottom"), tag("top")});
    const auto records = records_of(scene, 40);
    const auto hits = std::ranges::count_if(records, [pair = stochastic::pair_of_sides(a, b)](const auto& r) {
      return std::ranges::binary_search(r.flow->connected, pair);
    });
    return static_cast<double>(hits) / 40;
  };
  EXPECT_LT(share_at(1.4), 0.15);
  EXPECT_GT(share_at(3.4), 0.85);
}

// A realization is what its replay shows; with `water.flow` blocks are judged with its pressures.
TEST(FlowScene, RealizationsAreTheirReplays) {
  const std::string wedges =
      "[[joint_set]]\nname = \"A\"\norientation = { dip = 35, dip_direction = 90, distribution = \"fisher\", kappa = 5 "
      "}\n"
      "size = { distribution = \"constant\", mean = 12 }\nintensity = { count = 12 }\n"
      "[joints.default]\nfriction = 25\naperture = 1e-3\n[flow]\nlevel = 6\nexports = "
      "[\"pflotran\"]\n[stability]\nfree = [\"east\", "
      "\"top\"]\ngroups = \"off\"\nwater = { flow = true }\n[monte_carlo]\nrealizations = 4\n";
  const Scene scene = scene_of(with_box(wedges));
  EXPECT_TRUE(make_plan(scene).runs(Step::flow));
  const auto records = records_of(scene, 6);
  std::string dry = with_box(wedges);
  dry.replace(dry.find("water = { flow = true }"), 23, "water = { table = -50 }");
  double wet_volume = 0, dry_volume = 0;
  std::size_t meshes = 0;
  for (const stochastic::Record& r : records) {
    StageTimer timer;
    Progress progress{ProgressStyle::quiet};
    const auto replay = run(scene, {.threads = 1, .realization = r.realization}, timer, progress);
    ASSERT_TRUE(replay && replay->flow && replay->flow->flow);
    ASSERT_TRUE(r.flow && r.flow->water);
    EXPECT_EQ(r.flow->water->inflow.si(), replay->flow->flow->drained.value) << "no figure hangs on the mesh";
    EXPECT_EQ(replay->flow->mesh.has_value(), replay->flow->flow->wet_area > Area{});
    meshes += replay->flow->mesh ? 1U : 0U;
    EXPECT_EQ(r.flow->clusters, replay->flow->connectivity.clusters.size());
    EXPECT_EQ(r.flow->backbone_share, replay->flow->share_of_backbone());
    EXPECT_EQ(r.flow->opening_share, replay->flow->share_at_openings());
    EXPECT_NEAR(r.all.volume_m3, replay->figures.key_blocks->volume_m3, 1e-9);
    wet_volume += r.all.volume_m3;
  }
  EXPECT_GT(meshes, 0U);
  StageTimer timer;
  for (std::uint64_t k = 0; k < 6; ++k) {
    realize(scene, nullptr, k, 1, timer, [](std::uint64_t, const Realization* r) {
      ASSERT_TRUE(r != nullptr && r->flow);
      EXPECT_FALSE(r->flow->mesh.has_value()) << "nobody sees it";
    });
  }
  const Scene without = scene_of(dry);
  for (const stochastic::Record& r : records_of(without, 6)) dry_volume += r.all.volume_m3;
  EXPECT_GT(wet_volume, dry_volume) << "the pressures act";
}

TEST(FlowScene, WhatARunStopsByIsThere) {
  const std::string taken = "the scene was taken";
  const auto stop = [](const std::string& quantity, const std::string& more) {
    return errors_of(with_box(level_joint(3) + aperture + more + "[monte_carlo]\nstop = { quantity = \"" + quantity +
                              "\", relative_half_width = 0.1, max = 500 }\n"))
        .front();
  };
  EXPECT_EQ(stop("inflow", "[flow]\n" + across), taken);
  EXPECT_EQ(stop("inflow_m3_s", "[flow]\nlevel = 9\n"), taken);
  EXPECT_TRUE(stop("inflow", "[flow]\n").contains("none stands anywhere"));
  EXPECT_TRUE(stop("backbone_share", "").contains("add [flow]"));
  const std::string open = "[stability]\nfree = [\"east\"]\n";
  EXPECT_TRUE(stop("probability_of_failure_roof", open).contains("only cuts from above"));
  EXPECT_EQ(stop("probability_of_failure_roof", open + tunnel), taken);
  EXPECT_TRUE(stop("support_fails", open).contains("add [support]"));
  EXPECT_TRUE(stop("support_fails_at_a_stage", open + "[support]\n").contains("is of stages of the excavation"));
  EXPECT_TRUE(stop("key_group_count", open).contains("groups = \"decide\""));
  EXPECT_TRUE(stop("clamped_key_block_count", open).contains("add [field_stress]"));
  EXPECT_EQ(stop("key_block_count", open), taken);
}

TEST(FlowScene, ThePlanHasItOnlyWhereItIsAskedFor) {
  const Plan without = make_plan(scene_of(with_box(level_joint(3))));
  EXPECT_TRUE(std::ranges::none_of(without.steps, [](const PlannedStep& s) { return s.step == Step::flow; }));
}

}  // namespace
}  // namespace cleave::scene::test::flow_scene_test
