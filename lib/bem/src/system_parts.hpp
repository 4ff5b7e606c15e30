#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "system.hpp"

/// Parts of setting up a system that stand alone.
namespace cleave::bem {

/// Orthonormal basis of the rigid motions (x, y, rotation) that are orthogonal to all rows, translations first.
[[nodiscard]] std::vector<std::array<double, 3>> free_motions(const std::vector<std::array<double, 3>>& rows);

/// Whether a point force of the particular field acts here.
[[nodiscard]] bool at_force(const Particular& particular, Vec2 x);

/// Flamant's tractions are known at nodes only. What their interpolation lacks to balance the forces is spread over
/// the outline, so that force and moment are kept to rounding.
void keep_momentum(ScaledRegion& region);

/// Flamant's field fits a force at this point of an element where the outline is smooth and the cut of its angle,
/// straight out of the body, does not come back into it.
[[nodiscard]] bool flamant_fits(const ScaledRegion& region, Vec2 at, Vec2 normal, std::size_t on);

}  // namespace cleave::bem
