#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Loads of [stability] on blocks in motion: what the verdict counts acts there, too.

namespace cleave::scene::test::motion_loads_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// A block on a plane that dips 30 degrees east, open at its foot, with a crack behind it, and rock behind that which
/// the side of the domain holds; all blocks are let go.
std::string slab(double friction, const std::string& stability, const std::string& motion = {}) {
  return "[domain]\nbox = { min = [7, 0, 0], max = [30, 6, 14] }\n"
         "[[joint]]\nplane = { through = [14, 3, 6], dip = 30, dip_direction = 90 }\n"
         "[[joint]]\nplane = { through = [9, 3, 8], dip = 80, dip_direction = 90 }\nset = \"crack\"\n"
         "[[joint]]\nplane = { through = [12, 2, 6], dip = 89, dip_direction = 180 }\nset = \"side\"\n"
         "[[joint]]\nplane = { through = [12, 4, 6], dip = 89, dip_direction = 0 }\nset = \"side\"\n"
         "[joints.default]\nfriction = " +
         std::to_string(friction) +
         "\n[joints.crack]\nfriction = 20\n[joints.side]\nfriction = 0\n[rock]\ndensity = 2600\n"
         "[[excavation]]\nkind = \"slope\"\n"
         "profile = { direction = 90, points = [[7, 12], [11, 12], [15, 4], [30, 4]] }\n"
         "[stability]\ngroups = \"off\"\nrotation = \"decide\"\n" +
         stability + "[motion]\nrelease = \"all\"\nduration = 0.3\nerror = false\nsurface_friction = 60\n" + motion;
}

/// The block on the plane: the largest that is free and may move.
topology::BlockId block_of(const RunResult& result) {
  topology::BlockId largest{0U};
  double volume = 0;
  for (const topology::BlockId id : result.complex->complex().blocks().ids()) {
    const topology::Block& block = result.complex->complex().blocks()[id];
    if (block.fixed || !block.free || block.volume.si() <= volume) continue;
    volume = block.volume.si();
    largest = id;
  }
  return largest;
}
const stability::Judgement& judged(const RunResult& result) {
  const auto& all = result.analysis->judgements;
  return *std::ranges::find(all, block_of(result), &stability::Judgement::block);
}
double moved(const RunResult& result) {
  const auto at = std::ranges::find(result.motion->blocks, block_of(result), &MotionBlock::block);
  return at == result.motion->blocks.end() ? -1 : std::hypot(at->fall.si(), at->runout.si());
}

struct Acting {
  std::string stability, motion = {};
};

// What slides by its factor of safety moves, and what does not stands: within 1 % of the strength on either side.
TEST(MotionLoads, MoveWhatTheirVerdictSays) {
  const std::vector<Acting> all{
      {""},
      {"water = { table = 9.5 }\n"},
      {"water = { table = 9.5, free_faces = true }\n"},
      {"water = { pressures = { default = 20e3 } }\n"},
      {"water = { table = 8, free_faces = true, pressures = { default = 30e3 } }\n"},
      {"surcharge = [{ traction = [10e3, 0, -20e3], within = { min = [9, 2, 11], max = [11.5, 4, 13] } }]\n"},
      {"point = [{ at = [13, 3, 8], force = [-60e3, 0, 20e3] }]\n"},
      {"line = [{ from = [10, 2.5, 12], to = [10, 3.5, 12], force_per_metre = [0, 0, 100e3] }]\n"},
      {"seismic = [0.15, 0, 0.05]\n", "seismic = true\n"},
      {"seismic = [0.1, 0, 0]\nwater = { table = 9 }\npoint = [{ at = [13, 3, 8], force = [-30e3, 0, 0] }]\n",
       "seismic = true\n"},
  };
  for (const Acting& of : all) {
    const RunResult strong = run_of(slab(45, of.stability, of.motion));
    const double factor = judged(strong).factor_of_safety;
    ASSERT_EQ(judged(strong).mode, stability::Mode::sliding) << of.stability;
    ASSERT_GT(factor, 0.3) << of.stability;
    for (const double share : {0.99, 1.01}) {
      const RunResult result = run_of(slab(std::atan(share / factor) / degree, of.stability, of.motion));
      ASSERT_TRUE(result.motion->converged) << of.stability << result.motion->stopped_why;
      EXPECT_NEAR(judged(result).factor_of_safety, share, 1e-3) << of.stability;
      if (share > 1) {
        EXPECT_LT(moved(result), 1e-6) << of.stability << factor;
      } else {
        EXPECT_GT(moved(result), 5e-4) << of.stability << factor;
      }
      EXPECT_LT(result.motion->energy_error, 1e-9);
      EXPECT_LT(result.motion->momentum_error, 1e-9);
    }
  }
}

/// The joints that are under water, and in which it presses no more.
TEST(MotionLoads, JointsDrainAsTheyOpen) {
  const RunResult wet = run_of(slab(25, "water = { table = 9.5 }\n"));
  ASSERT_TRUE(wet.motion->loads.has_value());
  EXPECT_GE(wet.motion->loads->in_joints, 4U);
  EXPECT_EQ(wet.motion->loads->drained, 0U);
  EXPECT_EQ(wet.motion->loads->on_faces, 0U);
  EXPECT_GT(wet.motion->loads->work, 0);
  // With the block behind the crack let go as well: the base and both sides of each, and once the crack between them.
  std::string both = slab(25, "water = { table = 9.5 }\n");
  both.replace(both.find("[7, 0, 0]"), 9, "[0, 0, 0]");
  both.replace(both.find("[[7, 12]"), 8, "[[0, 12]");
  EXPECT_EQ(run_of(both).motion->loads->in_joints, 7U);
  const RunResult drained = run_of(slab(25, "water = { table = 9.5 }\n", "drains_at = 0.01\n"));
  EXPECT_GE(drained.motion->loads->drained, 1U);
  EXPECT_LT(moved(drained), moved(wet));
  EXPECT_EQ(notes_with(drained, "water presses no more in "), 1U);
  EXPECT_EQ(notes_with(wet, "water presses no more in "), 0U);
  const RunResult without = run_of(slab(25, "water = { table = 9.5 }\n", "loads = false\n"));
  EXPECT_FALSE(without.motion->loads.has_value());
  EXPECT_LT(moved(without), moved(drained));
  EXPECT_EQ(notes_with(without, "are left out: water on joints. A block that only these bring down stands"), 1U);
}

TEST(MotionLoads, AnEarthquakeActsOnce) {
  const auto errors =
      errors_of(slab(30, "seismic = [0.1, 0, 0]\n", "seismic = true\nground = { acceleration = [1, 0, 0] }\n"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_TRUE(errors[0].contains("the earthquake would act twice")) << errors[0];
}

// Sides that the verdict knows as key, and why they stand: the tip of the rock below the foot of the cut.
TEST(MotionLoads, TipsThatBarAreNamed) {
  const auto foot = [](double height) {
    return run_of("[domain]\nbox = { min = [0, 0, 0], max = [30, 6, 14] }\n[[joint]]\nplane = { through = [15, 3, " +
                  std::to_string(height) +
                  "], dip = 40, dip_direction = 90 }\n[[joint]]\nplane = { through = [9, 2, 8], dip = 90, "
                  "dip_direction = 0 }\n[[joint]]\nplane = { through = [9, 4, 8], dip = 90, dip_direction = 0 }\n"
                  "[joints.default]\nfriction = 25\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
                  "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n[stability]\n"
                  "groups = \"off\"\n[motion]\nduration = 0.2\nerror = false\n");
  };
  const RunResult barred = foot(4);
  EXPECT_GE(barred.motion->key_blocks_standing, 1U);
  EXPECT_EQ(notes_with(barred, "bars them at an edge or a corner alone (block "), 1U);
  const RunResult moves = foot(4.2);
  EXPECT_EQ(moves.motion->key_blocks_standing, 0U);
  EXPECT_EQ(notes_with(moves, "at an edge or a corner alone"), 0U);
}

}  // namespace
}  // namespace cleave::scene::test::motion_loads_test
