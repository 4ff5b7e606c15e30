#pragma once

#include <array>
#include <vector>

#include "detail/lattice_polygon.hpp"

namespace cleave::topology::detail {

/// Takes corners inside straight sides away and turns holes clockwise. False where nothing is left of one.
[[nodiscard]] bool tidy_holes(std::vector<std::vector<exact::LatticePoint>>& holes, exact::LatticePoint along);

/// Triangles of a polygon with holes, all in its plane, counter-clockwise about its normal. Corners of the holes count
/// as moved onto the plane along `polygon.along`, like its own. Empty when an outline crosses another or itself.
[[nodiscard]] std::vector<std::array<exact::LatticePoint, 3>> triangulate_with_holes(
    const LatticePolygon& polygon, std::vector<std::vector<exact::LatticePoint>> holes);

}  // namespace cleave::topology::detail
