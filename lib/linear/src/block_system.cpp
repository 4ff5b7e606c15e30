#include "cleave/linear/block_system.hpp"

namespace cleave::linear {
namespace {

/// Up to so many rows a dense factor is as good.
constexpr Eigen::Index few_rows = 72;

}  // namespace

BlockSystem::BlockSystem(std::size_t bodies, Eigen::Index width, Links links)
    : size_{width * static_cast<Eigen::Index>(bodies)}, width_{width} {
  if (size_ > few_rows) sparse_.emplace(bodies, width, std::move(links));
}

void BlockSystem::clear(bool symmetric) {
  ++factors_;
  symmetric_ = symmetric;
  if (!sparse_) {
    dense_.setIdentity(size_, size_);
    return;
  }
  sparse_->clear(symmetric);
  for (std::size_t b = 0; b < sparse_->nodes(); ++b) sparse_->block(b, b).diagonal().setOnes();
}

bool BlockSystem::factorise() {
  if (sparse_) return sparse_->factorise();
  if (!symmetric_) {
    lu_.compute(dense_);
    return true;
  }
  cholesky_.compute(dense_);
  return cholesky_.info() == Eigen::Success;
}

void BlockSystem::solve(Eigen::VectorXd& x) const {
  if (sparse_) {
    sparse_->solve(x);
  } else if (symmetric_) {
    cholesky_.solveInPlace(x);
  } else {
    x = lu_.solve(x).eval();
  }
}

}  // namespace cleave::linear
