#pragma once

#include <string>
#include <vector>

#include "motion_recorder.hpp"

namespace cleave::scene {

/// The bolts of the scene as ties of what is let go, to one another and to the walls.
void add_ties(const Scene& scene, const Realization& made, const topology::BlockComplex& complex,
              const motion::WorldOptions& options, MotionCast& cast);

/// What acted of the support, and what of it was left out.
void add_support_notes(const Scene& scene, const Realization& made, const MotionCast& cast, const MotionResult& result,
                       std::vector<std::string>& notes);

}  // namespace cleave::scene
