#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/io/file.hpp"

namespace cleave::io {

/// Heights of the ground on a rectangular grid, as a file lists them. A height is that of a point, not of an area:
/// value (column, row) stands at (x + column step_x, y_of(row)). Plain data; finite, within 1e9 m.
struct HeightGrid {
  std::uint32_t columns = 0;  ///< from west to east
  std::uint32_t rows = 0;     ///< from north to south, as in the file: row 0 is the northern edge
  double x = 0;       ///< m, of the values of column 0 (the centre of the cell, whatever the file's header gives)
  double y = 0;       ///< m, of the values of the *southern* row, rows - 1 (centre of the cell)
  double step_x = 1;  ///< m, between columns; > 0
  double step_y = 1;  ///< m, between rows; > 0
  std::vector<double> heights;     ///< m, row by row from the north, each from the west; NaN where there is none
  std::vector<std::string> notes;  ///< worth telling the user, not wrong

  /// Empty where the file has no height. Precondition: column < columns, row < rows.
  [[nodiscard]] std::optional<double> height(std::uint32_t column, std::uint32_t row) const;
  [[nodiscard]] double x_of(std::uint32_t column) const noexcept { return x + column * step_x; }
  [[nodiscard]] double y_of(std::uint32_t row) const noexcept { return y + (rows - 1 - row) * step_y; }
  /// How many values are there.
  [[nodiscard]] std::size_t known() const;
};

struct HeightGridOptions {
  /// The height that stands for "none", besides the one that an ESRI header states.
  std::optional<double> no_data;
};

/// ESRI ASCII grid: keys ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize (or dx and dy),
/// NODATA_value (-9999 when not given), in any case and order; then ncols x nrows heights from the north-west, lines
/// broken anywhere. A height that is NODATA as a float32 is none too (-3.402823e38 is written with few digits).
[[nodiscard]] std::expected<HeightGrid, ReadError> parse_esri_grid(std::string_view bytes, std::string_view name,
                                                                   const HeightGridOptions& options = {});
/// Lines of x, y, z (parted by blanks, tabs, commas, or by semicolons, with which numbers may have decimal commas; #
/// begins a comment), or a first line that names the columns, in any order, and their units. The points come in any
/// order; x and y lie on a rectangular grid along the axes, to 5 % of its step. Places without a point have no height.
/// Refused when less than a tenth of the grid is there, and for lines with more or fewer cells than columns.
[[nodiscard]] std::expected<HeightGrid, ReadError> parse_xyz_grid(std::string_view bytes, std::string_view name,
                                                                  const HeightGridOptions& options = {});

/// Either of the two, by the first word: a key of an ESRI grid or not.
[[nodiscard]] std::expected<HeightGrid, ReadError> parse_height_grid(std::string_view bytes, std::string_view name,
                                                                     const HeightGridOptions& options = {});
[[nodiscard]] std::expected<HeightGrid, ReadError> read_height_grid(const std::filesystem::path& path,
                                                                    const HeightGridOptions& options = {});

}  // namespace cleave::io
