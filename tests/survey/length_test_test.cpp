#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/traces.hpp"

// Goodness of fit of trace lengths in windows that cut them off.

namespace cleave::survey::length_test_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(LengthTestTest, ChordsByHand) {
  const PolygonWindow square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  EXPECT_DOUBLE_EQ(chord_through(square, {1, 1}, {1, 0}), 4);
  EXPECT_NEAR(chord_through(square, {1, 1}, {std::sqrt(0.5), std::sqrt(0.5)}), std::sqrt(32.0), 1e-12);
  EXPECT_NEAR(chord_through(square, {1, 1}, {std::sqrt(0.5), -std::sqrt(0.5)}), std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(chord_through(CircleWindow{{1, 1}, 5}, {1, 4}, {1, 0}), 8, 1e-12);
  // An L: the line leaves it and comes back; the part around the point counts.
  const PolygonWindow ell{{{0, 0}, {6, 0}, {6, 4}, {5, 4}, {5, 1}, {1, 1}, {1, 4}, {0, 4}}};
  EXPECT_NEAR(chord_through(ell, {0.5, 3}, {1, 0}), 1, 1e-12);
  EXPECT_NEAR(chord_through(ell, {0.5, 0.5}, {1, 0}), 6, 1e-12);
}

/// Whole traces of a law, in all directions, on a rectangle of 6 x 9 m.
std::vector<WholeTrace> outcrop(const Fit& law, double truncation, std::uint64_t number) {
  const PolygonWindow window{{{0, 0}, {9, 0}, {9, 6}, {0, 6}}};
  Rng rng{{.seed = 81, .realization = number}};
  std::vector<WholeTrace> traces;
  for (int i = 0; i < 160; ++i) {
    const double l = law.quantile(rng.uniform()), a = pi * rng.uniform();
    const MapPoint middle{9 * rng.uniform(), 6 * rng.uniform()}, d{std::cos(a), std::sin(a)};
    const double half = l / 2;
    const MapPoint from{middle.x - half * d.x, middle.y - half * d.y}, to{middle.x + half * d.x, middle.y + half * d.y};
    if (l < truncation || !holds(window, from) || !holds(window, to)) continue;
    traces.push_back({l, chord_through(window, middle, d)});
  }
  return traces;
}

// The level is kept: 5 and 20 % of false alarms over 1,000 outcrops, within 4 standard errors and what so few traces
// leave of the law for many (1 %). Lengths are of the size of the window: a test that forgets what was cut off refuses
// most of them.
TEST(LengthTestTest, TheLevelIsKept) {
  constexpr int outcrops = 1000;
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma}) {
    for (const double truncation : {0.0, 0.5}) {
      Fit law;
      law.family = family;
      law.a = family == Family::exponential ? 2 : family == Family::lognormal ? 0.4 : 2.5;
      law.b = family == Family::lognormal ? 0.6 : 0.8;
      int five = 0, twenty = 0;
      for (int k = 0; k < outcrops; ++k) {
        const auto test = test_lengths(outcrop(law, truncation, static_cast<std::uint64_t>(k)), truncation, family, 1);
        ASSERT_TRUE(test.has_value());
        five += test->p_value <= 0.05 ? 1 : 0;
        twenty += test->p_value <= 0.20 ? 1 : 0;
      }
      const std::string name = std::string{name_of(family)} + (truncation > 0 ? "_cut" : "");
      RecordProperty(name, std::to_string(five) + " " + std::to_string(twenty));
      EXPECT_NEAR(five, 50, 4 * std::sqrt(50 * 0.95) + 10) << name;
      EXPECT_NEAR(twenty, 200, 4 * std::sqrt(200 * 0.8) + 10) << name;
    }
  }
}

// Lengths of nearly one size are no exponential ones, and exponential ones no lognormal ones of another shape.
TEST(LengthTestTest, WrongLawsAreRefused) {
  Fit narrow;
  narrow.family = Family::gamma;
  narrow.a = 8;
  narrow.b = 0.25;
  int refused = 0, kept = 0;
  for (std::uint64_t k = 0; k < 50; ++k) {
    const auto traces = outcrop(narrow, 0, k);
    refused += test_lengths(traces, 0, Family::exponential, 1)->p_value <= 0.05 ? 1 : 0;
    kept += test_lengths(traces, 0, Family::gamma, 1)->p_value > 0.05 ? 1 : 0;
  }
  EXPECT_EQ(refused, 50);
  EXPECT_GE(kept, 40);
  EXPECT_FALSE(test_lengths(std::vector<WholeTrace>(19, {1, 5}), 0, Family::exponential, 1).has_value());
  EXPECT_FALSE(test_lengths(std::vector<WholeTrace>(90, {1, 5}), 0, Family::power, 1).has_value());
  EXPECT_LT(test_lengths(std::vector<WholeTrace>(90, {1, 5}), 0, Family::exponential, 1)->p_value, 1e-6);
}

}  // namespace
}  // namespace cleave::survey::length_test_test
