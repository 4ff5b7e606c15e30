#include "cleave/exchange/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "cleave/exchange/exports.hpp"
#include "hand_made.hpp"

namespace cleave::report {
namespace {

using geometry::Vec3;

struct Face {
  FaceLoops loops;
  std::vector<Vec3> points;
  Vec3 outward{0, 0, 1};

  void loop(const std::vector<Vec3>& corners) {
    std::vector<std::uint32_t> ids;
    for (const Vec3 c : corners) {
      const auto found = std::ranges::find(points, c);
      ids.push_back(static_cast<std::uint32_t>(found - points.begin()));
      if (found == points.end()) points.push_back(c);
    }
    loops.push_back(ids);
  }
  [[nodiscard]] std::size_t corners() const {
    std::size_t n = 0;
    for (const auto& l : loops) n += l.size();
    return n;
  }
};

double area_along(const Face& face, std::span<const std::uint32_t> ids) {
  Vec3 sum{};
  for (std::size_t i = 0; i < ids.size(); ++i)
    sum += 0.5 * cross(face.points[ids[i]], face.points[ids[(i + 1) % ids.size()]]);
  return dot(sum, normalized(face.outward));
}

// Every loop edge once in its own direction, every other edge once in both: then the triangles close up like the face
// itself.
void expect_closes(const Face& face, const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& loop : face.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) --uses[{loop[i], loop[(i + 1) % loop.size()]}];
  }
  for (const auto& [edge, count] : uses) {
    const auto back = uses.find({edge.second, edge.first});
    EXPECT_EQ(count, back == uses.end() ? 0 : back->second) << edge.first << ' ' << edge.second;
    EXPECT_TRUE(count == 0 || count == 1) << edge.first << ' ' << edge.second;
  }
}

void expect_good(const Face& face, std::size_t expected_triangles) {
  const auto triangles = triangulate(face.loops, face.points, face.outward);
  EXPECT_EQ(triangles.size(), expected_triangles);
  expect_closes(face, triangles);
  double whole = 0, sum = 0, covered = 0;
  for (const auto& loop : face.loops) whole += area_along(face, loop);
  for (const Triangle& t : triangles) {
    const double a = area_along(face, t);
    EXPECT_GE(a, -1e-12 * whole);
    sum += a;
    covered += std::abs(a);
  }
  EXPECT_NEAR(sum, whole, 1e-11 * whole);
  EXPECT_NEAR(covered, whole, 1e-11 * whole);  // no overlap, nothing folded back
}

std::vector<Vec3> square(double x0, double y0, double x1, double y1, bool clockwise = false) {
  std::vector<Vec3> corners{{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
  if (clockwise) std::ranges::reverse(corners);
  return corners;
}

TEST(Triangulate, SquareWithAHole) {
  Face face;
  face.loop(square(0, 0, 4, 4));
  face.loop(square(1, 1, 2, 2, true));
  expect_good(face, 8);
}

TEST(Triangulate, HolesThatTouchEachOtherOrTheOutlineAtAVertex) {
  Face face;
  face.loop(square(0, 0, 4, 4));
  face.loop(square(1, 1, 2, 2, true));
  face.loop(square(2, 2, 3, 3, true));
  expect_good(face, 12);  // one corner less than for two free holes and no bridge for the second: 12 + 2 * 2 - 2 - 2

  Face touching;
  touching.loop({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}});
  touching.loop({{2, 0, 0}, {1, 1, 0}, {3, 1, 0}});
  expect_good(touching, 6);  // as one loop of 8 corners
}

TEST(Triangulate, LoopThatPassesAVertexTwice) {
  Face face;  // two squares joined at (2, 2), walked as one loop
  face.loop({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {4, 2, 0}, {4, 4, 0}, {2, 4, 0}, {2, 2, 0}, {0, 2, 0}});
  expect_good(face, 4);
  Face figure_of_eight;  // as a hole
  figure_of_eight.loop(square(0, 0, 4, 4));
  figure_of_eight.loop({{1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 3, 0}, {3, 3, 0}, {3, 2, 0}, {2, 2, 0}, {2, 1, 0}});
  expect_good(figure_of_eight, 12);
}

TEST(Triangulate, CornersOnStraightEdges) {
  Face face;
  std::vector<Vec3> outline;
  for (int i = 0; i < 10; ++i) outline.push_back({0.1 * i, 0, 0});
  for (int i = 0; i < 10; ++i) outline.push_back({1, 0.1 * i, 0});
  for (int i = 0; i < 10; ++i) outline.push_back({1 - 0.1 * i, 1, 0});
  for (int i = 0; i < 10; ++i) outline.push_back({0, 1 - 0.1 * i, 0});
  face.loop(outline);
  face.loop({{0.5, 0.25, 0}, {0.4, 0.3, 0}, {0.3, 0.35, 0}, {0.4, 0.45, 0}, {0.6, 0.4, 0}});
  expect_good(face, 45);
}

TEST(Triangulate, ManyHolesInRowsWithEqualCoordinates) {
  Face face;
  face.loop(square(0, 0, 10, 10));
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) face.loop(square(i + 0.5, j + 0.5, i + 1, j + 1, true));
  }
  expect_good(face, 4 + 81 * 4 + 2 * 81 - 2);
}

// Ragged outlines with ragged holes on planes in all directions.
TEST(Triangulate, RandomFacesInSpace) {
  std::mt19937_64 bits{20260801};
  const auto uniform = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53; };
  std::size_t with_holes = 0;
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(trial);
    const Vec3 normal = normalized(Vec3{uniform() - 0.5, uniform() - 0.5, uniform() - 0.5});
    const Vec3 u = normalized(cross(normal, std::abs(normal.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
               v = cross(normal, u);
    Face face;
    face.outward = normal;
    const auto star = [&](double cx, double cy, double radius, bool clockwise) {
      std::vector<Vec3> corners;
      const std::size_t n = 3 + bits() % 14;
      for (std::size_t i = 0; i < n; ++i) {
        const double t = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        const double r = radius * (0.55 + 0.45 * uniform());
        corners.push_back((cx + r * std::cos(t)) * u + (cy + r * std::sin(t)) * v);
      }
      if (clockwise) std::ranges::reverse(corners);
      face.loop(corners);
    };
    star(0, 0, 10, false);
    std::vector<Vec3> outline = face.points;
    // Holes on a small grid, inside the disc that every outline of this kind with >= 8 corners contains.
    if (outline.size() >= 8) {
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          if (bits() % 3 != 0) star(2.2 * i, 2.2 * j, 1.0, true);
        }
      }
    }
    const std::size_t holes = face.loops.size() - 1;
    with_holes += holes > 0 ? 1 : 0;
    expect_good(face, face.corners() + 2 * holes - 2);
  }
  EXPECT_GT(with_holes, 200U);  // the generator itself is under test
}

// The surface of every block closes, and encloses its volume.
TEST(TrianglesOf, CloseAroundTheBlock) {
  const topology::BlockComplex complex = testing::grid(2);
  for (const topology::BlockId id : complex.blocks().ids()) {
    std::map<std::pair<topology::VertexId, topology::VertexId>, int> uses;
    double volume = 0;
    for (const auto& t : triangles_of(complex, id)) {
      for (std::size_t k = 0; k < 3; ++k) {
        ++uses[{t[k], t[(k + 1) % 3]}];
        --uses[{t[(k + 1) % 3], t[k]}];
      }
      const auto at = [&](std::size_t k) { return complex.position(t[k]) - complex.blocks()[id].centroid; };
      volume += dot(at(0), cross(at(1), at(2))) / 6;
    }
    EXPECT_TRUE(std::ranges::all_of(uses, [](const auto& use) { return use.second == 0; }));
    EXPECT_DOUBLE_EQ(volume, 1);
  }
}

}  // namespace
}  // namespace cleave::report
