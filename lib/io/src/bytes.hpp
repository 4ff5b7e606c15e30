#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cleave::io {

/// Unsigned integer of N bytes at the start of `bytes`, which has at least N.
template <std::size_t N>
[[nodiscard]] std::uint64_t unsigned_at(std::string_view bytes, std::endian order) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t at = order == std::endian::little ? N - 1 - i : i;
    value = value << 8U | static_cast<unsigned char>(bytes[at]);
  }
  return value;
}

[[nodiscard]] inline float float_at(std::string_view bytes, std::endian order) noexcept {
  return std::bit_cast<float>(static_cast<std::uint32_t>(unsigned_at<4>(bytes, order)));
}
[[nodiscard]] inline double double_at(std::string_view bytes, std::endian order) noexcept {
  return std::bit_cast<double>(unsigned_at<8>(bytes, order));
}

}  // namespace cleave::io
