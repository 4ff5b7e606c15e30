#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cleave::dbem {

/// Three entries of a node.
using Three = std::array<double, 3>;
/// A 3x3 block by rows.
using Block3 = std::array<double, 9>;

/// Factors of a sparse matrix of 3x3 blocks over few nodes whose pattern is symmetric (its values need not be), least
/// degree first. Rows are swapped within a block only: check answers. What FrontalFactor does for many nodes, without
/// what handling a front costs.
class CompactFactor final {
 public:
  static constexpr std::size_t most_nodes = 128;
  /// `links`: pairs of different nodes that share a block, either order, twice or more allowed.
  CompactFactor(std::size_t nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> links);

  /// All blocks 0 before entries are added.
  void clear();
  /// Of two nodes that are linked, or the same.
  [[nodiscard]] Block3& block(std::size_t row, std::size_t column) { return values_[at(row, column)]; }
  /// False when a pivot vanishes.
  [[nodiscard]] bool factorise();
  /// In place.
  void solve(std::vector<Three>& x) const;
  [[nodiscard]] double factor_work() const noexcept { return factor_work_; }
  [[nodiscard]] double solve_work() const noexcept { return solve_work_; }

 private:
  [[nodiscard]] std::size_t at(std::size_t row, std::size_t column) const {
    return place_[row * order_.size() + column];
  }

  std::vector<std::uint32_t> order_;   // of elimination
  std::vector<std::uint32_t> starts_;  // in later_, by place in the order, one more than nodes
  std::vector<std::uint32_t> later_;   // nodes linked, by fill too, that are eliminated later
  std::vector<std::uint16_t> place_;   // in values_, by row and column
  std::vector<Block3> values_;
  double factor_work_ = 0, solve_work_ = 0;
};

}  // namespace cleave::dbem
