#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "cleave/geometry/vec3.hpp"

namespace cleave::topology::detail {

struct Bounds {
  std::array<double, 3> lo, hi;
  Bounds() {
    lo.fill(std::numeric_limits<double>::infinity());
    hi.fill(-std::numeric_limits<double>::infinity());
  }
  void add(geometry::Vec3 p) {
    const std::array c{p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], c[k]);
      hi[k] = std::max(hi[k], c[k]);
    }
  }
};

/// Apart by more than a polygon's corners leave its plane.
[[nodiscard]] bool far_apart(const Bounds& polygon, const Bounds& region, double slack);

/// The region on one side of the polygon's plane, by more than corners leave it. The box of a large joint meets a small
/// window long before the joint does.
[[nodiscard]] bool beside(std::span<const geometry::Vec3> corners, const Bounds& region, double pitch);

}  // namespace cleave::topology::detail
