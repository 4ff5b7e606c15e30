#include "stereonet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cleave::report {
namespace {

using geometry::Vec3;

constexpr double to_radians = std::numbers::pi / 180;

Vec3 line(double trend, double plunge) {
  const double t = trend * to_radians, p = plunge * to_radians;
  return {std::cos(p) * std::sin(t), std::cos(p) * std::cos(t), -std::sin(p)};
}
Vec3 normal(double dip, double dip_direction) {
  const double d = dip * to_radians, a = dip_direction * to_radians;
  return {std::sin(d) * std::sin(a), std::sin(d) * std::cos(a), std::cos(d)};
}

// Distances from the centre of both nets, to the digits of the tables.
TEST(Stereonet, DistancesOfBothNets) {
  struct Row {
    double plunge, area, angle;
  };
  for (const Row& row : {Row{30, 0.707106781187, 0.577350269190}, Row{45, 0.541196100146, 0.414213562373},
                         Row{60, 0.366025403784, 0.267949192431}, Row{0, 1, 1}}) {
    for (const double trend : {0.0, 37.0, 90.0, 200.0, 300.0}) {
      const NetPoint area = project(line(trend, row.plunge), Net::equal_area);
      const NetPoint angle = project(line(trend, row.plunge), Net::equal_angle);
      EXPECT_NEAR(std::hypot(area.x, area.y), row.area, 1e-12);
      EXPECT_NEAR(std::hypot(angle.x, angle.y), row.angle, 1e-12);
      if (row.plunge > 0) {
        EXPECT_NEAR(area.x, row.area * std::sin(trend * to_radians), 1e-11);
        EXPECT_NEAR(area.y, row.area * std::cos(trend * to_radians), 1e-11);
      }
    }
  }
}

// The pole of a plane lies opposite to its dip direction, 90 - dip below the horizon.
TEST(Stereonet, PolesLieOppositeToTheDipDirection) {
  const NetPoint pole = project(normal(60, 90), Net::equal_angle);
  EXPECT_NEAR(pole.x, -std::tan(30 * to_radians), 1e-12);
  EXPECT_NEAR(pole.y, 0, 1e-12);
  const NetPoint turned = project(-normal(60, 90), Net::equal_angle);
  EXPECT_NEAR(turned.x, pole.x, 1e-15);
}

// In the equal-angle net a great circle is a circle of radius 1/cos(dip) about (tan(dip), 0) turned to the side away
// from the dip.
TEST(Stereonet, GreatCirclesAreCirclesInTheEqualAngleNet) {
  const double dip = 50, direction = 130;
  const Vec3 towards = line(direction, 0);
  const double t = std::tan(dip * to_radians);
  const auto points = great_circle(normal(dip, direction), Net::equal_angle, 41);
  for (const NetPoint& p : points) {
    EXPECT_NEAR(std::hypot(p.x + t * towards.x, p.y + t * towards.y), 1 / std::cos(dip * to_radians), 1e-9);
  }
  EXPECT_NEAR(std::hypot(points.front().x, points.front().y), 1, 1e-12);
  EXPECT_NEAR(std::hypot(points.back().x, points.back().y), 1, 1e-12);
  const NetPoint middle = points[20];
  const NetPoint dip_line = project(line(direction, dip), Net::equal_angle);
  EXPECT_NEAR(middle.x, dip_line.x, 1e-12);
  EXPECT_NEAR(middle.y, dip_line.y, 1e-12);
}

TEST(Stereonet, MeanOfAxesHasNoSense) {
  // Near-vertical joints on both sides of the vertical: a mean of vectors would fail.
  const std::vector<Vec3> poles{normal(88, 90), normal(88, 270), -normal(86, 90), normal(86, 270)};
  const MeanPole mean = mean_of(poles);
  EXPECT_NEAR(mean.dip_degrees, 90, 1e-9);
  EXPECT_NEAR(std::abs(mean.normal.x), 1, 1e-12);
  const MeanPole one = mean_of(std::vector<Vec3>{normal(35, 210)});
  EXPECT_NEAR(one.dip_degrees, 35, 1e-9);
  EXPECT_NEAR(one.dip_direction_degrees, 210, 1e-9);
  EXPECT_TRUE(std::isinf(one.kappa));
}

TEST(Stereonet, DrawingIsTheSameTwice) {
  const std::vector<Pole> poles{{normal(30, 40), 0}, {normal(70, 200), 1}};
  const std::vector<NetSet> sets{{"A", 1}, {"B", 1}};
  const std::string svg = stereonet_svg(poles, sets, Net::equal_area, 0);
  EXPECT_EQ(svg, stereonet_svg(poles, sets, Net::equal_area, 0));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg, stereonet_svg(poles, sets, Net::equal_angle, 0));
}

}  // namespace
}  // namespace cleave::report
