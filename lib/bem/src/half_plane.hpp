#pragma once

#include "kelvin.hpp"

/// What a free surface adds to Kelvin's solution (Melan 1932), by reflection of the complex potentials
/// (Muskhelishvili 1953, chapter 16): smooth as long as the source lies below the surface.
namespace cleave::bem {

/// Rock fills y < level; the surface y = level carries no traction. Lengths as those of the equations.
struct HalfPlane {
  double level = 0;
};

/// To be added to kelvin_displacement and kelvin_traction; x field point, y source, n unit normal at x.
[[nodiscard]] Mat2 half_plane_displacement(Vec2 x, Vec2 y, Elastic e, HalfPlane h);
[[nodiscard]] Mat2 half_plane_traction(Vec2 x, Vec2 y, Vec2 n, Elastic e, HalfPlane h);
/// To be added to kelvin_stress.
[[nodiscard]] StressKernels half_plane_stress(Vec2 x, Vec2 y, Vec2 n, Elastic e, HalfPlane h);

}  // namespace cleave::bem
