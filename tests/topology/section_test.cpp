#include "cleave/topology/section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cleave/core/rng.hpp"
#include "complexes.hpp"

// Sections of block systems: nothing missing, nothing double, neighbours share their corners.
namespace cleave::testing {
namespace {

using topology::Section;
using topology::SectionPlane;
using topology::SectionPoint;
using topology::SectionPolygon;

SectionPlane vertical(Vec3 through, double azimuth) {
  const double a = azimuth * 3.14159265358979323846 / 180;
  return {through, {std::sin(a), std::cos(a), 0}, {0, 0, 1}};
}

double area_of(const SectionPolygon& polygon) {
  double sum = 0;
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    const SectionPoint a = polygon.corners[k], b = polygon.corners[(k + 1) % polygon.corners.size()];
    sum += (a.x * b.y - a.y * b.x) / 2;
  }
  return sum;
}
double total(const Section& section) {
  double sum = 0;
  for (const SectionPolygon& polygon : section.polygons) sum += area_of(polygon);
  return sum;
}

TEST(SectionOfBlocks, GridFallsIntoItsCells) {
  auto input = scene(box({0, 0, 0}, {4, 4, 4}));
  for (int k = 1; k < 4; ++k) {
    input.joints.emplace_back(topology::PersistentJoint{{1.0 * k, 2, 2}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{2, 1.0 * k, 2}, {0, 1, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{2, 2, 1.0 * k}, {0, 0, 1}});
  }
  const auto audited = certified(input);
  const Section through = section(audited.complex(), vertical({0, 1.5, 0}, 90));
  ASSERT_EQ(through.polygons.size(), 16U);
  for (const SectionPolygon& polygon : through.polygons) {
    EXPECT_EQ(polygon.corners.size(), 4U);
    EXPECT_NEAR(area_of(polygon), 1, 1e-12);
    for (const auto& side : polygon.sides) EXPECT_EQ(side.role == topology::Role::joint, side.joint.has_value());
  }
  // Along a joint's own plane: one side of it, not both, not none.
  const Section on = section(audited.complex(), vertical({0, 1, 0}, 90));
  EXPECT_EQ(on.polygons.size(), 16U);
  EXPECT_NEAR(total(on), 16, 1e-12);
  const Section level = section(audited.complex(), {{0, 0, 2.25}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(level.polygons.size(), 16U);
  EXPECT_NEAR(total(level), 16, 1e-12);
}

// Random joints, some of them finite, and a tunnel: areas add up to that of the section, corners on inner sides are
// corners of a neighbour or lie on its side, every polygon is counter-clockwise.
TEST(SectionOfBlocks, RandomSystemsAddUp) {
  Rng rng{20260};
  std::size_t polygons = 0, concave = 0;
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    auto input = scene(box({0, 0, 0}, {10, 10, 10}), {}, {box({4, -1, 4}, {6, 11, 6})});
    for (int k = 0; k < 12; ++k) {
      const Vec3 centre{10 * rng.uniform(), 10 * rng.uniform(), 10 * rng.uniform()};
      const Vec3 u{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
      const Vec3 w{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
      const Vec3 v = cross(u, w);
      input.joints.emplace_back(parallelogram(centre, (6 / std::sqrt(dot(u, u))) * u, (6 / std::sqrt(dot(v, v))) * v));
    }
    const auto audited = certified(input);
    const Section found = section(audited.complex(), vertical({0, 5 + 3 * (rng.uniform() - 0.5), 0}, 90));
    EXPECT_NEAR(found.area, 96, 1e-9);
    EXPECT_NEAR(total(found) + found.left_out_area, found.area, 1e-9);
    EXPECT_LT(found.left_out_area, 1e-4);
    for (const SectionPolygon& polygon : found.polygons) {
      ++polygons;
      EXPECT_GT(area_of(polygon), 0);
      for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
        const auto n = polygon.corners.size();
        const SectionPoint a = polygon.corners[k], b = polygon.corners[(k + 1) % n], c = polygon.corners[(k + 2) % n];
        concave += (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) < -1e-9 ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(polygons, 150U);
  EXPECT_GT(concave, 10U);
}

// A block around another one: its ring is parted, by cuts that say so.
TEST(SectionOfBlocks, RingsAreParted) {
  auto input = scene(box({0, 0, 0}, {9, 9, 9}));
  add_closed_box(input, {3, 3, 3}, {5, 6, 6});
  const auto audited = certified(input);
  ASSERT_EQ(audited.complex().blocks().size(), 2U);
  const Section found = section(audited.complex(), vertical({0, 4.5, 0}, 90));
  EXPECT_EQ(found.parted, 1U);
  EXPECT_EQ(found.polygons.size(), 3U);
  EXPECT_NEAR(total(found), 81, 1e-12);
  std::map<std::uint32_t, double> by_block;
  int cuts = 0;
  for (const SectionPolygon& polygon : found.polygons) {
    by_block[polygon.block.value()] += area_of(polygon);
    for (const auto& side : polygon.sides) cuts += side.cut ? 1 : 0;
  }
  EXPECT_EQ(cuts, 4);
  for (const auto& [block, area] : by_block) EXPECT_TRUE(std::abs(area - 6) < 1e-12 || std::abs(area - 75) < 1e-12);
}

}  // namespace
}  // namespace cleave::testing
