#include "space.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave::flow {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Entry (i, j) of a triangle's stiffness; rows add up to 0.
double entry(const Stiffness& s, std::size_t i, std::size_t j) {
  if (i == j) return -(s[(i + 1) % 3] + s[(i + 2) % 3]);
  return s[3 - i - j];
}

}  // namespace

Space corners_of(const Mesh& mesh, const Sides& sides) {
  DisjointSets<Index> same{3 * mesh.triangles.size()};
  const auto corner_at = [&](Index triangle, Index point) {
    const auto& corners = mesh.triangles[triangle];
    return static_cast<Index>(3 * std::size_t{triangle} +
                              static_cast<std::size_t>(std::ranges::find(corners, point) - corners.begin()));
  };
  for (Index s = 0; s < sides.count(); ++s) {
    const auto around = sides.triangles(s);
    for (std::size_t k = 1; k < around.size(); ++k) {
      for (const Index end : sides.ends(s)) same.join(corner_at(around[0], end), corner_at(around[k], end));
    }
  }
  Space space{.of = std::vector<std::array<Index, 3>>(mesh.triangles.size())};
  std::vector<Index> number(3 * mesh.triangles.size(), none);
  Index count = 0;
  for (Index c = 0; c < number.size(); ++c) {
    const Index root = same.find(c);
    number[c] = root == c ? count++ : number[root];
    space.of[c / 3][c % 3] = number[c];
  }
  space.count = count;
  return space;
}

Space middles_of(const Mesh& mesh, const Sides& sides) {
  Space space{.of = {}, .count = sides.count(), .factor = 4};
  space.of.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) space.of.push_back(sides.of(t));
  return space;
}

std::optional<double> minimise_energy(const Space& space, std::span<const Stiffness> stiffness,
                                      std::span<const std::uint8_t> wet, Functions& functions) {
  std::vector<Index> row(space.count, none);
  Index rows = 0;
  for (std::size_t t = 0; t < space.of.size(); ++t) {
    if (wet[t] == 0) continue;
    for (const Index n : space.of[t]) {
      if (functions.fixed[n] == 0 && row[n] == none) row[n] = rows++;
    }
  }
  if (rows == 0) return 0.0;
  const Eigen::Index columns = functions.values.cols();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows, columns);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * space.of.size());
  for (std::size_t t = 0; t < space.of.size(); ++t) {
    if (wet[t] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = row[space.of[t][i]];
      if (r == none) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        const double k = space.factor * entry(stiffness[t], i, j);
        const Index n = space.of[t][j], c = row[n];
        if (c == none) {
          right.row(r) -= k * functions.values.row(n);
        } else if (c <= r) {
          entries.emplace_back(static_cast<int>(r), static_cast<int>(c), k);
        }
      }
    }
  }
  Matrix matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(rows));
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factor{matrix};
  if (factor.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd x = factor.solve(right);
  const auto whole = matrix.selfadjointView<Eigen::Lower>();
  x += factor.solve(right - whole * x);  // what rounding left over
  const Eigen::MatrixXd rest = right - whole * x;
  const Matrix sizes = matrix.cwiseAbs();
  const Eigen::MatrixXd scale = sizes.selfadjointView<Eigen::Lower>() * x.cwiseAbs() + right.cwiseAbs();
  double residual = 0;
  for (Eigen::Index c = 0; c < columns; ++c) {
    const double size = scale.col(c).maxCoeff();
    if (size > 0) residual = std::max(residual, rest.col(c).cwiseAbs().maxCoeff() / size);
  }
  for (std::size_t n = 0; n < space.count; ++n) {
    if (row[n] != none) functions.values.row(static_cast<Eigen::Index>(n)) = x.row(row[n]);
  }
  if (!x.allFinite()) return std::nullopt;
  return residual;
}

}  // namespace cleave::flow
