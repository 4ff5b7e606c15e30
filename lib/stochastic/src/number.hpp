#pragma once

#include <cstdint>
#include <vector>

#include "cleave/stochastic/record.hpp"

namespace cleave::stochastic {

/// A count among figures.
[[nodiscard]] constexpr double number(std::uint64_t n) noexcept { return static_cast<double>(n); }

/// What has to be held, each passed force once, over the area of the excavations, Pa.
[[nodiscard]] double pressure_over_area(const Record& record);
/// Pressures whose exceedance is reported: 1, 2, 5 in every decade from 100 Pa to 50 MPa.
[[nodiscard]] const std::vector<double>& pressures_pa();

}  // namespace cleave::stochastic
