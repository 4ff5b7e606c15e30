#include "cleave/dfn/joint_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace cleave::dfn {
namespace {

JointSetSpec good() {
  return {.orientation = FisherOrientation{Dip::degrees(30), DipDirection::degrees(40), 20},
          .shape = Square{SizeLaw::constant(metres(2))},
          .rotation = FixedRotation{},
          .intensity = P32{0.5}};
}

void expect_bad(const JointSetSpec& spec, const std::string& key) {
  const auto made = JointSet::make(spec);
  ASSERT_FALSE(made.has_value()) << key;
  EXPECT_EQ(describe(made.error()).substr(0, key.size()), key) << describe(made.error());
}

TEST(JointSetTest, BadValuesAreRefusedByKey) {
  EXPECT_TRUE(JointSet::make(good()).has_value());
  const auto oriented = [](OrientationLaw law) {
    JointSetSpec s = good();
    s.orientation = law;
    return s;
  };
  const Dip d = Dip::degrees(30);
  const DipDirection a = DipDirection::degrees(40);
  expect_bad(oriented(FisherOrientation{Dip::degrees(91), a, 20}), "orientation.dip:");
  expect_bad(oriented(FisherOrientation{Dip::degrees(NAN), a, 20}), "orientation.dip:");
  expect_bad(oriented(FisherOrientation{d, DipDirection::degrees(1e9), 20}), "orientation.dip_direction:");
  expect_bad(oriented(FisherOrientation{d, a, -1}), "orientation.kappa:");
  expect_bad(oriented(FisherOrientation{d, a, INFINITY}), "orientation.kappa:");
  expect_bad(oriented(UniformOrientation{d, a, Dip::degrees(-1), {}}), "orientation.dip_range:");
  expect_bad(oriented(UniformOrientation{d, a, {}, DipDirection::degrees(181)}), "orientation.dip_direction_range:");
  expect_bad(oriented(NormalOrientation{d, a, Dip::degrees(-1), {}}), "orientation.dip_std:");
  expect_bad(oriented(NormalOrientation{d, a, {}, DipDirection::degrees(NAN)}), "orientation.dip_direction_std:");

  const auto shaped = [](Shape shape) {
    JointSetSpec s = good();
    s.shape = shape;
    return s;
  };
  const SizeLaw two = SizeLaw::constant(metres(2));
  expect_bad(shaped(Disc{two, 2}), "sides:");
  expect_bad(shaped(RegularPolygon{two, 100'000}), "sides:");
  expect_bad(shaped(Rectangle{two, AspectRatio{0}}), "aspect:");
  expect_bad(shaped(Ellipse{two, AspectRatio{NAN}, 16}), "aspect:");

  const auto dense = [](Intensity i) {
    JointSetSpec s = good();
    s.intensity = i;
    return s;
  };
  expect_bad(dense(P32{-1}), "intensity.p32:");
  expect_bad(dense(P30{NAN}), "intensity.p30:");
  expect_bad(dense(P10{1e300}), "intensity.p10:");
  expect_bad(dense(Spacing{metres(0)}), "intensity.spacing:");
  expect_bad(dense(Count{1ULL << 40U}), "intensity.count:");
  JointSetSpec planes = dense(P30{1});
  planes.shape = Persistent{};
  expect_bad(planes, "intensity.p30:");

  JointSetSpec turned = good();
  turned.rotation = UniformRotation{Rotation::degrees(20), Rotation::degrees(10)};
  expect_bad(turned, "rotation.max:");
}

TEST(JointSetTest, MeanNormalPointsDownDipAndUp) {
  const JointSet set = JointSet::make(good()).value();
  const geometry::Vec3 n = set.mean_normal();  // dip 30, dip direction 40: (sin 30 sin 40, sin 30 cos 40, cos 30)
  EXPECT_NEAR(n.x, 0.5 * std::sin(40 * std::numbers::pi / 180), 1e-15);
  EXPECT_NEAR(n.y, 0.5 * std::cos(40 * std::numbers::pi / 180), 1e-15);
  EXPECT_NEAR(n.z, std::sqrt(0.75), 1e-15);
}

// P10/P32 along the mean pole.
TEST(JointSetTest, MeanCosineTurnsLineDensityIntoAreaDensity) {
  const auto cosine = [](OrientationLaw law) {
    JointSetSpec s = good();
    s.orientation = law;
    return JointSet::make(s).value().mean_cosine();
  };
  const Dip d = Dip::degrees(30);
  const DipDirection a = DipDirection::degrees(40);
  EXPECT_NEAR(cosine(FisherOrientation{d, a, 0}), 0.5, 1e-12);
  EXPECT_NEAR(cosine(FisherOrientation{d, a, 1e-3}), 0.5, 1e-7);
  EXPECT_NEAR(cosine(FisherOrientation{d, a, 2}), 0.619203, 5e-7);
  EXPECT_NEAR(cosine(FisherOrientation{d, a, 5}), 1 - std::tanh(2.5) / 5, 1e-15);
  EXPECT_NEAR(cosine(FisherOrientation{d, a, 10}), 0.900009079574, 5e-13);
  // A dip that is uniform in +-20 deg: mean of cos = sin(20)/(20 in radians).
  const double h = 20 * std::numbers::pi / 180;
  EXPECT_NEAR(cosine(UniformOrientation{d, a, Dip::degrees(20), {}}), std::sin(h) / h, 1e-4);
  EXPECT_NEAR(cosine(NormalOrientation{Dip::degrees(45), a, Dip::degrees(5), {}}),
              std::exp(-0.5 * std::pow(5 * std::numbers::pi / 180, 2)), 1e-4);
}

TEST(JointSetTest, AreasAndReachOfShapes) {
  const SizeLaw law = SizeLaw::make({.distribution = SizeDistribution::exponential,
                                     .mean = metres(80),
                                     .std = {},
                                     .exponent = {},
                                     .min = metres(40),
                                     .max = metres(120)})
                          .value();
  const double m1 = law.moment(1), m2 = law.moment(2), pi = std::numbers::pi;
  const auto set = [](Shape shape) {
    JointSetSpec s = good();
    s.shape = shape;
    return JointSet::make(s).value();
  };
  EXPECT_DOUBLE_EQ(set(Rectangle{law}).mean_area(), m1 * m1);  // sides independent
  EXPECT_DOUBLE_EQ(set(Rectangle{law, AspectRatio{2}}).mean_area(), m2 / 2);
  EXPECT_DOUBLE_EQ(set(Rectangle{law, SizeLaw::constant(metres(3))}).mean_area(), 3 * m1);
  EXPECT_DOUBLE_EQ(set(Square{law}).mean_area(), m2);
  EXPECT_DOUBLE_EQ(set(Disc{law}).mean_area(), pi / 4 * m2);
  EXPECT_DOUBLE_EQ(set(Ellipse{law}).mean_area(), pi / 4 * m1 * m1);
  EXPECT_DOUBLE_EQ(set(RegularPolygon{law, 6}).mean_area(), 6 * std::sin(pi / 3) / 8 * m2);
  EXPECT_DOUBLE_EQ(set(Rectangle{law}).reach(), std::hypot(120, 120) / 2);
  EXPECT_DOUBLE_EQ(set(Rectangle{law, AspectRatio{2}}).reach(), std::hypot(120, 60) / 2);
  EXPECT_NEAR(set(Disc{law, 32}).reach(), 60 * 1.003222, 60 * 5e-7);
  EXPECT_EQ(set(Persistent{}).reach(), 0);
}

TEST(JointSetTest, ExpectedDensity) {
  const auto p32 = [](Intensity i) {
    JointSetSpec s = good();
    s.intensity = i;
    return JointSet::make(s).value().expected_p32(100);
  };
  const double cosine = JointSet::make(good()).value().mean_cosine();
  EXPECT_DOUBLE_EQ(p32(Count{10}), 10 * 4.0 / 100);
  EXPECT_DOUBLE_EQ(p32(P32{0.3}), 0.3);
  EXPECT_DOUBLE_EQ(p32(P30{0.2}), 0.8);
  EXPECT_DOUBLE_EQ(p32(P10{0.2}), 0.2 / cosine);
  EXPECT_DOUBLE_EQ(p32(Spacing{metres(4)}), 0.25 / cosine);
}

}  // namespace
}  // namespace cleave::dfn
