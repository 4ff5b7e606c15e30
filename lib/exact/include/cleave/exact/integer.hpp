#pragma once

#include <array>
#include <cstdint>

namespace cleave::exact {

__extension__ using Int128 = __int128;  ///< g++ and clang both have it; the components of a plane's normal fit in it

/// A signed integer of 192 bits as plain words (two's complement, the low word first): how a plane keeps its offset.
/// Arithmetic is done on `Wide` (wide.hpp), which public headers have no need of.
struct Int192 {
  std::array<std::uint64_t, 3> words{};
  friend constexpr bool operator==(const Int192&, const Int192&) noexcept = default;
  [[nodiscard]] friend constexpr Int192 operator-(const Int192& value) noexcept {
    Int192 out;
    std::uint64_t carry = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      out.words[k] = ~value.words[k] + carry;
      carry = carry != 0 && out.words[k] == 0 ? 1 : 0;
    }
    return out;
  }
};

}  // namespace cleave::exact
