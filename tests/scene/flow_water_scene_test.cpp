#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Pressures of [flow] on blocks, in a domain of 8 x 8 x 6 m: still water presses as a table does; flow across a joint
// has a closed form.

namespace cleave::scene::test::flow_water_scene_test {
namespace {

std::string plane(double x, double y, double z, double dip, double direction) {
  return "[[joint]]\nplane = { through = [" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) +
         "], dip = " + std::to_string(dip) + ", dip_direction = " + std::to_string(direction) + " }\n";
}
std::string side(const std::string& face, double level) {
  return "[[flow.side]]\nface = \"" + face + "\"\nlevel = " + std::to_string(level) + "\n";
}
const std::string strength = "[joints.default]\nfriction = 20\naperture = 1e-3\n";
/// A slab that slides to the east on a plane of 30 degrees, parted from the rock behind and beside it.
const std::string slab =
    plane(4, 4, 3, 30, 90) + plane(1.5, 4, 3, 80, 90) + plane(4, 2, 3, 90, 0) + plane(4, 6, 3, 90, 0);
const std::string still = side("west", 5) + side("south", 5) + side("north", 5) + side("bottom", 5);
const std::string open = "[stability]\nfree = [\"east\", \"top\"]\n";

/// Of the blocks that leave first.
void expect_same_forces(const RunResult& a, const RunResult& b) {
  ASSERT_FALSE(a.analysis->batches.empty());
  ASSERT_FALSE(b.analysis->batches.empty());
  EXPECT_EQ(a.analysis->batches.front().blocks, b.analysis->batches.front().blocks);
  for (const topology::BlockId id : a.analysis->batches.front().blocks) {
    const auto own = std::ranges::find(a.analysis->judgements, id, &stability::Judgement::block);
    const auto other = std::ranges::find(b.analysis->judgements, id, &stability::Judgement::block);
    ASSERT_NE(own, a.analysis->judgements.end());
    ASSERT_NE(other, b.analysis->judgements.end());
    EXPECT_EQ(own->mode, other->mode);
    EXPECT_NEAR(own->factor_of_safety, other->factor_of_safety, 1e-9);
    EXPECT_NEAR(own->driving.si(), other->driving.si(), 1e-9 * own->weight.si());
    EXPECT_NEAR(own->resistance.si(), other->resistance.si(), 1e-9 * own->weight.si());
  }
}

TEST(FlowWaterScene, StillWaterPressesAsATableDoes) {
  const std::string flooded = still + side("east", 5) + side("top", 5);
  const auto flow = run_of(with_box(slab + strength + open + "water = { flow = true }\n[flow]\n" + flooded));
  const auto table = run_of(with_box(slab + strength + open + "water = { table = 5, free_faces = true }\n"));
  expect_same_forces(flow, table);
  const auto dry = run_of(with_box(slab + strength + open));
  EXPECT_LT(flow.analysis->judgements.front().driving, 0.9 * dry.analysis->judgements.front().driving) << "it floats";
  // Heavier water, and water elsewhere: origin far away.
  const auto heavy =
      run_of(with_box(slab + strength + open + "water = { flow = true, unit_weight = 10300 }\n[flow]\n" + flooded));
  expect_same_forces(heavy, run_of(with_box(slab + strength + open +
                                            "water = { table = 5, unit_weight = 10300, free_faces = true }\n")));
  EXPECT_EQ(notes_with(flow, "do not act on blocks"), 0U);
  EXPECT_EQ(notes_with(run_of(with_box(slab + strength + open + "[flow]\n" + flooded)), "do not act on blocks"), 1U);
}

TEST(FlowWaterScene, AFaultElsewhereDoesNotLeavePressuresCoarse) {
  // Nearly all of the inflow is in the fault; what feeds the joints under the block is thousands of times less.
  const std::string scene =
      "schema = 1\n[domain]\nbox = { min = [0, 0, 0], max = [10, 2, 20] }\n"
      "[[joint]]\nset = \"base\"\npolygon = [[-2, -1, 8.5], [12, -1, 1.5], [12, 5, 1.5], [-2, 5, 8.5]]\n"
      "[[joint]]\nset = \"rear\"\npolygon = [[3, -1, 6], [3, 5, 6], [3, 5, 21], [3, -1, 21]]\n"
      "[[joint]]\nset = \"feed\"\npolygon = [[5, 0.75, -1], [7, 0.75, -1], [7, 0.75, 4], [5, 0.75, 5]]\n"
      "[[joint]]\nset = \"fault\"\npolygon = [[8, -1, -0.5], [11, -1, 1.5], [11, 5, 1.5], [8, 5, -0.5]]\n"
      "[joints.feed]\nfriction = 30\naperture = 5e-5\n[joints.fault]\nfriction = 30\naperture = 1e-3\n"
      "[joints.base]\nfriction = 38\naperture = 1e-4\n[joints.rear]\nfriction = 20\naperture = 1e-4\n"
      "[stability]\nfree = [\"top\", \"east\", \"south\", \"north\"]\nwater = { flow = true }\n"
      "[[flow.side]]\nface = \"west\"\nclosed = true\n[[flow.side]]\nface = \"south\"\nclosed = true\n"
      "[[flow.side]]\nface = \"north\"\nclosed = true\n[[flow.side]]\nface = \"bottom\"\nlevel = 120\n[flow]\n";
  const auto factor = [&](const std::string& tolerance) {
    const auto result = run_of(scene + tolerance);
    EXPECT_EQ(result.flow->flow->status, flow::FlowStatus::converged);
    double least = 1e9;
    for (const auto& own : result.analysis->judgements) least = std::min(least, own.factor_of_safety);
    return least;
  };
  EXPECT_NEAR(factor("tolerance = 0.02\n"), 0.875, 0.02 * 0.875);
  EXPECT_NEAR(factor("tolerance = 0.002\n"), 0.875, 0.004 * 0.875);
}

TEST(FlowWaterScene, PressureFallsEvenlyToAnOpenFace) {
  // A level joint at z = 3: head 7 in the west, open in the east, so that heads of pressure fall from 4 m to 0.
  const auto result = run_of(with_box(plane(4, 4, 3, 0, 0) + strength + "[stability]\nfree = [\"east\"]\n" +
                                      "water = { flow = true }\n[flow]\n" + side("west", 7)));
  ASSERT_TRUE(result.flow_water.has_value());
  ASSERT_EQ(result.flow_water->contacts.size(), 2U);
  const auto& [first, second] = std::pair{result.flow_water->contacts[0], result.flow_water->contacts[1]};
  EXPECT_EQ(first.block, second.neighbour);
  EXPECT_EQ(second.block, first.neighbour);
  const auto& upper = first.heads.z > 0 ? first : second;
  EXPECT_NEAR(upper.heads.z, 8 * 8 * 4 / 2.0, 1e-9);
  EXPECT_NEAR(norm(first.heads + second.heads), 0, 1e-12);
  EXPECT_NEAR(upper.at.x, 8 / 3.0, 1e-9);
  EXPECT_NEAR(upper.at.y, 4, 1e-9);
  EXPECT_NEAR(upper.at.z, 3, 1e-12);
  EXPECT_GT(result.complex.value().complex().blocks()[upper.block].centroid.z, 3) << "it is lifted, not pressed down";
}

TEST(FlowWaterScene, NoSuctionAboveTheWater) {
  // A plane of 45 degrees from (0, 6) down to (6, 0), water to z = 3 all round: only its lower half is pressed.
  const auto result = run_of(with_box(plane(3, 4, 3, 45, 90) + strength + "[stability]\nfree = [\"top\"]\n" +
                                      "water = { flow = true }\n[flow]\n" + side("west", 3) + side("bottom", 3) +
                                      side("south", 3) + side("north", 3)));
  ASSERT_EQ(result.flow_water->contacts.size(), 2U);
  // Integral of (3 - z) over 8 m by the 3 sqrt 2 m below it, to 1e-9 by clipping where the pressure is 0.
  EXPECT_NEAR(norm(result.flow_water->contacts[0].heads), 8 * std::sqrt(2.0) * 4.5, 1e-9);
}

TEST(FlowWaterScene, AJointThatOpenedIsDrained) {
  // Two blocks over one another in a shaft of joints above a tunnel; water between them holds the upper one until the
  // lower one is gone.
  const std::string stack = plane(3, 4, 3, 90, 90) + plane(5, 4, 3, 90, 90) + plane(4, 3, 3, 90, 0) +
                            plane(4, 5, 3, 90, 0) + plane(4, 4, 4, 0, 0) + plane(4, 4, 5, 0, 0);
  const std::string tunnel =
      "[[excavation]]\nname = \"adit\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 4, height = 2 "
      "}\naxis = [[4, 2, 2], [4, 6, 2]]\n";
  const auto wet = run_of(with_box(stack + tunnel + "[joints.default]\nfriction = 0\naperture = 1e-3\n[stability]\n" +
                                   "water = { flow = true }\n[flow]\nlevel = 30\n"));
  const auto dry = run_of(with_box(stack + tunnel + "[joints.default]\nfriction = 0\n[stability]\n"));
  const auto of_batch = [](const RunResult& result, std::uint32_t batch) {
    for (const stability::Judgement& j : result.analysis->judgements) {
      const geometry::Vec3 at = result.complex.value().complex().blocks()[j.block].centroid;
      if (j.batch == batch && std::abs(at.x - 4) < 0.1 && std::abs(at.y - 4) < 0.1) return j.driving.si();
    }
    ADD_FAILURE() << "no block leaves in batch " << batch;
    return 0.0;
  };
  EXPECT_GT(of_batch(wet, 1), 1.5 * of_batch(dry, 1)) << "the water above presses on it";
  // What drives the second: its weight and the water above it, none below.
  const auto lifted = [&] {
    for (const auto& contact : wet.flow_water->contacts) {
      if (contact.heads.z < -1e-3 && std::abs(contact.at.z - 5) < 1e-6 && std::abs(contact.at.x - 4) < 0.1 &&
          std::abs(contact.at.y - 4) < 0.1) {
        return -9810 * contact.heads.z;
      }
    }
    return 0.0;
  }();
  EXPECT_NEAR(of_batch(wet, 2), of_batch(dry, 2) + lifted, 1e-6 * of_batch(wet, 2));
  EXPECT_GT(lifted, 0);
}

TEST(FlowWaterScene, LoadsMayTakeTheirWaterThere) {
  const std::string scene = slab + strength + open + "[flow]\n" + side("west", 6);
  const auto result = run_of(with_box(scene + "[[load]]\nname = \"rain\"\nwater = { flow = true }\n" +
                                      "[[load]]\nname = \"more\"\ncombine = { rain = 1.5 }\n"));
  const auto alone = run_of(with_box(slab + strength + open + "water = { flow = true }\n[flow]\n" + side("west", 6)));
  const double dry = result.analysis->judgements.front().factor_of_safety;
  const double rain = result.load_cases[0].analysis.judgements.front().factor_of_safety;
  const double more = result.load_cases[1].analysis.judgements.front().factor_of_safety;
  EXPECT_LT(rain, dry);
  EXPECT_LT(more, rain);
  EXPECT_NEAR(rain, alone.analysis->judgements.front().factor_of_safety, 1e-12);
  EXPECT_GT(alone.sensitivity.front().water[0], alone.sensitivity.front().water[1]);
  EXPECT_EQ(make_plan(scene_of(with_box(scene))).runs(Step::flow), true);
}

TEST(FlowWaterScene, WhatCannotBeIsSaid) {
  const auto wrong = [](const std::string& stability, const std::string& more) {
    return error_of(with_box(slab + strength + open + stability + "\n" + more));
  };
  const std::string flow = "[flow]\n" + still;
  EXPECT_TRUE(wrong("water = { flow = true }", "").contains("no water flows there"));
  EXPECT_TRUE(wrong("water = { flow = true }", "[flow]\n").contains("no water flows there"));
  EXPECT_TRUE(wrong("water = { flow = true, table = 3 }", flow).contains("stands beside flow = true"));
  EXPECT_TRUE(wrong("water = { flow = true, free_faces = true }", flow).contains("stands beside flow = true"));
  EXPECT_TRUE(wrong("gravity = [1, 0, -9.81]\nwater = { flow = true }", flow).contains("straight down"));
  EXPECT_TRUE(wrong("water = { table = 3 }", flow + "[[load]]\nname = \"a\"\nwater = { flow = true }\n" +
                                                 "[[load]]\nname = \"b\"\nwater = { table = 2 }\n"
                                                 "[[load]]\nname = \"c\"\ncombine = { a = 1, b = 1 }\n")
                  .contains("a table or pressures as well"));
  EXPECT_TRUE(wrong("water = {}", flow).contains("or flow = true"));
  EXPECT_TRUE(wrong("water = { flow = true }",
                    flow +
                        "[[excavation]]\nname = \"a\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = "
                        "1, height = 1 }\naxis = [[2, 2, 1], [2, 4, 1]]\nstage = 1\n" +
                        "[[excavation]]\nname = \"b\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = "
                        "1, height = 1 }\naxis = [[5, 2, 1], [5, 4, 1]]\nstage = 2\n")
                  .contains("stages of excavation"));
}

}  // namespace
}  // namespace cleave::scene::test::flow_water_scene_test
