#pragma once

#include <array>

#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {

/// m2, largest first: mean squares of the distances from the centroid along the three axes of inertia.
[[nodiscard]] std::array<double, 3> inertia(const BlockComplex& complex, const Block& block);

/// About its corners, as they are stored: from the origin of the complex.
[[nodiscard]] geometry::Box extents(const BlockComplex& complex, const Block& block);

}  // namespace cleave::topology
