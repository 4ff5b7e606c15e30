#include "cleave/dfn/joint_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace cleave::dfn {
namespace {

using enum SizeDistribution;

SizeLaw law(SizeDistribution d, double mean, double std, std::optional<double> min = {},
            std::optional<double> max = {}) {
  SizeSpec spec{.distribution = d, .mean = metres(mean), .std = metres(std), .exponent = {}, .min = {}, .max = {}};
  if (min) spec.min = metres(*min);
  if (max) spec.max = metres(*max);
  return SizeLaw::make(spec).value();
}
SizeLaw power_law(double exponent, double min, std::optional<double> max) {
  SizeSpec spec{.distribution = power, .mean = {}, .std = {}, .exponent = exponent, .min = metres(min), .max = {}};
  if (max) spec.max = metres(*max);
  return SizeLaw::make(spec).value();
}

// Digits from an independent script.
TEST(SizeLawTest, TruncatedMomentsAreTheClosedForms) {
  const SizeLaw small = law(exponential, 80, 0, 40, 120);
  EXPECT_NEAR(small.moment(1), 73.4418634, 1e-7);
  EXPECT_NEAR(small.moment(2), 5901.396304, 5e-7);
  EXPECT_NEAR(small.kept_share(), 0.3834, 5e-5);
  const SizeLaw medium = law(exponential, 59.88024, 0, 40, 120);
  EXPECT_NEAR(medium.moment(1), 71.3475120, 5e-8);
  EXPECT_NEAR(medium.moment(2), 5579.3758, 5e-5);
  const SizeLaw cut = law(exponential, 2, 0, {}, 12);
  EXPECT_NEAR(cut.moment(1), 1.970181, 5e-7);
  EXPECT_NEAR(cut.moment(2), 7.522897, 5e-7);
  const SizeLaw logs = law(lognormal, 10, 6, 2, 40);
  EXPECT_NEAR(logs.moment(1), 9.931697, 5e-7);
  EXPECT_NEAR(logs.moment(2), 130.431403, 5e-7);
  EXPECT_NEAR(law(normal, 100, 30, 1, 300).moment(1), 100.051702, 5e-7);
  EXPECT_NEAR(power_law(2.5, 1, 100).moment(1), 1.665017, 5e-7);
  EXPECT_NEAR(power_law(2.5, 1, 100).moment(2), 4.500045, 5e-7);
}

// E min(max(X, a), b)^k = a^k + the integral of k x^(k-1) P(X > x) from a to b.
TEST(SizeLawTest, ClampedLawsHaveTheirLimitsAsSizes) {
  const auto clamped = [](SizeDistribution d, double mean, double std, double min, double max) {
    return SizeLaw::make({.distribution = d,
                          .mean = metres(mean),
                          .std = metres(std),
                          .exponent = 1.5,
                          .min = metres(min),
                          .max = metres(max),
                          .clamp = true})
        .value();
  };
  const SizeLaw small = clamped(exponential, 80, 0, 40, 120);
  const double a = std::exp(-0.5), b = std::exp(-1.5);
  EXPECT_NEAR(small.moment(1), 40 + 80 * (a - b), 1e-11);
  EXPECT_NEAR(small.moment(2), 1600 + 2 * (80 * (40 * a - 120 * b) + 6400 * (a - b)), 1e-8);
  EXPECT_DOUBLE_EQ(small.quantile(0.39).si(), 40);
  EXPECT_GT(small.quantile(0.394).si(), 40);
  EXPECT_DOUBLE_EQ(small.quantile(0.78).si(), 120);
  EXPECT_NEAR(small.quantile(0.5).si(), 80 * std::log(2), 1e-9);  // between them the law itself
  const double ratio = std::pow(0.1, 1.5);
  EXPECT_NEAR(clamped(power, 1, 1, 2, 20).moment(1), 2 + 4 * (1 - std::pow(0.1, 0.5)), 1e-11);
  EXPECT_DOUBLE_EQ(clamped(power, 1, 1, 2, 20).quantile(1 - 0.9 * ratio).si(), 20);
  for (const SizeLaw& law : {small, clamped(normal, 60, 40, 40, 120), clamped(lognormal, 60, 50, 40, 120),
                             clamped(gamma, 60, 50, 40, 120), clamped(power, 1, 1, 2, 20)}) {
    double sum = 0, square = 0;
    constexpr int points = 200000;
    for (int i = 0; i < points; ++i) {
      const double x = law.quantile((i + 0.5) / points).si();
      sum += x / points;
      square += x * x / points;
    }
    EXPECT_NEAR(sum, law.moment(1), 1e-4 * sum);
    EXPECT_NEAR(square, law.moment(2), 1e-4 * square);
  }
}

TEST(SizeLawTest, UniformSizes) {
  const SizeLaw law =
      SizeLaw::make(
          {.distribution = uniform, .mean = {}, .std = {}, .exponent = {}, .min = metres(2), .max = metres(8)})
          .value();
  EXPECT_DOUBLE_EQ(law.moment(1), 5);
  EXPECT_DOUBLE_EQ(law.moment(2), 28);
  EXPECT_DOUBLE_EQ(law.quantile(0.25).si(), 3.5);
  EXPECT_DOUBLE_EQ(law.largest().si(), 8);
}

TEST(SizeLawTest, WithoutLimitsTheMomentsAreTheLawsOwn) {
  EXPECT_DOUBLE_EQ(law(exponential, 7, 0).moment(1), 7);
  EXPECT_DOUBLE_EQ(law(exponential, 7, 0).moment(2), 98);
  EXPECT_NEAR(law(lognormal, 10, 6).moment(1), 10, 1e-12);
  EXPECT_NEAR(law(lognormal, 10, 6).moment(2), 136, 1e-11);
  EXPECT_NEAR(power_law(3, 2, {}).moment(1), 3, 1e-12);
  EXPECT_NEAR(power_law(3, 2, {}).moment(2), 12, 1e-12);
  EXPECT_DOUBLE_EQ(SizeLaw::constant(metres(5)).moment(2), 25);
}

// The quantile and the moments are written apart; the midpoint rule over u joins them.
TEST(SizeLawTest, QuantilesIntegrateToTheMoments) {
  const std::vector<SizeLaw> laws{law(exponential, 80, 0, 40, 120),
                                  law(exponential, 5, 0, 100, 130),
                                  law(exponential, 1e6, 0, 3, 4),
                                  law(normal, 100, 30, 1, 300),
                                  law(normal, 10, 2, 18, 19),
                                  law(normal, 10, 5, {}, 6),
                                  law(lognormal, 10, 6, 2, 40),
                                  law(lognormal, 3, 1, 9, 12),
                                  power_law(2.5, 1, 100),
                                  power_law(1, 2, 9),
                                  power_law(2, 2, 9)};
  constexpr int n = 200'000;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    SCOPED_TRACE(i);
    double first = 0, second = 0, last = 0;
    for (int k = 0; k < n; ++k) {
      const double x = laws[i].quantile((k + 0.5) / n).si();
      EXPECT_GE(x, last);  // never falls
      last = x;
      first += x / n;
      second += x * x / n;
    }
    EXPECT_NEAR(first / laws[i].moment(1), 1, 2e-5);
    EXPECT_NEAR(second / laws[i].moment(2), 1, 3e-4);
    EXPECT_LE(last, laws[i].largest().si());
  }
}

TEST(SizeLawTest, QuantilesStayWithinTheLimitsFarOut) {
  const double least = std::numeric_limits<double>::epsilon() / 2;
  for (const SizeLaw& l :
       {law(exponential, 2, 0, 50, 52), law(normal, 0.5, 1, 7, 7.1), law(lognormal, 1, 1, 100, 1000)}) {
    EXPECT_GE(l.quantile(least).si(), 7);
    EXPECT_LT(l.quantile(least).si(), l.quantile(0.01).si());
    EXPECT_LE(l.quantile(1 - least).si(), l.largest().si());
    EXPECT_GT(l.quantile(1 - least).si(), l.quantile(0.99).si());
  }
}

TEST(SizeLawTest, NormalSizesArePositive) {
  const SizeLaw l = law(normal, 1, 10);
  EXPECT_GT(l.quantile(1e-16).si(), 0);
  EXPECT_LT(l.kept_share(), 0.55);
}

TEST(SizeLawTest, LargestOfAnEndlessLawIsAFarQuantile) {
  EXPECT_NEAR(law(exponential, 2, 0).largest().si(), 2 * std::log(1e6), 1e-9);
  EXPECT_DOUBLE_EQ(law(exponential, 2, 0, 1, 12).largest().si(), 12);
}

template <class Error>
void expect_error(const SizeSpec& spec, const std::string& part) {
  const auto made = SizeLaw::make(spec);
  ASSERT_FALSE(made.has_value());
  EXPECT_TRUE(std::holds_alternative<Error>(made.error()));
  EXPECT_NE(describe(made.error()).find(part), std::string::npos) << describe(made.error());
}

TEST(SizeLawTest, BadParametersAreRefusedByName) {
  const SizeSpec good{
      .distribution = normal, .mean = metres(10), .std = metres(2), .exponent = {}, .min = {}, .max = {}};
  const auto with = [&](auto change) {
    SizeSpec spec = good;
    change(spec);
    return spec;
  };
  EXPECT_TRUE(SizeLaw::make(good).has_value());
  expect_error<MissingParameter>(with([](SizeSpec& s) { s.mean.reset(); }), "mean");
  expect_error<MissingParameter>(with([](SizeSpec& s) { s.std.reset(); }), "std");
  expect_error<MissingParameter>(with([](SizeSpec& s) { s.distribution = power; }), "exponent");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.mean = metres(-1); }), "mean");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.mean = metres(NAN); }), "mean");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.mean = metres(1e300); }), "mean");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.std = metres(-2); }), "std");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.min = metres(-2); }), "min");
  expect_error<BadParameter>(with([](SizeSpec& s) { s.max = metres(INFINITY); }), "max");
  expect_error<EmptyRange>(with([](SizeSpec& s) { s.min = metres(12), s.max = metres(11); }), "min = 12");
  expect_error<EmptyRange>(with([](SizeSpec& s) { s.min = metres(40), s.max = metres(50); }),
                           "max = 50");  // 15 std away
  expect_error<EmptyRange>(with([](SizeSpec& s) { s.distribution = constant, s.max = metres(9); }), "max = 9");
  SizeSpec endless{.distribution = power, .mean = {}, .std = {}, .exponent = 2, .min = metres(1), .max = {}};
  expect_error<MissingParameter>(endless, "max");  // infinite area otherwise
  endless.min.reset();
  endless.max = metres(3);
  expect_error<MissingParameter>(endless, "min");
}

TEST(SizeLawTest, NoSpreadIsConstant) {
  EXPECT_EQ(law(normal, 10, 0).quantile(0.3).si(), 10);
  EXPECT_EQ(law(lognormal, 10, 0).quantile(0.9).si(), 10);
  EXPECT_EQ(law(exponential, 10, 0, 4, 4).quantile(0.9).si(), 4);
}

}  // namespace
}  // namespace cleave::dfn
