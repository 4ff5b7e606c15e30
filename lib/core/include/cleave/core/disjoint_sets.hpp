#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <numeric>
#include <vector>

namespace cleave {

/// Disjoint sets of the numbers below a count; the smallest member stands for its set, whatever the order of joins.
template <std::unsigned_integral Index = std::size_t>
class DisjointSets final {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }

  [[nodiscard]] Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index i, Index j) {
    const Index a = find(i), b = find(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// `join` for several threads at once, which call nothing else meanwhile. The sets and who stands for them are the
  /// same in the end, whatever the order.
  void join_shared(Index i, Index j) {
    for (;;) {
      const Index a = find_shared(i), b = find_shared(j);
      if (a == b) return;
      // Only who stands for a set is hung into another one, so nobody else's union is lost.
      i = std::min(a, b);
      j = std::max(a, b);
      Index expected = j;
      if (std::atomic_ref{parent_[j]}.compare_exchange_strong(expected, i, std::memory_order_relaxed)) return;
    }
  }
  [[nodiscard]] Index find_shared(Index a) {
    for (;;) {
      const Index above = std::atomic_ref{parent_[a]}.load(std::memory_order_relaxed);
      if (above == a) return a;
      const Index next = std::atomic_ref{parent_[above]}.load(std::memory_order_relaxed);
      if (next != above) std::atomic_ref{parent_[a]}.store(next, std::memory_order_relaxed);  // a shorter way up
      a = next;
    }
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace cleave
