#pragma once

#include <array>
#include <cstddef>
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

__extension__ using Int128 = __int128;  ///< g++ and clang both have it; the components of a plane's normal fit in it

/// A signed integer of 192 bits as plain words (two's complement, the low word first): how a plane keeps its offset,
/// and what the value of a plane at a site needs. More than that is done on `Int512` (wide.hpp), which public headers
/// have no need of. Results that do not fit wrap around.
struct Int192 {
  __extension__ using Word2 = unsigned __int128;
  std::array<std::uint64_t, 3> words{};

  [[nodiscard]] constexpr bool negative() const noexcept { return (words[2] >> 63U) != 0; }
  friend constexpr bool operator==(const Int192&, const Int192&) noexcept = default;
  [[nodiscard]] friend constexpr Int192 operator+(const Int192& a, const Int192& b) noexcept {
    Int192 out;
    Word2 carry = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      carry += a.words[k];
      carry += b.words[k];
      out.words[k] = static_cast<std::uint64_t>(carry);
      carry >>= 64U;
    }
    return out;
  }
  [[nodiscard]] friend constexpr Int192 operator-(const Int192& value) noexcept {
    return Int192{{~value.words[0], ~value.words[1], ~value.words[2]}} + Int192{{1, 0, 0}};
  }
  [[nodiscard]] static constexpr Int192 product(Int128 a, std::int64_t b) noexcept {
    const bool turned = (a < 0) != (b < 0);
    const auto size = static_cast<Word2>(a < 0 ? -a : a);
    const auto factor = static_cast<std::uint64_t>(b < 0 ? -b : b);
    const Word2 low = static_cast<Word2>(static_cast<std::uint64_t>(size)) * factor;
    const Word2 high = (size >> 64U) * factor + (low >> 64U);
    const Int192 out{
        {static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(high), static_cast<std::uint64_t>(high >> 64U)}};
    return turned ? -out : out;
  }
  /// To about an ulp.
  [[nodiscard]] double as_double() const noexcept;
};

[[nodiscard]] constexpr Sign sign_of(const Int192& value) noexcept {
  return value.negative() ? Sign::negative : value == Int192{} ? Sign::zero : Sign::positive;
}

}  // namespace cleave::exact
