#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Whether nothing is left in front of a face: it is free, or all its neighbours are `gone`.
[[nodiscard]] bool is_open(const topology::BlockComplex& complex, const topology::Face& face,
                           const std::function<bool(topology::BlockId)>& gone);

/// Of a unit normal and a unit direction: less is a motion along the face, but for rounding.
constexpr double along_face = 1e-9;

/// Whether a block that moves comes out through a face: neither along it nor away from it.
[[nodiscard]] bool moves_out_of(const topology::Face& face, geometry::Vec3 motion);

/// N of 1 Pa against the open faces that a block moves out of.
[[nodiscard]] geometry::Vec3 push_of_pressure(const topology::BlockComplex& complex, topology::BlockId block,
                                              geometry::Vec3 motion,
                                              const std::function<bool(topology::BlockId)>& gone);

/// The open faces that carry a layer of sprayed concrete.
class Sprayed final {
 public:
  Sprayed(const topology::BlockComplex& complex, const Shotcrete& layer,
          const std::function<bool(topology::BlockId)>& gone);
  /// Of an open face: it lies on what is sprayed, or was laid bare by what is gone from there. What is gone from
  /// nowhere lies within the rock, where nobody scales: it is there still, and holds at least as the layer would.
  [[nodiscard]] bool operator()(const topology::Face& face) const;

 private:
  [[nodiscard]] bool on_surface(const topology::Face& face) const;

  const topology::BlockComplex* complex_;
  std::vector<FreeSurface> on_;
  static constexpr std::uint8_t enclosed = 0, from_sprayed = 1, from_bare = 2;
  IdVector<topology::BlockId, std::uint8_t> gone_from_;  ///< of gone blocks, one by one behind each other
};

/// An edge of a block between an open face and a joint face that is not.
struct KeyedEdge {
  topology::VertexId from, to;
  topology::FaceId open;
  topology::FaceId beyond;  ///< the joint face
};
[[nodiscard]] std::vector<KeyedEdge> keyed_edges(const topology::BlockComplex& complex, topology::BlockId block,
                                                 const std::function<bool(topology::BlockId)>& gone);

/// What of an edge lies along one of the blocks beyond it.
struct EdgePart {
  topology::BlockId beyond;
  geometry::Vec3 middle;  ///< m
  double length = 0;      ///< m
};
/// Together no longer than the edge.
[[nodiscard]] std::vector<EdgePart> parts_along(const topology::BlockComplex& complex, const KeyedEdge& edge);

/// N/m: what a layer of sprayed concrete holds along an edge, ring shear limited by adhesion.
[[nodiscard]] double held_per_metre(const Shotcrete& layer);

/// m: perimeter of a block's sprayed faces, of those it moves out of, along which the layer is keyed to rock that
/// stays: the block's own joint face beyond the edge must not lead to another block that is `loose`.
[[nodiscard]] double keyed_perimeter(const topology::BlockComplex& complex, topology::BlockId block,
                                     geometry::Vec3 motion, const Sprayed& sprayed,
                                     const std::function<bool(topology::BlockId)>& loose,
                                     const std::function<bool(topology::BlockId)>& gone);

/// Where spot bolts of a block may go, best places first: on its faces on walls of excavations, from where they are
/// drilled, as many in each as its share of their area; where it has none that bolts would hold from, on its largest
/// free face. On each they are spread from the centroid on, all in the first of the `wanted` directions that goes into
/// the rock, else straight in. Empty when none would hold against `motion`.
[[nodiscard]] std::vector<Bolt> spot_places(const topology::BlockComplex& complex, topology::BlockId block,
                                            std::span<const geometry::Vec3> wanted, geometry::Vec3 motion,
                                            const SpotBolts& spot);

}  // namespace cleave::stability
