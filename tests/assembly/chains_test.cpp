#include <gtest/gtest.h>

#include <limits>

#include "chains.hpp"
#include "cleave/assembly/groups.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

bool holds(const Builder& b) { return project(b.made(), 1).largest < 1e-8; }

/// Where `holds` changes.
template <class Make>
double least(Make&& make, double low, double high, bool holds_above) {
  for (int k = 0; k < 19; ++k) {
    const double middle = (low + high) / 2;
    (holds(make(middle)) == holds_above ? high : low) = middle;
  }
  return (low + high) / 2;
}

TEST(Chains, SlicesC1) {
  // Sarma's recursion with all sides spent.
  for (const Freedom freedom : {Freedom::section_translation, Freedom::section}) {
    const Assembly assembly = circle(freedom).made();
    const StaticFactor up = static_factor(assembly);
    EXPECT_NEAR(up.factor, 1.489004849, 2e-6);
    const MovingFactor moving = moving_factor(assembly, up.factor);
    EXPECT_NEAR(moving.factor, 1.489004849, 2e-6);
  }
}

TEST(Chains, ColumnC2) {
  const double slides = tan_deg(40) / tan_deg(20);
  EXPECT_NEAR(static_factor(column(4, Freedom::section_translation).made()).factor, slides, 1e-6);
  EXPECT_EQ(static_factor(column(4).made()).factor, 0);
  EXPECT_EQ(moving_factor(column(4).made(), 0).factor, 0);
  EXPECT_NEAR(static_factor(column(2).made()).factor, slides, 1e-6);
  EXPECT_NEAR(moving_factor(column(2).made(), infinite).factor, slides, 1e-6);
}

TEST(Chains, ArchesC3ToC5) {
  EXPECT_NEAR(least([](double t) { return arch(1, t, std::numbers::pi, 16, 1e3); }, .1071, .1074, true), 0.107237229,
              1e-8);
  EXPECT_NEAR(least([](double k) { return arch(10, 1.5, rad(157.5), 7, 1e3, {k, -1}); }, .369, .371, false), 0.3700106,
              2e-6);
  const Assembly semicircle = arch(1, .15, std::numbers::pi, 16, tan_deg(35)).made();
  const StaticFactor up = static_factor(semicircle);
  EXPECT_NEAR(up.factor, 1.992008060, 1e-6);
  EXPECT_NEAR(moving_factor(semicircle, up.factor).factor, 1.992008060, 2e-6);
}

TEST(Chains, StacksC6AndC7) {
  EXPECT_EQ(static_factor(level_stack().made()).factor, infinite);
  EXPECT_EQ(moving_factor(level_stack().made(), infinite).factor, infinite);
  EXPECT_TRUE(holds(harmonic(5, .999)));
  EXPECT_FALSE(holds(harmonic(5, 1.001)));
}

TEST(Chains, VoussoirsC8) {
  const Assembly roof = voussoirs().made();
  EXPECT_EQ(static_factor(roof).factor, infinite);
  EXPECT_EQ(moving_factor(roof, infinite).factor, 0);
  EXPECT_NEAR(static_factor(confined_voussoirs(200).made()).factor, 2 * 200 * tan_deg(35) / 150, 2e-6);
}

TEST(Chains, TopplingColumnsC9) {
  EXPECT_NEAR(static_factor(toppling_columns(38.6598).made()).factor, 1.212857162, 2e-6);
  EXPECT_NEAR(static_factor(toppling_columns(38.6598, 2013).made()).factor, 1.361670342, 2e-6);
  const MovingFactor moving = moving_factor(toppling_columns(38.6598).made(), 1.212857162);
  // From rest it stands at 1.01 and falls at 1.02 (contact code); the recursion of limiting equilibrium says 1.0185.
  EXPECT_GT(moving.factor, 1.01);
  EXPECT_LT(moving.factor, 1.05);
}

TEST(Chains, DomeC10) {
  EXPECT_NEAR(least([](double t) { return lune(t); }, .04, .045, true), 0.0427473516, 2e-8);
}

}  // namespace
}  // namespace cleave::assembly
