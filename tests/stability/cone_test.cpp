#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/stability/block_theory.hpp"
#include "handmade.hpp"
#include "oracles.hpp"

namespace cleave::stability {
namespace {

using exact::Int128;
using exact::Sign;
using handmade::direction;
using handmade::upward;

Direction integer(std::int64_t x, std::int64_t y, std::int64_t z) { return Direction::make({x, y, z}).value(); }

TEST(DirectionTest, EqualDirectionsHaveEqualComponents) {
  EXPECT_EQ(integer(2, 4, -6), integer(5, 10, -15));
  EXPECT_NE(integer(2, 4, -6), integer(-5, -10, 15));
  EXPECT_TRUE(integer(2, 4, -6).opposite_to(integer(-5, -10, 15)));
  EXPECT_EQ(integer(0, 0, -7).components(), (Direction::Components{0, 0, -1}));
  EXPECT_EQ(integer(2, 4, -6).opposite(), integer(-1, -2, 3));
  const Int128 big = Int128{1} << 103;
  EXPECT_EQ(Direction::make({big, big, 0}).value(), integer(1, 1, 0));
  EXPECT_EQ(Direction::make({3 * (big / 8), 0, 9 * (big / 8)}).value(), integer(1, 0, 3));
  EXPECT_FALSE(Direction::make({0, 0, 0}).has_value());
  EXPECT_FALSE(Direction::make({big * 2, 0, 0}).has_value());
}

// Planes through different points of a common lattice, some parallel by construction.
TEST(DirectionTest, ParallelPlanesOfTheLatticeHaveOneDirection) {
  Rng rng{11};
  for (int trial = 0; trial < 2000; ++trial) {
    const auto site = [&](std::int64_t reach) {
      return exact::LatticePoint{rng.between(-reach, reach), rng.between(-reach, reach), rng.between(-reach, reach)};
    };
    const std::int64_t reach = trial % 2 == 0 ? 3 : std::int64_t{1} << 45;
    const auto a = site(reach), b = site(reach), c = site(reach), shift = site(reach);
    const auto plane = exact::Plane::through(a, b, c);
    if (!plane) continue;
    const auto moved = exact::Plane::through(a + shift, c + shift, c + c - b + shift);
    ASSERT_TRUE(moved.has_value());
    EXPECT_TRUE(Direction::normal_of(*plane) == Direction::normal_of(*moved) ||
                Direction::normal_of(*plane).opposite_to(Direction::normal_of(*moved)));
    const auto n = plane->unit_normal();
    EXPECT_NEAR(geometry::norm(Direction::normal_of(*plane).unit() - geometry::Vec3{n[0], n[1], n[2]}), 0, 1e-15);
  }
}

TEST(DirectionTest, OrientationIsExactWhereDoublesCancel) {
  Rng rng{12};
  int zero = 0;
  int turned = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const std::int64_t reach = std::int64_t{1} << (trial % 2 == 0 ? 20 : 50);
    std::array<Int128, 3> a{}, b{};
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = rng.between(-reach, reach);
      b[i] = rng.between(-reach, reach);
    }
    const std::int64_t p = rng.between(-1000, 1000), q = rng.between(-1000, 1000);
    std::array<Int128, 3> c{p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2]};
    const auto da = Direction::make(a), db = Direction::make(b), dc = Direction::make(c);
    if (!da || !db || !dc) continue;
    EXPECT_EQ(orientation(*da, *db, *dc), Sign::zero);
    ++zero;
    // One step along z: the sign is that of the minor (a x b)_z.
    c[2] += 1;
    const auto dd = Direction::make(c);
    const Int128 minor = a[0] * b[1] - a[1] * b[0];
    EXPECT_EQ(orientation(*da, *db, *dd), exact::sign_of(minor));
    EXPECT_EQ(orientation(*db, *da, *dd), -exact::sign_of(minor));
    turned += minor != 0;
  }
  EXPECT_GT(zero, 2900);
  EXPECT_GT(turned, 2900);
}

TEST(ConeTest, EqualNormalsAreOneGroupAntiparallelStayTwo) {
  const std::vector rows{integer(0, 0, 2), integer(1, 0, 0), integer(0, 0, 5), integer(0, 0, -1), integer(3, 0, 0)};
  const Cone cone{rows};
  ASSERT_EQ(cone.groups().size(), 3U);
  EXPECT_EQ(std::vector(cone.group_of_row().begin(), cone.group_of_row().end()),
            (std::vector<std::uint32_t>{0, 1, 0, 2, 1}));
}

TEST(ConeTest, DimensionOfSimpleContacts) {
  const auto dimension = [](const std::vector<Direction>& rows) { return int{Cone{rows}.dimension()}; };
  const auto e = integer(1, 0, 0), w = integer(-1, 0, 0), n = integer(0, 1, 0), s = integer(0, -1, 0),
             up = integer(0, 0, 1), down = integer(0, 0, -1);
  EXPECT_EQ(dimension({}), 3);
  EXPECT_EQ(dimension({up}), 3);
  EXPECT_EQ(dimension({up, down}), 2);           // slot
  EXPECT_EQ(dimension({up, e}), 3);              // edge
  EXPECT_EQ(dimension({up, down, e}), 2);        // slot with a back
  EXPECT_EQ(dimension({up, down, e, w}), 1);     // drawer open at both ends
  EXPECT_EQ(dimension({up, down, e, n, s}), 1);  // cube in a wall: K is the ray (1, 0, 0)
  EXPECT_EQ(dimension({up, down, e, w, n}), 1);
  EXPECT_EQ(dimension({up, down, e, w, n, s}), 0);
  EXPECT_EQ(dimension({integer(1, 0, 0), integer(-1, 2, 0), integer(-1, -2, 0)}),
            1);  // triangular prism: along its axis only
  EXPECT_EQ(dimension({direction(upward(60, 0)), direction(upward(60, 120)), direction(upward(60, 240))}), 3);
  EXPECT_EQ(dimension({integer(1, 1, -1), integer(-1, 1, -1), integer(0, -1, -1), integer(0, 0, 1)}), 0);
}

// Normals with components -1, 0, 1, all small cones.
TEST(ConeTest, DimensionAgreesWithExhaustionOverSmallVectors) {
  Rng rng{13};
  std::array<int, 4> seen{};
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<std::array<int, 3>> normals;
    std::vector<Direction> rows;
    const auto count = rng.between(1, 7);
    const bool flat = rng.between(0, 2) == 0;  // all in one plane
    while (static_cast<std::int64_t>(rows.size()) < count) {
      const auto c = [&] { return static_cast<int>(rng.between(-1, 1)); };
      std::array n{c(), c(), c()};
      if (flat) n[2] = -n[0] - n[1];
      if (n == std::array{0, 0, 0}) continue;
      normals.push_back(n);
      rows.push_back(integer(n[0], n[1], n[2]));
    }
    const int expected = stability_oracle::dimension_by_exhaustion(normals);
    ++seen[static_cast<std::size_t>(expected)];
    ASSERT_EQ(int{Cone{rows}.dimension()}, expected) << "trial " << trial;
  }
  for (const int n : seen) EXPECT_GT(n, 100);
}

// n planes in general position, all 2^n choices of sides: n^2 - n + 2 joint pyramids are not empty.
TEST(ConeTest, CountsOfTaperedPyramids) {
  Rng rng{14};
  for (std::size_t n = 2; n <= 7; ++n) {
    std::vector<Direction> base;
    for (std::size_t i = 0; i < n; ++i) base.push_back(direction({rng.normal(), rng.normal(), rng.normal()}));
    std::size_t tapered = 0;
    for (std::size_t sides = 0; sides < std::size_t{1} << n; ++sides) {
      std::vector<Direction> rows;
      for (std::size_t i = 0; i < n; ++i) rows.push_back((sides >> i & 1) != 0 ? base[i] : base[i].opposite());
      const int dimension = Cone{rows}.dimension();
      EXPECT_TRUE(dimension == 0 || dimension == 3);
      tapered += dimension == 0;
    }
    EXPECT_EQ(tapered, (std::size_t{1} << n) - (n * n - n + 2)) << n;
  }
}

}  // namespace
}  // namespace cleave::stability
