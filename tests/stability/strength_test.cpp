#include "cleave/stability/strength.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace cleave::stability::strength_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

TEST(StrengthTest, FrictionIsFromZeroUpToNinetyDegrees) {
  for (const double ok : {0.0, 1e-300, 30.0, 89.999999}) {
    EXPECT_TRUE(JointStrength::make(FrictionAngle::degrees(ok)).has_value()) << ok;
  }
  for (const double bad : {-1e-300, -5.0, 90.0, 180.0, infinity, not_a_number}) {
    const auto strength = JointStrength::make(FrictionAngle::degrees(bad));
    ASSERT_FALSE(strength.has_value()) << bad;
    EXPECT_TRUE(std::holds_alternative<FrictionOutOfRange>(strength.error()));
  }
  EXPECT_EQ(describe(JointStrength::make(FrictionAngle::degrees(-5)).error()),
            "friction -5 is not an angle from 0 up to (not including) 90 degrees; give degrees, not a coefficient");
}

TEST(StrengthTest, CohesionAndTensionAreNotNegative) {
  const auto phi = FrictionAngle::degrees(30);
  EXPECT_TRUE(JointStrength::make(phi, pascals(0), pascals(1e6)).has_value());
  for (const double bad : {-1.0, infinity, not_a_number}) {
    const auto cohesion = JointStrength::make(phi, pascals(bad));
    ASSERT_FALSE(cohesion.has_value());
    EXPECT_TRUE(std::holds_alternative<BadCohesion>(cohesion.error()));
    const auto tension = JointStrength::make(phi, pascals(0), pascals(bad));
    ASSERT_FALSE(tension.has_value());
    EXPECT_TRUE(std::holds_alternative<BadTension>(tension.error()));
  }
}

TEST(StrengthTest, DensityLoadsAndFactorsAreChecked) {
  for (const double bad : {0.0, -2700.0, infinity, not_a_number}) {
    EXPECT_FALSE(RockMass::make(kilograms_per_cubic_metre(bad)).has_value());
  }
  EXPECT_EQ(describe(RockMass::make(kilograms_per_cubic_metre(0)).error()),
            "density 0 kg/m3 is not a finite number > 0; rock has 2000 to 3000");
  EXPECT_FALSE(Loads::make({0, 0, not_a_number}).has_value());
  EXPECT_FALSE(Loads::make({0, 0, -9.81}, {infinity, 0, 0}).has_value());
  for (const double bad : {0.0, -1.0, infinity, not_a_number}) {
    EXPECT_FALSE(PartialFactors::make(bad, 1, 1).has_value());
    EXPECT_FALSE(PartialFactors::make(1, bad, 1).has_value());
    const auto weight = PartialFactors::make(1, 1, bad);
    ASSERT_FALSE(weight.has_value());
    EXPECT_EQ(std::get<BadPartialFactor>(weight.error()).which, "weight");
  }
}

TEST(StrengthTest, TableFallsBackToItsDefault) {
  const auto of = [](double phi) { return JointStrength::make(FrictionAngle::degrees(phi)).value(); };
  StrengthTable table{of(25)};
  table.set(topology::JointId{3U}, of(40));
  EXPECT_EQ(table.of(std::nullopt), of(25));
  EXPECT_EQ(table.of(topology::JointId{0U}), of(25));
  EXPECT_EQ(table.of(topology::JointId{3U}), of(40));
  EXPECT_EQ(table.of(topology::JointId{1000U}), of(25));
}

}  // namespace
}  // namespace cleave::stability::strength_test
