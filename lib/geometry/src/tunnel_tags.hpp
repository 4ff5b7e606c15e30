#pragma once

#include <cstdint>

namespace cleave::geometry {

/// Indices of a tunnel's tags.
inline constexpr std::uint32_t tunnel_wall = 0;
inline constexpr std::uint32_t tunnel_floor = 1;
inline constexpr std::uint32_t tunnel_crown = 2;
inline constexpr std::uint32_t tunnel_start = 3;
inline constexpr std::uint32_t tunnel_end = 4;

}  // namespace cleave::geometry
