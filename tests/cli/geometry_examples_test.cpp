#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "example_run.hpp"

// The scenes of examples/ that show one geometry each: counts and volumes, from the scene file to summary.json.

namespace cleave::cli::test {
namespace {

using Json = nlohmann::json;

class GeometryExamples : public ExampleRun {
 protected:
  /// Within 5 % of the stated number of blocks.
  void expect_size(const std::string& name, int stated) const {
    const auto result = result_of(name);
    EXPECT_NEAR(result["blocks"]["count"].get<int>(), stated, 0.05 * stated);
    RecordProperty(name + "_blocks", result["blocks"]["count"].get<int>());
    RecordProperty(name + "_concave", result["blocks"]["concave"].get<int>());
  }
};

/// Area of a half disc of n chords whose corners lie on the arc of radius r.
double half_disc(double r, int n) { return 0.5 * n * r * r * std::sin(std::numbers::pi / n); }

TEST_F(GeometryExamples, CrossingTunnelsAreOneBlock) {
  const auto result = result_of("crossing_tunnels");
  EXPECT_EQ(result["blocks"]["count"], 1);
  // Over the 6 m of the rectangle's width the horseshoe is 10 m wide where the rectangle lies (z 15 to 19, walls 15 to
  // 20).
  const double horseshoe = 60 * (50 + half_disc(5, 16)), rectangle = 60 * 24, shared = 10 * 24;
  EXPECT_NEAR(result["blocks"]["volume_m3"].get<double>(), 60 * 60 * 40 - horseshoe - rectangle + shared, 1e-4);
}

TEST_F(GeometryExamples, KindsOfJoints) {
  const auto result = result_of("joint_kinds");
  // The floating box; the upper west block around it; two of the lower west; four of the east.
  EXPECT_EQ(result["blocks"]["count"], 1 + 1 + 2 + 4);
  EXPECT_EQ(result["blocks"]["with_cavities"], 1);
  EXPECT_NEAR(result["blocks"]["volume_m3"].get<double>(), 12 * 10 * 8, 1e-9);
  const auto& dangling = result["dangling"];
  EXPECT_EQ(dangling["isolated_joints"], 1);
  // The disc, the membrane less its hole, and what the shelf has beyond the wall.
  EXPECT_EQ(dangling["joints"], 3);
  EXPECT_NEAR(dangling["area_m2"].get<double>(), std::numbers::pi + (5 * 4 - 2 * 2) + 1 * 10, 1e-9);
  EXPECT_TRUE(exists("joint_kinds/dangling.vtu"));
}

TEST_F(GeometryExamples, WaterComesIntoATunnelByItsFaultBeforeAll) {
  const auto flow = result_of("tunnel_inflow")["flow"];
  EXPECT_EQ(flow["status"], "converged");
  const double inflow = flow["inflow_m3_s"], low = flow["inflow_low_m3_s"], high = flow["inflow_high_m3_s"];
  EXPECT_LE(low, inflow);
  EXPECT_GE(high, inflow);
  EXPECT_LE(0.5 * (high - low), 0.02 * inflow);
  EXPECT_GT(flow["backbone_share"], 0.9);
  std::istringstream rows{read("tunnel_inflow/flow_joints.csv")};
  std::string header, fault;
  std::getline(rows, header);
  std::getline(rows, fault);
  EXPECT_TRUE(header.ends_with(",backbone,into_openings_m3_s"));
  EXPECT_TRUE(fault.contains(",fault,3e-04,"));
  EXPECT_GT(std::stod(fault.substr(fault.rfind(',') + 1)), 0.6 * inflow);
  EXPECT_TRUE(exists("tunnel_inflow/flow.vtu"));
  EXPECT_TRUE(read("tunnel_inflow/report.html").contains("Water in the joints"));
}

TEST_F(GeometryExamples, ATunnelAdvancesInMappedRock) {
  const auto result = result_of("tunnel_advance");
  const auto& mapped = result["mapped"];
  EXPECT_EQ(mapped["faces"], 5);
  EXPECT_EQ(mapped["holes"], 1);
  const int joints = mapped["joints"];
  EXPECT_EQ(joints, 20);
  EXPECT_GE(mapped["honoured"].get<int>(), 0.95 * joints);
  EXPECT_GT(mapped["random_joints_taken_out"], 10);
  EXPECT_EQ(result["input"]["files"].size(), 2U);
  std::istringstream rows{read("tunnel_advance/mapped_joints.csv")};
  std::string line;
  int count = -1;  // the header
  while (std::getline(rows, line)) ++count;
  EXPECT_EQ(count, joints);
  EXPECT_TRUE(read("tunnel_advance/report.html").contains("Joints that were mapped"));
  const Ended check = cleave("check '" + file("tunnel_advance", "tunnel_advance.toml") + "'");
  EXPECT_EQ(check.code, 0) << check.err;
}

TEST_F(GeometryExamples, DomainsFromTrianglesAndMeshes) {
  const auto knoll = result_of("knoll");
  EXPECT_EQ(knoll["blocks"]["count"], 4);
  // The pyramid of 10 m height loses its upper 8 m.
  EXPECT_NEAR(knoll["blocks"]["volume_m3"].get<double>(), 40 * 40 * 10 + 40 * 40 * 10 / 3.0 * (1 - std::pow(0.8, 3)),
              1e-7);
  const auto ell = result_of("ell");
  EXPECT_EQ(ell["blocks"]["count"], 6);
  EXPECT_EQ(ell["blocks"]["concave"], 2);
  EXPECT_NEAR(ell["blocks"]["volume_m3"].get<double>(), (6 * 2 + 4 * 2) * 4, 1e-10);
}

// A stump of a pyramid of height h between squares of sides a and b: h/3 (a^2 + a b + b^2); here 10, 8, 6 and 3 m,
// quartered.
TEST_F(GeometryExamples, HexahedronIsEightStumps) {
  const auto result = result_of("hexahedron");
  EXPECT_EQ(result["blocks"]["count"], 8);
  EXPECT_EQ(result["blocks"]["concave"], 0);
  EXPECT_NEAR(result["blocks"]["volume_m3"].get<double>(), 100 + 80 + 64 + 64 + 48 + 36, 1e-10);
  EXPECT_EQ(result["blocks"]["volume_relative_error"], 0);
}

TEST_F(GeometryExamples, CavernIsOneBlockWithACavity) {
  const auto result = result_of("cavern");
  EXPECT_EQ(result["blocks"]["count"], 1);
  EXPECT_EQ(result["blocks"]["with_cavities"], 1);
  EXPECT_EQ(result["blocks"]["with_holes"], 1);
  EXPECT_NEAR(result["blocks"]["volume_m3"].get<double>(), 463330, 1);
}

TEST_F(GeometryExamples, MineShaftsAndGreatWallAreOneBlockEach) {
  EXPECT_EQ(result_of("mine_shafts")["blocks"]["count"], 1);
  const auto wall = result_of("great_wall");
  EXPECT_EQ(wall["blocks"]["count"], 1);
  EXPECT_EQ(wall["blocks"]["with_holes"], 1);
  // 44 x 6 x 14 less what the boxes and the gate take (the sum of disjoint parts; the gate's arch has 16 chords a half
  // circle of radius 2).
  const double gate = 6 * (4 * 3 + half_disc(2, 16));
  const double walkway = 4 * 2 * (17 + 17), above = 6 * 3 * (17 + 17), crenels = 8 * 1.5 * 1 * 1;
  const double room = 6 * 3 * 3, doors = 2 * 2 * 2 * 2, window = 2 * 1.5 * 1.5, hatch = 2 * 2 * 2;
  EXPECT_NEAR(wall["blocks"]["volume_m3"].get<double>(),
              44 * 6 * 14 - gate - walkway - above - crenels - room - doors - window - hatch, 1e-6);
}

// Fu (2014), figure 3-19: two blocks.
TEST_F(GeometryExamples, NineTunnelsAndACurvedFaultMakeTwoBlocks) {
  const auto result = result_of("nine_tunnels");
  EXPECT_EQ(result["input"]["joints"], 1);
  EXPECT_EQ(result["blocks"]["count"], 2);
  EXPECT_EQ(result["blocks"]["with_holes"], 2);
}

TEST_F(GeometryExamples, CurvedTunnelHasKeyBlocks) {
  const auto result = result_of("curved_tunnel");
  EXPECT_GT(result["blocks"]["count"].get<int>(), 100);
  EXPECT_TRUE(result.contains("key_blocks"));
}

// Fu (2014), figure 3-22 c: 136 bricks; 17 x 4 voussoirs and 2 x 34 bricks of the walls.
TEST_F(GeometryExamples, MasonryBridgeHas136Bricks) {
  const auto result = result_of("masonry_bridge");
  EXPECT_EQ(result["blocks"]["count"], 136);
  EXPECT_EQ(result["blocks"]["slivers"], 0);
}

TEST_F(GeometryExamples, DamAndFoundation) {
  const auto result = result_of("dam");
  // Four monoliths, and the foundation: 1 + 3 planes + 2 lines (the two parallel planes each meet the third inside).
  EXPECT_EQ(result["blocks"]["count"], 4 + 6);
}

TEST_F(GeometryExamples, HillsideHasTheVolumeOfItsGrid) {
  const auto result = result_of("hillside");
  EXPECT_EQ(result["blocks"]["count"], 13);
  // Prisms under the triangles of the grid, cells parted from south-west to north-east; less the tunnel (120 m long).
  std::istringstream grid{text_of(file("hillside", "hill.asc"))};
  std::string word;
  for (int i = 0; i < 12; ++i) grid >> word;
  std::array<std::array<double, 25>, 25> z{};
  for (auto& row : z) {
    for (double& value : row) grid >> value;
  }
  double rock = 0;
  for (std::size_t r = 0; r + 1 < 25; ++r) {
    for (std::size_t c = 0; c + 1 < 25; ++c) {
      const double nw = z[r][c], ne = z[r][c + 1], sw = z[r + 1][c], se = z[r + 1][c + 1];
      rock += 12.5 * ((sw + se + ne) / 3 + 20) + 12.5 * ((sw + ne + nw) / 3 + 20);
    }
  }
  const double tunnel = 120 * (9 * 3.5 + half_disc(4.5, 16));
  const double left = result["blocks"]["volume_m3"].get<double>();
  EXPECT_NEAR(left, rock - tunnel, 1e-9 * rock);
}

TEST_F(GeometryExamples, OpenPitIsTakenOutBenchByBench) {
  const auto result = result_of("open_pit");
  ASSERT_EQ(result["sequence"]["stages"].size(), 4U);
  double rock = 80.0 * 80 * 60;
  for (const auto& stage : result["sequence"]["stages"]) {
    EXPECT_TRUE(stage["certificate_passed"]);
    EXPECT_LT(stage["block_volume_m3"].get<double>(), rock);
    rock = stage["block_volume_m3"].get<double>();
  }
  for (const char* stage : {"1", "2", "3", "4"}) {
    EXPECT_TRUE(exists(std::string{"open_pit/blocks_stage_"} + stage + ".vtu"));
  }
}

// The order of the scene's own stages is the first of 4! = 24; after the last stage the rock is that of the whole
// tunnel but for what has fallen.
TEST_F(GeometryExamples, SequentialTunnelComparesAllOrders) {
  const auto result = result_of("sequential_tunnel");
  const auto& sequence = result["sequence"];
  ASSERT_EQ(sequence["orders"].size(), 24U);
  EXPECT_EQ(sequence["orders"][0]["stages"], (Json{1, 2, 3, 4}));
  double least = 1e300;
  for (const auto& order : sequence["orders"]) {
    double sum = 0;
    for (const auto& volume : order["new_volume_m3"]) sum += volume.get<double>();
    EXPECT_NEAR(order["key_block_volume_m3"].get<double>(), sum, 1e-9 * sum);
    least = std::min(least, sum);
  }
  EXPECT_NEAR(sequence["orders"][sequence["best_order"].get<std::size_t>()]["key_block_volume_m3"].get<double>(), least,
              1e-9 * least);
  double fallen = 0;
  for (const auto& stage : sequence["stages"]) fallen += stage["new_key_block_volume_m3"].get<double>();
  // The rock of the last stage is that of the whole tunnel less what has fallen before and lay outside it.
  const double last = sequence["stages"][3]["block_volume_m3"].get<double>();
  EXPECT_LE(last, result["blocks"]["volume_m3"].get<double>());
  EXPECT_GE(last, result["blocks"]["volume_m3"].get<double>() - fallen);
}

// Fu (2014), figures 3-12, 3-22 a and b, 3-23 a and b: the numbers of blocks stated there, within 5 %.
TEST_F(GeometryExamples, RockMassesHaveTheirStatedSizes) {
  expect_size("rock_mass", 3166);
  expect_size("complex_slope", 107);
  expect_size("half_pit", 838);
  expect_size("cuboid_three_sets", 8261);
  expect_size("slope_four_sets", 7522);
}

}  // namespace
}  // namespace cleave::cli::test
