// Blocks clamped by a stress field: the roof prism of Crawford and Bray (1983) and what follows from statics.

#include "cleave/stability/strength.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cleave::stability::clamping_test {
namespace {

using geometry::Vec3;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

JointStrength rough(double friction, double cohesion = 0) {
  return JointStrength::make(FrictionAngle::degrees(friction), pascals(cohesion)).value();
}

/// A symmetric prism that points up, semi-apex angle `alpha`, its two faces of 1 m2 clamped by a horizontal force H.
std::vector<ClampedContact> prism(double alpha, double h, const JointStrength& joint) {
  const double a = radians(alpha);
  std::vector<ClampedContact> faces;
  for (const double side : {-1.0, 1.0}) {
    const Vec3 n{-side * std::cos(a), 0, -std::sin(a)};  // down and inwards
    const Vec3 up{-side * std::sin(a), 0, std::cos(a)};
    faces.push_back({.inward = n,
                     .area = 1,
                     .normal = h * std::cos(a),
                     .shear = h * std::sin(a) * up,
                     .strengths = {{&joint, 1.0}}});
  }
  return faces;
}

/// Crawford and Bray (1983; Brady and Brown, Rock Mechanics for Underground Mining): the pull-out force of the prism.
double pull_out(double alpha, double tan_friction, double h, double ratio) {
  const double a = radians(alpha), phi = std::atan(tan_friction);
  const double c = std::cos(a), s = std::sin(a);
  return 2 * h * (c * c + ratio * s * s) * std::sin(phi - a) / (c * std::cos(phi) + ratio * s * std::sin(phi));
}

/// The factor on tan(friction) at which the pull-out force is the weight; 0 where no friction makes it so much.
double by_pull_out(double alpha, double friction, double h, double ratio, double weight) {
  const double t = std::tan(radians(friction));
  if (pull_out(alpha, 1e9, h, ratio) < weight) return 0;
  double low = 1e-3, high = t / std::tan(radians(alpha));  // from there on it is negative
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (pull_out(alpha, t / middle, h, ratio) > weight ? low : high) = middle;
  }
  return low;
}

constexpr double weight = 100e3;

TEST(ClampingTest, APrismWiderThanItsFrictionIsSqueezedOut) {
  for (const auto& [alpha, friction] : {std::pair{30.0, 25.0}, {15.0, 10.0}, {45.0, 44.0}}) {
    const JointStrength joint = rough(friction);
    for (const double h : {1e5, 1e6, 1e8}) {
      const auto faces = prism(alpha, h, joint);
      EXPECT_FALSE(clamped_balances(faces, {0, 0, -weight}, 10, 1)) << alpha << " " << h;
      EXPECT_LT(clamped_factor(faces, {0, 0, -weight}, {}), std::tan(radians(friction)) / std::tan(radians(alpha)));
    }
  }
}

TEST(ClampingTest, TheFactorIsThatOfThePullOutForce) {
  int held = 0;
  for (const double alpha : {5.0, 15.0, 30.0}) {
    for (const double friction : {20.0, 35.0, 50.0}) {
      const JointStrength joint = rough(friction);
      for (const double h : {0.8e5, 4e5, 3e6}) {
        const auto faces = prism(alpha, h, joint);
        for (const double ratio : {1.0, 10.0, 200.0}) {
          const double exact = by_pull_out(alpha, friction, h, ratio, weight);
          EXPECT_NEAR(clamped_factor(faces, {0, 0, -weight}, ratio), exact, 1e-7 * exact)
              << alpha << " " << friction << " " << h << " " << ratio;
          held += exact > 1 ? 1 : 0;
        }
        // No stiffness given: the least of the ratios.
        const double least = by_pull_out(alpha, friction, h, 1000, weight);
        EXPECT_NEAR(clamped_factor(faces, {0, 0, -weight}, {}), least, 1e-7 * least);
      }
    }
  }
  EXPECT_GT(held, 20);
}

TEST(ClampingTest, WithoutAFieldItIsLimitEquilibrium) {
  const JointStrength joint = rough(30, 5e3);
  const double dip = radians(40), w = 200e3, area = 20;
  const Vec3 n{std::sin(dip), 0, std::cos(dip)};
  const std::vector<ClampedContact> base{{.inward = n, .area = area, .strengths = {{&joint, area}}}};
  const double expected = (w * std::cos(dip) * std::tan(radians(30)) + 5e3 * area) / (w * std::sin(dip));
  EXPECT_NEAR(clamped_factor(base, {0, 0, -w}, {}), expected, 1e-9);
  // The field's own shear, which rock outside would take: it is let go, so it changes nothing.
  auto loaded = base;
  loaded[0].normal = 1e5;
  loaded[0].shear = 3e4 * Vec3{std::cos(dip), 0, -std::sin(dip)};
  EXPECT_NEAR(clamped_factor(loaded, {0, 0, -w}, {}), expected, 1e-9);
}

TEST(ClampingTest, WallsThatAreNotPressedHoldNothing) {
  const JointStrength joint = rough(35, 1e6);
  std::vector<ClampedContact> slot{{.inward = {1, 0, 0}, .area = 2, .strengths = {{&joint, 2.0}}},
                                   {.inward = {-1, 0, 0}, .area = 2, .strengths = {{&joint, 2.0}}}};
  EXPECT_EQ(clamped_factor(slot, {0, 0, -1e4}, {}), 0);
  for (ClampedContact& wall : slot) wall.normal = -5e4;  // pulled apart
  EXPECT_EQ(clamped_factor(slot, {0, 0, -1e4}, {}), 0);
  for (ClampedContact& wall : slot) wall.normal = 5e4;  // pressed: nothing relaxes, 2 (N tan + c A) / W
  EXPECT_NEAR(clamped_factor(slot, {0, 0, -1e4}, {}), 2 * (5e4 * std::tan(radians(35)) + 2e6) / 1e4, 1e-6);
}

TEST(ClampingTest, PartialFactorsDivideTheStrengths) {
  const JointStrength joint = rough(35, 1e4);
  const auto faces = prism(20, 4e5, joint);
  const auto both = PartialFactors::make(1.25, 1.25, 1).value();
  EXPECT_NEAR(1.25 * clamped_factor(faces, {0, 0, -weight}, 10, both) / clamped_factor(faces, {0, 0, -weight}, 10), 1,
              1e-9);
}

}  // namespace
}  // namespace cleave::stability::clamping_test
