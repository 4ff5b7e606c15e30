#pragma once

#include <span>
#include <vector>

#include "cleave/assembly/assembly.hpp"
#include "contacts.hpp"

namespace cleave::stability {

/// Contacts that have no area yet: where four blocks meet along an edge, the tip of one that moves and the tip of the
/// one across it, at rest. Each of the two joints through the edge may be what parts them. Of those that the mover
/// pushes against, which make the other give way, this gives the points; rest alone knows nothing of them. `rates` are
/// those of `movers`; `body` and `other` of a contact are positions in `blocks`; movers and blocks ascending.
[[nodiscard]] std::vector<assembly::Contact> touching_contacts(Model& model, std::span<const topology::BlockId> movers,
                                                               std::span<const assembly::Rate> rates,
                                                               std::span<const topology::BlockId> blocks);

}  // namespace cleave::stability
