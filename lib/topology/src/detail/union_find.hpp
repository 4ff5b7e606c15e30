#pragma once

#include <atomic>
#include <numeric>
#include <utility>
#include <vector>

#include "detail/prepared.hpp"

namespace cleave::topology::detail {

/// Disjoint sets; the smallest member stands for its set, so that results do not depend on the order of unions.
class UnionFind final {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  [[nodiscard]] Index find(Index a) noexcept {
    while (parent_[a] != a) {
      parent_[a] = parent_[parent_[a]];
      a = parent_[a];
    }
    return a;
  }
  void unite(Index a, Index b) noexcept {
    a = find(a);
    b = find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

  /// The same for several threads at once, which call nothing else meanwhile. The sets and who stands for them are the
  /// same in the end, whatever the order.
  void unite_shared(Index a, Index b) noexcept {
    for (;;) {
      a = find_shared(a);
      b = find_shared(b);
      if (a == b) return;
      if (a > b) std::swap(a, b);
      // Only who stands for a set is hung into another one, so nobody else's union is lost.
      Index expected = b;
      if (std::atomic_ref{parent_[b]}.compare_exchange_strong(expected, a, std::memory_order_relaxed)) return;
    }
  }
  [[nodiscard]] Index find_shared(Index a) noexcept {
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

}  // namespace cleave::topology::detail
