#include <gtest/gtest.h>

#include <cmath>

#include "cleave/core/rng.hpp"
#include "complexes.hpp"

// Cases with counts and volumes known in closed form or from the literature.

namespace cleave::testing {
namespace {

geometry::Solid cube2() { return box({-1, -1, -1}, {1, 1, 1}); }

/// The planes x = +-y, y = +-z, z = +-x.
void add_mirrors(topology::CutInput& input) {
  for (const double s : {1.0, -1.0}) {
    input.joints.emplace_back(parallelogram({}, {4, 4 * s, 0}, {0, 0, 4}));
    input.joints.emplace_back(parallelogram({}, {0, 4, 4 * s}, {4, 0, 0}));
    input.joints.emplace_back(parallelogram({}, {4 * s, 0, 4}, {0, 4, 0}));
  }
}
void add_coordinate_planes(topology::CutInput& input) {
  for (const int axis : {0, 1, 2}) input.joints.emplace_back(rectangle(axis, 0, {-2, -2}, {2, 2}));
}
/// x + s y + t z = d for the four choices of signs.
void add_octahedral(topology::CutInput& input, double d) {
  for (const double s : {1.0, -1.0}) {
    for (const double t : {1.0, -1.0})
      input.joints.emplace_back(parallelogram({d, 0, 0}, {8, -8 * s, 0}, {0, 8 * s, -8 * t}));
  }
}
void expect_equal_volumes(const topology::CutInput& input, std::size_t count, double volume) {
  const auto found = volumes(input);
  EXPECT_EQ(found.size(), count);
  for (const double v : found) EXPECT_NEAR(v, volume, 1e-13);
}

TEST(MirrorPlanesOfACube, CutItIntoEqualBlocks) {
  auto input = scene(cube2());
  add_mirrors(input);
  expect_equal_volumes(input, 24, 1.0 / 3);
  add_coordinate_planes(input);
  expect_equal_volumes(input, 48, 1.0 / 6);
  add_octahedral(input, 0);
  expect_equal_volumes(input, 96, 1.0 / 12);
}

TEST(MirrorPlanesOfACube, FourThroughAPointMakeFourteenCones) {
  auto input = scene(cube2());
  add_octahedral(input, 0);
  const auto found = volumes(input);
  ASSERT_EQ(found.size(), 14U);
  for (std::size_t i = 0; i < 14; ++i) EXPECT_NEAR(found[i], i < 8 ? 1.0 / 2 : 2.0 / 3, 1e-13);
}

TEST(Cuboctahedron, IsWhatEightPlanesLeaveOfTheCube) {
  auto input = scene(cube2());
  add_octahedral(input, 2);
  add_octahedral(input, -2);
  const auto found = volumes(input);
  ASSERT_EQ(found.size(), 9U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(found[i], 1.0 / 6, 1e-13);
  EXPECT_NEAR(found[8], 20.0 / 3, 1e-12);
}

// Berre et al. (2021), Adv. Water Resour. 147:103759, section 4.2.
TEST(BerreCase2, Has22Blocks) {
  auto input = scene(box({0, 0, 0}, {1, 1, 1}));
  for (const int axis : {0, 1, 2}) {
    input.joints.emplace_back(rectangle(axis, 0.5, {0, 0}, {1, 1}));
    input.joints.emplace_back(rectangle(axis, 0.75, {0.5, 0.5}, {1, 1}));
    input.joints.emplace_back(rectangle(axis, 0.625, {0.5, 0.5}, {0.75, 0.75}));
  }
  std::vector<double> expected(8, 1.0 / 512);
  expected.insert(expected.end(), 7, 1.0 / 64);
  expected.insert(expected.end(), 7, 1.0 / 8);
  EXPECT_EQ(volumes(input), expected);

  auto planes = scene(box({0, 0, 0}, {1, 1, 1}));
  for (const Vec3 n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    for (const double at : {0.5, 0.75, 0.625}) planes.joints.emplace_back(topology::PersistentJoint{at * n, n});
  }
  EXPECT_EQ(count_blocks(planes), 64U) << "made infinite";
}

// ibid., section 4.3.
TEST(BerreCase3, ClosesNoBlock) {
  const auto input = scene(box({0, 0, 0}, {1, 2.25, 1}),
                           {joint({{0.05, 0.25, 0.5}, {0.95, 0.25, 0.5}, {0.95, 2.0, 0.5}, {0.05, 2.0, 0.5}}),
                            joint({{0.5, 0.05, 0.95}, {0.5, 0.05, 0.05}, {0.5, 0.3, 0.05}, {0.5, 0.3, 0.95}}),
                            joint({{0.05, 1.0, 0.5}, {0.95, 1.0, 0.5}, {0.95, 2.2, 0.85}, {0.05, 2.2, 0.85}}),
                            joint({{0.05, 1.0, 0.48}, {0.95, 1.0, 0.48}, {0.95, 2.2, 0.14}, {0.05, 2.2, 0.14}}),
                            joint({{0.23, 1.9, 0.3}, {0.23, 1.9, 0.7}, {0.17, 2.2, 0.7}, {0.17, 2.2, 0.3}}),
                            joint({{0.17, 1.9, 0.3}, {0.17, 1.9, 0.7}, {0.23, 2.2, 0.7}, {0.23, 2.2, 0.3}}),
                            joint({{0.77, 1.9, 0.3}, {0.77, 1.9, 0.7}, {0.77, 2.2, 0.7}, {0.77, 2.2, 0.3}}),
                            joint({{0.83, 1.9, 0.3}, {0.83, 1.9, 0.7}, {0.83, 2.2, 0.7}, {0.83, 2.2, 0.3}})});
  const auto audited = certified(input);
  EXPECT_EQ(volumes(audited.complex()), (std::vector<double>{2.25}));
  EXPECT_EQ(audited.complex().report().dangling.size(), 8U);
  EXPECT_EQ(shapes(input), (std::vector<Shape>{{cuboid, 2.25}})) << "nothing of the joints is left in the block";

  auto planes = scene(box({0, 0, 0}, {1, 2.25, 1}));
  for (const auto& entry : input.joints) {
    const auto c = std::get<topology::Joint>(entry).polygons[0].corners();
    planes.joints.emplace_back(topology::PersistentJoint{c[0], geometry::normalized(cross(c[1] - c[0], c[2] - c[0]))});
  }
  EXPECT_EQ(count_blocks(planes), 47U) << "made infinite";
}

// dfnWorks, example 4_user_rects: parameters of Hyman et al. (2015), Comput. Geosci. 84:10-19.
TEST(FourUserRectangles, MakeFiveBlocks) {
  const auto found =
      volumes(scene(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}),
                    {rectangle(2, 0, {-1, -0.6}, {0.2, 0.6}), rectangle(0, 0, {-1, -0.65}, {1, 0.65}),
                     rectangle(2, 0.2, {-0.2, -0.6}, {1, 0.6}), rectangle(2, -0.2, {-0.2, -0.6}, {1, 0.6})}));
  const std::vector<double> expected{0.15, 0.15, 0.2, 0.25, 0.25};
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-13);
}

// ---- Planes in general position: blocks = 1 + planes + pair lines + triple points that meet the body
// ----------------------

struct RandomPlane {
  Vec3 through, normal;
};
std::vector<RandomPlane> random_planes(std::size_t count, std::uint32_t key, double spread) {
  Rng rng{StreamKey{.seed = 11, .realization = key, .purpose = 7, .index = 0}};
  const auto coordinate = [&](double half) { return half * (2 * rng.uniform() - 1); };
  std::vector<RandomPlane> planes;
  while (planes.size() < count) {
    const Vec3 through{coordinate(spread), coordinate(spread), coordinate(spread)};
    const Vec3 normal{coordinate(1), coordinate(1), coordinate(1)};
    if (geometry::norm(normal) > 0.1 && geometry::norm(normal) <= 1)
      planes.push_back({through, geometry::normalized(normal)});
  }
  return planes;
}

struct Flats {
  std::size_t pairs = 0, triples = 0;
  double margin = 1;  ///< how close any of them comes to touching an edge or side of the cube
};
/// Lines and points of the planes that meet the cube [-1, 1]^3.
Flats count_flats(const std::vector<RandomPlane>& planes) {
  Flats out;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 n = planes[i].normal, m = planes[j].normal, d = cross(n, m);
      const double a = dot(n, planes[i].through), b = dot(m, planes[j].through);
      const Vec3 o = (a * cross(m, d) + b * cross(d, n)) / dot(d, d);
      double lo = -1e300, hi = 1e300;
      for (const auto& [p, v] : {std::pair{o.x, d.x}, std::pair{o.y, d.y}, std::pair{o.z, d.z}}) {
        lo = std::max(lo, std::min((-1 - p) / v, (1 - p) / v));
        hi = std::min(hi, std::max((-1 - p) / v, (1 - p) / v));
      }
      if (hi > lo) ++out.pairs;
      out.margin = std::min(out.margin, std::abs(hi - lo));
      for (std::size_t k = 0; k < j; ++k) {
        const Vec3 l = planes[k].normal;
        const Vec3 x =
            (a * cross(m, l) + b * cross(l, n) + dot(l, planes[k].through) * cross(n, m)) / dot(n, cross(m, l));
        const double reach = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
        if (reach < 1) ++out.triples;
        out.margin = std::min(out.margin, std::abs(reach - 1));
      }
    }
  }
  return out;
}

TEST(PlanesInGeneralPosition, FollowTheFormula) {
  std::size_t outside = 0;
  for (std::uint32_t key = 0; key < 20; ++key) {
    const auto planes = random_planes(12, key, 0.9);
    const Flats flats = count_flats(planes);
    ASSERT_GT(flats.margin, 1e-9) << "not in general position for doubles";
    outside += 220 - flats.triples;
    auto persistent = scene(cube2()), polygons = scene(cube2());
    for (const auto& [through, normal] : planes) {
      persistent.joints.emplace_back(topology::PersistentJoint{through, normal});
      const Vec3 u = 4 * geometry::normalized(cross(normal, std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
      polygons.joints.emplace_back(parallelogram(through, u, cross(normal, u)));
    }
    const std::size_t expected = 1 + planes.size() + flats.pairs + flats.triples;
    EXPECT_EQ(count_blocks(persistent), expected) << key;
    EXPECT_EQ(count_blocks(polygons), expected) << key;
  }
  EXPECT_GT(outside, 1000U) << "the sample must have points outside the cube too";
}

TEST(PlanesInGeneralPosition, AllMeetingInside) {
  constexpr std::array<std::size_t, 10> cake{1, 2, 4, 8, 15, 26, 42, 64, 93, 130};
  const auto planes = random_planes(9, 100, 0.01);
  ASSERT_EQ(count_flats(planes).triples, 84U) << "choose another key";
  auto input = scene(cube2());
  for (std::size_t n = 0; n < cake.size(); ++n) {
    EXPECT_EQ(count_blocks(input), cake.at(n)) << n;
    if (n < planes.size()) input.joints.emplace_back(topology::PersistentJoint{planes[n].through, planes[n].normal});
  }
}

TEST(PersistentJoints, AreTheSameAsPolygonsThatSpanTheBox) {
  auto planes = scene(box({0, 0, 0}, {4, 4, 4})), polygons = planes;
  for (const double at : {1.0, 2.0, 3.5}) {
    planes.joints.emplace_back(topology::PersistentJoint{{at, 7, -3}, {1, 0, 0}});
    polygons.joints.emplace_back(rectangle(0, at, {-1, -1}, {5, 5}));
    planes.joints.emplace_back(topology::PersistentJoint{{0, 0, at}, {0, 0, -1}});
    polygons.joints.emplace_back(rectangle(2, at, {-1, -1}, {5, 5}));
  }
  EXPECT_EQ(shapes(planes), shapes(polygons));
  EXPECT_EQ(count_blocks(planes), 16U);
}

TEST(PersistentJoints, OfOneOrientationAreExactlyParallel) {
  // Ten planes with one skew normal: layers, whatever their spacing.
  auto input = scene(box({0, 0, 0}, {10, 10, 10}));
  const Vec3 normal = geometry::normalized({0.3, -0.7, 0.64});
  for (int i = 0; i < 10; ++i)
    input.joints.emplace_back(topology::PersistentJoint{{5, 5, 3 + 0.4 * i + 1e-9 * i * i}, normal});
  EXPECT_EQ(count_blocks(input), 11U);
}

}  // namespace
}  // namespace cleave::testing
