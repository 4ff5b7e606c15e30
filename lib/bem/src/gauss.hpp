#pragma once

#include <cstddef>
#include <vector>

namespace cleave::bem {

struct GaussRule {
  std::vector<double> s;  ///< in (-1, 1), ascending
  std::vector<double> w;
};

/// Gauss-Legendre with n points, 1 <= n <= 64, to full precision; made once a program.
[[nodiscard]] const GaussRule& gauss(std::size_t n);

/// For integrands with ln|u| at u = 0 on [0, 1]: u = t^6 with 32 Gauss points; weights hold du.
[[nodiscard]] const GaussRule& log_rule();

}  // namespace cleave::bem
