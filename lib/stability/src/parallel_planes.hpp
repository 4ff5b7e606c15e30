#pragma once

#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// How far the corners of faces may lie off where they were meant to be: by roundings, and by what was moved to reach
/// what it ends on.
[[nodiscard]] Length rounding_of_corners(const topology::BlockComplex& complex);

/// By how much that may have turned the normal of a face, rad.
[[nodiscard]] double turn_by(Length rounding, Area face);

/// For each plane the one whose normal stands for its own: that of a plane from which it deviates by no more than
/// roundings of their corners over their faces, else itself. Joints that were drawn parallel, in whatever direction,
/// are parallel in doubles only to a rounding; a block between them would taper by so much, and be held for ever. So
/// are those that deviate by less than `taper`, rad.
[[nodiscard]] IdVector<topology::PlaneId, topology::PlaneId> parallel_planes(const topology::BlockComplex& complex,
                                                                             double taper = 0);

}  // namespace cleave::stability
