#pragma once

#include <span>

#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::topology::detail {

using Bounds = geometry::Extents;

/// Apart by more than a polygon's corners leave its plane.
[[nodiscard]] bool far_apart(const Bounds& polygon, const Bounds& region, double slack);

/// The region on one side of the polygon's plane, by more than corners leave it. The box of a large joint meets a small
/// window long before the joint does.
[[nodiscard]] bool beside(std::span<const geometry::Vec3> corners, const Bounds& region, double pitch);

}  // namespace cleave::topology::detail
