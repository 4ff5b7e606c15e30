#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/strength.hpp"

/// A block between joints that a stress field presses on: equilibrium under the pair of normal and shear forces.
namespace cleave::stability {

/// A joint face of a block with the force that the field puts across it before the block moves.
struct ClampedContact {
  geometry::Vec3 inward;      ///< unit, into the block
  double area = 0;            ///< m2, in contact
  double normal = 0;          ///< N along `inward`, > 0 in compression
  geometry::Vec3 shear = {};  ///< N in the plane of the face, of the rock on the block
  /// Strengths and the areas that they stand for.
  std::vector<std::pair<const JointStrength*, double>> strengths = {};
};

/// The block moves as a rigid body by u: across each face normal force falls by k_n A u.n (no tension), shear turns
/// towards -u by k_s A and is cut off at the strength, N tan(friction) + c A where N > 0 and nothing where the face
/// opens. Whether there is a u where these forces and `applied` balance, all strengths divided by `factor`. Forces
/// scale with u, so only `stiffness_ratio` = k_n / k_s matters. `false` also where the search does not settle.
[[nodiscard]] bool clamped_balances(std::span<const ClampedContact> contacts, geometry::Vec3 applied,
                                    double stiffness_ratio, double factor, const PartialFactors& partial = {});

/// The factor of safety: the largest factor on all strengths at which the block still balances, found by doubling and
/// bisection; the least over the ratios 1, 10, 100 and 1000 where none is given. 0: at no strength up to 1e9 times the
/// given one; infinite: at 1e-9 of it too. For a prism in a roof with contacts that share a height: Crawford and Bray
/// (1983) with friction reduced until their pull-out force is the weight.
[[nodiscard]] double clamped_factor(std::span<const ClampedContact> contacts, geometry::Vec3 applied,
                                    std::optional<double> stiffness_ratio, const PartialFactors& partial = {});

}  // namespace cleave::stability
