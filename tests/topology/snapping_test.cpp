#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "closed_sets.hpp"
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
  // A vertical joint that stops 0.8 d short of the level one, and one that stops 3 d short of it.
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

/// Triangles fanned out of the polygons.
std::vector<support::Corners> triangulated(const std::vector<support::Corners>& polygons) {
  std::vector<support::Corners> out;
  for (const auto& p : polygons) {
    for (std::size_t k = 1; k + 1 < p.size(); ++k) out.push_back({p[0], p[k], p[k + 1]});
  }
  return out;
}
topology::CutInput input_of(const std::vector<support::Corners>& polygons, double half) {
  auto input = scene(box({-half, -half, -half}, {half, half, half}));
  for (const auto& corners : polygons) input.joints.emplace_back(joint(corners));
  return input;
}

TEST(Snapping, NeverOpensWhatIsClosed) {
  const support::Placement at{{1, 2, 3}, 1, {}};
  for (const double distance : {1e-9, 1e-6, 1e-4, 1e-2}) {
    auto octahedron = support::placed(support::bipyramid(4), at);
    octahedron.polygons.pop_back();  // 8 triangles
    EXPECT_EQ(count_blocks(snapped(input_of(octahedron.polygons, 2), distance)), 2U) << distance;
    EXPECT_EQ(count_blocks(snapped(input_of(support::placed(support::dodecahedron(), at).polygons, 2), distance)), 2U);
  }
  std::mt19937_64 random{5};
  const auto cells =
      support::voronoi(60, [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; }, 0.6, false).polygons;
  for (const double distance : {1e-12, 1e-9, 1e-7}) {
    const auto audited = certified(snapped(input_of(cells, 0.6), distance));
    EXPECT_EQ(audited.complex().blocks().size(), 60U) << distance;
    EXPECT_EQ(audited.complex().report().near_misses.sides, 0U) << distance;
    EXPECT_EQ(count_blocks(snapped(input_of(triangulated(cells), 0.6), distance)), 60U) << distance;
  }
}

TEST(Snapping, TooCoarseForTheSmallestPolygonsIsSaid) {
  std::mt19937_64 random{5};
  const auto cells =
      support::voronoi(60, [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; }, 0.6, false).polygons;
  double shortest = 1;
  std::size_t owner = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    for (std::size_t i = 0; i < cells[k].size(); ++i) {
      const double side = geometry::norm(cells[k][(i + 1) % cells[k].size()] - cells[k][i]);
      if (side >= shortest) continue;
      shortest = side;
      owner = k;
    }
  }
  const auto said = [&](double distance) {
    return topology::cut(snapped(input_of(cells, 0.6), distance)).value().report().coarse_snap;
  };
  EXPECT_EQ(said(0.49 * shortest).polygons, 0U);
  const auto few = said(0.51 * shortest), many = said(1e-2);
  EXPECT_GE(few.polygons, 1U);
  EXPECT_NEAR(few.shortest.si(), shortest, 1e-12);
  EXPECT_GT(many.polygons, few.polygons);
  const auto& named = cells[many.joint.index()];
  double least = 1;
  for (std::size_t i = 0; i < named.size(); ++i) {
    least = std::min(least, geometry::norm(named[(i + 1) % named.size()] - named[i]));
  }
  EXPECT_NEAR(least, shortest, 1e-12) << owner;
}

TEST(Snapping, TooCoarseForTheSmallestTrianglesIsCertifiedAllTheSame) {
  // Corners move past each other, so that polygons of one plane lie on one another: blocks may be other than those
  // meant, which is said, and are right as what they are.
  const std::array<std::array<double, 2>, 4> scenes{{{0, 1.5}, {2, 10}, {7, 0.8}, {7, 3}}};  // seed, share of a side
  for (const auto& [seed, share] : scenes) {
    std::mt19937_64 random{static_cast<std::uint64_t>(seed)};
    const auto triangles =
        triangulated(support::voronoi(20, [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; }).polygons);
    double shortest = 1;
    for (const auto& corners : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        shortest = std::min(shortest, geometry::norm(corners[(i + 1) % 3] - corners[i]));
      }
    }
    const auto audited = certified(snapped(input_of(triangles, 1.2), share * shortest));
    EXPECT_GT(audited.complex().report().coarse_snap.polygons, 0U);
  }
}

TEST(Snapping, TriangulatedCellsBelowTheirShortestSides) {
  // Cells in triangles, as they are, turned, and far from the origin.
  std::mt19937_64 random{5};
  const auto cells = support::voronoi(120, [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; });
  for (const support::Placement& at :
       {support::Placement{{}, 1, {}}, {{1.3, 0.4, 0.3}, 1, {}}, {{2.6, 0.8, 0.6}, 1, {5e6, -5e6, 100}}}) {
    const Vec3 half{2, 2, 2};
    const auto triangles = triangulated(support::placed(cells, at).polygons);
    for (const double distance : {1e-9, 1e-6}) {
      auto input = scene(box(at.shift - half, at.shift + half));
      for (const auto& corners : triangles) input.joints.emplace_back(joint(corners));
      EXPECT_EQ(count_blocks(snapped(input, distance)), 121U) << distance << " at " << at.shift.x;
    }
  }
}

TEST(Snapping, DoesNotDependOnTheOrderOfTheJoints) {
  // Three rectangles side by side on one turned plane, which together go through the box.
  const support::Placement at{{0.3, 0.2, 0.1}, 1, {}};
  const auto rectangle = [&](double from, double to) {
    return support::Corners{at({from, -9, 0.1}), at({to, -9, 0.1}), at({to, 9, 0.1}), at({from, 9, 0.1})};
  };
  const std::array parts{rectangle(-9, -0.3), rectangle(-0.31, 0.4), rectangle(0.37, 9)};
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    const auto input = input_of({parts[order[0]], parts[order[1]], parts[order[2]]}, 1);
    EXPECT_EQ(count_blocks(snapped(input, 1e-9)), 2U) << order[0] << order[1] << order[2];
  } while (std::ranges::next_permutation(order).found);
}

TEST(Snapping, ASharedSideThatEndsOnAJointGoesThroughIt) {
  // A fold whose halves share a side stops just short of a level joint: with it, the box falls into three.
  const double low = 2 - 0.5 * d;
  const auto halves = [&](double top) {
    return scene(box({0, 0, 0}, {4, 4, 4}),
                 {level(2), joint({{1.1, -1, -1}, {1.4, 2.1, -1}, {1.4, 2.1, top}, {1.1, -1, top}}),
                  joint({{1.4, 2.1, -1}, {1.2, 5, -1}, {1.2, 5, top}, {1.4, 2.1, top}})});
  };
  EXPECT_EQ(count_blocks(halves(low)), 2U);
  EXPECT_EQ(count_blocks(snapped(halves(low))), 3U);
  EXPECT_EQ(count_blocks(snapped(halves(2 + 0.5 * d))), 3U);
}

}  // namespace
}  // namespace cleave::testing
