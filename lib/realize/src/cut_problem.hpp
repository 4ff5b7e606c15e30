#pragma once

#include "cleave/realize/run.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::scene {

/// Where in the scene the cutter's refusal comes from.
[[nodiscard]] Problem problem_of(const topology::CutError& error, const Scene& scene, const SampledScene& drawn);

}  // namespace cleave::scene
