#include <gtest/gtest.h>

#include "complexes.hpp"

// `snap`: what is moved becomes one, and the report says which joints were moved, how far, and in which way.

namespace cleave::testing {
namespace {

constexpr double d = 1e-3;

topology::CutInput snapped(topology::CutInput input, double distance = d) {
  input.snap = metres(distance);
  return input;
}

topology::Joint level(double z, double tilt = 0) {
  return joint({{-1, -1, z}, {5, -1, z}, {5, 5, z + tilt}, {-1, 5, z + tilt}});
}

TEST(Snapping, ChangesNothingUnlessAskedTo) {
  const auto audited = certified(scene(box({0, 0, 0}, {4, 4, 4}), {level(2), level(2 + 0.4 * d)}));
  EXPECT_EQ(audited.complex().blocks().size(), 3U);
  EXPECT_TRUE(audited.complex().report().snapped.empty());
}

TEST(Snapping, NearbyPlanesMergeAndTheReportSaysWhich) {
  // The third joint lies too far away, the fourth exactly on the first.
  const auto audited =
      certified(snapped(scene(box({0, 0, 0}, {4, 4, 4}), {level(2), level(2, 0.75 * d), level(2 + 4 * d), level(2)})));
  EXPECT_EQ(audited.complex().blocks().size(), 3U);
  const auto& report = audited.complex().report();
  EXPECT_EQ(report.merged_planes, 0U);  // its corners became those of the first joint: nothing is left to merge
  ASSERT_EQ(report.snapped.size(), 1U);
  EXPECT_EQ(report.snapped[0].joint, topology::JointId{1U});
  EXPECT_FALSE(report.snapped[0].plane_merged);
  EXPECT_NEAR(report.snapped[0].moved.si(), 0.75 * d, 1e-9);
}

TEST(Snapping, APlaneIsTakenOverWhereNoCornerIsNear) {
  const auto small = joint({{0.5, 0.5, 2 + 0.5 * d}, {3, 0.5, 2}, {3, 3, 2 + 0.25 * d}});
  const auto audited = certified(snapped(scene(box({0, 0, 0}, {4, 4, 4}), {level(2), small})));
  EXPECT_EQ(audited.complex().blocks().size(), 2U);
  const auto& report = audited.complex().report();
  EXPECT_EQ(report.merged_planes, 1U);
  ASSERT_EQ(report.snapped.size(), 1U);
  EXPECT_EQ(report.snapped[0].joint, topology::JointId{1U});
  EXPECT_TRUE(report.snapped[0].plane_merged);
  EXPECT_EQ(report.snapped[0].adopted_edges, 0U);
  EXPECT_NEAR(report.snapped[0].moved.si(), 0.5 * d, 1e-9);
  EXPECT_GE(report.largest_snap_m, report.snapped[0].moved.si());
}

TEST(Snapping, ASideThatNearlyReachesAJointEndsOnIt) {
  // An upright joint that stops 0.8 d short of the level one, and one that stops 3 d short of it.
  const auto upright = [](double x, double gap) {
    return joint({{x, -1, -1}, {x, 5, -1}, {x, 5, 2 - gap}, {x, -1, 2 - gap}});
  };
  auto input = scene(box({0, 0, 0}, {4, 4, 4}), {level(2), upright(1, 0.8 * d), upright(3, 3 * d)});
  EXPECT_EQ(count_blocks(input), 2U);
  const auto audited = certified(snapped(input));
  EXPECT_EQ(audited.complex().blocks().size(), 3U);
  const auto& report = audited.complex().report();
  EXPECT_EQ(report.adopted_edges, 1U);
  ASSERT_EQ(report.snapped.size(), 1U);
  EXPECT_EQ(report.snapped[0].joint, topology::JointId{1U});
  EXPECT_EQ(report.snapped[0].adopted_edges, 1U);
  EXPECT_FALSE(report.snapped[0].plane_merged);
  EXPECT_NEAR(report.snapped[0].moved.si(), 0.8 * d, 1e-9);
}

}  // namespace
}  // namespace cleave::testing
