#pragma once

#include "cleave/core/id.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// For each plane the one whose normal stands for its own: that of a plane from which it deviates by no more than
/// roundings of their corners over their faces, else itself. Joints that were drawn parallel, in whatever direction,
/// are parallel in doubles only to a rounding; a block between them would taper by so much, and be held for ever.
[[nodiscard]] IdVector<topology::PlaneId, topology::PlaneId> parallel_planes(const topology::BlockComplex& complex);

}  // namespace cleave::stability
