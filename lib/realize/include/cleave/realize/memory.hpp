#pragma once

#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What `run` refuses of a scene on a machine with `memory_mb` (10^6 bytes), by the estimate that `run` makes before it
/// cuts. Empty for scenes of which only the rock near free faces is cut, and for ensembles: `run` has no estimate of
/// these before it begins.
[[nodiscard]] std::vector<Problem> memory_refusals(const Scene& scene, double memory_mb);

}  // namespace cleave::scene
