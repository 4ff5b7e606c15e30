#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "closed_scenes.hpp"

// Surfaces that are closed on paper part the rock when they come in rounded doubles, at any place, turn and size.

namespace cleave::testing {
namespace {

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

/// Some thirty planes meet in each corner there, nearly all by a rounding: what that costs grows with their square.
TEST(SharedSides, TheProgramsOwnBlocksCostNoCube) {
  const auto u = uniform(11);
  auto input = scene(box({0, 0, 0}, {10, 10, 10}));
  for (int p = 0; p < 12; ++p) {
    input.joints.emplace_back(topology::PersistentJoint{{10 * u(), 10 * u(), 10 * u()},
                                                        geometry::normalized({u() - 0.5, u() - 0.5, u() - 0.5})});
  }
  const auto first = certified(input);
  const auto again = read_back(first.complex(), box({0, 0, 0}, {10, 10, 10}));
  const auto read = certified(again);
  EXPECT_EQ(read.complex().blocks().size(), first.complex().blocks().size());
  EXPECT_LT(read.complex().report().predicate_calls, 7500 * first.complex().faces().size());
  const auto parallel = topology::cut(again, {.threads = 7}).value();
  EXPECT_EQ(canonical_hash(parallel), canonical_hash(read.complex()));
  EXPECT_EQ(parallel.report().predicate_calls, read.complex().report().predicate_calls);
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

}  // namespace
}  // namespace cleave::testing
