#include "cleave/core/parallel.hpp"

#include <algorithm>

#if CLEAVE_THREADS
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <thread>
#endif

// Debian's oneTBB is not built for the thread sanitizer, which then sees races in TBB's own scheduler. Under that
// sanitizer plain threads do the work, so that it judges our code and nothing else.
#if defined(__SANITIZE_THREAD__)
#define CLEAVE_PLAIN_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CLEAVE_PLAIN_THREADS 1
#endif
#endif
#ifndef CLEAVE_PLAIN_THREADS
#define CLEAVE_PLAIN_THREADS 0
#endif

namespace cleave {
namespace {

using Chunk = std::function<void(std::size_t, std::size_t)>;

#if !CLEAVE_THREADS
void run(std::size_t count, std::size_t, const Chunk& chunk) { chunk(0, count); }
#elif CLEAVE_PLAIN_THREADS
void run(std::size_t count, std::size_t threads, const Chunk& chunk) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) chunk(i, i + 1);
  };
  std::vector<std::jthread> helpers;
  for (std::size_t t = 1; t < threads; ++t) helpers.emplace_back(work);
  work();
}
#else
void run(std::size_t count, std::size_t threads, const Chunk& chunk) {
  tbb::task_arena arena{static_cast<int>(threads)};
  arena.execute([&] {
    const tbb::blocked_range<std::size_t> whole{0, count};
    const auto body = [&](const tbb::blocked_range<std::size_t>& range) { chunk(range.begin(), range.end()); };
    if (count <= 64 * threads) {
      tbb::parallel_for(whole, body, tbb::simple_partitioner{});  // few and large pieces of work: one by one
    } else {
      tbb::parallel_for(whole, body);
    }
  });
}
#endif

}  // namespace

ThreadLimit ThreadLimit::all() noexcept {
#if CLEAVE_THREADS
  return ThreadLimit{static_cast<std::size_t>(std::max(1, tbb::info::default_concurrency()))};
#else
  return one();
#endif
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
  run(count, std::min(threads.count(), ThreadLimit::all().count()), chunk);
}

}  // namespace detail
}  // namespace cleave
