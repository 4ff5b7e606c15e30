#pragma once

/// Makes values out of a fuzzer's bytes. Total: when the bytes run out, every call gives its first value, so that a
/// short input is a small scene and not an error.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "cleave/core/assert.hpp"

namespace cleave::support {

class ByteSource final {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) noexcept : bytes_{bytes} {}

  [[nodiscard]] std::size_t remaining() const noexcept { return bytes_.size(); }

  /// The next byte; 0 when none is left.
  [[nodiscard]] std::uint8_t byte() noexcept {
    if (bytes_.empty()) return 0;
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }

  /// The next eight bytes, most significant first.
  [[nodiscard]] std::uint64_t u64() noexcept { return bits(8); }

  /// An integer in [lo, hi], both included, from as few bytes as the range needs. Precondition: lo <= hi.
  [[nodiscard]] std::int64_t between(std::int64_t lo, std::int64_t hi) noexcept {
    CLEAVE_ASSERT(lo <= hi);
    const std::uint64_t last = static_cast<std::uint64_t>(hi) - static_cast<std::uint64_t>(lo);
    const std::uint64_t value = bits((std::size_t{64} - static_cast<std::size_t>(std::countl_zero(last)) + 7) / 8);
    const std::uint64_t offset = last == UINT64_MAX ? value : value % (last + 1);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(lo) + offset);
  }

  /// A size or an index in [0, last].
  [[nodiscard]] std::size_t up_to(std::size_t last) noexcept {
    return static_cast<std::size_t>(between(0, static_cast<std::int64_t>(last)));
  }

  [[nodiscard]] bool flip() noexcept { return (byte() & 1U) != 0; }

  /// Any double, also infinities and NaN.
  [[nodiscard]] double any_double() noexcept { return std::bit_cast<double>(u64()); }

  /// One of the choices.
  template <class T, std::size_t N>
  [[nodiscard]] T pick(const std::array<T, N>& choices) noexcept {
    static_assert(N > 0);
    return choices[up_to(N - 1)];
  }

  /// All that is left, as text.
  [[nodiscard]] std::string rest() {
    std::string text;
    text.reserve(bytes_.size());
    for (const std::uint8_t b : bytes_) text += static_cast<char>(b);
    bytes_ = {};
    return text;
  }

 private:
  [[nodiscard]] std::uint64_t bits(std::size_t count) noexcept {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = (value << 8U) | byte();
    return value;
  }

  std::span<const std::uint8_t> bytes_;
};

}  // namespace cleave::support
