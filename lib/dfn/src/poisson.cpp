#include "poisson.hpp"

#include <cmath>
#include <numbers>

namespace cleave::dfn::detail {
namespace {

/// ln k!; Stirling's series (std::lgamma writes a global).
double log_factorial(double k) {
  double shift = 0;
  double x = k + 1;
  while (x < 10) shift += std::log(x++);
  const double r = 1 / x, r2 = r * r;
  return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2 * std::numbers::pi) +
         r * (1.0 / 12 - r2 * (1.0 / 360 - r2 * (1.0 / 1260 - r2 * (1.0 / 1680 - r2 / 1188)))) - shift;
}

std::uint64_t by_inversion(double mean, double u) {
  double term = std::exp(-mean), sum = term;
  std::uint64_t k = 0;
  while (u > sum && k < 1000) {  // beyond 1000 no probability is left that a double can see
    term *= mean / static_cast<double>(++k);
    sum += term;
  }
  return k;
}

}  // namespace

std::uint64_t poisson(double mean, Rng& rng) noexcept {
  if (!(mean > 0)) return 0;
  if (mean < 30) return by_inversion(mean, rng.uniform());
  const double b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
  const double log_mean = std::log(mean);
  for (;;) {
    const double u = rng.uniform() - 0.5, v = rng.uniform();
    const double us = 0.5 - std::abs(u);
    const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return static_cast<std::uint64_t>(k);
    if (k < 0 || (us < 0.013 && v > us)) continue;
    if (std::log(v * inverse_alpha / (a / (us * us) + b)) <= k * log_mean - mean - log_factorial(k)) {
      return static_cast<std::uint64_t>(k);
    }
  }
}

}  // namespace cleave::dfn::detail
