#pragma once

#include <vector>

namespace cleave::stability {

/// Columns of a matrix with few rows.
using Columns = std::vector<std::vector<double>>;

struct NonNegative {
  std::vector<double> x;         ///< one a column, >= 0
  std::vector<double> residual;  ///< b - A x
};

/// min |b - A x|, x >= 0 (Lawson and Hanson 1974). Of several x with the same residual any one.
[[nodiscard]] NonNegative nonnegative_least_squares(const Columns& a, const std::vector<double>& b);

/// As above; of all x with the same residual nearly the shortest one, corrected on the columns it uses.
[[nodiscard]] NonNegative shortest_nonnegative(const Columns& a, const std::vector<double>& b);

}  // namespace cleave::stability
