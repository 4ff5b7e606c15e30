#pragma once

#include "cleave/stability/result.hpp"
#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {

/// Moment equilibrium of a block that translation does not move, in the state in which batch `batch` is judged.
[[nodiscard]] Rotation rotation_of(Model& model, topology::BlockId id, std::uint32_t batch, const Contacts& contacts,
                                   const Verdict& verdict);

/// The same, and where forces that hold it exist, whether it turns from rest all the same, all others fixed.
[[nodiscard]] Rotation rotation_from_rest(Model& model, topology::BlockId id, std::uint32_t batch,
                                          const Contacts& contacts, const Verdict& verdict);

}  // namespace cleave::stability
