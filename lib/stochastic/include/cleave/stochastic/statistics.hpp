#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cleave::stochastic {

// ---- Moments --------------------------------------------------------------------------------------------------------

/// Running mean and central moments up to the fourth of numbers that come in a fixed order (Welford 1962, Pebay 2008).
/// Same numbers in the same order, same bits.
class Moments final {
 public:
  void add(double x) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return n_; }
  [[nodiscard]] double mean() const noexcept { return mean_; }
  [[nodiscard]] double variance() const noexcept;  ///< m2/(n - 1); 0 for n < 2
  [[nodiscard]] double std() const noexcept;
  [[nodiscard]] double standard_error() const noexcept;  ///< of the mean
  [[nodiscard]] double skewness() const noexcept;        ///< sqrt(n) m3/m2^(3/2); 0 without spread
  [[nodiscard]] double excess_kurtosis() const noexcept;
  [[nodiscard]] double largest() const noexcept { return max_; }
  [[nodiscard]] double smallest() const noexcept { return min_; }

 private:
  std::uint64_t n_ = 0;
  double mean_ = 0, m2_ = 0, m3_ = 0, m4_ = 0, min_ = 0, max_ = 0;
};

/// Moments of pairs: for ratios of sums, sum y / sum x.
class PairMoments final {
 public:
  void add(double y, double x) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return n_; }
  /// sum y / sum x; 0 when sum x is 0.
  [[nodiscard]] double ratio() const noexcept;
  /// Delta method, the pairs independent of each other: sqrt(sum (y - R x)^2/((n - 1) n))/mean x.
  [[nodiscard]] double ratio_standard_error() const noexcept;
  [[nodiscard]] bool has_ratio() const noexcept { return mean_x_ > 0; }
  /// Of y - R x about the ratio R; 0 without spread.
  [[nodiscard]] double ratio_skewness() const noexcept;
  /// (sum x)^2/sum x^2: as many equal x would weigh as much.
  [[nodiscard]] double equal_parts() const noexcept;
  [[nodiscard]] double sum_x() const noexcept { return mean_x_ * static_cast<double>(n_); }

 private:
  std::uint64_t n_ = 0;
  double mean_y_ = 0, mean_x_ = 0, yy_ = 0, xx_ = 0, xy_ = 0, yyy_ = 0, yyx_ = 0, yxx_ = 0, xxx_ = 0;
};

/// Upper tail of numbers that are not negative, as seen from their middle: how far those above the median lie from it
/// on the logarithm. Few large values move it little, while they make both mean and standard error of a sample: a
/// sample that met none has the same tail as one that did.
class Tail final {
 public:
  void add(double x, double weight = 1);
  /// Numbers above 0, as many of equal weight: (sum w)^2/sum w^2.
  [[nodiscard]] double parts() const noexcept;
  /// Square of the standard deviation of the logarithm that a lognormal law with this upper half has.
  [[nodiscard]] double log_variance() const noexcept;
  /// Square of the standard error of the logarithm of such a law's mean, from its median, spread and share of zeros
  /// (Cox's method; Zhou & Gao 1997); 0 without a tail.
  [[nodiscard]] double log_error_squared() const noexcept;
  /// A long tail seen in few numbers: an interval of the mean may cover less than it says.
  [[nodiscard]] bool long_from_few() const noexcept;

 private:
  std::map<int, double> bins_;  // weight by logarithm, in steps that are small against a long tail's spread
  double above_ = 0, above_squares_ = 0, all_ = 0, all_squares_ = 0;
  bool negative_ = false;
};

// ---- Values kept to the end -----------------------------------------------------------------------------------------

/// Numbers that are only needed again at the end. Beyond a few thousand they go to a temporary file without a name, so
/// that memory does not grow with their number; where no such file can be had they stay in memory.
class ValueStore final {
 public:
  void push_back(double value);
  [[nodiscard]] std::size_t size() const noexcept { return written_ + recent_.size(); }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  /// All of them, in their order. Empty when the temporary file cannot be read back (disk full).
  [[nodiscard]] std::vector<double> all() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { static_cast<void>(std::fclose(file)); }
  };
  static constexpr std::size_t most_recent = 2048;
  std::vector<double> recent_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t written_ = 0;
  bool in_memory_ = false;
};

// ---- Intervals ------------------------------------------------------------------------------------------------------

struct Interval {
  double low = 0, high = 0;
};

/// mean -+ t SE with n - 1 degrees of freedom; n >= 2.
[[nodiscard]] Interval t_interval(double mean, double standard_error, std::uint64_t n, double confidence);
/// As `t_interval`, of a mean or ratio of skewed values: Student's t moved by their skewness (Hall 1992) and widened by
/// 1 + widening |skewness|/sqrt n, as the skewness is itself seen too small in few values.
[[nodiscard]] Interval skew_interval(double mean, double standard_error, double skewness, std::uint64_t n,
                                     double confidence, double widening);
/// `interval` of a mean or ratio, with the upper end that a lognormal law with the tail has where that one is higher.
[[nodiscard]] Interval with_tail(Interval interval, double mean, const Tail& tail, std::uint64_t n, double confidence);
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

// ---- When to stop ---------------------------------------------------------------------------------------------------

enum class StopRule : std::uint8_t {
  fixed_looks,   ///< looks at 100, 150, 225, ... realizations only; z SE <= h |mean|
  always_valid,  ///< the same looks with an asymptotic confidence sequence (Waudby-Smith et al. 2024), rho = 0.1
};

/// Stop when the interval of `quantity` is narrow enough, or at `max`.
struct Stop {
  std::string quantity = "key_block_volume_m3";
  double relative_half_width = 0.05;
  double confidence = 0.95;
  std::uint64_t max = 10000;
  StopRule rule = StopRule::fixed_looks;
};

/// The numbers of realizations at which a run may stop: ceil(100 * 1.5^j) below `max`, then `max` itself.
[[nodiscard]] std::vector<std::uint64_t> looks(std::uint64_t max);
/// Half width of the interval that the rule goes by, absolute.
[[nodiscard]] double half_width(const Moments& moments, const Stop& stop);
/// Whether the run may stop after what `moments` has seen. Laws with a skewness above 2 are not judged before 300
/// realizations; a mean of 0 never.
[[nodiscard]] bool narrow_enough(const Moments& moments, const Stop& stop);

}  // namespace cleave::stochastic
