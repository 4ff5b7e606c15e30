#pragma once

#include <vector>

#include "cleave/bem/statics.hpp"

/// What the stress around an opening does to a block of its roof or wall: tractions of the elastic section on the
/// block's faces, and its factor of safety with and without that clamping side by side (Crawford and Bray 1983).
namespace cleave::bem {

/// A joint face of a block in the section, from a to b; the block lies on its left.
struct BlockFace {
  Vec2 a, b;            ///< m
  double friction = 0;  ///< radians, in [0, pi/2)
  double cohesion = 0;  ///< Pa
};

struct FaceForces {
  double length = 0;  ///< m
  double normal = 0;  ///< N/m, compression positive
  double shear = 0;   ///< N/m along a to b, as the rock outside acts on the block
};

/// Tractions of the elastic field on the faces, by 16 Gauss points each. Precondition: the faces lie in `region`.
[[nodiscard]] std::vector<FaceForces> forces_on_faces(const Solution& solution, std::size_t region,
                                                      const std::vector<BlockFace>& faces);

/// Factors of safety of a block that is driven by `active` (N/m): shear strength of its faces along the motion over
/// the driving force. Infinite when nothing drives it.
struct ClampedFactors {
  double without = 0;  ///< no stress across the joints: cohesion only
  double with = 0;     ///< with the compression of the field; tension across a joint counts as none
};
[[nodiscard]] ClampedFactors factors_of_safety(const std::vector<BlockFace>& faces,
                                               const std::vector<FaceForces>& forces, Vec2 active);

}  // namespace cleave::bem
