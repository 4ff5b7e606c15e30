#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/realize/run_result.hpp"

namespace cleave::scene {

/// What blocks so small that nobody counts on them hold: the blocks that move where they are left out, and the groups
/// that lean on them. Empty where that is nothing. `crumbs`: ascending.
[[nodiscard]] std::optional<HeldByCrumbs> held_by_crumbs(const topology::AuditedComplex& complex,
                                                         stability::Settings settings,
                                                         const stability::Analysis& analysis,
                                                         const std::optional<stability::KeyGroups>& groups,
                                                         std::vector<topology::BlockId> crumbs);

void add_crumb_notes(const std::optional<HeldByCrumbs>& held, std::vector<std::string>& notes);

}  // namespace cleave::scene
