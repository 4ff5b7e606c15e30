#pragma once

#include <cstdint>
#include <vector>

#include "cleave/assembly/groups.hpp"

namespace cleave::assembly {

/// The factors of a group of `island`, or that it has none. `counting`: the island with the cohesion that counts for
/// what may move. `moves`: by body, whether it is in a group that moves; such bodies beside the group do not hold it.
void give_factors(Group& group, const Assembly& island, const Assembly& counting,
                  const std::vector<std::uint8_t>& moves, Ask ask);

}  // namespace cleave::assembly
