#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave::assembly {

/// Bodies marked with 1 in `among` that links between two of them hang together, each part ascending, parts by their
/// first body. A link has `body` and an optional `other`.
template <class Link>
std::vector<std::vector<std::uint32_t>> linked_parts(const std::vector<Link>& links,
                                                     std::span<const std::uint8_t> among) {
  DisjointSets<std::uint32_t> sets{among.size()};
  for (const Link& link : links) {
    if (link.other && among[link.body] != 0 && among[*link.other] != 0) sets.join(link.body, *link.other);
  }
  // The smallest member stands for its set, so every part begins with it.
  std::vector<std::size_t> place(among.size());
  std::vector<std::vector<std::uint32_t>> parts;
  for (std::uint32_t b = 0; b < among.size(); ++b) {
    if (among[b] == 0) continue;
    const std::uint32_t first = sets.find(b);
    if (first == b) {
      place[b] = parts.size();
      parts.emplace_back();
    }
    parts[place[first]].push_back(b);
  }
  return parts;
}

}  // namespace cleave::assembly
