#include "cleave/core/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace cleave {

ThreadLimit ThreadLimit::all() noexcept {
  return ThreadLimit{static_cast<std::size_t>(std::max(1, tbb::info::default_concurrency()))};
}

namespace detail {

void parallel_chunks(std::size_t count, ThreadLimit threads,
                     const std::function<void(std::size_t, std::size_t)>& chunk) {
  if (count == 0) return;
  if (threads.count() == 1 || count == 1) {
    chunk(0, count);
    return;
  }
  // More threads than the machine runs at once win nothing, and TBB would complain on stderr.
  tbb::task_arena arena{static_cast<int>(std::min(threads.count(), ThreadLimit::all().count()))};
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, count},
                      [&](const tbb::blocked_range<std::size_t>& range) { chunk(range.begin(), range.end()); });
  });
}

}  // namespace detail
}  // namespace cleave
