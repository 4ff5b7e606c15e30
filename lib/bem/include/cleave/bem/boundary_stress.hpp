#pragma once

#include <array>
#include <vector>

#include "cleave/bem/block.hpp"

/// Stress on the boundary of bodies that are followed by their block operator (in motion, in contact).
namespace cleave::bem {

/// Element-wise tractions (Pa) of the static extension of the boundary's displacements. O(freedoms^2).
[[nodiscard]] std::vector<std::array<Vec2, 3>> tractions_of(const BlockOperator& block,
                                                            const std::vector<double>& freedoms);

/// Stress (Pa, body frame, tension positive) at a place of the boundary: from these tractions, and from the strain of
/// the displacements along the side by Hooke's law.
[[nodiscard]] Sym2 boundary_stress(const BlockOperator& block, BoundaryPlace at, const std::vector<double>& freedoms,
                                   const std::vector<std::array<Vec2, 3>>& tractions);

}  // namespace cleave::bem
