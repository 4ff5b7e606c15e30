#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run_result.hpp"

namespace cleave::scene {

/// Bolts and shotcrete that are held at blocks which only a side of the domain holds: in the base case, under each load
/// case and after each stage, each block once.
void add_holds_at_border_notes(const Realization& made, std::vector<std::string>& notes);

}  // namespace cleave::scene
