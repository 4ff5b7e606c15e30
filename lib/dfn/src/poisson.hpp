#pragma once

#include <cstdint>

#include "cleave/core/rng.hpp"

namespace cleave::dfn::detail {

/// Poisson variate, exact for every mean >= 0 (below 1e15): inversion below 30, else Hormann's PTRS (1993, Insurance:
/// Mathematics and Economics 12, 39-45).
[[nodiscard]] std::uint64_t poisson(double mean, Rng& rng) noexcept;

}  // namespace cleave::dfn::detail
