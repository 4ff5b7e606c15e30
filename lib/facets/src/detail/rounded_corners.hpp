#pragma once

#include <span>

#include "detail/joint_polygon.hpp"
#include "detail/weld.hpp"

namespace cleave::topology::detail {

/// Corners of several polygons that were meant to be one and were computed in more than one way: sites within the
/// distance of each other become the smallest of them. Never two corners of one polygon: small and thin ones stay.
[[nodiscard]] Moves unite_rounded_corners(std::span<const JointPolygon> polygons, double within);

}  // namespace cleave::topology::detail
