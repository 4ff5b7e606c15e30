#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "cleave/bem/block.hpp"

namespace cleave::bem {

/// Eigen counts with a sign.
[[nodiscard]] inline Eigen::Index ix(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// The same matrix as a value of our own, which public headers can hold without Eigen.
[[nodiscard]] inline DenseMatrix dense(const Eigen::MatrixXd& m) {
  DenseMatrix out{static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()), {}};
  const auto flat = m.reshaped();
  out.values.assign(flat.begin(), flat.end());
  return out;
}

}  // namespace cleave::bem
