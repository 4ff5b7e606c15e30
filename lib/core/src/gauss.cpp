#include <array>
#include <cmath>
#include <numbers>

#include "cleave/core/assert.hpp"
#include "cleave/core/special.hpp"

namespace cleave::special {
namespace {

constexpr std::size_t most = 64;

GaussRule make(std::size_t n) {
  GaussRule rule{std::vector<double>(n), std::vector<double>(n)};
  const double count = static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    // Newton's method on the Legendre polynomial from the usual cosine guess.
    double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (count + 0.5));
    double slope = 1;
    for (int pass = 0; pass < 100; ++pass) {
      double before = 1;
      double value = x;
      for (std::size_t k = 2; k <= n; ++k) {
        const double order = static_cast<double>(k);
        const double next = ((2 * order - 1) * x * value - (order - 1) * before) / order;
        before = value;
        value = next;
      }
      slope = n == 1 ? 1 : count * (x * value - before) / (x * x - 1);
      const double step = value / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.s[i] = x;
    rule.w[i] = 2 / ((1 - x * x) * slope * slope);
  }
  if (n % 2 == 1) rule.s[n / 2] = 0;
  return rule;
}

std::array<GaussRule, most + 1> make_all() {
  std::array<GaussRule, most + 1> all;
  for (std::size_t n = 1; n <= most; ++n) all[n] = make(n);
  return all;
}

}  // namespace

const GaussRule& gauss_rule(std::size_t n) {
  static const std::array<GaussRule, most + 1> all = make_all();
  CLEAVE_ASSERT(n >= 1 && n <= most);
  return all[n];
}

}  // namespace cleave::special
