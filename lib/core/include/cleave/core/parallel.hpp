#pragma once

/// Work over indices on several threads. Work is handed out by index and results are stored by index, so what comes
/// out does not depend on the number of threads or on who finished first.

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"

namespace cleave {

/// How many threads a piece of work may use, at least one.
class ThreadLimit final {
 public:
  /// Precondition: count >= 1.
  explicit ThreadLimit(std::size_t count) noexcept : count_{count} { CLEAVE_ASSERT(count >= 1); }
  /// As many as the machine runs at once.
  [[nodiscard]] static ThreadLimit all() noexcept;
  /// The calling thread alone; no thread pool is touched.
  [[nodiscard]] static ThreadLimit one() noexcept { return ThreadLimit{1}; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::size_t count_;
};

namespace detail {
/// Calls `chunk(first, last)` for pieces that cover [0, count) once.
void parallel_chunks(std::size_t count, ThreadLimit threads,
                     const std::function<void(std::size_t, std::size_t)>& chunk);
}  // namespace detail

/// Calls `body(i)` for every i in [0, count), each once, in any order, and returns when all are done. `body` must be
/// callable from several threads at once; writing to element i of a vector is fine (not of a vector<bool>).
template <class Body>
void parallel_for(std::size_t count, ThreadLimit threads, const Body& body) {
  detail::parallel_chunks(count, threads, [&body](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

/// The values of `body(i)` for i in [0, count), in the order of i.
template <class Body>
[[nodiscard]] auto parallel_map(std::size_t count, ThreadLimit threads, const Body& body) {
  using Value = decltype(body(std::size_t{0}));
  std::vector<std::optional<Value>> slots(count);
  parallel_for(count, threads, [&](std::size_t i) { slots[i].emplace(body(i)); });
  std::vector<Value> values;
  values.reserve(count);
  for (auto& slot : slots) values.push_back(*std::move(slot));
  return values;
}

}  // namespace cleave
