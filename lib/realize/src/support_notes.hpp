#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What the support installed by each stage does not hold, and spot bolts put in between.
void add_stage_support_notes(const SequenceResult& sequence, std::vector<std::string>& notes);

/// What bolts and shotcrete hold on to, and what they were not asked to hold.
void add_support_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes);

}  // namespace cleave::scene
