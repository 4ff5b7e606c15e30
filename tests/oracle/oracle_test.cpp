#include "oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "trials.hpp"

namespace cleave::oracle {
namespace {

using testing::add_closed_box;
using testing::covering_plane;
using testing::integer_box;
using testing::IntegerScene;
using testing::rectangle;

OracleBlock cube_like(int volume) { return {volume, 8, 12, 6, 6, 1, 0}; }

IntegerScene box(int x, int y, int z) {
  return {.min = {0, 0, 0}, .max = {x, y, z}, .joints = {}, .excavations = {}, .domain = {}};
}
IntegerScene box(int side) { return box(side, side, side); }

// Both ways to cut must agree on every scene they are shown.
void expect_blocks(const IntegerScene& scene, std::vector<OracleBlock> want) {
  std::ranges::sort(want);
  const auto got = oracle_blocks(scene);
  EXPECT_EQ(got, want) << "got\n" << describe(got) << "want\n" << describe(want);
  EXPECT_EQ(oracle_blocks(scene, {.outlines_cut_cells = true}), want);
}

// ---- standard scenes: joints that end, cavities, rings, excavations ----

TEST(OracleTest, BoxWithoutJointIsOneBlock) { expect_blocks(box(6), {cube_like(216)}); }

TEST(OracleTest, FullJointParts) {
  IntegerScene s = box(6);
  s.joints.push_back(rectangle(0, 3, 0, 0, 6, 6));
  expect_blocks(s, {cube_like(108), cube_like(108)});
}

TEST(OracleTest, JointThatStopsShortPartsNothing) {
  IntegerScene s = box(6);
  s.joints.push_back(rectangle(0, 3, 0, 0, 6, 5));
  expect_blocks(s, {cube_like(216)});
}

TEST(OracleTest, TwoHalfJointsMeetInAnL) {
  IntegerScene s = box(6);
  s.joints = {rectangle(0, 3, 0, 0, 3, 6), rectangle(1, 3, 0, 0, 3, 6)};
  const std::vector<OracleBlock> want{cube_like(54), {162, 12, 18, 8, 8, 1, 0}};
  expect_blocks(s, want);
  s.joints = {rectangle(0, 3, 0, 0, 5, 6), rectangle(1, 3, 0, 0, 4, 6)};  // overshoot of both
  expect_blocks(s, want);
  s.joints = {rectangle(0, 3, 0, 0, 2, 6), rectangle(1, 3, 0, 0, 3, 6)};  // a gap
  expect_blocks(s, {cube_like(216)});
}

TEST(OracleTest, CoplanarJoints) {
  IntegerScene s = box(6);
  s.joints = {rectangle(0, 3, 0, 0, 3, 6), rectangle(0, 3, 3, 0, 6, 6)};
  expect_blocks(s, {cube_like(108), cube_like(108)});
  s.joints = {rectangle(0, 3, 0, 0, 4, 6), rectangle(0, 3, 2, 0, 6, 6)};
  expect_blocks(s, {cube_like(108), cube_like(108)});
  s.joints = {rectangle(0, 3, 0, 0, 2, 6), rectangle(0, 3, 4, 0, 6, 6)};
  expect_blocks(s, {cube_like(216)});
}

TEST(OracleTest, FacesEndWhereACoplanarJointTakesOverIfAskedTo) {
  IntegerScene s = box(6);
  s.joints = {rectangle(0, 3, 0, 0, 4, 6), rectangle(0, 3, 2, 0, 6, 6)};
  const OracleBlock want{108, 10, 15, 7, 7, 1, 0};
  EXPECT_EQ(oracle_blocks(s, {.rule = FaceRule::role_and_joint}), (std::vector{want, want}));
}

TEST(OracleTest, TJunction) {
  IntegerScene s = box(6);
  s.joints = {rectangle(0, 3, 0, 0, 6, 6), rectangle(1, 3, 0, 0, 3, 6)};
  expect_blocks(s, {cube_like(54), cube_like(54), cube_like(108)});
}

TEST(OracleTest, ThreeFullJointsMakeEight) {
  IntegerScene s = box(6);
  for (int axis = 0; axis < 3; ++axis) s.joints.push_back(rectangle(axis, 3, 0, 0, 6, 6));
  expect_blocks(s, std::vector(8, cube_like(27)));
}

TEST(OracleTest, ClosedBoxesOfJoints) {
  IntegerScene s = box(6);
  add_closed_box(s, {2, 2, 2}, {4, 4, 4});
  expect_blocks(s, {cube_like(8), {208, 16, 24, 12, 12, 2, 0}});

  s = box(8);
  add_closed_box(s, {1, 1, 1}, {7, 7, 7});
  add_closed_box(s, {3, 3, 3}, {5, 5, 5});
  expect_blocks(s, {cube_like(8), {208, 16, 24, 12, 12, 2, 0}, {296, 16, 24, 12, 12, 2, 0}});

  s = box(8);
  add_closed_box(s, {1, 1, 1}, {3, 3, 3});
  add_closed_box(s, {5, 5, 5}, {7, 7, 7});
  expect_blocks(s, {cube_like(8), cube_like(8), {496, 24, 36, 18, 18, 3, 0}});
}

TEST(OracleTest, RingOfJointsWithAndWithoutMembrane) {
  IntegerScene s = box(8, 8, 6);
  for (const int z : {2, 4}) {
    s.joints.push_back(rectangle(2, z, 1, 1, 7, 3));
    s.joints.push_back(rectangle(2, z, 1, 5, 7, 7));
    s.joints.push_back(rectangle(2, z, 1, 3, 3, 5));
    s.joints.push_back(rectangle(2, z, 5, 3, 7, 5));
  }
  for (const int axis : {0, 1}) {
    for (const int at : {1, 7}) s.joints.push_back(rectangle(axis, at, 1, 2, 7, 4));
    for (const int at : {3, 5}) s.joints.push_back(rectangle(axis, at, 3, 2, 5, 4));
  }
  const std::vector<OracleBlock> want{{64, 16, 24, 10, 12, 1, 1}, {320, 24, 36, 16, 18, 2, 1}};
  expect_blocks(s, want);
  s.joints.push_back(rectangle(2, 3, 3, 3, 5, 5));  // a membrane over the hole: no free edge, yet it parts nothing
  expect_blocks(s, want);
}

TEST(OracleTest, Excavations) {
  const auto expect_one = [](int side, std::vector<testing::IntegerSolid> voids, const OracleBlock& want) {
    IntegerScene s = box(side);
    s.excavations = std::move(voids);
    expect_blocks(s, {want});
  };
  expect_one(6, {integer_box({2, 2, 0}, {4, 4, 6})}, {192, 16, 24, 10, 12, 1, 1});  // shaft right through
  expect_one(6, {integer_box({2, 2, -2}, {4, 4, 9})}, {192, 16, 24, 10, 12, 1, 1});
  expect_one(6, {integer_box({2, 2, 2}, {4, 4, 6})}, {200, 16, 24, 11, 12, 1, 0});  // blind shaft
  expect_one(6, {integer_box({2, 2, 2}, {4, 4, 4})}, {208, 16, 24, 12, 12, 2, 0});  // cavern
  expect_one(6, {integer_box({2, 0, 2}, {4, 6, 4}), integer_box({0, 2, 2}, {6, 4, 4})},
             {176, 32, 48, 16, 20, 1, 3});  // cross
  expect_one(6, {integer_box({2, 0, 2}, {4, 4, 4}), integer_box({0, 2, 2}, {6, 4, 4})},
             {184, 24, 36, 13, 16, 1, 2});  // T
  expect_one(8, {integer_box({3, 0, 1}, {5, 8, 3}), integer_box({0, 3, 5}, {8, 5, 7})},
             {448, 24, 36, 14, 18, 1, 2});                                          // two levels
  expect_one(6, {integer_box({2, 0, 0}, {4, 6, 2})}, {192, 16, 24, 10, 10, 1, 0});  // trench
  expect_one(5, {integer_box({1, 1, 0}, {2, 2, 5}), integer_box({2, 2, 0}, {3, 3, 5})},
             {115, 24, 36, 14, 16, 1, 1});  // touch along an edge: counted once a fan
}

TEST(OracleTest, ExcavationThatSwallowsTheDomainLeavesNothing) {
  IntegerScene s = box(4);
  s.excavations = {integer_box({-1, -1, -1}, {5, 5, 5})};
  EXPECT_TRUE(oracle_blocks(s).empty());
}

TEST(OracleTest, ConcaveDomain) {  // L-prism of volume 3, twice its size
  IntegerScene s = box(4, 4, 2);
  testing::IntegerSolid l{{{0, 0, 0},
                           {4, 0, 0},
                           {4, 2, 0},
                           {2, 2, 0},
                           {2, 4, 0},
                           {0, 4, 0},
                           {0, 0, 2},
                           {4, 0, 2},
                           {4, 2, 2},
                           {2, 2, 2},
                           {2, 4, 2},
                           {0, 4, 2}},
                          {{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}}};
  for (std::uint32_t i = 0; i < 6; ++i) l.faces.push_back({i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6});
  s.domain = l;
  expect_blocks(s, {{24, 12, 18, 8, 8, 1, 0}});
  // Closes one arm in the plane of a domain side: the other block has two faces there, one joint and one fixed.
  s.joints = {rectangle(0, 2, 0, 0, 2, 2)};
  expect_blocks(s, {cube_like(8), {16, 10, 15, 7, 7, 1, 0}});
}

// ---- persistent planes with known counts and volumes ----

std::map<Rational, int> volumes(const IntegerScene& scene) {
  std::map<Rational, int> out;
  for (const OracleBlock& b : oracle_blocks(scene)) {
    ++out[b.volume];
    EXPECT_EQ(b.genus, 0U);
    EXPECT_EQ(b.shells, 1U);
    EXPECT_EQ(b.loops, b.faces);
  }
  return out;
}

IntegerScene unit_cube() {
  return {.min = {-1, -1, -1}, .max = {1, 1, 1}, .joints = {}, .excavations = {}, .domain = {}};
}
void add_plane(IntegerScene& s, testing::IntegerPoint normal, testing::IntegerPoint through = {0, 0, 0}) {
  s.joints.push_back(covering_plane(through, normal, 8));
}
void add_mirrors(IntegerScene& s) {
  for (const int sign : {1, -1}) {
    add_plane(s, {1, sign, 0});
    add_plane(s, {0, 1, sign});
    add_plane(s, {sign, 0, 1});
  }
}
void add_axes(IntegerScene& s) {
  for (const testing::IntegerPoint n : {testing::IntegerPoint{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) add_plane(s, n);
}
void add_diagonals(IntegerScene& s) {
  for (const int a : {1, -1}) {
    for (const int b : {1, -1}) add_plane(s, {1, a, b});
  }
}
using Table = std::map<Rational, int>;

TEST(OracleTest, MirrorPlanesOfACube) {
  IntegerScene s = unit_cube();
  add_mirrors(s);
  EXPECT_EQ(volumes(s), (Table{{Rational(1, 3), 24}}));
  add_axes(s);
  EXPECT_EQ(volumes(s), (Table{{Rational(1, 6), 48}}));
  add_diagonals(s);
  EXPECT_EQ(volumes(s), (Table{{Rational(1, 12), 96}}));
  s = unit_cube();
  add_diagonals(s);
  EXPECT_EQ(volumes(s), (Table{{Rational(1, 2), 8}, {Rational(2, 3), 6}}));
}

TEST(OracleTest, Cuboctahedron) {
  IntegerScene s = unit_cube();
  for (const int sign : {2, -2}) {
    for (const int a : {1, -1}) {
      for (const int b : {1, -1}) add_plane(s, {1, a, b}, {sign, 0, 0});
    }
  }
  EXPECT_EQ(volumes(s), (Table{{Rational(20, 3), 1}, {Rational(1, 6), 8}}));
}

TEST(OracleTest, PlanesInGeneralPosition) {  // 1 + n + C(n, 2) + C(n, 3) when all points lie inside
  IntegerScene s{.min = {-900, -900, -900}, .max = {900, 900, 900}, .joints = {}, .excavations = {}, .domain = {}};
  const std::array<std::size_t, 7> want{1, 2, 4, 8, 15, 26, 42};
  for (int k = 0; k < 7; ++k) {
    const auto blocks = oracle_blocks(s);
    EXPECT_EQ(blocks.size(), want[static_cast<std::size_t>(k)]) << k;
    EXPECT_EQ(std::accumulate(blocks.begin(), blocks.end(), Rational{0},
                              [](Rational sum, const OracleBlock& b) { return sum + b.volume; }),
              Rational{1800} * 1800 * 1800);
    static constexpr std::array<testing::IntegerPoint, 6> normals{
        {{7, 1, -2}, {-1, 8, 3}, {2, -3, 7}, {5, 5, 4}, {-6, 4, 5}, {4, -5, 6}}};
    if (k < 6) s.joints.push_back(covering_plane({k, 2 - k, k * k % 5}, normals[static_cast<std::size_t>(k)], 2000));
  }
}

// ---- published networks ----

TEST(OracleTest, BerreCase2) {  // unit cube x 8
  IntegerScene s = box(8);
  s.joints = {rectangle(0, 4, 0, 0, 8, 8), rectangle(1, 4, 0, 0, 8, 8), rectangle(2, 4, 0, 0, 8, 8),
              rectangle(0, 6, 4, 4, 8, 8), rectangle(2, 6, 4, 4, 8, 8), rectangle(1, 6, 4, 4, 8, 8),
              rectangle(1, 5, 4, 4, 6, 6), rectangle(0, 5, 4, 4, 6, 6), rectangle(2, 5, 4, 4, 6, 6)};
  EXPECT_EQ(volumes(s), (Table{{64, 7}, {8, 7}, {1, 8}}));
}

TEST(OracleTest, BerreCase3) {  // x 100
  IntegerScene s = box(100, 225, 100);
  s.joints = {{{5, 25, 50}, {95, 25, 50}, {95, 200, 50}, {5, 200, 50}},
              {{50, 5, 95}, {50, 5, 5}, {50, 30, 5}, {50, 30, 95}},
              {{5, 100, 50}, {95, 100, 50}, {95, 220, 85}, {5, 220, 85}},
              {{5, 100, 48}, {95, 100, 48}, {95, 220, 14}, {5, 220, 14}},
              {{23, 190, 30}, {23, 190, 70}, {17, 220, 70}, {17, 220, 30}},
              {{17, 190, 30}, {17, 190, 70}, {23, 220, 70}, {23, 220, 30}},
              {{77, 190, 30}, {77, 190, 70}, {77, 220, 70}, {77, 220, 30}},
              {{83, 190, 30}, {83, 190, 70}, {83, 220, 70}, {83, 220, 30}}};
  expect_blocks(s, {cube_like(2250000)});
}

TEST(OracleTest, FourUserRectangles) {  // dfnWorks, box of side 1 about the origin x 10
  IntegerScene s{.min = {-5, -5, -5}, .max = {5, 5, 5}, .joints = {}, .excavations = {}, .domain = {}};
  s.joints = {rectangle(2, 0, -10, -6, 2, 6), rectangle(0, 0, -10, -7, 10, 7), rectangle(2, 2, -2, -6, 10, 6),
              rectangle(2, -2, -2, -6, 10, 6)};
  EXPECT_EQ(volumes(s), (Table{{150, 2}, {200, 1}, {250, 2}}));
}

// ---- the oracle against itself, and its generator ----

testing::Choose choose_from(std::mt19937_64& bits) {  // no std:: distribution: the same scenes on every library
  return [&bits](std::int32_t lo, std::int32_t hi) {
    return lo + static_cast<std::int32_t>(bits() % static_cast<std::uint64_t>(hi - lo + 1));
  };
}

TEST(OracleTest, BothWaysToCutAgreeOnRandomScenes) {
  std::mt19937_64 bits{20240301};
  const int count = testing::trials(240, 40);
  int several = 0, shells = 0, genus = 0, with_holes = 0, small = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const IntegerScene scene = testing::make_integer_scene(choose_from(bits), {.max_joints = 9, .max_excavations = 1});
    const auto blocks = oracle_blocks(scene);
    ASSERT_EQ(blocks, oracle_blocks(scene, {.outlines_cut_cells = true})) << testing::describe(scene);
    several += blocks.size() > 2 ? 1 : 0;
    for (const OracleBlock& b : blocks) {
      shells += b.shells > 1 ? 1 : 0;
      genus += b.genus > 0 ? 1 : 0;
      with_holes += b.loops != b.faces ? 1 : 0;
      small += b.volume < 1 ? 1 : 0;
    }
  }
  // What the generator is for: it must keep making the hard cases.
  if (count < 200) return;  // too few to judge the generator by
  EXPECT_GT(several, count / 5);
  EXPECT_GT(shells, count / 30);
  EXPECT_GT(genus, count / 150);
  EXPECT_GT(with_holes, count / 15);
  EXPECT_GT(small, count / 10);
}

TEST(OracleTest, MapsOfSpaceKeepTheBlocks) {
  std::mt19937_64 bits{7};
  for (int trial = 0; trial < testing::trials(100, 15); ++trial) {
    SCOPED_TRACE(trial);
    IntegerScene scene = testing::make_integer_scene(choose_from(bits));
    const auto blocks = oracle_blocks(scene);
    EXPECT_EQ(oracle_blocks(testing::axes_rotated(scene)), blocks) << testing::describe(scene);
    EXPECT_EQ(oracle_blocks(testing::axes_swapped(scene)), blocks) << testing::describe(scene);
    EXPECT_EQ(oracle_blocks(testing::translated(scene, {5, -7, 3})), blocks) << testing::describe(scene);
    std::ranges::reverse(scene.joints);
    EXPECT_EQ(oracle_blocks(scene), blocks) << testing::describe(scene);
  }
}

TEST(IntegerSceneTest, PolygonsAreChecked) {
  using testing::is_valid_polygon;
  EXPECT_TRUE(is_valid_polygon({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}));
  EXPECT_FALSE(is_valid_polygon({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}));                        // no area
  EXPECT_FALSE(is_valid_polygon({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 1}}));             // not planar
  EXPECT_FALSE(is_valid_polygon({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}}));             // crosses itself
  EXPECT_FALSE(is_valid_polygon({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}));  // touches itself
  EXPECT_FALSE(is_valid_polygon({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {0, 4, 0}}));             // folds back
  EXPECT_TRUE(is_valid_polygon({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 2, 0}, {2, 4, 0}, {0, 4, 0}}));
}

}  // namespace
}  // namespace cleave::oracle
