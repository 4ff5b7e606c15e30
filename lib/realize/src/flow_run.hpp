#pragma once

#include <expected>

#include "cleave/realize/run_result.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

/// [flow] on the joints of a cut that kept its network.
[[nodiscard]] std::expected<FlowResult, Problem> run_flow(const Scene& scene, const SampledScene& drawn,
                                                          const topology::BlockComplex& complex);

}  // namespace cleave::scene
