#pragma once

#include <optional>
#include <span>
#include <vector>

#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"
#include "detail/weld.hpp"

namespace cleave::topology::detail {

/// Corners given on the sides of a convex domain miss them by the rounding of their doubles. What is that near a side
/// is meant to reach it: corners that polygons share go just beyond it, sides of single polygons end on it.
class DomainTouch final {
 public:
  /// `sides`: the half-spaces of the domain; `farthest`: its largest coordinate, m.
  DomainTouch(const Prepared& prepared, std::span<const HalfSpace> sides, double farthest);

  /// The farthest that counts as rounding, m.
  [[nodiscard]] double reach() const noexcept { return reach_ * pitch_; }
  /// Where a shared corner goes.
  [[nodiscard]] exact::LatticePoint beyond(exact::LatticePoint corner) const;
  /// For each side of the polygon (corner i to i + 1) the side of the domain that it ends on; empty when on none.
  [[nodiscard]] std::vector<std::optional<HalfSpace>> ends(const LatticePolygon& polygon) const;

 private:
  struct DomainSide {
    HalfSpace inside;
    std::array<double, 3> normal;  ///< unit, into the domain
    double offset;                 ///< sites
  };
  [[nodiscard]] static double height(const DomainSide& side, exact::LatticePoint p) {
    return side.normal[0] * static_cast<double>(p.x) + side.normal[1] * static_cast<double>(p.y) +
           side.normal[2] * static_cast<double>(p.z) + side.offset;
  }
  [[nodiscard]] bool on(const DomainSide& side, exact::LatticePoint p) const;

  const Prepared& prepared_;
  std::vector<DomainSide> sides_;
  double pitch_, reach_;  ///< m; sites
};

}  // namespace cleave::topology::detail
