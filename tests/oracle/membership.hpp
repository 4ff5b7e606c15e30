#pragma once

/// Where exact points lie: in polygons of their plane, in closed solids.

#include "arrangement.hpp"

namespace cleave::oracle {

/// Precondition: the point is in the polygon's plane and not on its outline.
[[nodiscard]] bool contains(const testing::IntegerPolygon& polygon, const PlaneEquation& plane,
                            const HomogeneousPoint& point);
/// Precondition: the point is on no plane of the solid's faces.
[[nodiscard]] bool contains(const testing::IntegerSolid& solid, const HomogeneousPoint& point);
[[nodiscard]] testing::IntegerPolygon face_polygon(const testing::IntegerSolid& solid, std::size_t face);

}  // namespace cleave::oracle
