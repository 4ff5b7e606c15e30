#pragma once

#include "cleave/core/quantity.hpp"

namespace cleave::scene {

/// Where joints lie on one another the one counts that bears less shear under this normal stress.
inline constexpr Stress normal_stress_on_overlaps = pascals(100e3);

}  // namespace cleave::scene
