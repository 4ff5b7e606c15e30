#include "cleave/geometry/predicates.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace cleave::geometry {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using exact::Sign;

Sign rational_orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const auto from_a = [&](Vec3 p) {
    return std::array<Rational, 3>{Rational(p.x) - Rational(a.x), Rational(p.y) - Rational(a.y),
                                   Rational(p.z) - Rational(a.z)};
  };
  const auto p = from_a(b), q = from_a(c), r = from_a(d);
  const Rational det =
      p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
  return exact::sign_of(det);
}

Sign rational_orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const Rational det = (Rational(b.x) - Rational(a.x)) * (Rational(c.y) - Rational(a.y)) -
                       (Rational(b.y) - Rational(a.y)) * (Rational(c.x) - Rational(a.x));
  return exact::sign_of(det);
}

double uniform(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

// Points all but on one plane: the double determinant is rounding noise, so a wrong bound or a wrong expansion shows at
// once.
TEST(PredicatesTest, SignsAreThoseOfRationalArithmeticWhereTheDeterminantCancels) {
  std::mt19937_64 bits{11};
  std::array<int, 3> seen{};
  for (int trial = 0; trial < 4000; ++trial) {
    SCOPED_TRACE(trial);
    const double offset = trial % 2 == 0 ? 0 : 5e6;
    const auto point = [&] { return Vec3{offset + uniform(bits), uniform(bits), uniform(bits)}; };
    const Vec3 a = point(), b = point(), c = point();
    const double s = uniform(bits), t = uniform(bits);
    Vec3 d = a + s * (b - a) + t * (c - a);
    if (trial % 4 < 2) d = a + 0.25 * (trial % 8) * (b - a);  // on an edge: often exactly 0
    const Sign expected = rational_orient3d(a, b, c, d);
    EXPECT_EQ(orient3d(a, b, c, d), expected);
    EXPECT_EQ(orient3d(b, a, c, d), -expected);
    EXPECT_EQ(orient3d(d, b, c, a), -expected);
    ++seen[static_cast<std::size_t>(static_cast<int>(expected) + 1)];
    const Vec2 u = drop(a, 2), v = drop(b, 2), w{u.x + s * (v.x - u.x), u.y + s * (v.y - u.y)};
    EXPECT_EQ(orient2d(u, v, w), rational_orient2d(u, v, w));
    EXPECT_EQ(orient2d(v, u, w), -orient2d(u, v, w));
  }
  for (const int count : seen) EXPECT_GT(count, 200);  // the generator itself: all three answers occur
}

TEST(PredicatesTest, ExtremesOfTheRangeNeitherOverflowNorUnderflow) {
  const double big = largest_coordinate;
  const double tiny = 1e-60;
  EXPECT_EQ(orient2d({-big, -big}, {big, big}, {tiny, 0}), Sign::negative);
  EXPECT_EQ(orient2d({-big, -big}, {big, big}, {0, tiny}), Sign::positive);
  EXPECT_EQ(orient2d({0, 0}, {tiny, tiny}, {2 * tiny, 2 * tiny}), Sign::zero);
  EXPECT_EQ(orient3d({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}), Sign::positive);
  EXPECT_EQ(orient3d({-big, 0, 0}, {big, 0, 0}, {0, big, 0}, {1, 1, -tiny}), Sign::negative);
}

TEST(PredicatesTest, SegmentsMeetAlsoAtEndsAndWhenTheyOverlap) {
  EXPECT_TRUE(segments_meet({0, 0}, {2, 2}, {0, 2}, {2, 0}));
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {1, 5}));
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {2, 0}, {3, 1}));
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {4, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {2.5, 0}, {4, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {1, 1e-300}, {1, 5}));
  EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {3, -1}, {3, 1}));
}

TEST(PredicatesTest, SegmentAndTriangle) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  EXPECT_TRUE(segment_meets_triangle({1, 1, -1}, {1, 1, 1}, a, b, c));
  EXPECT_TRUE(segment_meets_triangle({1, 1, 0}, {1, 1, 1}, a, b, c));    // ends on it
  EXPECT_TRUE(segment_meets_triangle({2, 2, -1}, {2, 2, 1}, a, b, c));   // through an edge
  EXPECT_TRUE(segment_meets_triangle({0, 0, -1}, {0, 0, 1}, a, b, c));   // through a corner
  EXPECT_TRUE(segment_meets_triangle({-1, 1, 0}, {5, 1, 0}, a, b, c));   // in its plane
  EXPECT_TRUE(segment_meets_triangle({0.5, 1, 0}, {1, 1, 0}, a, b, c));  // wholly in it
  EXPECT_FALSE(segment_meets_triangle({-1, 5, 0}, {5, 5, 0}, a, b, c));
  EXPECT_FALSE(segment_meets_triangle({2, 2.0000000000000004, -1}, {2, 2.0000000000000004, 1}, a, b, c));
  EXPECT_FALSE(segment_meets_triangle({1, 1, 1e-30}, {1, 1, 1}, a, b, c));
}

// Outlines on a lattice that cross themselves too; corners at the height of the point. Against turns about the point:
// of an outline that goes round an even number of times no point is inside.
TEST(PredicatesTest, OutlinesGoRoundWhatTheyTurnAboutAnOddNumberOfTimes) {
  std::mt19937_64 bits{5};
  const auto lattice = [&] { return static_cast<double>(bits() % 9); };
  int in = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<Vec2> outline(3 + bits() % 6);
    for (Vec2& corner : outline) corner = {lattice(), lattice()};
    const Vec2 p{lattice() + 1.0 / 3,
                 lattice()};  // on no side between lattice points but level ones and those of slope 1/3
    double turns = 0;
    bool on = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2 a = outline[i] - p, b = outline[(i + 1) % outline.size()] - p;
      on = on || segments_meet(p, p, outline[i], outline[(i + 1) % outline.size()]);
      turns += std::atan2(cross(a, b), dot(a, b));
    }
    if (on) continue;
    const bool odd = std::lround(turns / (2 * std::numbers::pi)) % 2 != 0;
    EXPECT_EQ(encloses(outline, p), odd) << trial;
    in += odd ? 1 : 0;
  }
  EXPECT_GT(in, 300);
  // Nearer to the side than doubles tell: the sign is exact.
  const std::array<Vec2, 3> thin{{{0, 0}, {3, 1}, {-1, 5}}};
  const double y = 1.0 / 3, below = std::nextafter(3 * y, 9);
  EXPECT_EQ(encloses(thin, {3 * y, y}), rational_orient2d(thin[0], thin[1], {3 * y, y}) != Sign::negative);
  EXPECT_EQ(encloses(thin, {below, y}), rational_orient2d(thin[0], thin[1], {below, y}) != Sign::negative);
}

}  // namespace
}  // namespace cleave::geometry
