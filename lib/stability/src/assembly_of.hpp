#pragma once

#include <span>
#include <vector>

#include "cleave/assembly/assembly.hpp"
#include "contacts.hpp"

namespace cleave::stability {

/// Compressive strength that intact rock is taken to have at the utmost, Pa: what a contact can press with.
inline constexpr double most_pressure = 5e8;

/// The blocks named (ascending), all others that are there in this batch's state taken to be fixed: six rows a block,
/// contacts at the corners of the convex hull of what two blocks share of a plane, cohesion and tension by triangles.
/// Joints with a curved law have their least friction. Sides of the domain are fixed rock without friction: of blocks
/// that have any.
[[nodiscard]] assembly::Assembly assembly_of(Model& model, std::span<const topology::BlockId> blocks,
                                             std::uint32_t batch);

/// Of the joints of blocks that move together (ascending, the rest taken to be fixed) the share of cohesion and tension
/// that counts as they start: all where at least sin(1 degree) of the load of the lighter block presses, less in
/// proportion, as for single blocks. Joints that have none are left out; nothing where no motion is found.
[[nodiscard]] BondShares bonds_that_count(Model& model, std::span<const topology::BlockId> blocks, std::uint32_t batch);

}  // namespace cleave::stability
