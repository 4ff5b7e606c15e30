#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../topology/complexes.hpp"
#include "cleave/geometry/terrain.hpp"

// Scenes of ten thousand slivers and of surfaces with a hundred thousand triangles.

namespace cleave::testing {
namespace {

// Fu (2014), figure 3-9 c: 64,000 blocks; faces and vertices of each block counted by themselves.
TEST(LargeGeometry, SixtyFourThousandBlocks) {
  auto input = scene(box({0, 0, 0}, {1, 1, 1}));
  for (int k = 1; k < 40; ++k) {
    input.joints.emplace_back(topology::PersistentJoint{{0.025 * k, 0.5, 0.5}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.025 * k, 0.5}, {0, 1, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.5, 0.025 * k}, {0, 0, 1}});
  }
  const auto audited = certified(input);
  std::size_t faces = 0, vertices = 0;
  for (const topology::Block& block : audited.complex().blocks()) {
    faces += block.counts.faces;
    vertices += block.counts.vertices;
  }
  EXPECT_EQ(audited.complex().blocks().size(), 64000U);
  EXPECT_EQ(faces, 384000U);
  EXPECT_EQ(vertices, 512000U);
}

TEST(LargeGeometry, TenThousandSlivers) {
  auto input = scene(box({0, 0, 0}, {1, 1, 1}));
  for (int k = 0; k <= 10000; ++k) {
    input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.5, 0.25 + 1e-9 * k}, {0, 0, 1}});
  }
  input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.5, 0.5}, {1, 0, 0}});
  const auto audited = certified(input);
  EXPECT_EQ(audited.complex().blocks().size(), 2U * 10002);
  EXPECT_EQ(std::ranges::count_if(audited.complex().blocks(), [](const topology::Block& b) { return b.sliver; }),
            2 * 10000);
}

/// z = level + gentle waves over 0 .. 100 x 0 .. 100, and a little beyond, as 2 n^2 triangles.
geometry::Ground waves(std::uint32_t n, double level) {
  std::vector<double> values;
  for (std::uint32_t row = 0; row <= n; ++row) {
    for (std::uint32_t column = 0; column <= n; ++column) {
      const double x = 110.0 * column / n - 5, y = 105 - 110.0 * row / n;
      values.push_back(level + 4 * std::sin(0.13 * x) * std::cos(0.09 * y) + 0.02 * x);
    }
  }
  return geometry::ground_of(
      {.columns = n + 1, .rows = n + 1, .x = -5, .y = -5, .step_x = 110.0 / n, .step_y = 110.0 / n, .values = values});
}

TEST(LargeGeometry, AFaultOfAHundredThousandTriangles) {
  auto input = scene(box({0, 0, 0}, {100, 100, 60}));
  const geometry::Ground fault = waves(224, 30);
  ASSERT_GT(fault.triangles.size(), 100000U);
  topology::Joint surface;
  for (const auto& [a, b, c] : fault.triangles) {
    surface.polygons.push_back(
        geometry::Polygon::make({fault.vertices[a], fault.vertices[b], fault.vertices[c]}).value());
  }
  input.joints.emplace_back(std::move(surface));
  for (int k = 1; k <= 5; ++k) {  // vertical planes in two directions: 36 columns, each cut once by the fault
    input.joints.emplace_back(topology::PersistentJoint{{100.0 / 6 * k, 50, 30}, {1, 0.01 * k, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{50, 100.0 / 6 * k, 30}, {0.02, 1, 0}});
  }
  EXPECT_EQ(count_blocks(input), 72U);
}

}  // namespace
}  // namespace cleave::testing
