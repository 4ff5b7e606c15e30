#include "space.hpp"

#include <algorithm>
#include <utility>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave::flow {
namespace {

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

LeastEnergy::LeastEnergy(const Space& space, std::span<const Stiffness> stiffness, std::span<const std::uint8_t> wet,
                         std::vector<std::uint8_t> fixed)
    : space_{&space}, stiffness_{stiffness}, wet_{wet}, fixed_{std::move(fixed)}, row_(space.count, none) {
  for (std::size_t t = 0; t < space.of.size(); ++t) {
    if (wet[t] == 0) continue;
    for (const Index n : space.of[t]) {
      if (fixed_[n] == 0 && row_[n] == none) row_[n] = rows_++;
    }
  }
  if (rows_ == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * space.of.size());
  for (std::size_t t = 0; t < space.of.size(); ++t) {
    if (wet[t] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = row_[space.of[t][i]];
      for (std::size_t j = 0; j < 3 && r != none; ++j) {
        const Index c = row_[space.of[t][j]];
        if (c == none || c > r) continue;
        entries.emplace_back(static_cast<int>(r), static_cast<int>(c), space.factor * entry(stiffness[t], i, j));
      }
    }
  }
  matrix_.resize(static_cast<Eigen::Index>(rows_), static_cast<Eigen::Index>(rows_));
  matrix_.setFromTriplets(entries.begin(), entries.end());
  factor_ = std::make_unique<Eigen::SimplicialLDLT<Matrix, Eigen::Lower>>(matrix_);
}

std::optional<double> LeastEnergy::fill(Eigen::MatrixXd& values) const {
  if (rows_ == 0) return 0.0;
  if (factor_->info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows_), values.cols());
  for (std::size_t t = 0; t < space_->of.size(); ++t) {
    if (wet_[t] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = row_[space_->of[t][i]];
      for (std::size_t j = 0; j < 3 && r != none; ++j) {
        const Index n = space_->of[t][j];
        if (row_[n] == none) right.row(r) -= space_->factor * entry(stiffness_[t], i, j) * values.row(n);
      }
    }
  }
  Eigen::MatrixXd x = factor_->solve(right);
  const auto whole = matrix_.selfadjointView<Eigen::Lower>();
  x += factor_->solve(right - whole * x);  // what rounding left over
  if (!x.allFinite()) return std::nullopt;
  const Eigen::MatrixXd rest = right - whole * x;
  const Matrix sizes = matrix_.cwiseAbs();
  const Eigen::MatrixXd scale = sizes.selfadjointView<Eigen::Lower>() * x.cwiseAbs() + right.cwiseAbs();
  double residual = 0;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const double size = scale.col(c).maxCoeff();
    if (size > 0) residual = std::max(residual, rest.col(c).cwiseAbs().maxCoeff() / size);
  }
  for (std::size_t n = 0; n < space_->count; ++n) {
    if (row_[n] != none) values.row(static_cast<Eigen::Index>(n)) = x.row(row_[n]);
  }
  return residual;
}

}  // namespace cleave::flow
