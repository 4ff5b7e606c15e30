#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What a user should know of a run: what was left out, what may move beyond it, what does not reach its aim.
[[nodiscard]] std::vector<std::string> notes_of(const Scene& scene, const Realization& made);

/// Openings that lie partly outside the rock, or take nothing that an earlier one has not.
void add_excavation_notes(const std::vector<ExcavationInfo>& excavations, std::vector<std::string>& notes);

}  // namespace cleave::scene
