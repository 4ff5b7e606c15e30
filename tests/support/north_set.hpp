#pragma once

#include <utility>

#include "cleave/survey/analyse.hpp"

namespace cleave::support {

/// One set of all traces of a map, vertical and striking north: what is known of its orientation is known exactly.
inline survey::SetRule north_set() {
  return {.name = "a",
          .polygon = {},
          .azimuth = std::pair{150.0, 30.0},
          .dip = Dip::degrees(90),
          .dip_direction = DipDirection::degrees(90),
          .kappa = 1e6,
          .shape = {}};
}

}  // namespace cleave::support
