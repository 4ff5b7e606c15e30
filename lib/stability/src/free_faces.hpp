#pragma once

#include <functional>
#include <span>
#include <vector>

#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Whether nothing is left in front of a face: it is free, or all its neighbours are `gone`.
[[nodiscard]] bool is_open(const topology::BlockComplex& complex, const topology::Face& face,
                           const std::function<bool(topology::BlockId)>& gone);

/// An edge of a block between an open face and a joint face that is not.
struct KeyedEdge {
  topology::VertexId from, to;
  topology::FaceId open;
  topology::FaceId beyond;  ///< the joint face
};
[[nodiscard]] std::vector<KeyedEdge> keyed_edges(const topology::BlockComplex& complex, topology::BlockId block,
                                                 const std::function<bool(topology::BlockId)>& gone);

/// N/m: what a layer of sprayed concrete holds along an edge, ring shear limited by adhesion.
[[nodiscard]] double held_per_metre(const Shotcrete& layer);

/// m: perimeter of a block's open faces along which sprayed concrete is keyed to rock that stays: the block's own joint
/// face beyond the edge must not lead to another block that is `loose`.
[[nodiscard]] double keyed_perimeter(const topology::BlockComplex& complex, topology::BlockId block,
                                     const std::function<bool(topology::BlockId)>& loose,
                                     const std::function<bool(topology::BlockId)>& gone);

/// Where spot bolts of a block may go, best places first: spread over its largest free face from the centroid on, all
/// in the first of the `wanted` directions that goes into the rock, else straight in. Empty when none would hold
/// against `motion`.
[[nodiscard]] std::vector<Bolt> spot_places(const topology::BlockComplex& complex, topology::BlockId block,
                                            std::span<const geometry::Vec3> wanted, geometry::Vec3 motion,
                                            const SpotBolts& spot);

}  // namespace cleave::stability
