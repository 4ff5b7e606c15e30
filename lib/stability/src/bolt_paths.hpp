#pragma once

#include <optional>
#include <vector>

#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// The blocks a bolt goes through, in order.
struct BoltPath {
  std::vector<Pierced> pierced;  ///< a bolt that comes out into the air ends there; empty when no free face lies at the
                                 ///< collar with the rock in front of the bolt
  bool leaves_window = false;    ///< goes on where nothing was cut
  double outside = 0;            ///< m beyond a side of the domain that is not free
};

/// Follows bolts from block to block.
class BoltPaths final {
 public:
  explicit BoltPaths(const topology::BlockComplex& complex);

  [[nodiscard]] BoltPath path(const Bolt& bolt) const;

 private:
  struct FreeFace {
    topology::FaceId face;
    geometry::Box box;  ///< grown by `reach`
  };
  [[nodiscard]] std::optional<topology::FaceId> collar_face(const Bolt& bolt) const;
  [[nodiscard]] BoltPath along(const Bolt& bolt, topology::FaceId start, bool& clear) const;
  [[nodiscard]] std::optional<topology::BlockId> behind(const topology::Face& face, geometry::Vec3 x) const;

  const topology::BlockComplex* complex_;
  std::vector<FreeFace> free_;
};

}  // namespace cleave::stability
