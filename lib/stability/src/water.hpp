#pragma once

#include <functional>

#include "surface_loads.hpp"

namespace cleave::stability {

/// Forces of the water on one block, with the block's own moment about its centroid. `there` says whether a neighbour
/// is still in place: a joint that has opened to the air is drained.
[[nodiscard]] ForceSum water_forces(const topology::BlockComplex& complex, const Actions& actions,
                                    geometry::Vec3 gravity, topology::BlockId block,
                                    const std::function<bool(topology::BlockId)>& there);

}  // namespace cleave::stability
