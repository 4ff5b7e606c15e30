#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contacts.hpp"

namespace cleave::stability {

/// What holds a block that would move, N.
struct Resistance {
  double least = 0;
  double greatest = 0;
  double cohesion_left_out = 0;                            ///< of faces that do not open but that nothing presses
  std::vector<std::pair<std::uint32_t, double>> pressing;  ///< group and reaction of the least one
  std::vector<double> strength;                            ///< of `pressing`: friction and cohesion of each
};

/// Which shares of a group's cohesion count, and of that of faces that do not open.
struct CohesionShares {
  double counted = 0, touches = 0;
};
/// Those of what a load (N) presses on, `pressing` having the group and reaction of each; `opens`: the sine at which
/// the motion opens the face; `parallel_contact`: what does not open counts, too.
[[nodiscard]] CohesionShares cohesion_shares(std::span<const std::pair<std::uint32_t, double>> pressing,
                                             std::uint32_t group, double load, double opens, bool parallel_contact);

/// Friction and cohesion of the pressing groups, tension of those that open. Cohesion counts in full where the
/// resultant stands at a degree and more to the plane, in proportion to that angle's sine below. Where three or more
/// coplanar normals touch, the reactions are not unique: all pairs that carry the force are tried.
[[nodiscard]] Resistance resistance(const Contacts& contacts, const Resultant& resultant, const Motion& motion,
                                    bool parallel_contact);

}  // namespace cleave::stability
