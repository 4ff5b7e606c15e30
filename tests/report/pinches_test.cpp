// Edges used more than twice, and triangles that are lines.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "cleave/exchange/polygons.hpp"

namespace cleave::report::detail {
namespace {

// A loop that passes a point twice is cut into triangles some of which are lines, there and back. Their two edges are
// one: no middle point parts them, and the search for the next pinched edge went on for ever.
TEST(PinchesTest, TrianglesThatAreLinesGo) {
  std::vector<geometry::Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  std::vector<Polygon> polygons;
  const auto add = [&](std::vector<std::uint32_t> corners) {
    const auto p = points[corners[0]], q = points[corners[1]], r = points[corners[2]];
    polygons.push_back({.corners = std::move(corners),
                        .outward = cross(q - p, r - p),
                        .face = static_cast<std::uint32_t>(polygons.size())});
  };
  // Two tetrahedra that share the edge from 0 to 1.
  add({0, 2, 1});
  add({0, 1, 3});
  add({0, 3, 2});
  add({1, 2, 3});
  add({0, 4, 1});
  add({0, 1, 5});
  add({0, 5, 4});
  add({1, 4, 5});
  polygons.push_back({.corners = {0, 1, 1}, .outward = {0, 0, 1}, .face = 8});
  separate_pinches(polygons, points);
  EXPECT_EQ(polygons.size(), 8U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const Polygon& polygon : polygons) {
    for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
      ++uses[{polygon.corners[i], polygon.corners[(i + 1) % polygon.corners.size()]}];
    }
  }
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((uses[{edge.second, edge.first}]), 1);
  }
}

}  // namespace
}  // namespace cleave::report::detail
