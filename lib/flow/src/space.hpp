#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "discretisation.hpp"

namespace cleave::flow {

/// What a triangle's stiffness is made of: transmissivity times half the cotangents, negative, across from corners.
using Stiffness = std::array<double, 3>;

/// Numbers at the corners of triangles, or in the middles of their sides.
struct Space {
  std::vector<std::array<Index, 3>> of = {};  ///< of each triangle, by corner or by the corner across
  std::size_t count = 0;
  double factor = 1;  ///< of the stiffness
};

/// A conforming one: a number for each corner, shared by triangles around it that have sides in common. Where they
/// touch in the point alone water cannot pass.
[[nodiscard]] Space corners_of(const Mesh& mesh, const Sides& sides);
/// One in the middle of each side.
[[nodiscard]] Space middles_of(const Mesh& mesh, const Sides& sides);

/// Which numbers of a space are given: the others follow so that a function has the least energy. The equations of the
/// `wet` triangles, factored once.
class LeastEnergy final {
 public:
  LeastEnergy(const Space& space, std::span<const Stiffness> stiffness, std::span<const std::uint8_t> wet,
              std::vector<std::uint8_t> fixed);
  /// Functions side by side in columns; fills in the rows that are not fixed. Rows of no wet triangle stay as they are.
  /// The largest relative residual, or nothing where there is no solution.
  [[nodiscard]] std::optional<double> fill(Eigen::MatrixXd& values) const;
  [[nodiscard]] bool fixed(Index row) const { return fixed_[row] != 0; }

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  const Space* space_;
  std::span<const Stiffness> stiffness_;
  std::span<const std::uint8_t> wet_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Index> row_;  ///< of each number that is not fixed
  Index rows_ = 0;
  Matrix matrix_;
  std::unique_ptr<Eigen::SimplicialLDLT<Matrix, Eigen::Lower>> factor_;
};

}  // namespace cleave::flow
