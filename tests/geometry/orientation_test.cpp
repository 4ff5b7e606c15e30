#include "cleave/geometry/orientation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace cleave::geometry {
namespace {

Attitude plane(double dip, double direction) { return {Dip::degrees(dip), DipDirection::degrees(direction)}; }
LineAttitude line(double trend, double plunge) { return {Trend::degrees(trend), Plunge::degrees(plunge)}; }

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(OrientationTest, QuarterTurnsAreExact) {
  EXPECT_EQ(upward_normal(plane(90, 90)), (Vec3{1, 0, 0}));
  EXPECT_EQ(upward_normal(plane(90, 180)), (Vec3{0, -1, 0}));
  EXPECT_EQ(upward_normal(plane(0, 37)), (Vec3{0, 0, 1}));
  EXPECT_EQ(dip_vector(plane(90, 270)), (Vec3{0, 0, -1}));
  EXPECT_EQ(dip_vector(plane(0, 270)), (Vec3{-1, 0, 0}));
  EXPECT_EQ(strike_vector(DipDirection::degrees(90)), (Vec3{0, 1, 0}));  // strike 000
  EXPECT_EQ(sin_degrees(30), -sin_degrees(210));
  EXPECT_EQ(sin_degrees(45), cos_degrees(45));
  for (int a = -720; a <= 720; a += 90) {
    EXPECT_EQ(sin_degrees(a), std::round(std::sin(a * M_PI / 180)));
    EXPECT_EQ(cos_degrees(a), std::round(std::cos(a * M_PI / 180)));
  }
}

TEST(OrientationTest, FormulasOfTheTheory) {
  // 60/045: N = (sin 60 sin 45, sin 60 cos 45, cos 60)
  expect_near(upward_normal(plane(60, 45)), {std::sqrt(0.375), std::sqrt(0.375), 0.5}, 1e-15);
  expect_near(dip_vector(plane(60, 45)), {std::sqrt(0.125), std::sqrt(0.125), -std::sqrt(0.75)}, 1e-15);
  // planes 60/045 and 60/135 meet along (sqrt .4, 0, -sqrt .6)
  const Vec3 along = normalized(cross(upward_normal(plane(60, 45)), upward_normal(plane(60, 135))));
  expect_near(along.z > 0 ? -along : along, {std::sqrt(0.4), 0, -std::sqrt(0.6)}, 1e-15);
  const LineAttitude wedge = line_attitude_of({std::sqrt(0.4), 0, -std::sqrt(0.6)});
  EXPECT_NEAR(wedge.trend.degrees(), 90, 1e-12);
  EXPECT_NEAR(wedge.plunge.degrees(), 50.768479516407744, 1e-12);
}

TEST(OrientationTest, VectorsFormAFrameAndTurnBack) {
  int planes = 0;
  for (double dip = 0.5; dip < 90; dip += 7.3) {
    for (double direction = 0; direction < 360; direction += 11.7) {
      const Attitude a = plane(dip, direction);
      const Vec3 n = upward_normal(a), d = dip_vector(a), s = strike_vector(a.direction);
      EXPECT_NEAR(norm(n), 1, 1e-15);
      expect_near(cross(n, s), -d, 1e-15);
      EXPECT_LT(d.z, 0);
      for (const Vec3 given : {n, -n, 1e-200 * n, -1e200 * n}) {
        const Attitude back = attitude_of(given);
        EXPECT_NEAR(back.dip.degrees(), dip, 1e-12);
        EXPECT_NEAR(back.direction.degrees(), direction, 1e-11);
      }
      const LineAttitude pole = pole_of(a);
      expect_near(line_vector(pole), -n, 1e-15);
      const LineAttitude back = line_attitude_of(line_vector(line(direction, dip - 45)));
      EXPECT_NEAR(back.trend.degrees(), direction, 1e-11);
      EXPECT_NEAR(back.plunge.degrees(), dip - 45, 1e-12);
      ++planes;
    }
  }
  EXPECT_EQ(planes, 13 * 31);
  EXPECT_EQ(attitude_of({0, 0, -2}), plane(0, 0));
  EXPECT_EQ(attitude_of({0, 3, 0}), plane(90, 0));
  EXPECT_EQ(line_attitude_of({0, 0, 1}), line(0, -90));
}

TEST(OrientationTest, StrikeFollowsTheRightHandRule) {
  EXPECT_EQ(dip_direction_of(Strike::degrees(300)).degrees(), 30);
  EXPECT_EQ(strike_of(DipDirection::degrees(30)).degrees(), 300);
  // y axis to true north is 10 degrees clockwise: a plane dipping to true north dips 10 degrees clockwise of y
  EXPECT_EQ(from_true_north(DipDirection::degrees(355), North::degrees(10)).degrees(), 5);
  EXPECT_EQ(to_true_north(DipDirection::degrees(5), North::degrees(10)).degrees(), 355);
  EXPECT_EQ(wrap_degrees(-1e-20), 0);
  EXPECT_EQ(wrap_degrees(360), 0);
  EXPECT_EQ(wrap_degrees(-90), 270);
}

TEST(StereonetTest, RadiiOfBothNets) {
  struct Row {
    double plunge, area, angle;
  };
  constexpr std::array rows{Row{0, 1, 1}, Row{30, 0.707106781187, 0.577350269190},
                            Row{45, 0.541196100146, 0.414213562373}, Row{60, 0.366025403784, 0.267949192431},
                            Row{90, 0, 0}};
  for (const auto& [plunge, area, angle] : rows) {
    for (const double trend : {0.0, 40.0, 90.0, 200.0, 310.0}) {
      const NetPoint a = project(line(trend, plunge), Net::equal_area);
      const NetPoint b = project(line_vector(line(trend, plunge)), Net::equal_angle);
      EXPECT_NEAR(std::hypot(a.x, a.y), area, 1e-12);
      EXPECT_NEAR(std::hypot(b.x, b.y), angle, 1e-12);
      EXPECT_NEAR(a.x, area * std::sin(trend * M_PI / 180), 1e-12);
      EXPECT_NEAR(b.y, angle * std::cos(trend * M_PI / 180), 1e-12);
    }
  }
}

TEST(StereonetTest, LinesThatPointUpAreTurnedRound) {
  const NetPoint up = project(line(40, -30), Net::equal_area);
  const NetPoint down = project(line(220, 30), Net::equal_area);
  EXPECT_NEAR(up.x, down.x, 1e-15);
  EXPECT_NEAR(up.y, down.y, 1e-15);
}

TEST(StereonetTest, GreatCirclesAreCirclesOnTheEqualAngleNet) {
  // Wulff: centre at tan(dip) against the dip direction, radius 1 / cos(dip).
  const auto arc = great_circle(plane(50, 70), Net::equal_angle, 36);
  ASSERT_EQ(arc.size(), 37U);
  const double t = 250 * M_PI / 180, c = std::tan(50 * M_PI / 180);
  for (const NetPoint& p : arc) {
    EXPECT_NEAR(std::hypot(p.x - c * std::sin(t), p.y - c * std::cos(t)), 1 / std::cos(50 * M_PI / 180), 1e-12);
    EXPECT_LE(std::hypot(p.x, p.y), 1 + 1e-12);
  }
  const NetPoint steepest = project(line(70, 50), Net::equal_angle);
  EXPECT_NEAR(arc[18].x, steepest.x, 1e-12);
  EXPECT_NEAR(arc[18].y, steepest.y, 1e-12);
}

}  // namespace
}  // namespace cleave::geometry
