#pragma once

#include <algorithm>
#include <cstddef>

#include "cleave/core/parallel.hpp"

namespace cleave::topology::detail {

/// Calls `body(first, last)` for neighbouring pieces that cover [0, count); one piece on one thread.
template <class Body>
void in_pieces(std::size_t count, std::size_t grain, ThreadLimit threads, const Body& body) {
  if (threads.count() == 1 || count <= grain) {
    if (count > 0) body(std::size_t{0}, count);
    return;
  }
  parallel_for((count + grain - 1) / grain, threads,
               [&](std::size_t piece) { body(piece * grain, std::min(count, (piece + 1) * grain)); });
}

}  // namespace cleave::topology::detail
