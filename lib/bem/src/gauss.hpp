#pragma once

#include <cstddef>

#include "cleave/core/special.hpp"

namespace cleave::bem {

using special::GaussRule;
[[nodiscard]] inline const GaussRule& gauss(std::size_t n) { return special::gauss_rule(n); }

/// For integrands with ln|u| at u = 0 on [0, 1]: u = t^6 with 32 Gauss points; weights hold du.
[[nodiscard]] const GaussRule& log_rule();

}  // namespace cleave::bem
