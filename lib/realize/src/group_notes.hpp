#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// Groups of one state that move though no block of theirs does by itself, and what could not be decided. `where`: the
/// state, before each note; empty for the final one under the loads of the base case.
void add_moving_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis,
                            std::string_view where, std::vector<std::string>& notes);

/// Those that are in no group that was found.
[[nodiscard]] std::vector<stability::Barred> in_no_group(std::vector<stability::Barred> blocks,
                                                         const std::optional<stability::KeyGroups>& groups);

/// That groups could not be looked for with the support. `where`: the load case or stage, before it.
[[nodiscard]] std::string too_many_with_support(std::string_view where);

/// What support leaves of groups below their target. `where`: the load case, before each note.
void add_group_support_notes(const stability::GroupSupport& groups, std::string_view where,
                             std::vector<std::string>& notes);

/// Groups that a pattern which was found leaves.
void add_design_notes(const std::vector<DesignResult>& designs, std::vector<std::string>& notes);

/// What groups in doubt do as rigid blocks that start from rest.
void add_let_go_note(const std::vector<std::optional<LetGo>>& outcomes, std::vector<std::string>& notes);

/// Of the final state under the loads of the base case, with what was not looked at.
void add_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis, bool unasked,
                     std::vector<std::string>& notes);

/// Groups below the target where no support asks for them: those `found` at strengths over it, where these are more
/// than `groups` at strengths as they are. `where`: the load case or stage, before it.
void add_below_target_note(const stability::KeyGroups& found, const stability::KeyGroups& groups, double target,
                           std::string_view where, std::vector<std::string>& notes);

/// Between which divisors of the strengths all blocks together begin to move.
void add_group_factor_note(const std::optional<stability::FactorTogether>& found, std::vector<std::string>& notes);

/// Groups at strengths over a target, where less was looked at than at strengths as they are.
void add_target_notes(const Realization& made, std::vector<std::string>& notes);

}  // namespace cleave::scene
