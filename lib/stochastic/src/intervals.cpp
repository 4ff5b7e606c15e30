#include "cleave/stochastic/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"

namespace cleave::stochastic {

Interval t_interval(double mean, double standard_error, std::uint64_t n, double confidence) {
  CLEAVE_ASSERT(n >= 2);
  const double half = special::student_t_quantile(0.5 + confidence / 2, static_cast<double>(n - 1)) * standard_error;
  return {mean - half, mean + half};
}

Interval skew_interval(double mean, double standard_error, double skewness, std::uint64_t n, double confidence,
                       double widening) {
  CLEAVE_ASSERT(n >= 2);
  const double a = skewness / std::sqrt(static_cast<double>(n));
  const double t = special::student_t_quantile(0.5 + confidence / 2, static_cast<double>(n - 1));
  // The normal variate y of a t statistic: y = t + a (2 t^2 + 1)/6 + ... = [(1 + a t/3)^3 - 1]/a + a/6.
  const auto statistic = [&](double y) {
    return std::abs(a) < 1e-6 ? y : (std::cbrt(1 + a * (y - a / 6)) - 1) * 3 / a;
  };
  const double far = t * (1 + widening * std::abs(a));
  return {mean - standard_error * statistic(far), mean - standard_error * statistic(-far)};
}

Interval with_tail(Interval interval, double mean, const Tail& tail, std::uint64_t n, double confidence) {
  CLEAVE_ASSERT(n >= 2);
  const double t = special::student_t_quantile(0.5 + confidence / 2, static_cast<double>(n - 1));
  return {interval.low, std::max(interval.high, mean * std::exp(t * std::sqrt(tail.log_error_squared())))};
}

Interval clopper_pearson(std::uint64_t k, std::uint64_t n, double confidence) {
  CLEAVE_ASSERT(n >= 1 && k <= n);
  const double a = (1 - confidence) / 2, successes = static_cast<double>(k), others = static_cast<double>(n - k);
  return {k == 0 ? 0 : special::beta_quantile(a, successes, others + 1),
          k == n ? 1 : special::beta_quantile(1 - a, successes + 1, others)};
}

Interval clopper_pearson_effective(double share, double effective, double confidence) {
  CLEAVE_ASSERT(effective > 0 && share >= 0 && share <= 1);
  const double a = (1 - confidence) / 2, successes = share * effective, others = effective - successes;
  return {share <= 0 ? 0 : special::beta_quantile(a, successes, others + 1),
          share >= 1 ? 1 : special::beta_quantile(1 - a, successes + 1, others)};
}

std::optional<Ranks> quantile_ranks(std::uint64_t n, double p, double confidence) {
  const double a = (1 - confidence) / 2;
  // The r-th smallest lies above the quantile with probability P(B <= r - 1), the s-th below with P(B >= s).
  std::uint64_t low = 0, high = 0;
  std::uint64_t from = 0, to = n;  // largest r with P(B <= r - 1) <= a, by bisection: the probability rises with r
  while (from < to) {
    const std::uint64_t middle = (from + to + 1) / 2;
    if (special::binomial_cdf(middle - 1, n, p) <= a) {
      from = middle;
    } else {
      to = middle - 1;
    }
  }
  low = from;
  from = 1;
  to = n + 1;  // smallest s with 1 - P(B <= s - 1) <= a
  while (from < to) {
    const std::uint64_t middle = (from + to) / 2;
    if (1 - special::binomial_cdf(middle - 1, n, p) <= a) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  high = from;
  if (low == 0 || high > n) return std::nullopt;
  return Ranks{low, high};
}

std::uint64_t wilks_size(std::uint64_t k, double p, double confidence) {
  std::uint64_t n = k;
  // The k-th largest is below the quantile when fewer than k values lie above it.
  while (special::binomial_cdf(k - 1, n, 1 - p) > 1 - confidence) ++n;
  return n;
}

std::optional<Interval> bca_mean(std::span<const double> values, double confidence, std::uint32_t resamples,
                                 std::uint64_t seed) {
  const std::size_t n = values.size();
  if (n < 3 || std::ranges::adjacent_find(values, std::ranges::not_equal_to{}) == values.end()) return std::nullopt;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
  // The jackknife values of a mean are linear in the values themselves.
  double second = 0, third = 0;
  for (const double v : values) {
    const double d = v - mean;
    second += d * d;
    third += d * d * d;
  }
  const double acceleration = third / (6 * std::pow(second, 1.5));
  std::vector<double> means(resamples);
  double below = 0;
  for (std::uint32_t b = 0; b < resamples; ++b) {
    Rng rng{{.seed = seed, .realization = ~std::uint64_t{0}, .purpose = 0xffffffffU, .index = b}};
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += values[static_cast<std::size_t>(rng.uniform() * static_cast<double>(n))];
    means[b] = sum / static_cast<double>(n);
    below += means[b] < mean ? 1 : (means[b] == mean ? 0.5 : 0);
  }
  std::ranges::sort(means);
  const double share = std::clamp(below / resamples, 0.5 / resamples, 1 - 0.5 / resamples);
  const double bias = normal_quantile(share);
  const auto end = [&](double p) {
    const double z = bias + normal_quantile(p);
    const double level = special::normal_cdf(bias + z / (1 - acceleration * z));
    const auto at = static_cast<std::size_t>(std::clamp(level * resamples, 0.0, static_cast<double>(resamples - 1)));
    return means[at];
  };
  return Interval{end((1 - confidence) / 2), end((1 + confidence) / 2)};
}

}  // namespace cleave::stochastic
