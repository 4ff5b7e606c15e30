#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <utility>
#include <vector>

namespace cleave::linear {

/// Factors of a sparse matrix of square blocks whose pattern is symmetric (its values need not be), by dense fronts
/// over the elimination tree (Duff and Reid 1983; supernodes: Ashcraft and Grimes 1989). Rows are swapped within the
/// pivots of a front only: check answers.
class FrontalFactor final {
 public:
  /// `links`: pairs of different nodes that share a block, either order, twice or more allowed.
  FrontalFactor(std::size_t nodes, Eigen::Index width, std::vector<std::pair<std::uint32_t, std::uint32_t>> links);

  /// All blocks 0 before entries are added.
  void clear(bool symmetric);
  /// Adds to block (row, column), which must be linked or on the diagonal; of a symmetric matrix both (r, c) and (c,
  /// r).
  template <int Width = Eigen::Dynamic>
  [[nodiscard]] Eigen::Map<Eigen::Matrix<double, Width, Width>> block(std::size_t row, std::size_t column) {
    return {values_of(row, column), width_, width_};
  }
  /// False when a pivot vanishes.
  [[nodiscard]] bool factorise();
  /// In place.
  void solve(Eigen::VectorXd& x) const;
  /// Of the determinant, after `factorise`.
  [[nodiscard]] int sign() const;
  [[nodiscard]] std::size_t nodes() const noexcept { return place_.size(); }
  /// Multiplications of one `factorise` as it was last cleared for, and of one `solve`; with what handling a front
  /// costs.
  [[nodiscard]] double factor_work() const noexcept { return symmetric_ ? factor_work_ : 2 * factor_work_; }
  [[nodiscard]] double solve_work() const noexcept { return solve_work_; }

 private:
  struct Front {
    std::uint32_t first = 0, last = 0;  // pivots, last exclusive, in the order of elimination
    std::vector<std::uint32_t> rows;    // below the pivots
    std::vector<std::uint32_t> children;
  };
  struct Factor {
    Eigen::LLT<Eigen::MatrixXd> cholesky;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu;
    Eigen::MatrixXd below, right;
  };
  double* values_of(std::size_t row, std::size_t column);
  template <int Width>
  [[nodiscard]] bool eliminate();
  template <int Width>
  [[nodiscard]] Eigen::MatrixXd assemble(const Front& front, const std::vector<std::uint32_t>& local,
                                         std::vector<Eigen::MatrixXd>& updates) const;
  void order();
  void find_fronts(const std::vector<std::uint32_t>& parent, std::vector<std::vector<std::uint32_t>>&& below);

  Eigen::Index width_;
  bool symmetric_ = true;
  std::vector<std::uint32_t> place_;                            // in the order of elimination, of each node
  std::vector<std::size_t> starts_;                             // rows of the matrix in the order of elimination
  std::vector<std::uint32_t> columns_;                          // ascending; the diagonal is among them
  std::vector<std::size_t> mirror_;                             // where the transposed block is
  std::vector<double> values_;                                  // blocks by columns
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links_;  // of nodes
  std::vector<Front> fronts_;
  std::vector<Factor> factors_;
  double factor_work_ = 0, solve_work_ = 0;  // of symmetric values
};

}  // namespace cleave::linear
