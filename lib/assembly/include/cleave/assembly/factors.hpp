#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "cleave/assembly/assembly.hpp"

namespace cleave::assembly {

/// The unique rate of motion nearest to free fall, in the metric of the masses, that contacts of the associated law
/// (opening tan(friction)/F times the slip) let through: zero when forces in all contacts can hold the loads.
struct Projection {
  Motion motion;
  std::vector<double> speed;  ///< of each body, as a share of the largest free fall
  double largest = 0;         ///< of `speed`
  bool settled = false;       ///< rates are as exact as rounding lets them be
};
/// With strengths over `factor`; infinity: without strength.
[[nodiscard]] Projection project(const Assembly& assembly, double factor);

/// Forces in the contacts, N: at each point and then at each bond, normal and two tangents as vectors.
struct ContactForces {
  std::vector<std::vector<geometry::Vec3>> at_points, at_bonds;
};
/// Forces that hold the loads at strengths over `factor` (infinity: without strength), every point pressed by
/// `prestress` times the largest load at least. They may lack balance: check them.
[[nodiscard]] ContactForces holding_forces(const Assembly& assembly, double factor, double prestress = 0);

/// The largest F at which strengths/F still admit balance: above it motion is certain whatever the law of flow, the
/// initial stress or the stiffness. Infinite above 10^4, 0 below 10^-4.
struct StaticFactor {
  double factor = 0;
  double lower = 0;  ///< largest F at which forces were found
  bool settled = true;
};
[[nodiscard]] StaticFactor static_factor(const Assembly& assembly);

/// What the search for motion from rest under Coulomb's law found at one strength.
enum class FromRest : std::uint8_t {
  moves,      ///< a solution that moves, all conditions checked
  rests,      ///< only solutions at rest were found: no proof that there is no other
  unsettled,  ///< neither
};
struct Start {
  FromRest found = FromRest::unsettled;
  Motion motion;              ///< accelerations, m/s2 and 1/s2
  std::vector<double> speed;  ///< of each body, as a share of the largest free fall
  double residual = 1;        ///< largest violation of the conditions, relative
};
/// Follows the branch of motion from frictionless contacts down to strengths over `factor`.
[[nodiscard]] Start start_from_rest(const Assembly& assembly, double factor);

/// The factor of safety of an assembly: the least F at which the Coulomb problem from rest, strengths over F, has a
/// solution that moves. An upper estimate: no search proves that there is no motion below.
struct MovingFactor {
  double factor = 0;    ///< infinite when nothing moves without friction, 0 when it moves at any
  bool settled = true;  ///< just below, a state at rest was found; false: nothing that could be checked
};
/// `up`: what `static_factor` found.
[[nodiscard]] MovingFactor moving_factor(const Assembly& assembly, double up);

}  // namespace cleave::assembly
