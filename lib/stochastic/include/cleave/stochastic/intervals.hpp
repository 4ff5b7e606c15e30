#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace cleave::stochastic {

struct Interval {
  double low = 0, high = 0;
};

/// mean -+ t SE with n - 1 degrees of freedom; n >= 2.
[[nodiscard]] Interval t_interval(double mean, double standard_error, std::uint64_t n, double confidence);
/// As `t_interval`, of a mean or ratio of skewed values: Student's t moved by their skewness (Hall 1992) and widened by
/// 1 + widening |skewness|/sqrt n, as the skewness is itself seen too small in few values.
[[nodiscard]] Interval skew_interval(double mean, double standard_error, double skewness, std::uint64_t n,
                                     double confidence, double widening);
/// Of a probability after k successes in n trials, n >= 1: Clopper & Pearson (1934), exact (at least the confidence).
[[nodiscard]] Interval clopper_pearson(std::uint64_t k, std::uint64_t n, double confidence);
/// The same of a share that comes from samples that hang together (Korn & Graubard 1998): `share` of `effective`
/// independent trials, neither a whole number.
[[nodiscard]] Interval clopper_pearson_effective(double share, double effective, double confidence);
/// Ranks (from 1) r <= s of order statistics that hold the p quantile between them with at least the confidence, each
/// side at most (1 - confidence)/2; empty when n is too small (Wilks 1941).
struct Ranks {
  std::uint64_t low, high;
};
[[nodiscard]] std::optional<Ranks> quantile_ranks(std::uint64_t n, double p, double confidence);
/// Smallest n for which the k-th largest value is an upper bound of the p quantile with the confidence.
[[nodiscard]] std::uint64_t wilks_size(std::uint64_t k, double p, double confidence);
/// Bias-corrected accelerated bootstrap interval of the mean (Efron 1987), `resamples` resamples of the values keyed by
/// `seed`. Needs 3 values or more that are not all equal.
[[nodiscard]] std::optional<Interval> bca_mean(std::span<const double> values, double confidence,
                                               std::uint32_t resamples, std::uint64_t seed);

}  // namespace cleave::stochastic
