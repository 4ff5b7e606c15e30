#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/realize/run_result.hpp"

namespace cleave::scene {

/// What blocks so small that nobody counts on them hold: the blocks that move where they are left out, and the groups
/// that lean on them. Empty where that is nothing. `crumbs`: ascending.
[[nodiscard]] std::optional<HeldByCrumbs> held_by_crumbs(const topology::AuditedComplex& complex,
                                                         stability::Settings settings,
                                                         const stability::Analysis& analysis,
                                                         const std::optional<stability::KeyGroups>& groups,
                                                         std::vector<topology::BlockId> crumbs,
                                                         const stability::Together& most);

/// `known`: of the base case, which is not said again; empty where this is it. Blocks of another stage have other
/// numbers: the same ones have the same volume. `where`: the load case or the stage, before the note.
void add_crumb_notes(const std::optional<HeldByCrumbs>& held, const std::optional<HeldByCrumbs>& known,
                     std::string_view where, std::vector<std::string>& notes);

/// Of micro-blocks that `settings` leave out and that would move were they judged. What is said is then `known`.
void add_left_out_note(const topology::AuditedComplex& complex, stability::Settings settings,
                       std::vector<HeldByCrumbs::Row>& known, std::string_view where, std::vector<std::string>& notes);

/// Of blocks that reach their target with the support, and not where crumbs are left out with the same bolts.
void add_supported_by_crumbs_note(const topology::AuditedComplex& complex, stability::Settings settings,
                                  stability::SupportPlan plan, const stability::SupportResult& support,
                                  std::vector<topology::BlockId> crumbs, std::string_view where,
                                  std::vector<std::string>& notes);

}  // namespace cleave::scene
