#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// Partial factors, which blocks in motion do not have.
[[nodiscard]] bool reduces_strength(const StabilitySettings& settings);

/// A block that block theory, or the judgement of blocks together, lets move and that stood in motion.
struct StandingBlock {
  topology::BlockId block;
  double factor = 0;  ///< of safety: its own, or that of its group
};
/// Of the blocks that were let go, by number. Not those that bolts tie.
[[nodiscard]] std::vector<StandingBlock> standing_blocks(const Realization& made, const MotionResult& result);

/// Counts the key blocks that stand, and marks those of them as locked for which nothing else is known that could hold
/// them: the verdict has an answer in which they move. After it notes, counts and marks say the same.
void mark_locked(const Scene& scene, const Realization& made, MotionResult& result);

/// What is to be said of a run; `accepted`: residual of the contact law up to which a step counts.
void add_motion_notes(const Scene& scene, const Realization& made, double accepted, MotionResult& result);

}  // namespace cleave::scene
