#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cleave/realize/run.hpp"
#include "cleave/scene/plan.hpp"
#include "run_scene.hpp"

// Slopes, benches, terrain and excavation in stages, from the text of a scene to its figures.

namespace cleave::scene::test {
namespace {

double rock_of(const RunResult& result) { return result.complex.value().complex().rock_volume().si(); }
std::size_t blocks_of(const RunResult& result) { return result.complex.value().complex().blocks().size(); }

TEST(Cuts, PlaneSlope) {
  // Above the plane through the middle of the box, 45 degrees to the east: half of the box.
  const auto result = run_of(
      with_box("[[excavation]]\nkind = \"slope\"\nplane = { through = [4, 4, 3], dip = 30, dip_direction = 57 }\n"));
  EXPECT_NEAR(rock_of(result), 192, 1e-6);
  EXPECT_EQ(blocks_of(result), 1U);
}

TEST(Cuts, ProfileSlope) {
  // 2 m high to x = 2, a face up to 4 m at x = 3, a berm to x = 5, a face up to 6 m at x = 7: 8 x section.
  const auto result =
      run_of(with_box("[[excavation]]\nkind = \"slope\"\nprofile = { origin = [0, 4], direction = 90, points = [[2, "
                      "2], [3, 4], [5, 4], "
                      "[7, 6]] }\n"));
  EXPECT_NEAR(rock_of(result), 8 * (2 * 2 + 3 + 2 * 4 + 2 * 5 + 6), 1e-6);
}

TEST(Cuts, SurfaceSlopeFromAGrid) {
  const Files files{{"dem.asc", "ncols 2\nnrows 2\nxllcenter -1\nyllcenter -1\ncellsize 10\n1 5\n1 5\n"}};
  const auto result = run_of(with_box("[[excavation]]\nkind = \"slope\"\nsurface = { file = \"dem.asc\" }\n"), files);
  // z = 1 + 0.4 (x + 1): over x = 0 .. 8, never above 6.
  EXPECT_NEAR(rock_of(result), 8 * 8 * (1 + 0.4 * 5), 1e-6);
}

TEST(Cuts, BenchesAndStages) {
  const std::string pit =
      "[[excavation]]\nname = \"pit\"\nkind = \"benches\"\nplan = [[1, 1], [7, 1], [7, 7], [1, 7]]\ntop = 5\nheight = "
      "1\nwidth = 0.5\nangle = 90\ncount = 3\n";
  const double volume = 384 - 36 * 2 - 25 - 16;
  const auto result = run_of(with_box(pit));
  EXPECT_NEAR(rock_of(result), volume, 1e-9);
  EXPECT_FALSE(result.sequence.has_value());
  ASSERT_EQ(result.excavations.size(), 4U);
  EXPECT_EQ(result.excavations[0].name, "pit above");
  EXPECT_EQ(result.excavations[3].name, "pit bench 3");
  const auto staged = run_of(with_box(pit + "stage = 2\nstage_each = true\n"));
  EXPECT_NEAR(rock_of(staged), volume, 1e-9);
  ASSERT_TRUE(staged.sequence.has_value());
  ASSERT_EQ(staged.sequence->stages.size(), 3U);
  EXPECT_EQ(staged.sequence->stages[0].excavations, (std::vector<std::string>{"pit above", "pit bench 1"}));
  EXPECT_NEAR(staged.sequence->stages[0].complex->value().complex().rock_volume().si(), 384 - 72, 1e-9);
  EXPECT_EQ(staged.sequence->stages[2].block_hash, staged.block_hash);
}

TEST(Cuts, TerrainDomain) {
  const Files files{{"dem.asc", "ncols 3\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 2\n3 3 3\n3 5 3\n3 3 3\n"}};
  const auto result = run_of(
      "[domain]\nterrain = { file = \"dem.asc\", base = -1 }\n[[joint]]\nplane = { through = [1, 1, 1], dip = 0, "
      "dip_direction = 0 }\n[stability]\nfree = [\"top\"]\n",
      files);
  // The peak stands on six of the eight triangles (diagonals from south-west to north-east): 6 x 2 m2 x 2 m / 3.
  EXPECT_NEAR(rock_of(result), 16 * 4 + 8, 1e-9);
  EXPECT_EQ(blocks_of(result), 2U);
  const auto part = run_of("[domain]\nterrain = { file = \"dem.asc\", base = -1, window = [[0, 0], [2, 2]] }\n", files);
  EXPECT_NEAR(rock_of(part), 4 * 4 + 2 * 2.0 * 2 / 3, 1e-9);
  const auto thin = run_of("[domain]\nterrain = { file = \"dem.asc\", base = -1, every = 2 }\n", files);
  EXPECT_NEAR(rock_of(thin), 16 * 4, 1e-9);
}

TEST(Cuts, HeightsThatAreMissingAreSaid) {
  const std::string dem = "ncols 4\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 2\n3 3 3 3\n3 -9999 3 3\n3 3 3 3\n";
  const std::string terrain = "[domain]\nterrain = { file = \"dem.asc\", base = -1";
  const auto result = run_of(terrain + " }\n", {{"dem.asc", dem}});
  EXPECT_NEAR(rock_of(result), 2 * 4 * 4, 1e-9);
  EXPECT_EQ(notes_with(result, "1 of 12 heights are missing: 4 of 6 cells, 66.7 % of the plan area, are left out"), 1U);
  // not in what the window leaves
  const auto part = run_of(terrain + ", window = [[4, 0], [6, 4]] }\n", {{"dem.asc", dem}});
  EXPECT_EQ(notes_with(part, "heights are missing"), 0U);
}

/// The upper corner stands 0.2 m above the plane of the other three: 1 + 0.2 / 6 or 1 + 0.2 / 3 m3, as it is cut.
TEST(Cuts, BentFacesOfADomainAreSaid) {
  const std::string mesh =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1.2\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\n"
      "f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const auto result = run_of("[domain]\nmesh = \"bent.obj\"\n", {{"bent.obj", mesh}});
  EXPECT_NEAR(rock_of(result), 1 + 0.2 / 6, 1e-9);
  EXPECT_EQ(notes_with(result, "1 faces of bodies are bent, with corners up to 0.0495 m off their plane"), 1U);
}

TEST(Cuts, WhatIsWrongWithThem) {
  EXPECT_EQ(
      error_of(
          with_box("[[excavation]]\nkind = \"slope\"\nplane = { through = [4, 4, 9], dip = 0, dip_direction = 0 }\n")),
      "s.toml:5: excavation[1].plane: lies above the whole domain and takes nothing out; check its point and dip");
  EXPECT_EQ(
      error_of(with_box("[[excavation]]\nkind = \"benches\"\nplan = [[1, 1], [7, 1], [7, 7], [1, 7]]\nheight = 2\n"
                        "width = 1\nangle = 60\ncount = 3\n")),
      "s.toml:5: excavation[1].plan: the pit closes at bench 2; give fewer benches, steeper faces, narrower berms or "
      "a larger plan");
  EXPECT_EQ(
      error_of("[domain]\nterrain = { file = \"dem.asc\", base = 3 }\n",
               {{"dem.asc", "ncols 2\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 2\n3 3 3 4\n"}}),
      "s.toml:2: domain.terrain.base: the level 3 m that closes the body lies within the ground, which reaches from "
      "3 to 4 m; give one below or above all of it");
  EXPECT_EQ(error_of(with_box("[sequence]\n")),
            "s.toml:3: sequence: asks for excavation in stages, but all excavations are of one stage; give the "
            "excavations different `stage` numbers, or remove the section");
}

constexpr std::string_view two_stages =
    "[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 90 }\n"
    "[[joint]]\nplane = { through = [4, 4, 3.1], dip = 60, dip_direction = 270 }\n"
    "[[joint]]\nplane = { through = [4, 3, 3], dip = 90, dip_direction = 0 }\n"
    "[[joint]]\nplane = { through = [4, 5, 3], dip = 90, dip_direction = 0 }\n"
    "[joints.default]\nfriction = 0\n"
    "[[excavation]]\nname = \"left\"\nkind = \"polyhedron\"\nbox = { min = [2, 0, 1], max = [4, 8, 2] }\nstage = 2\n"
    "[[excavation]]\nname = \"right\"\nkind = \"polyhedron\"\nbox = { min = [4, 0, 1], max = [6, 8, 2] }\nstage = 5\n";

// A roof prism over the tunnel: the two joints meet above the middle, so with the left half out the wedge still stands
// on the right half; it falls when that is out.
TEST(Sequence, AKeyBlockIsFoundInTheStageThatUndercutsIt) {
  const auto result = run_of(with_box(two_stages));
  ASSERT_TRUE(result.sequence.has_value());
  const SequenceResult& sequence = *result.sequence;
  ASSERT_EQ(sequence.stages.size(), 2U);
  EXPECT_EQ(sequence.stages[0].stage, 2U);
  EXPECT_EQ(sequence.stages[0].excavations, std::vector<std::string>{"left"});
  EXPECT_EQ(sequence.stages[1].block_hash.empty(), false);
  ASSERT_TRUE(result.analysis.has_value());
  std::size_t alone = 0;
  for (const auto& batch : result.analysis->batches) alone += batch.blocks.size();
  EXPECT_GT(alone, 0U);
  EXPECT_GT(sequence.stages[1].new_key_blocks, 0U);
  ASSERT_EQ(sequence.orders.size(), 1U);
  EXPECT_EQ(sequence.orders[0].key_blocks, sequence.stages[0].new_key_blocks + sequence.stages[1].new_key_blocks);
  // By symmetry the other order has the same figures.
  const auto both = run_of(with_box(std::string{two_stages} + "[sequence]\ncompare_orders = \"all\"\n"));
  ASSERT_EQ(both.sequence->orders.size(), 2U);
  EXPECT_EQ(both.sequence->orders[1].stages, (std::vector<std::uint32_t>{5, 2}));
  EXPECT_EQ(both.block_hash, result.block_hash);
}

// A bolt through the prism, put in after the first stage or after the one that frees it.
TEST(Sequence, SupportIsCheckedStageByStage) {
  const auto supported = [](int after) {
    const std::string bolts =
        "[sequence]\nfallen = \"put_back\"\n[[support.bolts]]\nat = [[4.2, 4, 2]]\ndirection = [0, 0, 1]\nlength = 3\n"
        "tendon_capacity = 200e3\nplate_capacity = 200e3\nbond_strength = 1e6\nanchorage = 0.3\nafter_stage = ";
    return run_of(with_box(std::string{two_stages} + bolts + std::to_string(after) + "\n")).sequence.value().stages;
  };
  for (const int after : {2, 5}) {
    const auto stages = supported(after);
    ASSERT_EQ(stages.size(), 2U);
    ASSERT_TRUE(stages[0].support && stages[1].support);
    EXPECT_EQ(stages[0].support->blocks, 0U);
    EXPECT_EQ(stages[1].support->blocks, 1U);
    EXPECT_EQ(stages[1].support->bolts_before, after < 5 ? 1U : 0U);
    EXPECT_EQ(stages[1].support->not_held_before, after < 5 ? 0U : 1U);
    EXPECT_EQ(stages[1].support->not_held, 0U);
  }
}

TEST(Sequence, BoltsThatAreNeverInstalledAreRefused) {
  const auto bolts = [](const std::string& more) {
    return with_box(std::string{two_stages} +
                    "[[support.bolts]]\nlength = 3\ntendon_capacity = 200e3\n"
                    "plate_capacity = 200e3\nbond_strength = 1e6\nanchorage = 0.3\n" +
                    more);
  };
  const std::string single = "at = [[4.2, 4, 2]]\ndirection = [0, 0, 1]\nafter_stage = ";
  EXPECT_TRUE(parse_text(bolts(single + "5\n")).has_value());
  EXPECT_TRUE(error_of(bolts(single + "6\n")).contains("stage 5 of the excavations is the last"));
  // Before there is a tunnel nobody drills from it.
  const std::string second =
      "[[excavation]]\nname = \"t\"\nstage = 5\nkind = \"tunnel\"\nsection = { shape = \"circle\", radius = 0.5 }\n"
      "axis = [[1, 0, 5], [1, 8, 5]]\n";
  const std::string rings = second +
                            "[[support.bolts]]\nlength = 1\ntendon_capacity = 200e3\nbond_strength = 1e6\n"
                            "anchorage = 0.3\nplate_capacity = 200e3\ntunnel = \"t\"\nspacing = [1, 1]\n";
  EXPECT_TRUE(parse_text(with_box(std::string{two_stages} + rings)).has_value());
  EXPECT_TRUE(parse_text(with_box(std::string{two_stages} + rings + "after_stage = 5\n")).has_value());
  EXPECT_TRUE(error_of(with_box(std::string{two_stages} + rings + "after_stage = 2\n"))
                  .contains("is 2, and its tunnel is excavated in stage 5"));
}

TEST(Sequence, BlocksPutBackAreThoseOfTheWholeExcavation) {
  const auto result = run_of(with_box(std::string{two_stages} + "[sequence]\nfallen = \"put_back\"\n"));
  EXPECT_EQ(result.sequence->fallen, Fallen::put_back);
  EXPECT_EQ(result.sequence->stages.back().block_hash, result.block_hash);
  EXPECT_EQ(result.sequence->stages.back().analysis->judgements.size(), result.analysis->judgements.size());
  std::size_t marked = 0;
  for (const auto stage : result.sequence->stage_of_block) {
    EXPECT_TRUE(!stage || stage == 2U || stage == 5U);
    if (stage) ++marked;
  }
  EXPECT_GT(marked, 0U);
}

// A prism over a room, cut into a thin plate below and the rest above: with the plate left out the rest is undercut
// from the start and leaves in the first batch.
TEST(MicroBlocks, LeftOutBlocksHoldNothing) {
  const std::string prism = std::string{two_stages} +
                            "[[joint]]\nplane = { through = [4, 4, 2.001], dip = 0, dip_direction = 0 }\n"
                            "[output]\nvtu = false\n";
  const auto micro_of = [&](const std::string& more) {
    const auto result = run_of(with_box(prism + more));
    return std::pair{micro_blocks(result.complex.value().complex(), result.micro_blocks).size(),
                     result.analysis->batches.size()};
  };
  EXPECT_EQ(micro_of("").first, 0U) << "1 mm is no sliver of a box of 8 m";
  const auto [reported, batches] = micro_of("[micro_blocks]\nthickness = 0.01\n");
  EXPECT_GT(reported, 0U);
  const auto [excluded, fewer] = micro_of("[micro_blocks]\npolicy = \"exclude\"\nthickness = 0.01\n");
  EXPECT_EQ(excluded, reported);
  EXPECT_LE(fewer, batches);
  const auto result = run_of(with_box(prism + "[micro_blocks]\npolicy = \"exclude\"\nthickness = 0.01\n"));
  const auto out = micro_blocks(result.complex.value().complex(), result.micro_blocks);
  for (const auto& judgement : result.analysis->judgements) {
    EXPECT_EQ(std::ranges::count(out, judgement.block), 0) << "a block that is left out is not judged";
  }
  EXPECT_GT(result.analysis->judgements.size(), 0U);
  EXPECT_EQ(error_of(with_box("[micro_blocks]\npolicy = \"drop\"\n")),
            "s.toml:4: micro_blocks.policy: \"drop\" is not known; choose one of: keep, report, exclude");
}

TEST(Sequence, WhatIsWrongWithOrders) {
  EXPECT_EQ(error_of(with_box(std::string{two_stages} + "[sequence]\ncompare_orders = [[2, 2]]\n")),
            "s.toml:24: sequence.compare_orders: order 1 does not name every stage once; write \"all\", or a list of "
            "orders of the stages [2, 5] such as [[2, 5]]");
  EXPECT_EQ(error_of(with_box(std::string{two_stages} + "[sequence]\nfallen = \"gone\"\n")),
            "s.toml:24: sequence.fallen: \"gone\" is not known; choose one of: stay_out, put_back");
}

}  // namespace
}  // namespace cleave::scene::test
