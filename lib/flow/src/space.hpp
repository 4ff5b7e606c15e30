#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
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

/// Some functions of a space side by side, in columns.
struct Functions {
  Eigen::MatrixXd values;           ///< rows: numbers of the space
  std::vector<std::uint8_t> fixed;  ///< of each row
};

/// Fills in the rows that are not fixed, so that each function has the least energy; only `wet` triangles count, and
/// rows of no wet triangle stay as they are. The largest relative residual, or nothing where there is no solution.
[[nodiscard]] std::optional<double> minimise_energy(const Space& space, std::span<const Stiffness> stiffness,
                                                    std::span<const std::uint8_t> wet, Functions& functions);

}  // namespace cleave::flow
