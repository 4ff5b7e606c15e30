#pragma once

#include <cstdint>

namespace cleave::stochastic {

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

}  // namespace cleave::stochastic
