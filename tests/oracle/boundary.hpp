#pragma once

/// Counts of one block from the half-faces on its boundary.

#include "oracle.hpp"

namespace cleave::oracle {

/// A face of a cell on the boundary of the cell's block. Coplanar ones with equal `label` on the same side make one
/// face.
struct HalfFace {
  std::uint32_t cell, face;
  std::int64_t label;
};

struct Neighbour {
  std::uint32_t cell, face;
};
/// neighbours[cell][face]: the same face seen from the other cell; none on the box.
using Neighbours = std::vector<std::vector<std::optional<Neighbour>>>;

/// The half-faces of one block -> its volume and counts. `number[cell][face]` is the index in `boundary` or -1.
[[nodiscard]] OracleBlock measure(const Arrangement& arrangement, const Neighbours& neighbours,
                                  const std::vector<HalfFace>& boundary,
                                  const std::vector<std::vector<std::int32_t>>& number);

class UnionFind final {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = i;
  }
  std::size_t find(std::size_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace cleave::oracle
