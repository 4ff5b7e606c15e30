#include "cleave/survey/analyse.hpp"
#include "cleave/survey/traces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/core/rng.hpp"
#include "heavy_rock.hpp"
#include "north_set.hpp"

namespace cleave::survey::size_test {
namespace {

constexpr double pi = std::numbers::pi;

Fit law_of(Family family, double a, double b = 1) {
  Fit fit;
  fit.family = family;
  fit.a = a;
  fit.b = b;
  return fit;
}

// The choice of the law of the traces is in the interval of the moments of the sizes.
TEST(SizeTest, MomentsAreOverAllLawsOfTheTraces) {
  Rng rng{3};
  SurveyInput input;
  LineSurvey& line = input.lines.emplace_back();
  line.name = "L";
  line.pieces.emplace_back(geometry::Vec3{1, 0, 0}, 40);
  for (std::size_t i = 0; i < 55; ++i) {
    line.positions.push_back(40 * rng.uniform());
    line.sets.emplace_back("A");
    line.joints.emplace_back(i);
    line.lengths.emplace_back(
        SeenLength{-3 * std::log(rng.uniform() * rng.uniform()), 1 + static_cast<unsigned>(i % 2)});
    const geometry::Vec3 normal = normalized(geometry::Vec3{1, 0.1 * rng.normal(), 0.1 * rng.normal()});
    input.orientations.push_back({normal.z < 0 ? -normal : normal, "A", geometry::Vec3{1, 0, 0}, std::nullopt});
  }
  const SetResult set = analyse(input).sets.at(0);
  ASSERT_GE(set.lengths.size(), 2U);
  for (const auto& [taken, order] : {std::pair{*set.m2, 1}, std::pair{*set.m3, 2}}) {
    const auto figure = [&](const Fit& f) {
      const SizeMoments m = size_moments(f.moment(1), f.moment(2), set.chords);
      return std::optional{order == 1 ? m.m2 : m.m3};
    };
    const Estimate best = estimate_of(set.lengths.front().fit, "", figure, 0.95);
    EXPECT_DOUBLE_EQ(taken.value.value(), best.value.value());
    EXPECT_GT(taken.high / taken.low, 1.02 * best.high / best.low);
    EXPECT_TRUE(taken.method.contains("over all laws by their AIC")) << taken.method;
    EXPECT_TRUE(std::isfinite(taken.high));
    EXPECT_TRUE(taken.note.empty()) << taken.note;
  }
}

TEST(SizeTest, DiscsByHand) {
  EXPECT_NEAR(quarter_sine(1), 1, 1e-15);
  EXPECT_NEAR(quarter_sine(2), pi / 4, 1e-15);
  EXPECT_NEAR(quarter_sine(3), 2.0 / 3, 1e-15);
  EXPECT_NEAR(quarter_sine(4), 3 * pi / 16, 1e-15);
  const SizeOfJoints lognormal = size_law(Family::lognormal, 3.403392, 18.082304).value();
  EXPECT_NEAR(lognormal.mean, 3, 1e-5);
  EXPECT_NEAR(lognormal.std, 2, 1e-5);
  // Gamma 2.5, 1.2: mu_l and q from E D^2/E D = 1.2 * 3.5, E D^3/E D = 1.44 * 3.5 * 4.5.
  const SizeOfJoints gamma = size_law(Family::gamma, pi / 4 * 4.2, 1.44 * 3.5 * 4.5 / 1.5).value();
  EXPECT_NEAR(gamma.mean, 3, 1e-12);
  EXPECT_NEAR(gamma.std, 1.897367, 5e-7);
  EXPECT_NEAR(size_law(Family::exponential, 4.712389, 0)->mean, 3, 1e-6);
  EXPECT_NEAR(third_moment({.family = Family::exponential, .mean = 3, .std = 3}), 381.703507, 5e-7);
  EXPECT_FALSE(size_law(Family::lognormal, 4, 10).has_value());  // traces too much alike for discs
}

TEST(SizeTest, EllipsesAndParallelogramsByHand) {
  EXPECT_NEAR(ellipse_factor(2.5, 35 * pi / 180), 0.605538, 5e-7);
  EXPECT_NEAR(pi / 4 * 4 * ellipse_factor(2.5, 35 * pi / 180), 1.902355, 5e-7);
  const ParallelogramChords c = parallelogram_chords(2, 5, 70 * pi / 180, 30 * pi / 180);
  EXPECT_NEAR(c.longest, 3.939231, 5e-7);
  EXPECT_NEAR(c.share_longest, 0.141713, 5e-7);
  EXPECT_NEAR(c.mean, 2.248735, 5e-7);
}

// Chords of similar shapes in one direction: the parallelogram of the theory's example is not one of ours, so a
// rectangle is met with lines spread evenly across it.
TEST(SizeTest, ChordsOfEllipsesAndRectanglesByLines) {
  for (const JointShape shape : {JointShape::ellipse, JointShape::rectangle}) {
    for (const double trace : {0.0, 20.0, 50.0, 90.0, 140.0}) {
      SCOPED_TRACE(trace);
      const ShapeRule rule{shape, 2.5, 10};
      const Chords chords = chords_of(rule, trace);
      // Long axis along x; lines in direction (c, s), at offset u across.
      const double beta = (trace - 10) * pi / 180, c = std::cos(beta), s = std::sin(beta);
      double hits = 0, first = 0, second = 0;
      constexpr int lines = 200'000;
      constexpr double span = 2;  // offsets from -1 to 1
      for (int i = 0; i < lines; ++i) {
        const double u = -1 + span * (i + 0.5) / lines, x = -u * s, y = u * c;
        double chord = 0;
        if (shape == JointShape::ellipse) {
          const double a = 0.5, b = 0.2, p = c * c / a / a + s * s / b / b, q = x * c / a / a + y * s / b / b;
          const double d = q * q - p * (x * x / a / a + y * y / b / b - 1);
          chord = d > 0 ? 2 * std::sqrt(d) / p : 0;
        } else {
          double low = -9, high = 9;
          const auto within = [&](double at, double direction, double half) {
            if (std::abs(direction) < 1e-12) {
              if (std::abs(at) > half) high = low;
              return;
            }
            const double t1 = (-half - at) / direction, t2 = (half - at) / direction;
            low = std::max(low, std::min(t1, t2));
            high = std::min(high, std::max(t1, t2));
          };
          within(x, c, 0.5);
          within(y, s, 0.2);
          chord = std::max(0.0, high - low);
        }
        hits += chord > 0 ? 1 : 0;
        first += chord;
        second += chord * chord;
      }
      EXPECT_NEAR(chords.first, first / hits, 1e-4);
      EXPECT_NEAR(chords.second, second / hits, 1e-4);
      EXPECT_NEAR(chords.width(), hits * span / lines, 1e-4);
      EXPECT_EQ(chords.disc.has_value(), shape == JointShape::ellipse);
    }
  }
}

TEST(SizeTest, MomentsAreUndoneForEveryShape) {
  for (const ShapeRule& rule :
       {ShapeRule{}, ShapeRule{JointShape::ellipse, 3, 25}, ShapeRule{JointShape::rectangle, 2, 0}}) {
    const Chords chords = chords_of(rule, 70);
    for (const Family family : {Family::lognormal, Family::gamma}) {
      const SizeOfJoints truth{.family = family, .mean = 3, .std = 1.5};
      const double mean = chords.first * size_moment(truth, 2) / size_moment(truth, 1);
      const double second = chords.second * size_moment(truth, 3) / size_moment(truth, 1);
      const auto back = size_law(family, mean, second, chords);
      ASSERT_TRUE(back.has_value());
      EXPECT_NEAR(back->mean, 3, 1e-9);
      EXPECT_NEAR(back->std, 1.5, 1e-9);
    }
  }
  Fit power = law_of(Family::power, 1.7);
  power.min = 0.5;
  power.max = 20;
  const auto back = power_size(power.moment(2) / power.moment(1), 0.5, 20);
  ASSERT_TRUE(back.has_value());
  EXPECT_NEAR(back->exponent, 1.7, 1e-9);
  EXPECT_NEAR(back->mean, power.moment(1), 1e-9);
  EXPECT_NEAR(size_moment(*back, 3), power.moment(3), 1e-7);
  EXPECT_FALSE(power_size(30, 0.5, 20).has_value());
}

// Against Warburton's integrals: the moments of the traces are those of the diameters, and for the exponential law the
// density is l K0(l/a)/a^2.
TEST(SizeTest, TracesOfDiscsHaveTheirLaw) {
  for (const Fit& law :
       {law_of(Family::exponential, 2), law_of(Family::lognormal, 0.7, 0.6), law_of(Family::gamma, 2.5, 1.2)}) {
    double whole = 0, first = 0, second = 0;
    constexpr double step = 0.005, most = 80;
    for (double l = step / 2; l < most; l += step) {
      const double g = disc_trace_density(law, l) * step;
      whole += g;
      first += l * g;
      second += l * l * g;
    }
    EXPECT_NEAR(whole, 1, 2e-4) << name_of(law.family);
    EXPECT_NEAR(first, pi / 4 * law.moment(2) / law.moment(1), 1e-3 * first) << name_of(law.family);
    EXPECT_NEAR(second, 2.0 / 3 * law.moment(3) / law.moment(1), 1e-3 * second) << name_of(law.family);
    // Probability of more than 3.
    double above = 0;
    for (double l = 3 + step / 2; l < most; l += step) above += disc_trace_density(law, l) * step;
    EXPECT_NEAR(disc_trace_above(law, 3), above, 1e-4) << name_of(law.family);
  }
  const Fit exponential = law_of(Family::exponential, 2);
  for (const double l : {0.1, 1.0, 5.0}) {
    EXPECT_NEAR(disc_trace_density(exponential, l), l * std::cyl_bessel_k(0, l / 2) / 4, 1e-9);
    EXPECT_NEAR(disc_trace_above(exponential, l), l / 2 * std::cyl_bessel_k(1, l / 2), 1e-9);
  }
}

// Whole traces of discs by the thousands: the likelihood finds the law, with every length looked up and (more than 400)
// by the grid.
TEST(SizeTest, LikelihoodOfTracesFindsTheDiameters) {
  for (const std::size_t n : {400U, 4000U}) {
    for (const Fit& truth :
         {law_of(Family::exponential, 2), law_of(Family::lognormal, 0.7, 0.6), law_of(Family::gamma, 2.5, 1.2)}) {
      Rng rng{5};
      std::vector<SeenLength> lengths;
      // A disc is met with a probability that rises with its diameter: drawn by rejection.
      const double most = truth.quantile(1 - 1e-7);
      while (lengths.size() < n) {
        const double d = truth.quantile(rng.uniform());
        if (rng.uniform() * most > d) continue;
        const double u = rng.uniform();
        lengths.push_back({d * std::sqrt(1 - u * u), 2});
      }
      const auto fit = fit_discs(lengths, {1, 0}, truth.family);
      ASSERT_TRUE(fit.has_value());
      const Estimate mean = estimate_of(*fit, "mean", [](const Fit& f) { return f.moment(1); }, 0.9999);
      EXPECT_LT(mean.low, truth.moment(1)) << name_of(truth.family) << n;
      EXPECT_GT(mean.high, truth.moment(1)) << name_of(truth.family) << n;
      EXPECT_LT(mean.high / mean.low, n == 400 ? 3.5 : 1.5) << name_of(truth.family);
    }
  }
  EXPECT_FALSE(fit_discs(std::vector<SeenLength>{{1, 0}}, {1, 0}, Family::gamma).has_value());
}

// The likelihood of nearly equal discs has a pole at the longest trace: no fit may run into it, whatever the sample.
TEST(SizeTest, FitsDoNotCollapseToOneSize) {
  int fits = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    Rng rng{{.seed = 12, .realization = k}};
    std::vector<SeenLength> lengths;
    for (int i = 0; i < 37; ++i) {
      const double d = k % 3 == 0 ? 4.7314 : 3 * std::exp(0.6 * rng.normal()), u = rng.uniform();
      lengths.push_back({d * std::sqrt(1 - u * u), rng.uniform() < 0.7 ? 2U : 1U});
    }
    for (const Family family : {Family::lognormal, Family::gamma}) {
      const auto fit = fit_discs(lengths, {50, 8}, family);
      if (!fit) continue;  // refused: it has no maximum in between
      ++fits;
      EXPECT_GT(std_of(*fit), 0.02 * fit->moment(1)) << k;
      const Estimate mean = estimate_of(*fit, "mean", [](const Fit& f) { return f.moment(1); });
      EXPECT_GT(mean.high, 1.02 * mean.low) << k;
      EXPECT_LT(mean.value.value(), 40) << k;
    }
  }
  EXPECT_GT(fits, 60);
}

// Discs of one size: a collapse means that they are, with the size and an interval, and how much spread there may be.
TEST(SizeTest, EqualDiscsHaveTheirSize) {
  int held = 0, spreads = 0, best = 0;
  constexpr int samples = 200;
  for (std::uint64_t k = 0; k < samples; ++k) {
    Rng rng{{.seed = 13, .realization = k}};
    std::vector<SeenLength> lengths;
    // Pieces of traces of 4 m in a window of 50 m2, 8 m wide: whole with the chance that their length leaves.
    while (lengths.size() < 40) {
      const double u = rng.uniform(), l = 4 * std::sqrt(1 - u * u), met = rng.uniform() * (50 + 8 * 4.0);
      if (met > 50 + 8 * l) continue;
      // Ends beyond the border: both inside for A - b l of the places, one for 2 b l (nearly).
      const bool whole = met < 50 - 8 * l;
      lengths.push_back(whole ? SeenLength{std::round(100 * l) / 100, 2} : SeenLength{l * rng.uniform(), 1});
    }
    const auto one = fit_discs(lengths, {50, 8}, Family::constant);
    ASSERT_TRUE(one.has_value());
    const Estimate size = estimate_of(*one, "size", [](const Fit& f) { return f.moment(1); });
    held += size.low <= 4 && 4 <= size.high ? 1 : 0;
    EXPECT_NEAR(size.value.value(), 4, 0.4);
    spreads += one->max > 0.05 && one->max < 2 ? 1 : 0;
    const auto other = fit_discs(lengths, {50, 8}, Family::exponential);
    best += one->aic + 10 < other->aic ? 1 : 0;
  }
  RecordProperty("held", held);
  EXPECT_GE(held, samples * 0.95 - 2.5 * std::sqrt(samples * 0.95 * 0.05));
  EXPECT_GE(spreads, 0.95 * samples);
  EXPECT_GE(best, 0.99 * samples);
  // Two longest traces of one rounded length are no pole to run into.
  Rng rng{14};
  std::vector<SeenLength> unequal;
  for (int i = 0; i < 60; ++i) unequal.push_back({std::round(10 * 3 * std::exp(0.6 * rng.normal())) / 10 + 0.1, 2});
  double longest = 0;
  for (const SeenLength& l : unequal) longest = std::max(longest, l.length);
  for (int i = 0; i < 2; ++i) unequal.push_back({longest, 2});
  EXPECT_LT(fit_discs(unequal, {50, 8}, Family::lognormal)->aic + 20,
            fit_discs(unequal, {50, 8}, Family::constant)->aic);
}

// The law of one size against its own integrals.
TEST(SizeTest, TracesOfEqualDiscsHaveTheirLaw) {
  const Fit law = law_of(Family::constant, 4);
  EXPECT_NEAR(disc_trace_above(law, 2), std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(disc_trace_density(law, 2), 2 / (4 * std::sqrt(12.0)), 1e-15);
  EXPECT_EQ(disc_trace_density(law, 4.1), 0);
  double excess = 0, first = 0;
  constexpr double step = 1e-4;
  for (double l = step / 2; l < 4; l += step) {
    first += disc_trace_above(law, l) * step;
    if (l > 1) excess += disc_trace_above(law, l) * step;
  }
  EXPECT_NEAR(first, pi, 1e-5);  // mean trace, pi/4 of the diameter
  EXPECT_NEAR(disc_chance(law, {50, 8}), 50 + 8 * pi, 1e-9);
  EXPECT_NEAR(disc_chance(law, {50, 8, 1}), 42 * std::sqrt(15.0 / 16) + 8 * excess, 1e-3);
  EXPECT_EQ(law.moment(3), 64);
  EXPECT_EQ(law.quantile(0.3), 4);
  EXPECT_EQ(law.mean_excess(1), 3);
  EXPECT_EQ(size_moment(size_of(law), 2), 16);
}

/// Discs on edge with a gamma law of mean 3 and standard deviation 4.5 m, about 40 traces in a circle of radius 5 m: a
/// sample of `./x study coverage`.
SurveyInput gamma_outcrop(std::uint64_t sample) {
  constexpr double mean = 3, variation = 2.25, half = 25;
  const double trace = std::numbers::pi / 4 * mean * (1 + variation);
  const double p20 = 40 / (25 * std::numbers::pi + 10 * trace);
  Rng rng{{.seed = 74, .realization = sample, .purpose = 3}};
  WindowSurvey window{.name = "w",
                      .window = CircleWindow{{0, 0}, 5},
                      .normal = {0, 0, 1},
                      .x_axis = {1, 0, 0},
                      .traces = {},
                      .border = {},
                      .truncation = {}};
  for (double at = -std::log(rng.uniform()); at < p20 * 4 * half * half; at -= std::log(rng.uniform())) {
    const double d = support::detail::gamma_draw(rng, 1 / variation + 1) * mean * variation;
    const double u = rng.uniform(), l = d * std::sqrt(1 - u * u);
    const double x = half * (2 * rng.uniform() - 1), y = half * (2 * rng.uniform() - 1);
    window.traces.push_back({{x, y - l / 2}, {x, y + l / 2}});
  }
  SurveyInput input;
  input.windows.push_back(std::move(window));
  input.rules.push_back(support::north_set());
  return input;
}

// Small joints leave few traces, so these hardly tell how many there are: the interval of the mean size has to reach
// down to where the likelihood of gamma laws falls. By its curvature it ended above 3 m in all of these samples, and in
// 19 of 100; in some the likelihood rises up to the widest law.
TEST(SizeTest, TheMeanMayBeSmallWhereSmallJointsAreNotSeen) {
  for (const std::uint64_t sample : {1U, 22U, 32U, 46U, 71U, 82U, 93U, 96U}) {
    const SurveyResult result = analyse(gamma_outcrop(sample));
    const Estimate& mean = *result.sets.front().size_mean;
    EXPECT_LE(mean.low, 3) << sample;
    EXPECT_GE(mean.low, 0.05) << sample;
    EXPECT_GE(mean.high, 3) << sample;
    EXPECT_LE(mean.high, 40) << sample;
  }
}

}  // namespace
}  // namespace cleave::survey::size_test
