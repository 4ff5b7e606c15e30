#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/facets/prepared.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"

namespace cleave::topology::detail {

/// The part of a segment (sites) that a convex domain and the window leave; false where nothing is.
[[nodiscard]] bool clip_to_domain(const Prepared& prepared, geometry::Vec3& p, geometry::Vec3& q);

/// Slits in surfaces: sides of a polygon that has others in common with its neighbours run along an open side of
/// another polygon less than 1e-6 of the domain's extent away, where both belong to one sheet or meet at an end. (All
/// other pairs are told apart by GapFinder.) `left_out`: polygons that are not cut.
[[nodiscard]] NearMisses find_open_rims(std::span<const JointPolygon> polygons,
                                        const std::vector<std::uint8_t>& left_out,
                                        const std::vector<std::optional<exact::Plane>>& sheets,
                                        const SharedCorners& shared, const Prepared& prepared, double limit_sites);

}  // namespace cleave::topology::detail
