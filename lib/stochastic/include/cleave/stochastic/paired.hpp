#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/stochastic/record.hpp"
#include "cleave/stochastic/statistics.hpp"

namespace cleave::stochastic {

/// One quantity of two designs judged on the same random numbers.
struct PairedEstimate {
  std::string name;
  std::uint64_t pairs = 0;
  double first = 0, second = 0;  ///< means
  double difference = 0;         ///< mean of second - first
  double standard_error = 0;     ///< of the difference, from the paired differences
  Interval interval;             ///< Student's t; without ends where no pair differs
  double correlation = 0;        ///< of the two designs over the realizations; 0 without spread
  /// Variance of the difference with independent random numbers over that with common ones: so many times fewer
  /// realizations. Empty when the designs never differ or never vary.
  std::optional<double> gain;
};

/// Compares two designs realization by realization (common random numbers): excavation sequences, supports, loads. Only
/// realizations that both have and could do count. `unit` realizations in a row are one sample (nested designs).
class PairedComparison final {
 public:
  explicit PairedComparison(std::uint64_t unit = 1);
  /// The records of one realization, in ascending order. Precondition: the same number.
  void add(const Record& first, const Record& second);
  /// Realizations that one of the two could not do: left out.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }
  /// Realizations in which the designs do not have as many joints: then their random numbers are not those of the same
  /// rock.
  [[nodiscard]] std::uint64_t other_joints() const noexcept { return other_joints_; }
  /// Of what both were asked for; `by_case`: only of what load cases have.
  [[nodiscard]] std::vector<PairedEstimate> estimates(double confidence, bool by_case = false) const;
  /// Quantities that one of the two alone was asked for, by name.
  struct OnlyInOne {
    std::vector<std::string> first, second;
  };
  [[nodiscard]] OnlyInOne only_in_one() const;

 private:
  struct Sums {
    double first = 0, second = 0;
  };
  struct Paired {
    Moments first, second, difference, sum;    // the sum gives the covariance
    bool in_first = false, in_second = false;  // asked for
  };
  void finish_unit();

  std::uint64_t unit_;
  std::vector<Paired> quantities_;
  std::vector<Sums> sums_;
  std::uint64_t in_unit_ = 0, unit_number_ = 0;
  std::uint64_t left_out_ = 0, other_joints_ = 0;
};

}  // namespace cleave::stochastic
