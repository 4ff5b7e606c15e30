#pragma once

#include <Eigen/Core>

#include "cleave/bem/block.hpp"
#include "cleave/bem/kelvin.hpp"

namespace cleave::bem {

[[nodiscard]] Eigen::Map<const Eigen::MatrixXd> view(const DenseMatrix& m);

struct GalerkinStiffness {
  Eigen::MatrixXd stiffness;    ///< 2N x 2N
  Eigen::MatrixXd traction_of;  ///< element-wise traction of nodal displacement
  double check = 0;             ///< worst of |K R| / |K| and |K U - F| / |F|
};
[[nodiscard]] GalerkinStiffness galerkin_stiffness(const Mesh& mesh, Elastic elastic, const BlockOptions& options,
                                                   bool project = true);

struct BlockMass {
  Eigen::MatrixXd mass;  ///< boundary freedoms first
  Eigen::MatrixXd bubble_stiffness;
};
[[nodiscard]] BlockMass block_mass(const Mesh& mesh, const std::vector<Loop>& loops, Vec2 origin,
                                   const Material& material, const Eigen::MatrixXd& traction_of,
                                   const BlockOptions& options);

/// Nodal forces of element-wise tractions: integral of N_a N_b.
[[nodiscard]] Eigen::MatrixXd boundary_gram(const Mesh& mesh);

}  // namespace cleave::bem
