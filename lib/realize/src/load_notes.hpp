#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What moves under a load in a stage before the last, and not without it.
void add_stage_case_notes(const SequenceResult& sequence, std::vector<std::string>& notes);

/// Key blocks that water lifts out of free faces below its level, in the base case and under each load.
void add_lifted_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes);

/// Earthquakes and surcharges of the base case that a wrong sign turns into what holds the rock.
void add_sign_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes);

/// Cases that change nothing, and earthquakes that push the rock where it is held: what a wrong sign, or a depth in
/// place of a level, looks like.
void add_case_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes);

/// Where other blocks move than in the base case.
void add_case_counts(const Realization& made, std::vector<std::string>& notes);

}  // namespace cleave::scene
