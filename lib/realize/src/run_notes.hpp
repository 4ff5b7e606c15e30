#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What a user should know of a run: what was left out, what may move beyond it, what does not reach its aim.
[[nodiscard]] std::vector<std::string> notes_of(const Scene& scene, const Realization& made);

/// Blocks that only their lesser neighbours hold, where blocks were not judged together: nobody asked, or there are
/// `too_many` of them.
void add_barred_note(const std::vector<stability::Barred>& barred, bool too_many, std::vector<std::string>& notes);

}  // namespace cleave::scene
