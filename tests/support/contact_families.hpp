#pragma once

/// Random scenes of blocks that touch in the awkward places: corners over corners, equal faces, acute toes, lattices.
/// With an overlap check of its own, which knows nothing of contacts.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/dbem/world.hpp"

namespace cleave::testing {

enum class ContactFamily : std::uint8_t {
  dropped,   ///< a block onto one of equal width
  column,    ///< equal blocks, open joints
  row,       ///< equal bricks one behind another on a floor, the first pushed
  head_on,   ///< equal bars against each other, no weight
  toe,       ///< a wedge with an acute toe slides into the block before it
  slope,     ///< slabs on a slope above a fixed toe
  rubble,    ///< convex polygons fall into a bin
  cut_wall,  ///< a wall cut by random lines
  gas,       ///< polygons in a box, no friction, restitution 1
  lattice,   ///< convex and concave polygons of equal cells on a lattice, falling
  stacks,    ///< stacks side by side, faces against faces
  ratio,     ///< stacks and lintels of blocks up to 10^9 times heavier than others
  tips,      ///< corners on corners: blocks on their tips, diagonal neighbours, staircases, diamonds side by side
};
inline constexpr std::array<std::string_view, 13> contact_family_names{
    "dropped",  "column", "row",     "head_on", "toe",   "slope", "rubble",
    "cut_wall", "gas",    "lattice", "stacks",  "ratio", "tips"};

struct ContactScene {
  std::vector<dbem::Body> bodies;
  /// Convex parts of each body, coordinates of Body::outline.
  std::vector<std::vector<std::vector<dbem::Vec2>>> parts;
  dbem::Laws laws;
  dbem::WorldOptions options;
  double until = 1;     ///< s
  bool closed = false;  ///< no energy may be lost but by rounding
  double gain = 1e-9;   ///< of energy in a step that is rounding, over the largest energy there was
};

/// The same scene for the same family and seed.
[[nodiscard]] ContactScene make_contact_scene(ContactFamily family, std::uint64_t seed);

/// Turned by a quarter, gravity and velocities with it.
[[nodiscard]] ContactScene turned_by_a_quarter(ContactScene scene);
/// x to -x.
[[nodiscard]] ContactScene mirrored(ContactScene scene);
/// The last body first.
[[nodiscard]] ContactScene reversed_order(ContactScene scene);

/// Smallest extent of the largest part that convex pieces of two bodies share, by clipping; 0 when they share none.
[[nodiscard]] double widest_common_part(const std::vector<std::vector<dbem::Vec2>>& a,
                                        const std::vector<std::vector<dbem::Vec2>>& b);

/// Largest width of the part two bodies share over the square root of the smaller one's area, by clipping.
[[nodiscard]] double deepest_overlap(const ContactScene& scene, const dbem::World& world);

struct ContactOutcome {
  bool made = false;     ///< the scene was accepted
  bool stopped = false;  ///< a step was refused
  std::string why;
  double overlap = 0;      ///< the worst after any step
  double reported = 0;     ///< largest penetration the steps told, m
  double energy_gain = 0;  ///< largest rise in a step over the largest energy there was (see energy_scale)
  double energy_left = 1;  ///< kinetic at the end over kinetic at the start
  double momentum = 0;     ///< largest change in a step without weight and supports, over the sum of the moduli
  double time = 0, start = 0;
  std::size_t steps = 0;
  std::vector<dbem::Vec2> places;  ///< centroids at the end
};
/// At most `most` steps.
[[nodiscard]] ContactOutcome run_contact_scene(const ContactScene& scene, std::size_t most = 100000);

}  // namespace cleave::testing
