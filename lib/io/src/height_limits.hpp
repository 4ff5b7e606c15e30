#pragma once

#include <cmath>
#include <string_view>

namespace cleave::io {

/// Coordinates and heights beyond this are no places on the Earth, m.
constexpr double farthest = 1e9;

/// The same number, or the same when both are rounded to float32.
[[nodiscard]] inline bool same_height(double a, double b) noexcept {
  constexpr double float_max = 3.4028235677973366e38;  // beyond it the conversion is not defined
  if (a == b) return true;
  return std::abs(a) < float_max && std::abs(b) < float_max && static_cast<float>(a) == static_cast<float>(b);
}

/// Begins the header of an ESRI ASCII grid, in either case.
[[nodiscard]] bool is_esri_key(std::string_view word) noexcept;

}  // namespace cleave::io
