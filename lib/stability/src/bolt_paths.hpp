#pragma once

#include <optional>
#include <vector>

#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Follows bolts from block to block.
class BoltPaths final {
 public:
  explicit BoltPaths(const topology::BlockComplex& complex);

  /// The blocks a bolt goes through, in order; a bolt that comes out into the air ends there. Empty when no free face
  /// lies at the collar with the rock in front of the bolt.
  [[nodiscard]] std::vector<Pierced> path(const Bolt& bolt) const;

 private:
  struct FreeFace {
    topology::FaceId face;
    geometry::Vec3 low, high;  ///< its box, grown by `reach`
  };
  [[nodiscard]] std::optional<topology::FaceId> collar_face(const Bolt& bolt) const;
  [[nodiscard]] std::optional<topology::BlockId> behind(const topology::Face& face, geometry::Vec3 x) const;

  const topology::BlockComplex* complex_;
  std::vector<FreeFace> free_;
};

}  // namespace cleave::stability
