#pragma once

#include <cmath>
#include <string>

#include "cleave/exchange/text.hpp"
#include "cleave/stochastic/ensemble.hpp"

/// Parts of the page of an ensemble. HTML; empty where there is nothing to show.
namespace cleave::report::detail {

inline std::string percent(double share, int digits = 3) { return display(100 * share, digits) + " %"; }
inline std::string interval(double low, double high) {
  const auto end = [](double value) { return std::isfinite(value) ? display(value) : std::string{"not known"}; };
  return end(low) + " … " + end(high);
}

/// Size distribution of the blocks, with its band.
[[nodiscard]] std::string block_size_figure(const stochastic::Figures& f);
/// Percentiles by number and by volume side by side, and shares of shapes.
[[nodiscard]] std::string block_size_tables(const stochastic::Figures& f);
[[nodiscard]] std::string sets_table(const stochastic::Figures& f);
[[nodiscard]] std::string lines_table(const stochastic::Figures& f);
[[nodiscard]] std::string percolation_table(const stochastic::Figures& f);

}  // namespace cleave::report::detail
