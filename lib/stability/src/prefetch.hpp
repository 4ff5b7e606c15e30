#pragma once

#include <cstddef>
#include <span>

#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Asks memory for what the blocks after `blocks[at]` will need, while that one is judged. Blocks that are judged one
/// after the other lie scattered in a large complex, and waiting for their faces was the larger part of the time. A
/// hint only: nothing is read or changed.
inline void prefetch(const topology::BlockComplex& complex, std::span<const topology::BlockId> blocks, std::size_t at) {
  if (at + 12 < blocks.size()) __builtin_prefetch(&complex.blocks()[blocks[at + 12]]);
  if (at + 6 < blocks.size()) {
    for (const topology::FaceId id : complex.blocks()[blocks[at + 6]].faces) complex.faces().prefetch(id, false);
  }
  if (at + 3 < blocks.size()) {
    for (const topology::FaceId id : complex.blocks()[blocks[at + 3]].faces) complex.faces().prefetch(id, true);
  }
}

}  // namespace cleave::stability
