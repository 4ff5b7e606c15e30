#pragma once

#include <array>
#include <optional>

#include "cleave/exact/integer.hpp"
#include "cleave/exact/plane.hpp"

namespace cleave::exact {

/// A point in units of 2^-64 of a site: each component is the greatest integer that is not above its value, so it is
/// less than one unit off. Far better than doubles can tell, and all points have one denominator: sums do not grow.
using FixedPoint = std::array<Int128, 3>;

/// Where three planes meet. Empty when they do not meet in one point, or 2^62 sites or more away.
[[nodiscard]] std::optional<FixedPoint> fixed_meet(const Plane& p, const Plane& q, const Plane& r) noexcept;

/// In units of 2^48 sites, to a few ulp.
[[nodiscard]] std::array<double, 3> as_position(const FixedPoint& point) noexcept;

}  // namespace cleave::exact
