#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"

namespace cleave::topology::detail {

/// The polygons that have each shared side.
class SideUsers final {
 public:
  SideUsers(std::span<const JointPolygon> polygons, const SharedCorners& shared) {
    for (std::size_t k = 0; k < polygons.size(); ++k) {
      for_each_side(polygons[k], [&](exact::LatticePoint a, exact::LatticePoint b) {
        if (shared.shared(a, b)) users_.emplace_back(side_of(a, b), k);
      });
    }
    std::ranges::sort(users_);
  }
  static void for_each_side(const JointPolygon& entry, const auto& visit) {
    const auto& corners = entry.corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const exact::LatticePoint a = corners[i], b = corners[(i + 1) % corners.size()];
      if (a != b) visit(a, b);
    }
  }
  [[nodiscard]] auto of(exact::LatticePoint a, exact::LatticePoint b) const {
    return std::ranges::equal_range(users_, side_of(a, b), {}, &std::pair<Side, std::size_t>::first);
  }

 private:
  std::vector<std::pair<Side, std::size_t>> users_;
};

}  // namespace cleave::topology::detail
