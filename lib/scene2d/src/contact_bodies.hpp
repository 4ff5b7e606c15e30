#pragma once

#include <expected>
#include <optional>
#include <vector>

#include "cleave/dbem/body.hpp"
#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {

/// The bodies of a scene as the contact code takes them.
struct PreparedBodies {
  std::vector<dbem::Body> bodies;
  std::vector<std::size_t> elements;  ///< boundary elements of each, 0: rigid
  /// Stress at the corners of an elastic body for a unit amplitude of each mode: corner v, mode m at v * modes + m.
  struct StressOfModes {
    std::vector<bem::Sym2> values;  ///< Pa/m, axes of the shape
    double poisson = 0;             ///< 0 in plane stress: none out of the plane
  };
  std::vector<StressOfModes> shapes;
  struct OwnStress {
    std::size_t shape;
    double angle;  ///< of the body against its shape, at the start
  };
  std::vector<std::optional<OwnStress>> stress;  ///< of each body; rigid ones have none
  std::vector<bem::Sym2> locked;                 ///< stress of the start in each, scene's axes; 0 where there is none
  std::size_t operators = 0;                     ///< elastic operators built: one for each shape and material
};

/// Rigid ones as they stand. Elastic ones with the modes of their boundary-element operator, one corner a node; bodies
/// that are equal up to a motion share one operator, turned with each. Clamped ones are held with the modes of the
/// clamped body, their weight as forces on the nodes.
[[nodiscard]] std::expected<PreparedBodies, std::vector<Problem>> prepare_bodies(const ContactScene& scene,
                                                                                 bool elastic, unsigned threads);

/// Bodies that share no operator with one before them, of those that would deform.
[[nodiscard]] std::vector<std::size_t> shapes_of(const ContactScene& scene);

/// Strengths of all pairs of joints: a side without a name takes the other's; of two names the weaker of each counts.
[[nodiscard]] dbem::Laws laws_of(const ContactScene& scene);

}  // namespace cleave::scene
