#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "cleave/motion/world.hpp"
#include "shapes.hpp"

namespace cleave::motion {
namespace {

using namespace shapes;

MassProperties of(const Polyhedron& shape) {
  const auto made = mass_properties(shape);
  EXPECT_TRUE(made.has_value());
  return made.value_or(MassProperties{});
}

void expect_near(Vec3 got, Vec3 want, double tolerance) {
  EXPECT_NEAR(got.x, want.x, tolerance);
  EXPECT_NEAR(got.y, want.y, tolerance);
  EXPECT_NEAR(got.z, want.z, tolerance);
}
void expect_inertia(const Symmetric& got, const Symmetric& want, double tolerance) {
  expect_near({got.xx, got.yy, got.zz}, {want.xx, want.yy, want.zz}, tolerance);
  expect_near({got.xy, got.yz, got.zx}, {want.xy, want.yz, want.zx}, tolerance);
}

TEST(Mass, Tetrahedron) {
  const MassProperties m = of(hull({{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 5}}));
  EXPECT_NEAR(m.volume, 10, 1e-14);
  expect_near(m.centroid, {0.75, 1, 1.25}, 1e-14);
  expect_inertia(m.inertia, {15.375, 12.75, 9.375, 1.5, 2.5, 1.875}, 1e-12);
}

TEST(Mass, HoleThrough) {
  Polyhedron shape = box({0, 0, 0}, {4, 4, 4});
  const std::vector<Vec3> shaft = box_vertices({1, 1, 0}, {2.5, 3, 4});
  shape.vertices.insert(shape.vertices.end(), shaft.begin(), shaft.end());
  std::vector<Facet> walls = box_facets(8, true);
  // Bottom and top of the shaft are holes of the box's.
  for (const std::size_t end : {0U, 1U}) shape.facets[end].loops.push_back(walls[end].loops[0]);
  shape.facets.insert(shape.facets.end(), walls.begin() + 2, walls.end());
  const MassProperties m = of(shape);
  EXPECT_NEAR(m.volume, 64 - 12, 1e-12);
}

TEST(Mass, HoleThroughFlatBox) {
  Polyhedron shape = box({0, 0, 0}, {4, 4, 2});
  const std::vector<Vec3> shaft = box_vertices({1, 1, 0}, {2.5, 3, 2});
  shape.vertices.insert(shape.vertices.end(), shaft.begin(), shaft.end());
  std::vector<Facet> walls = box_facets(8, true);
  for (const std::size_t end : {0U, 1U}) shape.facets[end].loops.push_back(walls[end].loops[0]);
  shape.facets.insert(shape.facets.end(), walls.begin() + 2, walls.end());
  const MassProperties m = of(shape);
  EXPECT_NEAR(m.volume, 26, 1e-12);
  EXPECT_NEAR(m.centroid.x, 2.0576923, 1e-7);
  expect_near({m.inertia.xx, m.inertia.yy, m.inertia.zz}, {49.333333, 49.746795, 81.746795}, 1e-6);
}

TEST(Mass, Cavity) {
  Polyhedron shape = box({0, 0, 0}, {3, 3, 3});
  const std::vector<Vec3> inner = box_vertices({1, 1, 1}, {1.5, 2, 2.5});
  shape.vertices.insert(shape.vertices.end(), inner.begin(), inner.end());
  const std::vector<Facet> walls = box_facets(8, true);
  shape.facets.insert(shape.facets.end(), walls.begin(), walls.end());
  const MassProperties m = of(shape);
  EXPECT_NEAR(m.volume, 26.25, 1e-12);
  expect_near(m.centroid, {1.5071429, 1.5, 1.4928571}, 1e-7);
  expect_inertia(m.inertia, {40.248661, 40.247321, 40.373661, 0, 0, -0.048214286}, 1e-6);
}

TEST(Mass, ConcaveNearAndFarFromTheOrigin) {
  const Polyhedron shape = prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1);
  for (const double far : {0.0, 1e6}) {
    const MassProperties m = of(moved(shape, {far, far, far}));
    expect_near(m.centroid - Vec3{far, far, far}, {1.25, 0.75, 0.5}, far > 0 ? 1e-9 : 1e-14);
    expect_inertia(m.inertia, {1.4166667, 3.4166667, 4.1666667, 0.75, 0, 0}, 1e-7);
    EXPECT_NEAR(m.inertia.zz, 25.0 / 6, 1e-9);
  }
}

TEST(Mass, Icosahedron) {
  const MassProperties m = of(icosahedron(2));
  EXPECT_NEAR(m.volume, 17.453560, 1e-6);
  const double j = std::numbers::phi * std::numbers::phi / 10 * m.volume * 4;
  expect_inertia(m.inertia, {j, j, j, 0, 0, 0}, 1e-12);
  EXPECT_NEAR(j, 18.277605, 1e-6);
}

TEST(Mass, WhatIsNoBodyIsRefused) {
  EXPECT_FALSE(mass_properties({}).has_value());
  Polyhedron inside_out = block(1, 1, 1);
  inside_out.facets = box_facets(0, true);
  EXPECT_FALSE(mass_properties(inside_out).has_value());
  Polyhedron missing = block(1, 1, 1);
  missing.facets[0].loops[0][0] = 9;
  EXPECT_FALSE(mass_properties(missing).has_value());
  Polyhedron infinite = block(1, 1, 1);
  infinite.vertices[0].x = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(mass_properties(infinite).has_value());
  EXPECT_FALSE(mass_properties(block(1, 1, 0)).has_value());
}

/// A cube of side `side` below the origin on all axes, without a cube of side `notch` at the corner there.
Polyhedron notched(double side, double notch) {
  Polyhedron out;
  const auto number = [&](Vec3 at) {
    const auto found = std::ranges::find(out.vertices, at);
    if (found == out.vertices.end()) out.vertices.push_back(at);
    return static_cast<std::uint32_t>(std::ranges::find(out.vertices, at) - out.vertices.begin());
  };
  for (unsigned axis = 0; axis < 3; ++axis) {
    // Counter-clockwise seen from where the axis goes.
    const auto add = [&](double along, const std::vector<std::pair<double, double>>& outline, bool back) {
      std::vector<std::uint32_t> loop;
      for (const auto& [u, v] : outline) {
        const std::array<double, 3> at{along, u, v};
        loop.push_back(number({at.at((3 - axis) % 3), at.at((4 - axis) % 3), at.at((5 - axis) % 3)}));
      }
      if (back) std::ranges::reverse(loop);
      out.facets.push_back({{loop}});
    };
    const double s = -side, n = -notch;
    add(0, {{s, s}, {0, s}, {0, n}, {n, n}, {n, 0}, {s, 0}}, false);
    add(s, {{s, s}, {0, s}, {0, 0}, {s, 0}}, true);
    add(n, {{n, n}, {0, n}, {0, 0}, {n, 0}}, false);
  }
  return out;
}

// Facets of a ten-thousandth of a body's size are cut by, too: what fills the notch does not overlap.
TEST(Mass, ASmallNotchIsRoomForABlock) {
  for (const double notch : {2.0, 1e-2, 1e-4, 1e-5}) {
    const auto mass = mass_properties(notched(8, notch));
    ASSERT_TRUE(mass.has_value());
    EXPECT_NEAR(mass->volume, 512 - notch * notch * notch, 1e-9);
    const auto world = World::make(
        {.bodies = {{.shape = notched(8, notch), .fixed = true}, {.shape = box({-notch, -notch, -notch}, {0, 0, 0})}}},
        {});
    EXPECT_TRUE(world.has_value()) << notch << ": " << describe(world.error());
    const auto inside = World::make({.bodies = {{.shape = notched(8, notch), .fixed = true},
                                                {.shape = box({-1.1 * notch, -notch, -notch}, {0, 0, 0})}}},
                                    {});
    ASSERT_FALSE(inside.has_value()) << notch;
    EXPECT_EQ(inside.error().bodies, (std::vector<std::uint32_t>{0, 1}));
  }
}

}  // namespace
}  // namespace cleave::motion
