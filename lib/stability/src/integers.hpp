#pragma once

/// Small vector algebra on exact integers: on 128 bits where the operands are short (axis-parallel and other simple
/// scenes), on 512 bits otherwise.

#include <array>
#include <bit>
#include <cstdint>

#include "cleave/exact/wide.hpp"

namespace cleave::stability {

[[nodiscard]] inline exact::Int128 magnitude(exact::Int128 v) noexcept { return v < 0 ? -v : v; }

/// Number of bits of the largest component.
[[nodiscard]] inline int bits(const std::array<exact::Int128, 3>& v) noexcept {
  const exact::Int128 all = magnitude(v[0]) | magnitude(v[1]) | magnitude(v[2]);
  const auto high = static_cast<std::uint64_t>(all >> 64);
  const auto width = high != 0 ? 64 + std::bit_width(high) : std::bit_width(static_cast<std::uint64_t>(all));
  return static_cast<int>(width);
}

template <class Integer>
[[nodiscard]] std::array<Integer, 3> integers(const std::array<exact::Int128, 3>& v) noexcept {
  return {Integer(v[0]), Integer(v[1]), Integer(v[2])};
}

template <class Integer>
[[nodiscard]] Integer dot3(const std::array<Integer, 3>& a, const std::array<Integer, 3>& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Integer>
[[nodiscard]] std::array<Integer, 3> cross3(const std::array<Integer, 3>& a, const std::array<Integer, 3>& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace cleave::stability
