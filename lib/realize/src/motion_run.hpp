#pragma once

#include "cleave/realize/run_result.hpp"

namespace cleave::scene {

/// Lets the blocks go that [motion] names, all others walls.
[[nodiscard]] MotionResult run_motion(const Scene& scene, const Realization& made,
                                      const topology::BlockComplex& complex);

}  // namespace cleave::scene
