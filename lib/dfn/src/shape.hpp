#pragma once

#include <cstdint>

#include "cleave/core/rng.hpp"
#include "cleave/dfn/joint_set.hpp"

namespace cleave::dfn::detail {

[[nodiscard]] double mean_area(const Shape& shape) noexcept;
/// Largest distance of a corner from the centre.
[[nodiscard]] double reach(const Shape& shape) noexcept;

/// Half sides of a rectangle, or half axes of the ellipse through the corners of a round joint (m).
struct HalfAxes {
  double first, second;
};

/// Draws the sizes of one shape.
class SizeDrawer final {
 public:
  /// Precondition: not persistent, for `draw`.
  explicit SizeDrawer(const Shape& shape);
  /// Corners of a disc, ellipse or regular polygon; 0 for rectangles.
  [[nodiscard]] std::uint32_t sides() const noexcept { return sides_; }
  /// u and v in (0, 1) for the first and the second size.
  [[nodiscard]] HalfAxes draw(double u, double v) const;
  /// Whether v decides anything.
  [[nodiscard]] bool two_draws() const noexcept;

 private:
  const Shape* shape_;
  std::uint32_t sides_ = 0;
  double stretch_ = 1;  // that gives the polygon the circle's area
};

/// In the joint's plane, radians from the strike.
[[nodiscard]] double draw_rotation(const RotationLaw& law, Rng rng) noexcept;

}  // namespace cleave::dfn::detail
