#pragma once

#include <optional>
#include <string>

namespace cleave::survey {

/// A figure of a survey with its confidence interval. `note` says how it came about or why it cannot be had.
struct Estimate {
  std::string name;
  std::optional<double> value;  ///< empty: not estimable
  double low = 0, high = 0;
  std::string method;
  std::string note;
};

/// a/b of two positive estimates that scatter independently: their half widths on the logarithm are added as squares.
[[nodiscard]] Estimate over(const Estimate& a, const Estimate& b, std::string name, std::string method);

}  // namespace cleave::survey
