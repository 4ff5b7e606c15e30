#pragma once

#include <span>

#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"

namespace cleave::topology::detail {

/// Whether two polygons may lie in one plane. Quick; polygons of less than 1e5 sites may be overlooked.
[[nodiscard]] bool some_lie_in_one_plane(std::span<const JointPolygon> polygons);

/// A corner of several polygons that lies on a longer side of others, but for a rounding, becomes a corner of those
/// too: then the parts of the side are shared. Whether any did. `within`: sites.
[[nodiscard]] bool take_hanging_corners(std::span<JointPolygon> polygons, const SharedCorners& shared, double within);

}  // namespace cleave::topology::detail
