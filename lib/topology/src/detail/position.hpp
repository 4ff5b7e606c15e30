#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "cleave/exact/predicates.hpp"

namespace cleave::topology::detail {

/// Position of the meet of three planes in units of 2^48 sites: in double where its proven error is below 2^-44, from
/// the integers (then correct to about 2^-51 of its size) otherwise. Precondition: the planes meet in one point.
[[nodiscard]] inline std::array<double, 3> meet_position(const exact::PointApprox& point, const exact::Plane& p,
                                                         const exact::Plane& q, const exact::Plane& r) {
  constexpr double w_min = 0x1p-2;  // error <= (1024 u + |x| 1024 u) / |W|, and |x| <= 1/2
  if (std::abs(point.w) >= w_min) return {point.x[0] / point.w, point.x[1] / point.w, point.x[2] / point.w};
  return exact::position_exact(p, q, r);
}

}  // namespace cleave::topology::detail
