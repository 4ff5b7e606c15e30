#pragma once

#include <expected>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// Lets the blocks go that [motion] names, all others walls. Error: `how.from` is of another scene, or no state.
[[nodiscard]] std::expected<MotionResult, Problem> run_motion(const Scene& scene, const Realization& made,
                                                              const topology::BlockComplex& complex,
                                                              const MovingRun& how, unsigned threads);

/// Lets each group in doubt go for 0.2 s under the loads of [stability], with the blocks around it, all others walls.
/// Batches before that of the group are gone.
[[nodiscard]] std::vector<std::optional<LetGo>> let_go(const Scene& scene, const Realization& made,
                                                       const topology::BlockComplex& complex,
                                                       const stability::KeyGroups& groups, unsigned threads);

}  // namespace cleave::scene
