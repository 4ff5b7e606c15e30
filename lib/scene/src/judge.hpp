#pragma once

#include <vector>

#include "cleave/scene/run.hpp"
#include "cleave/stability/analyse.hpp"

namespace cleave::scene {

/// What the analysis needs, from a scene and its drawn joints. Everything was checked when the scene was parsed.
[[nodiscard]] stability::Settings settings_of(const Scene& scene, const Drawn& drawn, const StabilitySettings& wanted,
                                              const LoadSet& loads);

/// Point and line forces of the base case and of the named ones that lie on no free face of the complex.
[[nodiscard]] std::vector<Problem> misplaced_loads(const Scene& scene, const Drawn& drawn,
                                                   const StabilitySettings& wanted,
                                                   const topology::BlockComplex& complex);

}  // namespace cleave::scene
