#pragma once

#include <cmath>

namespace cleave::report::detail {

struct Point2 {
  double u = 0, v = 0;
  friend constexpr bool operator==(const Point2&, const Point2&) = default;
};

/// Sign (-1, 0, 1) of the turn a, b, c: 1 when c lies to the left of a -> b. Exact for finite coordinates below 1e150
/// whose products do not underflow.
[[nodiscard]] int turn_exactly(Point2 a, Point2 b, Point2 c) noexcept;

/// The same; doubles decide where they can.
[[nodiscard]] inline int turn(Point2 a, Point2 b, Point2 c) noexcept {
  const double left = (a.u - c.u) * (b.v - c.v);
  const double right = (a.v - c.v) * (b.u - c.u);
  if (left == 0 && right == 0) return 0;  // along an axis: differences that are zero are so exactly
  const double det = left - right;
  // 3 + 16 eps times eps, eps = 2^-53 (Shewchuk 1997, ccwerrboundA).
  const double bound = 3.3306690738754716e-16 * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return turn_exactly(a, b, c);
}

}  // namespace cleave::report::detail
