#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What a user should know of a run: what was left out, what may move beyond it, what does not reach its aim.
[[nodiscard]] std::vector<std::string> notes_of(const Scene& scene, const Realization& made);

/// Groups of one state that move though no block of theirs does by itself, and what could not be decided. `where`: the
/// state, before each note; empty for the final one under the loads of the base case.
void add_moving_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis,
                            std::string_view where, std::vector<std::string>& notes);

/// That groups could not be looked for with the support. `where`: the load case or stage, before it.
[[nodiscard]] std::string too_many_with_support(std::string_view where);

/// Blocks that only their lesser neighbours hold, where blocks were not judged together: nobody asked, or there are
/// `too_many` of them.
void add_barred_note(const std::vector<stability::Barred>& barred, bool too_many, std::vector<std::string>& notes);

/// Openings that lie partly outside the rock, or take nothing that an earlier one has not.
void add_excavation_notes(const std::vector<ExcavationInfo>& excavations, std::vector<std::string>& notes);

}  // namespace cleave::scene
