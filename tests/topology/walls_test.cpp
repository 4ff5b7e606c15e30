#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "closed_scenes.hpp"

// Walls in one turned plane: of bricks, of strips, of rectangles that overlap, given again in pieces.

namespace cleave::testing {
namespace {

TEST(SharedSides, BricksInOneTurnedPlane) {
  // Neighbours of the outer ones lie outside the box: their outer corners are those of one polygon alone.
  for (const double off : {0.3, 0.35}) {
    for (const int rows : {2, 3}) {
      const Placement at{{0.4, 0.2, 0.8}, 1, {}};
      const double high = 6.0 / rows;
      std::vector<Corners> bricks;
      for (int i = -3; i < 3; ++i) {
        for (int j = 0; j < rows; ++j) {
          const double x = 1.5 * i + (j % 2 == 0 ? 0 : off), y = -3 + high * j;
          const auto corner = [&](double a, double b) { return at({a, b, 0.05}); };
          bricks.push_back({corner(x, y), corner(x + 1.5, y), corner(x + 1.5, y + high), corner(x, y + high)});
        }
      }
      auto input = scene(box({-1, -1, -1}, {1, 1, 1}));
      add(input, bricks);
      const auto audited = certified(input);
      EXPECT_EQ(audited.complex().blocks().size(), 2U) << off << ", " << rows;
      EXPECT_EQ(audited.complex().report().near_misses.sides, 0U);
    }
  }
}

/// Rectangles that tile a wall of more than the box's size, by their least and greatest corners.
using Wall = std::vector<std::array<double, 4>>;

/// Rows of equal bricks, every other row shifted.
Wall running_bond(const support::Uniform& u) {
  const double rows = 2 + std::floor(4 * u()), high = 6 / rows, wide = 0.5 + 1.5 * u();
  const double shift = wide * (0.05 + 0.9 * u());
  Wall wall;
  for (double j = 0; j < rows; ++j) {
    const double start = std::fmod(j, 2) > 0 ? shift : 0, y = -3 + high * j;
    for (double i = -std::ceil(5 / wide); wide * i + start < 4; ++i) {
      const double x = wide * i + start;
      wall.push_back({x, y, x + wide, y + high});
    }
  }
  return wall;
}
/// Rows of bricks of any lengths: ends are summed up, so that neighbours round them differently.
Wall rows_of_any_bricks(const support::Uniform& u) {
  const double rows = 2 + std::floor(4 * u());
  Wall wall;
  for (double j = 0; j < rows; ++j) {
    const double y = -3 + 6 / rows * j;
    for (double x = -4 - u(); x < 4;) {
      const double wide = 0.3 + 1.5 * u();
      wall.push_back({x, y, x + wide, y + 6 / rows});
      x += wide;
    }
  }
  return wall;
}
/// Long strips that end anywhere outside the box: no two have a corner in common.
Wall strips(const support::Uniform& u) {
  const double rows = 2 + std::floor(4 * u());
  Wall wall;
  for (double j = 0; j < rows; ++j) wall.push_back({-4 - u(), -3 + 6 / rows * j, 4 + u(), -3 + 6 / rows * (j + 1)});
  return wall;
}

TEST(SharedSides, WallsOfRectanglesInOneTurnedPlane) {
  for (const auto& wall_of : {running_bond, rows_of_any_bricks, strips}) {
    const auto u = uniform(11);
    for (int k = 0; k < 80; ++k) {
      Placement at = turned(u);
      at.shift = {0.2 * u(), 0.2 * u(), 0.2 * u()};
      auto input = scene(box({-1, -1, -1}, {1, 1, 1}));
      const auto corner = [&](double x, double y) {  // each brick computes its own: the last bit is anything
        const auto last_bit = [&](double c) { return c * (1 + 0x1p-52 * std::floor(3 * u() - 1)); };
        const geometry::Vec3 p = at({x, y, 0.05});
        return geometry::Vec3{last_bit(p.x), last_bit(p.y), last_bit(p.z)};
      };
      for (const auto& [x, y, x2, y2] : wall_of(u)) {
        const auto a = corner(x, y), b = corner(x2, y), c = corner(x2, y2), e = corner(x, y2);
        input.joints.emplace_back(joint({a, b, c, e}));
      }
      const auto audited = certified(input);
      EXPECT_EQ(audited.complex().blocks().size(), 2U) << k;
      EXPECT_EQ(convex_blocks(audited.complex()), 2U) << k;
      EXPECT_EQ(audited.complex().report().near_misses.sides, 0U) << k;
    }
  }
}

TEST(SharedSides, WallsGivenAgainInPieces) {
  const auto u = uniform(21);
  for (int k = 0; k < 60; ++k) {
    const ClosedSet set = support::any_closed_set(u);
    Placement at = turned(u);
    at.scale = std::pow(10, 6 * u() - 2);
    if (k % 3 == 0) at.shift = {5e6, -3e6, 1e3};
    auto input = in_a_box({}, at);
    add(input, support::some_again_in_pieces(placed(set, at).polygons, u));
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), set.parts + 1) << set.name << ", " << at.scale << ", set " << k;
    if (set.convex) {
      EXPECT_GE(convex_blocks(audited.complex()), set.parts) << set.name << ", " << at.scale << ", set " << k;
    }
  }
}

TEST(SharedSides, NeedlesBeforeWhatTheyLieBeside) {
  // Each side of a cube in four triangles about a point, the thinnest of them first: roundings turn its plane.
  const auto u = uniform(24);
  for (int k = 0; k < 24; ++k) {
    Placement at = turned(u);
    at.shift = {5e6, -3e6, 1e3};
    ClosedSet set{"cube of triangles", {}, 1, true};
    for (const Corners& c : support::cube_of_squares().polygons) {
      const Vec3 apex = c[0] + (0.3 + 0.4 * u()) * (c[1] - c[0]) + 0.003 * (c[3] - c[0]);
      for (std::size_t i = 0; i < 4; ++i) set.polygons.push_back({c[i], c[(i + 1) % 4], apex});
    }
    expect_parts(set, at);
  }
}

TEST(SharedSides, ALongWallOfTiles) {
  // No tile is large enough for its plane to hold the whole wall.
  const auto u = uniform(25);
  for (int k = 0; k < 4; ++k) {
    const Placement at{{1e-3 * u(), 0.3 * u(), 5e-3 * u()}, 1, {5e6, -3e6, 4e6}};
    std::vector<Corners> tiles;
    for (int i = -102; i < 102; ++i) {
      for (int j = -4; j < 4; ++j) {
        const auto p = [&](int a, int b) { return at({1.0 * a, 1.0 * b, 0.1}); };
        tiles.push_back({p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)});
      }
    }
    auto input = scene(box(at.shift - Vec3{100, 2, 4}, at.shift + Vec3{100, 2, 4}));
    add(input, tiles);
    const auto audited = certified(input);
    EXPECT_EQ(convex_blocks(audited.complex()), 2U) << k;
    for (const topology::Block& block : audited.complex().blocks()) EXPECT_EQ(block.counts.faces, 6U) << k;
  }
}

TEST(SharedSides, TurnedRectanglesInOnePlane) {
  // They overlap as they like; nothing is common to their outlines. One of them is a wall of its own.
  const auto u = uniform(23);
  for (int k = 0; k < 12; ++k) {
    const Placement at = turned(u);
    auto input = scene(box({-1, -1, -1}, {1, 1, 1}));
    const auto rectangle_at = [&](double x0, double y0, double x1, double y1) {
      add(input, {{at({x0, y0, 0}), at({x1, y0, 0}), at({x1, y1, 0}), at({x0, y1, 0})}});
    };
    rectangle_at(-3, -3, 0.3 * u(), 3);
    rectangle_at(-0.5 * u(), -3, 3, 0.4);
    rectangle_at(-0.7 * u(), 0.1, 3, 3);
    rectangle_at(-0.2, -0.3, 0.5, 0.6);
    add(input, {{at({0.1, -3, -3}), at({0.1, 3, -3}), at({0.1, 3, 3}), at({0.1, -3, 3})}});
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), 4U) << k;
    EXPECT_EQ(convex_blocks(audited.complex()), 4U) << k;
  }
}

}  // namespace
}  // namespace cleave::testing
