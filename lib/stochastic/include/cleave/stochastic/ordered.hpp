#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "cleave/core/parallel.hpp"

namespace cleave::stochastic {

/// Makes items `first`, `first + step`, ... below `end` on several threads and hands each to `commit` in this order,
/// one at a time. A thread takes the next item as soon as it is free, at most `ahead` items beyond the last committed
/// one, so memory does not grow with the number of items. `commit` returns false to stop: items in work are then
/// thrown away.
void run_ordered(std::uint64_t first, std::uint64_t end, std::uint64_t step, ThreadLimit threads, std::size_t ahead,
                 const std::function<std::function<bool()>(std::uint64_t)>& make);

}  // namespace cleave::stochastic
