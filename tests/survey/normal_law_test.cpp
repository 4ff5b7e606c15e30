#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/traces.hpp"

// The normal law of trace lengths (Fu 2014, table A-1), cut at 0, against quadrature and by its coverage.

namespace cleave::survey::normal_law_test {
namespace {

Fit normal(double a, double b) {
  Fit fit;
  fit.family = Family::normal;
  fit.a = a;
  fit.b = b;
  return fit;
}

TEST(NormalLawTest, FiguresAgreeWithQuadrature) {
  for (const auto& [a, b] : {std::pair{5.0, 1.0}, std::pair{3.0, 2.0}, std::pair{0.5, 2.0}}) {
    const Fit law = normal(a, b);
    constexpr int steps = 200'000;
    const double top = a + 12 * b, h = top / steps, at = h * std::floor(1.3 / h);
    double mass = 0, excess = 0, below = 0;
    std::array<double, 4> moments{};
    for (int i = 0; i < steps; ++i) {
      const double x = (i + 0.5) * h, p = law.density(x) * h;
      mass += p;
      for (std::size_t k = 0; k < 4; ++k) moments[k] += p * std::pow(x, static_cast<double>(k) + 1);
      if (x > at) excess += p * (x - at);
      if (x < at) below += p;
    }
    EXPECT_NEAR(mass, 1, 1e-9);
    for (int k = 1; k <= 4; ++k) {
      EXPECT_NEAR(law.moment(k) / moments[static_cast<std::size_t>(k) - 1], 1, 1e-8) << k;
    }
    EXPECT_NEAR(law.mean_excess(at), excess, 1e-8);
    EXPECT_NEAR(law.below(at), below, 1e-8);
    for (const double u : {1e-6, 0.2, 0.7, 0.999}) EXPECT_NEAR(law.below(law.quantile(u)), u, 1e-12);
  }
}

// Traces in a window of area 60 and width 6 with ends cut off as they come: centres at random along a strip.
TEST(NormalLawTest, FitsCensoredTracesAndCovers) {
  constexpr int samples = 400;
  const Fit truth = normal(4, 1.2);
  int mean = 0, spread = 0, chosen = 0;
  for (int k = 0; k < samples; ++k) {
    Rng rng{{.seed = 41, .realization = static_cast<std::uint64_t>(k)}};
    std::vector<SeenLength> seen;
    // Window 10 m along the traces, 6 m across: a trace of length l is met where its middle lies within (10 + l)/2.
    while (seen.size() < 80) {
      const double l = truth.quantile(rng.uniform()), middle = (2 * rng.uniform() - 1) * (10 + 12) / 2;
      const double from = std::max(-5.0, middle - l / 2), to = std::min(5.0, middle + l / 2);
      if (from >= to) continue;
      seen.push_back(
          {to - from, static_cast<std::uint32_t>((middle - l / 2 > -5 ? 1 : 0) + (middle + l / 2 < 5 ? 1 : 0))});
    }
    const auto fit = fit_lengths(seen, {.area = 60, .width = 6}, Family::normal);
    ASSERT_TRUE(fit.has_value());
    const auto holds = [](const Estimate& e, double v) { return e.low <= v && v <= e.high ? 1 : 0; };
    mean += holds(estimate_of(*fit, "m", [](const Fit& f) { return f.moment(1); }), truth.moment(1));
    spread += holds(estimate_of(*fit, "s", [](const Fit& f) { return std_of(f); }), std_of(truth));
    const auto other = fit_lengths(seen, {.area = 60, .width = 6}, Family::exponential);
    chosen += other && fit->aic < other->aic ? 1 : 0;
  }
  // 95 % within 2.7 standard errors of the count.
  EXPECT_GE(mean, 368);
  EXPECT_LE(mean, 392);
  EXPECT_GE(spread, 366);
  EXPECT_LE(spread, 392);
  EXPECT_GT(chosen, 390);
}

}  // namespace
}  // namespace cleave::survey::normal_law_test
