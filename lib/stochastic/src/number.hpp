#pragma once

#include <cstdint>

namespace cleave::stochastic {

/// A count among figures.
[[nodiscard]] constexpr double number(std::uint64_t n) noexcept { return static_cast<double>(n); }

}  // namespace cleave::stochastic
