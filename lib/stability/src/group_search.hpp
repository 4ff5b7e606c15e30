#pragma once

#include <optional>
#include <vector>

#include "cleave/stability/key_groups.hpp"
#include "contacts.hpp"
#include "ties.hpp"

/// The search for groups of blocks that move together, batch by batch (theory: assembly.md).
namespace cleave::stability {

/// Mass times the acceleration of the centroid.
[[nodiscard]] inline Force out_of_balance(const Settings& settings, const topology::Block& block,
                                          const assembly::Rate& rate) {
  return newtons(settings.rock.density().si() * block.volume.si() * norm(rate.velocity));
}

/// With `ask` for verdicts alone groups have no factors; so it is in all searches below.
[[nodiscard]] KeyGroups search_groups(const topology::BlockComplex& complex, const Settings& settings,
                                      const Together& most, assembly::Ask ask);

/// Of the first state alone.
[[nodiscard]] KeyGroups first_groups(const topology::BlockComplex& complex, const Settings& settings,
                                     const Together& most);

/// With ties between blocks. `begin`: the first state is looked at around these alone; what moves without ties is among
/// them. `untied`: what is known of these blocks without ties. `bonds`: what counts of joints without ties, and so with
/// them.
[[nodiscard]] KeyGroups search_groups(const topology::BlockComplex& complex, const Settings& settings,
                                      const Together& most, const Ties& ties, std::vector<topology::BlockId> begin,
                                      assembly::UntiedSets& untied, const BondShares& bonds);

/// Of what moves when the blocks of the border may, their sides smooth, and `gone` has left: groups with one of them.
/// Ascending; empty when there are more blocks than `most`.
[[nodiscard]] std::optional<std::vector<topology::BlockId>> groups_at_border(
    const topology::BlockComplex& complex, const Settings& settings, const Together& most,
    const std::vector<topology::BlockId>& gone);

}  // namespace cleave::stability
