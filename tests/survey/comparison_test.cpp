#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/comparison.hpp"

// Formulas that stand for comparison only: figures by hand, and what they say of synthetic outcrops.

namespace cleave::survey::comparison_test {
namespace {

constexpr double pi = std::numbers::pi;

WindowCounts counts_of_ten_circles() {
  WindowCounts c;
  c.n0 = 14;
  c.n1 = 132;
  c.n2 = 90;
  c.area = 10 * pi * 25;
  c.width = 100;
  c.radius = 50;
  return c;
}

TEST(ComparisonTest, PahlsMeanByHand) {
  WindowCounts c = counts_of_ten_circles();
  // q = -76/237: A/b (1 + q)/(1 - q) = 7.853982 x 161/313.
  const Estimate e = mean_length_by_pahl(c);
  EXPECT_NEAR(*e.value, 7.853982 * 161 / 313, 1e-6);
  EXPECT_LT(e.low, *e.value);
  EXPECT_GT(e.high, *e.value);
  EXPECT_TRUE(e.note.starts_with("for comparison only")) << e.note;
  c.n0 = 236;
  c.n1 = c.n2 = 0;
  EXPECT_NEAR(*mean_length_by_pahl(c).value, 7.853982 * 473, 1e-3);  // finite where every end is out of sight
  EXPECT_FALSE(mean_length_by_pahl(WindowCounts{}).value.has_value());
}

TEST(ComparisonTest, MeanByNumberByHand) {
  WindowCounts c = counts_of_ten_circles();
  c.length = 236 / (1.0 / 4 + c.width / c.area);
  EXPECT_NEAR(*mean_length_by_number(c).value, 4, 1e-12);
  c.length = 236 * c.area / c.width * 1.01;  // longer than the circles are wide
  EXPECT_FALSE(mean_length_by_number(c).value.has_value());
  c.circle = false;
  EXPECT_FALSE(mean_length_by_number(c).value.has_value());
}

TEST(ComparisonTest, MidpointsByHand) {
  Fit law;
  law.a = 1;
  // Exponential: one end seen 1 - e^-l, none 1 - e^-l.
  const double l = std::numbers::ln2;
  EXPECT_NEAR(*p20_by_midpoints(std::vector<SeenLength>{{l, 2}, {l, 1}, {l, 0}}, law, 4).value, 0.5, 1e-12);
}

TEST(ComparisonTest, SpreadsByHand) {
  const std::vector<SeenLength> lengths{{1, 2}, {2, 2}, {3, 2}};
  const auto all = spread_as_measured(lengths, Chords{});
  ASSERT_EQ(all.size(), 4U);
  EXPECT_NEAR(*all[0].value, std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(*all[1].value, std::sqrt(2.0 / 3), 1e-12);  // the mean 2S/m is that of the pieces, too
  // Second moment 14/3: E D = 128 x 8/(3 pi^3 14/3).
  EXPECT_NEAR(*all[2].value, 1024 / (14 * pi * pi * pi), 1e-12);
  for (const Estimate& e : all) {
    EXPECT_TRUE(e.note.starts_with("for comparison only")) << e.name;
    EXPECT_LT(e.low, *e.value) << e.name;
    EXPECT_GT(e.high, *e.value) << e.name;
  }
  // One end out of sight: the mean grows to 2.4, the first figure does not know.
  const auto cut = spread_as_measured(std::vector<SeenLength>{{1, 2}, {2, 2}, {3, 1}}, Chords{});
  EXPECT_NEAR(*cut[0].value, std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(*cut[1].value, 1.2 * std::sqrt(2.0 / 3), 1e-12);
  EXPECT_FALSE(spread_as_measured(std::vector<SeenLength>{{1, 0}, {2, 0}, {3, 0}}, Chords{})[1].value.has_value());
}

TEST(ComparisonTest, TextbookPValues) {
  // Kolmogorov's law at 1.3581 and 1.6276: 5 % and 1 %.
  EXPECT_NEAR(textbook_p_value(1.3581015 / 1000.12011, 1'000'000), 0.05, 1e-6);
  EXPECT_NEAR(textbook_p_value(1.6276236 / 1000.12011, 1'000'000), 0.01, 1e-6);
  EXPECT_EQ(textbook_p_value(0, 10), 1);
  EXPECT_LT(textbook_p_value(1, 50), 1e-20);
}

// Parallel exponential traces of mean 2 m, 1 a square metre, on squares and circles: A.13 and A.26 come right on
// average (within 4 standard errors), their intervals cover; the standard deviation of the pieces comes out too small.
TEST(ComparisonTest, SyntheticOutcropsSayWhatTheFormulasAreWorth) {
  constexpr int outcrops = 1000;
  const CircleWindow circle{{0, 0}, 4};
  const PolygonWindow square{{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}};
  Fit law;
  law.a = 2;
  double p20 = 0, p20_squares = 0;
  int covered = 0, spread_too_small = 0;
  for (int k = 0; k < outcrops; ++k) {
    Rng rng{{.seed = 71, .realization = static_cast<std::uint64_t>(k)}};
    std::vector<Polyline> traces;
    // Midpoints of a Poisson process in the square grown by ten means along the traces.
    for (double x = -std::log(rng.uniform()) / 48; x < 8; x -= std::log(rng.uniform()) / 48) {
      const double y = 48 * rng.uniform() - 24, half = -std::log(rng.uniform());
      traces.push_back({{x - 4, y - half}, {x - 4, y + half}});
    }
    const Estimate mean = mean_length_by_number(count(circle, seen_through(circle, traces)));
    ASSERT_TRUE(mean.value.has_value());
    covered += mean.low <= 2 && 2 <= mean.high ? 1 : 0;
    std::vector<SeenLength> lengths;
    for (const SeenTrace& t : seen_through(square, traces)) lengths.push_back({t.length, t.ends});
    const double midpoints = *p20_by_midpoints(lengths, law, 64).value;
    p20 += midpoints;
    p20_squares += midpoints * midpoints;
    spread_too_small += *spread_as_measured(lengths, Chords{})[0].value < 2 ? 1 : 0;
  }
  p20 /= outcrops;
  const double error = std::sqrt((p20_squares / outcrops - p20 * p20) / outcrops);
  EXPECT_NEAR(p20, 1, 4 * error);
  EXPECT_GE(covered, 930);
  EXPECT_LE(covered, 970);
  EXPECT_GT(spread_too_small, 800);
}

}  // namespace
}  // namespace cleave::survey::comparison_test
