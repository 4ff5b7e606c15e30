#pragma once

#include <functional>

#include "motion_recorder.hpp"

/// How far a run of blocks in motion may be from the path of steps without end.
namespace cleave::scene {

/// Runs again with half the step, and with twice the step, and says in `result` how far they are apart.
void estimate_error(const Scene& scene, const topology::BlockComplex& complex, const MotionCast& cast,
                    const motion::WorldOptions& options, const std::function<bool()>& stop, MotionResult& result);

}  // namespace cleave::scene
