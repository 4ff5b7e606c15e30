#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cleave::flow {

/// The nodes of a graph that lie on a ring (no node twice) with the given link, and its two ends: its biconnected
/// component (Hopcroft and Tarjan 1973). Ascending. Links may be there several times.
[[nodiscard]] std::vector<std::uint32_t> together_with_link(
    std::size_t nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> links, std::size_t link);

}  // namespace cleave::flow
