#include "cleave/stochastic/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {

std::vector<std::uint64_t> looks(std::uint64_t max) {
  std::vector<std::uint64_t> result;
  for (double at = 100; at < static_cast<double>(max); at *= 1.5) {
    result.push_back(static_cast<std::uint64_t>(std::ceil(at)));
  }
  while (!result.empty() && result.back() >= max) result.pop_back();
  result.push_back(max);
  return result;
}

double half_width(const Moments& moments, const Stop& stop) {
  const auto n = static_cast<double>(moments.count());
  switch (stop.rule) {
    case StopRule::fixed_looks: return normal_quantile(0.5 + stop.confidence / 2) * moments.standard_error();
    case StopRule::always_valid: {
      constexpr double rho = 0.1;
      const double spread = n * rho * rho + 1;
      return moments.std() *
             std::sqrt(2 * spread / (n * n * rho * rho) * std::log(std::sqrt(spread) / (1 - stop.confidence)));
    }
  }
  std::unreachable();
}

bool narrow_enough(const Moments& moments, const Stop& stop) {
  if (moments.count() < 100 || moments.mean() == 0) return false;
  if (moments.skewness() > 2 && moments.count() < 300) return false;
  return half_width(moments, stop) <= stop.relative_half_width * std::abs(moments.mean());
}

}  // namespace cleave::stochastic
