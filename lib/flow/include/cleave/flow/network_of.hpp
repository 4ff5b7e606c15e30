#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "cleave/flow/network.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::flow {

/// A surface of the rock: an excavation, or a side of the domain.
struct RockSurface {
  topology::Role role;                      ///< free, fixed or window
  std::optional<std::uint32_t> excavation;  ///< index into CutInput::excavations
  std::optional<std::uint32_t> tag;         ///< of the domain's sides
  friend auto operator<=>(const RockSurface&, const RockSurface&) = default;
};

/// Where the joints of a cut end on surfaces of the rock: those that any reaches, domain sides before excavations.
struct JointSurfaces {
  std::vector<RockSurface> surfaces;
  std::vector<std::uint32_t> of_border;  ///< of each of JointNetwork::borders
};
[[nodiscard]] JointSurfaces surfaces_of(const topology::JointNetwork& network);

/// The mesh of a cut that was made with CutInput::keep_network: parts are its pieces. Points are in m relative to the
/// complex's origin, and so are heads. Sides shorter than 1e-11 of the network's extent, whose direction positions in
/// doubles do not tell, become points.
[[nodiscard]] Mesh mesh_of(const topology::BlockComplex& complex, const JointSurfaces& surfaces);

}  // namespace cleave::flow
