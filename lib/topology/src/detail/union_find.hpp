#pragma once

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

 private:
  std::vector<Index> parent_;
};

}  // namespace cleave::topology::detail
