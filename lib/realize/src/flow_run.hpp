#pragma once

#include <expected>

#include "cleave/realize/run_result.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene3d/scene.hpp"
#include "judge.hpp"

namespace cleave::scene {

/// [flow] on the joints of a cut that kept its network. What is only shown, a mesh for other programs, is left out of
/// what is counted; no other figure hangs on it.
[[nodiscard]] std::expected<FlowResult, Problem> run_flow(const Scene& scene, const SampledScene& drawn,
                                                          const topology::BlockComplex& complex, Detail detail);

/// Whether some load takes its water from there.
[[nodiscard]] bool acts_on_blocks(const Scene& scene);
/// What the water found presses on blocks.
[[nodiscard]] stability::FlowWater water_on_blocks(const Scene& scene, const topology::BlockComplex& complex,
                                                   const FlowResult& result);

}  // namespace cleave::scene
