#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "cleave/bem/block.hpp"
#include "domain_rule.hpp"
#include "kelvin.hpp"

namespace cleave::bem {

[[nodiscard]] Eigen::Map<const Eigen::MatrixXd> view(const DenseMatrix& m);

/// Freedoms of modal amplitudes.
[[nodiscard]] std::vector<double> expanded(const Modes& modes, std::span<const double> amplitudes,
                                           std::size_t freedoms);
/// `steepest` of every mode.
[[nodiscard]] std::vector<double> steepest_of(const BlockOperator& block, const Modes& modes);
/// Half of u^T K u.
[[nodiscard]] double energy_of(const BlockOperator& block, const std::vector<double>& freedoms);

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
  Bubbles bubbles;
};
[[nodiscard]] Bubbles bubbles_of(const Mesh& mesh, const std::vector<DomainPoint>& points, const Material& material,
                                 std::size_t degree);
[[nodiscard]] BlockMass block_mass(const Mesh& mesh, const Material& material, const Eigen::MatrixXd& traction_of,
                                   const BlockOptions& options);

/// Nodal forces of element-wise tractions: integral of N_a N_b.
[[nodiscard]] Eigen::MatrixXd boundary_gram(const Mesh& mesh);

}  // namespace cleave::bem
