#pragma once

#include <utility>
#include <vector>

#include "cleave/exchange/polygons.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::report::detail {

/// The two halves of a closed surface of triangles, below and above `position` along `axis`, each closed by triangles
/// in the plane. No point may lie on the plane. `points` grows by one point for each edge that is cut.
[[nodiscard]] std::pair<std::vector<Polygon>, std::vector<Polygon>> split(const std::vector<Polygon>& triangles,
                                                                          double geometry::Vec3::* axis,
                                                                          double position,
                                                                          std::vector<geometry::Vec3>& points);

}  // namespace cleave::report::detail
