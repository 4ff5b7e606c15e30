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

}  // namespace cleave::stability
