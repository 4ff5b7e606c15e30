#include "cleave/geometry/terrain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

namespace cleave::geometry {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Volume below the ground by prisms over its triangles: an independent sum.
double prisms(const Ground& ground, double level) {
  double volume = 0;
  for (const auto& [i, j, k] : ground.triangles) {
    const Vec3 a = ground.vertices[i], b = ground.vertices[j], c = ground.vertices[k];
    const double area = 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    volume += area * ((a.z + b.z + c.z) / 3 - level);
  }
  return volume;
}

std::size_t faces_with(const Solid& solid, std::string_view tag) {
  return static_cast<std::size_t>(
      std::ranges::count_if(solid.faces(), [&](const SolidFace& f) { return solid.tags()[f.tag] == tag; }));
}

TEST(Terrain, GridBecomesABodyWithFourSides) {
  const std::array values{3.0, 4.0, 5.0, 2.0, 6.0, 1.0, 2.5, 3.5, 4.5};
  const auto ground =
      ground_of({.columns = 3, .rows = 3, .x = 500000, .y = 7e6, .step_x = 10, .step_y = 5, .values = values});
  EXPECT_EQ(ground.triangles.size(), 8U);
  EXPECT_EQ(ground.vertices[0], (Vec3{500000, 7e6 + 10, 3})) << "north-west first";
  const auto below = close_ground(ground, -10).value();
  EXPECT_NEAR(below.volume().si(), prisms(ground, -10), 1e-6);
  for (const char* tag : {"west", "east", "south", "north", "bottom"}) EXPECT_EQ(faces_with(below, tag), 1U) << tag;
  EXPECT_EQ(faces_with(below, "top"), 8U);
  const auto above = close_ground(ground, 20).value();
  EXPECT_NEAR(above.volume().si(), -prisms(ground, 20), 1e-6);
  EXPECT_EQ(faces_with(above, "bottom"), 8U);
  EXPECT_EQ(faces_with(above, "top"), 1U);
}

TEST(Terrain, MissingHeightsLeaveCellsOut) {
  std::vector<double> values(25, 1.0);
  values[12] = nothing;  // the middle: a hole of 2 x 2 cells
  const auto ring = ground_of({.columns = 5, .rows = 5, .x = 0, .y = 0, .step_x = 1, .step_y = 1, .values = values});
  EXPECT_EQ(ring.triangles.size(), 24U);
  EXPECT_NEAR(close_ground(ring, 0).value().volume().si(), 12, 1e-12);
  values[12] = 1.0;
  values[0] = nothing;  // the north-west corner: the border turns inwards there
  const auto corner = ground_of({.columns = 5, .rows = 5, .x = 0, .y = 0, .step_x = 1, .step_y = 1, .values = values});
  const auto solid = close_ground(corner, 0).value();
  EXPECT_NEAR(solid.volume().si(), 15, 1e-12);
  EXPECT_EQ(faces_with(solid, "west"), 2U);
}

TEST(Terrain, TrianglesOfAnySense) {
  Ground ground{.vertices = {{0, 0, 1}, {4, 0, 2}, {4, 4, 3}, {0, 4, 2}}, .triangles = {{0, 2, 1}, {0, 2, 3}}};
  EXPECT_NEAR(close_ground(ground, 0).value().volume().si(), prisms(ground, 0), 1e-12);
}

// A sheet whose middle strip leans over: fine inside, but where it reaches the border its vertical sides would overlap.
TEST(Terrain, AnOverhangAtTheBorderIsRefused) {
  const Ground ground{
      .vertices = {{0, 0, 1}, {6, 0, 1}, {4, 0, 5}, {10, 0, 5}, {0, 4, 1}, {6, 4, 1}, {4, 4, 5}, {10, 4, 5}},
      .triangles = {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}}};
  EXPECT_TRUE(std::holds_alternative<SolidError>(close_ground(ground, 0).error()));
}

TEST(Terrain, Refusals) {
  const Ground flat{.vertices = {{0, 0, 1}, {4, 0, 2}, {4, 4, 3}}, .triangles = {{0, 1, 2}}};
  EXPECT_TRUE(std::holds_alternative<LevelWithin>(close_ground(flat, 2).error()));
  EXPECT_TRUE(std::holds_alternative<LevelWithin>(close_ground(flat, 1).error()));
  EXPECT_TRUE(std::holds_alternative<EmptyGround>(close_ground({}, 0).error()));
  EXPECT_TRUE(std::holds_alternative<BadTriangle>(close_ground({flat.vertices, {{0, 1, 3}}}, 0).error()));
  Ground fan = flat;
  fan.vertices.insert(fan.vertices.end(), {{0, 4, 5}, {2, -4, 6}});
  fan.triangles.insert(fan.triangles.end(), {{0, 2, 3}, {0, 2, 4}});
  EXPECT_TRUE(std::holds_alternative<TwistedGround>(close_ground(fan, 0).error()));
}

}  // namespace
}  // namespace cleave::geometry
