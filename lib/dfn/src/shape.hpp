#pragma once

#include <vector>

#include "cleave/dfn/joint_set.hpp"

namespace cleave::dfn::detail {

[[nodiscard]] double mean_area(const Shape& shape) noexcept;
/// Largest distance of a corner from the centre.
[[nodiscard]] double reach(const Shape& shape) noexcept;

/// A corner in the joint's own axes (m): along the first side or axis, and across.
struct FlatPoint {
  double along, across;
};

/// Draws outlines of one shape; keeps the cosines of the regular polygon.
class OutlineDrawer final {
 public:
  explicit OutlineDrawer(const Shape& shape);
  /// Corners counter-clockwise about the normal; u and v in (0, 1) for the first and the second size. Empty for
  /// persistent joints.
  void draw(double u, double v, std::vector<FlatPoint>& corners) const;
  /// Whether v decides anything.
  [[nodiscard]] bool two_draws() const noexcept;

 private:
  const Shape* shape_;
  std::vector<FlatPoint> unit_;  // regular polygon of circumradius 1
  double stretch_ = 1;           // that gives it the circle's area
};

}  // namespace cleave::dfn::detail
