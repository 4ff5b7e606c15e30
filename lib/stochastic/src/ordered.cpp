#include "cleave/stochastic/ordered.hpp"

#if CLEAVE_THREADS
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#endif

namespace cleave::stochastic {

void run_ordered(std::uint64_t first, std::uint64_t end, std::uint64_t step, [[maybe_unused]] ThreadLimit threads,
                 [[maybe_unused]] std::size_t ahead, const std::function<std::function<bool()>(std::uint64_t)>& make) {
  bool stopped = false;
  if (!CLEAVE_THREADS || threads.count() == 1) {
    for (std::uint64_t i = first; i < end && !stopped; i += step) stopped = !make(i)();
    return;
  }
#if CLEAVE_THREADS
  std::uint64_t next = first;
  std::atomic<bool> enough{false};
  using Commit = std::function<bool()>;
  const auto source = tbb::make_filter<void, std::uint64_t>(tbb::filter_mode::serial_in_order,
                                                            [&](tbb::flow_control& control) -> std::uint64_t {
                                                              if (next >= end || enough) {
                                                                control.stop();
                                                                return 0;
                                                              }
                                                              const std::uint64_t item = next;
                                                              next += step;
                                                              return item;
                                                            });
  const auto work = tbb::make_filter<std::uint64_t, Commit>(
      tbb::filter_mode::parallel, [&](std::uint64_t item) { return enough ? Commit{} : make(item); });
  const auto sink = tbb::make_filter<Commit, void>(tbb::filter_mode::serial_in_order, [&](const Commit& commit) {
    if (!commit || enough) return;
    if (!commit()) enough = true;
  });
  tbb::task_arena arena{static_cast<int>(std::min(threads.count(), ThreadLimit::all().count()))};
  arena.execute([&] { tbb::parallel_pipeline(std::max<std::size_t>(ahead, threads.count()), source & work & sink); });
#endif
}

}  // namespace cleave::stochastic
