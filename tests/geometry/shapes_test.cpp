#include "cleave/geometry/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace cleave::geometry {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 area_vector(const Polygon& p) {
  Vec3 sum{};
  const auto c = p.corners();
  for (std::size_t i = 1; i + 1 < c.size(); ++i) sum += cross(c[i] - c[0], c[i + 1] - c[0]);
  return sum / 2;
}
Vec3 mean(const Polygon& p) {
  Vec3 sum{};
  for (const Vec3 c : p.corners()) sum += c;
  return sum / static_cast<double>(p.corners().size());
}
const Attitude tilted{Dip::degrees(60), DipDirection::degrees(235)};
const Vec3 centre{10, -20, 30};

TEST(ShapesTest, DiscsKeepTheAreaOfTheCircleAndFaceUp) {
  for (const std::uint32_t sides : {3U, 8U, 16U, 32U, 77U}) {
    const auto d = disc(centre, tilted, metres(5), sides);
    ASSERT_TRUE(d.has_value());
    EXPECT_TRUE(d->convex());
    EXPECT_EQ(d->corners().size(), sides);
    const Vec3 area = area_vector(*d);
    EXPECT_NEAR(norm(area), pi * 25, 1e-11);
    EXPECT_NEAR(dot(normalized(area), upward_normal(tilted)), 1, 1e-14);  // counter-clockwise from above
    EXPECT_LT(norm(mean(*d) - centre), 1e-13);
    EXPECT_NEAR(dot(normalized(d->corners()[0] - centre), strike_vector(tilted.direction)), 1, 1e-14);
  }
  EXPECT_NEAR(same_area_radius(32), 1.0032, 5e-5);
}

TEST(ShapesTest, EllipsesTurnCounterClockwiseFromTheStrike) {
  const auto e = ellipse(centre, tilted, metres(4), metres(2), InPlaneRotation::degrees(30), 40);
  ASSERT_TRUE(e.has_value());
  EXPECT_NEAR(norm(area_vector(*e)), pi * 8, 1e-12);
  const Vec3 first = e->corners()[0] - centre;
  EXPECT_NEAR(norm(first), 4 * same_area_radius(40), 1e-13);
  EXPECT_NEAR(dot(normalized(first), strike_vector(tilted.direction)), std::cos(pi / 6), 1e-14);
  EXPECT_GT(first.z, 0);  // counter-clockwise from above turns the strike up the dip
}

TEST(ShapesTest, RectanglesHaveTheirSides) {
  const auto r = rectangle(centre, tilted, metres(6), metres(3));
  ASSERT_TRUE(r.has_value());
  ASSERT_EQ(r->corners().size(), 4U);
  EXPECT_NEAR(norm(area_vector(*r)), 18, 1e-13);
  EXPECT_NEAR(dot(normalized(area_vector(*r)), upward_normal(tilted)), 1, 1e-14);
  const Vec3 along = r->corners()[1] - r->corners()[0];
  EXPECT_NEAR(norm(along), 6, 1e-13);
  EXPECT_NEAR(std::abs(dot(along, strike_vector(tilted.direction))), 6, 1e-13);
  const auto upright = rectangle({0, 0, 0}, {Dip::degrees(90), DipDirection::degrees(90)}, metres(2), metres(4));
  for (const Vec3 c : upright.value().corners()) EXPECT_EQ(c.x, 0);  // vertical means vertical
}

TEST(ShapesTest, BadSizesAreNamed) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const auto d = disc(centre, tilted, metres(bad));
    ASSERT_FALSE(d.has_value());
    EXPECT_EQ(std::get<NonPositiveSize>(d.error()).what, "radius");
    EXPECT_NE(describe(d.error()).find("; "), std::string::npos);
    EXPECT_TRUE(std::holds_alternative<NonPositiveSize>(rectangle(centre, tilted, metres(1), metres(bad)).error()));
    EXPECT_TRUE(std::holds_alternative<NonPositiveSize>(ellipse(centre, tilted, metres(1), metres(bad)).error()));
  }
  EXPECT_EQ(std::get<TooFewSides>(disc(centre, tilted, metres(1), 2).error()).sides, 2U);
  const auto huge = disc(centre, tilted, metres(1e300));
  EXPECT_TRUE(std::holds_alternative<PolygonError>(huge.error()));
}

}  // namespace
}  // namespace cleave::geometry
