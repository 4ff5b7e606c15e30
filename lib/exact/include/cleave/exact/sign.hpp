#pragma once

#include <cstdint>

namespace cleave::exact {

/// The sign of an exact expression; zero is an ordinary answer. "Not decided yet" is std::optional<Sign>, a different
/// type.
enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1 };

[[nodiscard]] constexpr Sign operator-(Sign s) noexcept { return static_cast<Sign>(-static_cast<int>(s)); }
[[nodiscard]] constexpr Sign operator*(Sign a, Sign b) noexcept {
  return static_cast<Sign>(static_cast<int>(a) * static_cast<int>(b));
}
template <class T>
[[nodiscard]] Sign sign_of(const T& value) noexcept {
  return value > 0 ? Sign::positive : value < 0 ? Sign::negative : Sign::zero;
}

}  // namespace cleave::exact
