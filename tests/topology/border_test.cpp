#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "closed_sets.hpp"
#include "complexes.hpp"

// The border of the exact world: surfaces that are closed on paper part the rock when they come in rounded doubles, at
// any place, turn and size.

namespace cleave::testing {
namespace {

using support::ClosedSet;
using support::Corners;
using support::Placement;

support::Uniform uniform(std::uint64_t seed) {
  return [random = std::mt19937_64{seed}]() mutable { return static_cast<double>(random() >> 11U) * 0x1p-53; };
}
Placement turned(const support::Uniform& u) { return {{6 * u(), 6 * u(), 6 * u()}, 1, {}}; }
constexpr double degree = std::numbers::pi / 180;

/// One polygon a joint.
void add(topology::CutInput& input, const std::vector<Corners>& polygons) {
  for (const Corners& corners : polygons) input.joints.emplace_back(joint(corners));
}
/// In a box twice as wide as it needs.
topology::CutInput in_a_box(const ClosedSet& set, const Placement& at) {
  const double half = 2 * at.scale;
  auto input = scene(box(at.shift - Vec3{half, half, half}, at.shift + Vec3{half, half, half}));
  add(input, placed(set, at).polygons);
  return input;
}
std::size_t convex_blocks(const topology::BlockComplex& complex) {
  return static_cast<std::size_t>(
      std::ranges::count_if(complex.blocks(), [](const topology::Block& b) { return b.convex; }));
}
void expect_parts(const ClosedSet& set, const Placement& at) {
  const auto input = in_a_box(set, at);
  const auto audited = certified(input);
  EXPECT_EQ(audited.complex().blocks().size(), set.parts + 1) << set.name;
  if (set.convex) {
    EXPECT_EQ(convex_blocks(audited.complex()), set.parts) << set.name;
  }
}

TEST(SharedSides, ACubeOfSquaresTurned) {
  expect_parts(support::cube_of_squares(), {{30 * degree, 20 * degree, 0}, 1, {}});
  const auto u = uniform(1);
  for (int k = 0; k < 12; ++k) {
    const auto audited = certified(in_a_box(support::cube_of_squares(), turned(u)));
    ASSERT_EQ(audited.complex().blocks().size(), 2U);
    const auto own = shapes(audited.complex());
    EXPECT_EQ(own[0].counts, cuboid) << "faces stay whole";
    EXPECT_NEAR(own[0].volume, 1, 1e-12);
  }
}

TEST(SharedSides, Dodecahedra) {
  const auto u = uniform(2);
  for (int k = 0; k < 12; ++k) {
    expect_parts(support::dodecahedron(), turned(u));
    const auto audited = certified(in_a_box(support::dodecahedron(), turned(u)));
    EXPECT_EQ(shapes(audited.complex())[0].counts, (std::array<unsigned, 6>{20, 30, 12, 12, 1, 0}));
  }
}

TEST(SharedSides, AFaultAsAMeshOfQuads) {
  const auto u = uniform(3);
  for (int k = 0; k < 12; ++k) {
    const Placement at = turned(u);
    std::vector<Corners> quads;
    for (int i = -6; i < 6; ++i) {
      for (int j = -6; j < 6; ++j) {
        const auto p = [&](int a, int b) { return at({0.4 * a, 0.4 * b, 0.1}); };
        quads.push_back({p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)});
      }
    }
    auto input = scene(box({-1, -1, -1}, {1, 1, 1}));
    topology::Joint fault;
    for (const Corners& quad : quads) fault.polygons.push_back(geometry::Polygon::make(quad).value());
    input.joints.emplace_back(fault);
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), 2U);
    EXPECT_EQ(convex_blocks(audited.complex()), 2U);
  }
}

TEST(SharedSides, VoronoiCells) {
  for (const std::size_t cells : {10U, 50U, 300U}) {
    const auto u = uniform(cells);
    auto input = scene(box({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}));
    add(input, support::voronoi(cells, u, 0.6, false).polygons);
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), cells);
    EXPECT_EQ(convex_blocks(audited.complex()), cells);
    expect_parts(support::voronoi(cells, u), turned(u));
  }
}

TEST(SharedSides, VoronoiCellsCutByPlanes) {
  // What crosses a folded face is bent by rounding where it passes from piece to piece: no corner, no face more.
  const auto u = uniform(5);
  for (int k = 0; k < 6; ++k) {
    const Placement at = turned(u);
    auto input = in_a_box(support::voronoi(8, u), at);
    input.joints.emplace_back(topology::PersistentJoint{{0.01, 0.02, 0.03}, geometry::normalized({u(), u(), 1})});
    const auto audited = certified(input);
    EXPECT_EQ(convex_blocks(audited.complex()), audited.complex().blocks().size() - 2);
    for (const topology::Block& block : audited.complex().blocks()) {
      if (!block.convex) continue;
      EXPECT_EQ(2 * block.counts.edges, 3 * block.counts.vertices) << "three edges at every corner";
    }
  }
}

TEST(SharedSides, AnySetAnywhere) {
  const auto u = uniform(6);
  for (int k = 0; k < 300; ++k) {
    const ClosedSet set = support::any_closed_set(u);
    Placement at = turned(u);
    at.scale = std::pow(10, 9 * u() - 3);
    if (k % 3 == 0) at.shift = {5e6, -3e6, 1e3};
    const auto input = in_a_box(set, at);
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), set.parts + 1) << set.name << ", " << at.scale << ", set " << k;
    if (set.convex) {
      EXPECT_GE(convex_blocks(audited.complex()), set.parts) << set.name << ", " << at.scale << ", set " << k;
    }
  }
}

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
        const auto a = corner(x, y), b = corner(x2, y), c = corner(x2, y2), d = corner(x, y2);
        input.joints.emplace_back(joint({a, b, c, d}));
      }
      const auto audited = certified(input);
      EXPECT_EQ(audited.complex().blocks().size(), 2U) << k;
      EXPECT_EQ(convex_blocks(audited.complex()), 2U) << k;
      EXPECT_EQ(audited.complex().report().near_misses.sides, 0U) << k;
    }
  }
}

/// The faces of all blocks as joints of a new scene, as a file of them is read back.
topology::CutInput read_back(const topology::BlockComplex& complex, geometry::Solid domain) {
  auto input = scene(std::move(domain));
  for (const topology::Face& face : complex.faces()) {
    Corners corners;
    for (const topology::VertexId v : complex.loops(face)[0]) corners.push_back(complex.position(v));
    input.joints.emplace_back(joint(corners));
  }
  return input;
}

TEST(SharedSides, TheProgramsOwnBlocks) {
  const auto u = uniform(7);
  for (int k = 0; k < 24; ++k) {
    auto input = scene(box({0, 0, 0}, {10, 10, 10}));
    for (int p = 0; p < 2 + k % 5; ++p) {
      input.joints.emplace_back(topology::PersistentJoint{{10 * u(), 10 * u(), 10 * u()},
                                                          geometry::normalized({u() - 0.5, u() - 0.5, u() - 0.5})});
    }
    const auto first = certified(input);
    const auto again = certified(read_back(first.complex(), box({0, 0, 0}, {10, 10, 10})));
    EXPECT_EQ(again.complex().blocks().size(), first.complex().blocks().size()) << k;
    EXPECT_EQ(convex_blocks(again.complex()), first.complex().blocks().size()) << k;
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

/// Discs that end in one another: concave blocks, walls that blocks on either side see in other parts.
TEST(SharedSides, TheProgramsOwnBlocksOfDiscs) {
  const auto u = uniform(22);
  for (int k = 0; k < 8; ++k) {
    auto input = scene(box({0, 0, 0}, {10, 10, 10}));
    for (int p = 0; p < 3 + k % 4; ++p) {
      const Placement at{{6 * u(), 6 * u(), 6 * u()}, 6 + 8 * u(), {10 * u(), 10 * u(), 10 * u()}};
      Corners disc;
      for (int i = 0; i < 12; ++i) disc.push_back(at({std::cos(30 * i * degree), std::sin(30 * i * degree), 0}));
      add(input, {disc});
    }
    const auto first = certified(input);
    auto again = scene(box({0, 0, 0}, {10, 10, 10}));
    std::vector<Corners> faces;
    bool holes = false;
    for (const topology::Face& face : first.complex().faces()) {
      Corners corners;
      for (const topology::VertexId v : first.complex().loops(face)[0]) corners.push_back(first.complex().position(v));
      faces.push_back(corners);
      holes = holes || first.complex().loops(face).size() > 1;
    }
    if (holes) continue;
    add(again, faces);
    const auto read = certified(again);
    EXPECT_EQ(read.complex().blocks().size(), first.complex().blocks().size()) << k;
    EXPECT_EQ(convex_blocks(read.complex()), convex_blocks(first.complex())) << k;
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

TEST(SharedSides, ARectangleInAHexahedronTurnedAlike) {
  const auto u = uniform(8);
  for (int k = 0; k < 10; ++k) {
    const Placement at{{6 * u(), 6 * u(), 6 * u()}, 10, k % 2 == 0 ? Vec3{} : Vec3{5e6, 2e6, 100}};
    std::array<Vec3, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
      corners[c] = at({c % 2 == 0 ? -1.0 : 1.0, c / 2 % 2 == 0 ? -1.0 : 1.0, c / 4 == 0 ? -1.0 : 1.0});
    }
    auto input = scene(geometry::make_hexahedron(corners).value());
    const double z = u() - 0.5, tilt = 0.3 * u();
    add(input, {{at({-1, -1, z - tilt}), at({1, -1, z + tilt}), at({1, 1, z + tilt}), at({-1, 1, z - tilt})}});
    EXPECT_EQ(count_blocks(input), 2U);
    // The same as two polygons that share a side.
    input.joints.clear();
    add(input, {{at({-1, -1, z - tilt}), at({0, -1, z}), at({0, 1, z}), at({-1, 1, z - tilt})},
                {at({0, -1, z}), at({1, -1, z + tilt}), at({1, 1, z + tilt}), at({0, 1, z})}});
    EXPECT_EQ(count_blocks(input), 2U);
  }
}

TEST(SharedSides, LongSidesAlongShortOnes) {
  // A cube: three sides whole, three of tiles, so that corners of tiles hang on the sides of the squares.
  const auto u = uniform(12);
  for (int k = 0; k < 40; ++k) {
    Placement at = turned(u);
    at.scale = std::pow(10, 6 * u() - 2);
    if (k % 4 == 0) at.shift = {5e6, -3e6, 1e3};
    const int n = 2 + k % 3;
    ClosedSet set{"cube, half of tiles", {}, 1, true};
    const ClosedSet whole = support::cube_of_squares(), tiles = support::cube_of_tiles(n);
    const auto per_side = static_cast<std::size_t>(n * n);
    for (std::size_t side = 0; side < 6; ++side) {
      if (side % 2 == 0) {
        set.polygons.push_back(whole.polygons[side]);
      } else {
        set.polygons.insert(set.polygons.end(), tiles.polygons.begin() + static_cast<std::ptrdiff_t>(side * per_side),
                            tiles.polygons.begin() + static_cast<std::ptrdiff_t>((side + 1) * per_side));
      }
    }
    expect_parts(set, at);
  }
}

TEST(SharedSides, SidesOfSeveralAlongShortOnes) {
  // Two boxes with a wall between them; the floor of the second is of tiles, whose corners hang on sides that the wall
  // and the first floor have in common.
  const auto u = uniform(14);
  for (int k = 0; k < 30; ++k) {
    Placement at = turned(u);
    at.scale = std::pow(10, 6 * u() - 2);
    const int n = 2 + k % 3;
    ClosedSet set{"two boxes", {}, 2, true};
    const auto p = [](double x, double y, double z) { return 0.5 * geometry::Vec3{x, y, z}; };
    for (const double x : {0.0, 1.0, 2.0}) set.polygons.push_back({p(x, 0, 0), p(x, 1, 0), p(x, 1, 1), p(x, 0, 1)});
    for (const double x : {0.0, 1.0}) {
      for (const double y : {0.0, 1.0}) {
        set.polygons.push_back({p(x, y, 0), p(x + 1, y, 0), p(x + 1, y, 1), p(x, y, 1)});
      }
      set.polygons.push_back({p(x, 0, 1), p(x + 1, 0, 1), p(x + 1, 1, 1), p(x, 1, 1)});
    }
    set.polygons.push_back({p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)});
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double x = 1 + static_cast<double>(i) / n, y = static_cast<double>(j) / n;
        const double to_x = 1 + static_cast<double>(i + 1) / n, to_y = static_cast<double>(j + 1) / n;
        set.polygons.push_back({p(x, y, 0), p(to_x, y, 0), p(to_x, to_y, 0), p(x, to_y, 0)});
      }
    }
    expect_parts(set, at);
  }
}

/// What is noted of joints that nearly reach one another.
topology::NearMisses near_misses(const topology::CutInput& input) {
  return certified(input).complex().report().near_misses;
}

TEST(NearMisses, ASideShortOfAFace) {
  for (const double gap : {1e-6, 1e-8, 1e-10, 1e-12}) {
    // The second ends on the first but for the gap; it reaches beyond the domain elsewhere.
    const auto input = scene(
        box({-5, -5, -5}, {5, 5, 5}),
        {rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 0.5, {gap, -9}, {9, 9}), rectangle(2, -1, {-9, -9}, {-2, 9})});
    const auto found = near_misses(input);
    EXPECT_EQ(found.sides, 1U) << gap;
    EXPECT_NEAR(found.largest.si(), gap, 1.2e-13 + 1e-3 * gap) << "but for the lattice";
    EXPECT_EQ(found.joint, topology::JointId{0U});
    EXPECT_EQ(found.other, topology::JointId{1U});
    auto snapped = input;
    snapped.snap = 1.05 * found.largest;
    EXPECT_EQ(count_blocks(input), 2U);
    EXPECT_EQ(count_blocks(snapped), 3U);
    EXPECT_EQ(near_misses(snapped).sides, 0U);
  }
}

TEST(NearMisses, OnlyWhatDoesNotTouch) {
  const auto cube = box({-5, -5, -5}, {5, 5, 5});
  const auto sides = [&](std::initializer_list<topology::Joint> joints) {
    return near_misses(scene(cube, joints)).sides;
  };
  const auto fault = rectangle(0, 0, {-9, -9}, {9, 9});
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {0, -9}, {9, 9})}), 0U) << "it ends on the fault";
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {-1e-9, -9}, {9, 9})}), 0U) << "it goes through";
  EXPECT_EQ(sides({fault, rectangle(2, 0.5, {1e-3, -9}, {9, 9})}), 0U) << "it keeps away";
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 0}), rectangle(0, 0, {-9, 1e-8}, {9, 9})}), 1U) << "in one plane";
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 0}), rectangle(0, 0, {-9, 0}, {9, 9})}), 0U) << "in one plane";
  EXPECT_EQ(sides({rectangle(2, 0, {-4, -4}, {4, 4 - 1e-9}), rectangle(1, 4, {-4, -1}, {4, 1})}), 1U);
  EXPECT_EQ(sides({rectangle(2, 0, {-4.9999999, -9}, {9, 9})}), 1U) << "of the domain's side";
  // Beyond the domain nothing is missed.
  EXPECT_EQ(sides({rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 6, {1e-9, -9}, {9, 9})}), 0U);
}

TEST(NearMisses, NotOfWhatWasCutOff) {
  // The second ends on the first; the third ends just above where the second would have gone on.
  auto input = scene(
      box({-5, -5, -5}, {5, 5, 5}),
      {rectangle(0, 0, {-9, -9}, {9, 9}), rectangle(2, 1, {-2, -9}, {9, 9}), rectangle(0, -1, {-9, 1 + 1e-8}, {9, 9})});
  EXPECT_EQ(near_misses(input).sides, 1U);
  input.terminations.push_back({topology::JointId{1U}, topology::JointId{0U}});
  EXPECT_EQ(near_misses(input).sides, 0U);
}

TEST(NearMisses, ClosedSurfacesHaveNone) {
  const auto u = uniform(13);
  for (int k = 0; k < 30; ++k) {
    const ClosedSet set = support::any_closed_set(u);
    EXPECT_EQ(near_misses(in_a_box(set, turned(u))).sides, 0U) << set.name;
  }
  // A bar with one edge taken off by 1e-7: the sides that it parts do not meet, and yet nothing is open.
  const double d = 1e-7;
  const std::vector<std::array<double, 2>> outline{{0, 0}, {0.5, 0}, {0.5, 0.5 - d}, {0.5 - d, 0.5}, {0, 0.5}};
  ClosedSet bar{"bar", {{}, {}}, 1, true};
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto [x, y] = outline[k];
    const auto [to_x, to_y] = outline[(k + 1) % outline.size()];
    bar.polygons.push_back({{x, y, 0}, {to_x, to_y, 0}, {to_x, to_y, 0.5}, {x, y, 0.5}});
    bar.polygons[0].push_back({x, y, 0});
    bar.polygons[1].push_back({x, y, 0.5});
  }
  const auto input = in_a_box(bar, turned(u));
  EXPECT_EQ(count_blocks(input), 2U);
  EXPECT_EQ(near_misses(input).sides, 0U);
}

/// Four triangles about a point.
std::vector<Corners> tetrahedron(geometry::Vec3 middle, double size) {
  const std::array corners{middle + size * geometry::Vec3{1, 1, 1}, middle + size * geometry::Vec3{1, -1, -1},
                           middle + size * geometry::Vec3{-1, 1, -1}, middle + size * geometry::Vec3{-1, -1, 1}};
  std::vector<Corners> faces;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    Corners face;
    for (std::size_t k = 0; k < 4; ++k) {
      if (k != left_out) face.push_back(corners[k]);
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

TEST(Nesting, PiecesTooCloseForDoubles) {
  // One within the other within the other, closer together than any ray in doubles can tell.
  const auto u = uniform(11);
  for (const double size : {1e-3, 1e-8, 2e-9, 5e-10, 2e-10}) {
    for (int k = 0; k < 8; ++k) {
      auto input = scene(box({0, 0, 0}, {10, 10, 10}));
      const Placement at{{6 * u(), 6 * u(), 6 * u()}, size, {1, 2, 3}};
      for (const double part : {1.0, 0.3, 0.09}) {
        add(input, placed({"tetrahedron", tetrahedron({}, part), 1, true}, at).polygons);
      }
      const auto audited = certified(input);
      ASSERT_EQ(audited.complex().blocks().size(), 4U) << size;
      std::vector<std::uint32_t> shells;
      for (const topology::Block& block : audited.complex().blocks()) shells.push_back(block.counts.shells);
      std::ranges::sort(shells);
      EXPECT_EQ(shells, (std::vector<std::uint32_t>{1, 2, 2, 2})) << size;
    }
  }
}

TEST(Nesting, PiecesBesideOneAnother) {
  // A speck just off a face of a large piece, on either side of it.
  const geometry::Vec3 middle{5, 5, 5};
  for (const double off : {-1e-3, -1e-9, -3e-10, 3e-10, 1e-9, 1e-3}) {
    for (const double size : {1e-4, 1e-10, 5e-11}) {
      auto input = scene(box({0, 0, 0}, {10, 10, 10}));
      add(input, tetrahedron(middle, 2));
      const geometry::Vec3 out = geometry::normalized({1, 1, -1});
      if (std::abs(off) < 3 * size) continue;
      add(input, tetrahedron(middle + (2 / std::sqrt(3) + off) * out, size));
      const auto audited = certified(input);
      ASSERT_EQ(audited.complex().blocks().size(), 3U) << off << ", " << size;
      std::vector<std::pair<double, std::uint32_t>> own;
      for (const topology::Block& b : audited.complex().blocks()) own.emplace_back(b.volume.si(), b.counts.shells);
      std::ranges::sort(own);
      EXPECT_EQ(own[0].second, 1U);
      EXPECT_EQ(own[1].second, off < 0 ? 2U : 1U) << off << ", " << size;
      EXPECT_EQ(own[2].second, off < 0 ? 2U : 3U) << off << ", " << size;
    }
  }
}

TEST(Lattice, JointsFarOutsideChangeNothing) {
  const auto input = [](bool far) {
    auto made = scene(box({0, 0, 0}, {10, 10, 10}),
                      {rectangle(2, 5, {-1, -1}, {11, 11}), rectangle(2, 5 + 1e-6, {-1, -1}, {11, 11})});
    if (far) {
      made.joints.emplace_back(rectangle(0, 5e8, {5e8, 5e8}, {5e8 + 10, 5e8 + 10}));
      made.joints.emplace_back(topology::PersistentJoint{{5e8, 0, 0}, {1, 0, 0}});
    }
    return made;
  };
  EXPECT_EQ(count_blocks(input(false)), 3U);
  EXPECT_EQ(count_blocks(input(true)), 3U);
  EXPECT_EQ(hash_of(input(true)), hash_of(input(false)));
}

TEST(Convex, WhereAnExcavationEndsAtAJoint) {
  auto input = scene(box({0, 0, 0}, {10, 10, 10}), {rectangle(2, 5, {-1, -1}, {11, 11})}, {box({3, 3, 5}, {7, 7, 8})});
  const auto audited = certified(input);
  ASSERT_EQ(audited.complex().blocks().size(), 2U);
  for (const topology::Block& block : audited.complex().blocks()) {
    EXPECT_EQ(block.convex, block.centroid.z < 5) << "the one below is a cuboid, whatever is on the other side";
  }
}

}  // namespace
}  // namespace cleave::testing
