#include "cleave/geometry/terrain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

// Volumes that cuts take out of a box, by closed formulas; the bodies reach beyond the box, so volumes of the bodies
// themselves are compared where they are known.

namespace cleave::geometry::slope_test {
namespace {

const Reach reach{{0, 0, 0}, {40, 30, 20}};

double sum_of(const std::vector<Solid>& solids) {
  return std::accumulate(solids.begin(), solids.end(), 0.0,
                         [](double sum, const Solid& s) { return sum + s.volume().si(); });
}

BenchCut square_pit() {
  return {.plan = {{0, 0}, {120, 0}, {120, 100}, {0, 100}},
          .top = 50,
          .count = 3,
          .height = metres(10),
          .width = metres(5),
          .angle = 45};
}

TEST(PlaneCut, KeepsThePlaneAndClearsTheDomain) {
  const Attitude plane{Dip::degrees(60), DipDirection::degrees(120)};
  const Vec3 through{20, 15, 10}, n = upward_normal(plane);
  const auto solid = make_plane_cut({through, plane}, reach).value();
  int on = 0;
  for (const Vec3& v : solid.vertices()) {
    const double height = dot(n, v - through);
    EXPECT_GT(height, -1e-7);
    if (std::abs(height) < 1e-7) ++on;
  }
  EXPECT_EQ(on, 4);
  EXPECT_TRUE(std::holds_alternative<NothingCut>(
      make_plane_cut({{0, 0, 30}, {Dip::degrees(0), DipDirection::degrees(0)}}, reach).error()));
}

TEST(PlaneCut, UprightPlaneTakesTheSideItDipsTo) {
  const auto solid = make_plane_cut({{10, 0, 0}, {Dip::degrees(90), DipDirection::degrees(90)}}, reach).value();
  for (const Vec3& v : solid.vertices()) EXPECT_GE(v.x, 10 - 1e-8);
}

TEST(ProfileCut, VolumeIsAreaTimesStrike) {
  // East: level 5 to x = 10, up to 15 at x = 20, level beyond; the roof and the sides grow by 1 % of the diagonal.
  const double margin = 0.01 * std::sqrt(40.0 * 40 + 30 * 30 + 20 * 20);
  const auto solid = make_profile_cut({{0, 0}, DipDirection::degrees(90), {{10, 5}, {20, 15}}}, reach).value();
  const double roof = 20 + margin;
  const double area = (10 + margin) * (roof - 5) + 10 * (roof - 10) + (20 + margin) * (roof - 15);
  EXPECT_NEAR(solid.volume().si(), area * (30 + 2 * margin), 1e-4);
  EXPECT_EQ(
      std::get<BadProfile>(make_profile_cut({{0, 0}, DipDirection::degrees(90), {{10, 5}, {10, 15}}}, reach).error())
          .point,
      1U);
}

TEST(Benches, VolumeOfARectangularPit) {
  // Faces run in by 10 a bench at 45 degrees, berms by 5: bench k has its crest 15 k inside. Prismoidal formula.
  double expected = 0;
  for (int k = 0; k < 3; ++k) {
    const double a = 120 - 30.0 * k, b = 100 - 30.0 * k;
    expected += 10.0 / 6 * (a * b + (a - 20) * (b - 20) + 4 * (a - 10) * (b - 10));
  }
  const auto benches = make_benches(square_pit(), 0).value();
  ASSERT_EQ(benches.size(), 3U);
  EXPECT_NEAR(sum_of(benches), expected, 1e-9 * expected);
  for (const Solid& bench : benches) EXPECT_TRUE(bench.from_half_spaces());
  const auto cleared = make_benches(square_pit(), 60).value();
  ASSERT_EQ(cleared.size(), 4U);
  EXPECT_NEAR(cleared.front().volume().si(), 120 * 100 * 10, 1e-6);
}

TEST(Benches, SenseOfThePlanAndUprightFaces) {
  auto cut = square_pit();
  const double volume = sum_of(make_benches(cut, 0).value());
  std::ranges::reverse(cut.plan);
  EXPECT_NEAR(sum_of(make_benches(cut, 0).value()), volume, 1e-6);
  cut.angle = 90;
  EXPECT_NEAR(sum_of(make_benches(cut, 0).value()), 10 * (120 * 100 + 110 * 90 + 100 * 80), 1e-6);
}

TEST(Benches, ConcavePlan) {
  // An L: the reflex corner moves outwards of the remaining arm; area of the inset by mitres in closed form.
  BenchCut cut{.plan = {{0, 0}, {60, 0}, {60, 30}, {30, 30}, {30, 60}, {0, 60}},
               .top = 0,
               .count = 1,
               .height = metres(5),
               .width = metres(0),
               .angle = 45};
  const auto area = [](double d) { return (60 - 2 * d) * (60 - 2 * d) - 30.0 * 30.0; };
  const auto benches = make_benches(cut, 0).value();
  EXPECT_NEAR(sum_of(benches), 5.0 / 6 * (area(0) + 4 * area(2.5) + area(5)), 1e-9);
  EXPECT_FALSE(benches.front().from_half_spaces());
}

TEST(Benches, Refusals) {
  auto cut = square_pit();
  cut.count = 4;  // 15 * 3 + 10 = 55 inside 100: nothing left
  EXPECT_EQ(std::get<BenchCloses>(make_benches(cut, 0).error()).bench, 4U);
  cut = square_pit();
  cut.angle = 0;
  EXPECT_EQ(std::get<BadBench>(make_benches(cut, 0).error()).what, "angle");
  cut = square_pit();
  cut.plan = {{0, 0}, {10, 10}, {10, 0}, {0, 10}};
  EXPECT_TRUE(std::holds_alternative<BadPlan>(make_benches(cut, 0).error()));
}

}  // namespace
}  // namespace cleave::geometry::slope_test
