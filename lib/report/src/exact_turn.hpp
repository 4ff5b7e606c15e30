#pragma once

namespace cleave::report::detail {

struct Point2 {
  double u = 0, v = 0;
  friend constexpr bool operator==(const Point2&, const Point2&) = default;
};

/// Sign (-1, 0, 1) of the turn a, b, c: 1 when c lies to the left of a -> b. Exact for finite coordinates below 1e150
/// whose products do not underflow.
[[nodiscard]] int turn(Point2 a, Point2 b, Point2 c) noexcept;

}  // namespace cleave::report::detail
