#pragma once

#include "cleave/survey/analyse.hpp"

namespace cleave::scene {

/// Sizes above this are cut off: a box is grown by the largest joint.
[[nodiscard]] double largest_size(const survey::SetResult& set);
/// Gamma laws have joints too small to have corners; those below this hold no area to speak of.
[[nodiscard]] double smallest_size(const survey::SetResult& set);

}  // namespace cleave::scene
