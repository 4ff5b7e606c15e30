#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/exchange/exports.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::report::detail {

/// A face of a cell as points of Cells::points, counter-clockwise seen from outside.
using CellFace = std::vector<std::uint32_t>;

[[nodiscard]] std::vector<CellFace> faces_of_cell(const Cells& cells, std::size_t cell);
/// Convex faces as they are, the others in triangles.
[[nodiscard]] std::vector<CellFace> convex_faces_of_cell(const Cells& cells, std::size_t cell);
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles_of_cell(const Cells& cells, std::size_t cell);

/// "block_12", and "block_12_part_2" for the further cells of a block with cavities.
[[nodiscard]] std::vector<std::string> names_of_cells(const Cells& cells);

/// "cleave VERSION; scene: TITLE" without line ends.
[[nodiscard]] std::string header_of(std::string_view title);

/// Of the points that cells use.
[[nodiscard]] geometry::Box extent_of(const Cells& cells);

}  // namespace cleave::report::detail
