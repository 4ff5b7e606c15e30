#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"

namespace cleave::topology::detail {

/// Polygons that share sides and lie on one plane but for rounding are one sheet, and so is a folded polygon alone: a
/// flat fault drawn as a mesh is flat. Of each polygon the plane of its sheet; `flat`: how far corners may be off it,
/// sites; `bend`: grows to how far any is.
[[nodiscard]] std::vector<std::optional<exact::Plane>> find_sheets(std::span<const JointPolygon> polygons,
                                                                   const std::vector<std::uint8_t>& left_out,
                                                                   const SharedCorners& shared, double flat,
                                                                   double& bend);

}  // namespace cleave::topology::detail
