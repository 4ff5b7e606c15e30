#pragma once

#include <cstdint>

#include "cleave/geometry/vec3.hpp"

namespace cleave::stability {

enum class RotationCheck : std::uint8_t {
  off,
  flag,    ///< looked at and reported; mode, key and batches are those of translation
  decide,  ///< a block that turns is a key block too
};

/// Whether a block that cannot slide could turn (topple, or twist on its base).
///
/// It turns for certain when no forces at its contacts (compression, friction within the cone, cohesion spread evenly
/// over each contact) balance the applied forces and their moments about its centroid: then no statics holds it. That
/// such forces exist does not prove that it stands. Tension is not counted.
struct Rotation {
  bool turns = false;
  geometry::Vec3 axis = {};  ///< unit, through the centroid, right-handed; zero when it does not turn
  double lack = 0;           ///< what is left unbalanced over the load (moments over the block's reach); 0 when nothing
};

}  // namespace cleave::stability
