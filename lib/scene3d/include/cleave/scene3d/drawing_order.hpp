#pragma once

#include <cstddef>
#include <vector>

#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

/// Numbers of the sets, each behind those it ends at, otherwise as in the scene; sets that end at one another in a
/// circle, and what ends at them, are left out.
[[nodiscard]] std::vector<std::size_t> drawing_order(const std::vector<RandomSet>& sets);

}  // namespace cleave::scene
