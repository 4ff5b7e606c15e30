#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/scene/run.hpp"
#include "judge.hpp"
#include "system.hpp"

namespace cleave::scene {

/// What a user should know of a run: what was left out, what may move beyond it, what does not reach its aim.
[[nodiscard]] std::vector<std::string> notes_of(const Scene& scene, const Drawn& drawn, const System& system,
                                                const JudgedMore& more,
                                                const std::optional<FieldStressResult>& clamped);

/// Groups that move though no block of theirs does by itself, and what could not be decided.
void add_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis,
                     std::vector<std::string>& notes);

}  // namespace cleave::scene
