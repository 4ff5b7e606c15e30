#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "cleave/flow/network_of.hpp"

namespace cleave::flow {

/// A part of a joint: its pieces that hang together by sides. An excavation may cut one joint into several.
struct JointPart {
  topology::JointId joint;  ///< the first of those that lie there
  Area area;
  std::uint32_t cluster;
  /// It lies on a path from a fixed side of the domain to an opening that passes no part twice: water in all others
  /// only goes in and comes out again where it went in.
  bool backbone;
};

/// Joints that hang together.
struct Cluster {
  std::vector<topology::JointId> joints;  ///< ascending
  Area area;
  std::vector<std::uint32_t> surfaces;  ///< that it reaches, into JointSurfaces::surfaces; ascending
};

/// Which joints hang together: exact, as two that share a line of any length do. What touches in a point does not.
struct Connectivity {
  std::vector<JointPart> parts;
  std::vector<std::uint32_t> part_of;  ///< of each of JointNetwork::pieces
  std::vector<Cluster> clusters;       ///< by area, the largest first; of equals that with the first joint
  Area area;                           ///< of all joints in the rock
  std::size_t meetings = 0;            ///< pairs of joints that meet in a line
  Length meeting_length;               ///< of all these lines
  /// Domain sides that one cluster connects: pairs of JointSurfaces::surfaces, ascending.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> percolates;
};
[[nodiscard]] Connectivity connectivity(const topology::BlockComplex& complex, const JointSurfaces& surfaces);

}  // namespace cleave::flow
