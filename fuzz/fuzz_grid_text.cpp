/// Any bytes as a height grid: heights or an error, never a crash; line ends do not matter; the grid written as points
/// is the same grid.

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "cleave/core/assert.hpp"
#include "cleave/io/height_grid.hpp"
#include "fuzz_target.hpp"
#include "surfaces_check.hpp"

namespace {

using cleave::io::HeightGrid;

bool same(const HeightGrid& a, const HeightGrid& b) {
  if (a.columns != b.columns || a.rows != b.rows || a.heights.size() != b.heights.size()) return false;
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    if (a.heights[i] != b.heights[i] && !(std::isnan(a.heights[i]) && std::isnan(b.heights[i]))) return false;
  }
  return true;
}

/// All places known, and steps that show in doubles.
bool is_plain(const HeightGrid& grid) {
  const double reach = std::max(std::abs(grid.x), std::abs(grid.x_of(grid.columns - 1))) +
                       std::max(std::abs(grid.y), std::abs(grid.y_of(0)));
  return grid.known() == grid.heights.size() && grid.heights.size() < 1000 &&
         std::min(grid.step_x, grid.step_y) > 1e-6 * reach;
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  const std::string text(bytes.begin(), bytes.end());
  const auto grid = cleave::io::parse_height_grid(text, "fuzz");
  const auto windows = cleave::io::parse_height_grid(cleave::fuzz::with_windows_line_ends(text), "fuzz");
  CLEAVE_ASSERT(grid.has_value() == windows.has_value());
  if (!grid) {
    CLEAVE_ASSERT(!grid.error().what.empty() && !grid.error().remedy.empty());
    return;
  }
  CLEAVE_ASSERT(same(*grid, *windows));
  CLEAVE_ASSERT(grid->columns >= 1 && grid->rows >= 1 && grid->step_x > 0 && grid->step_y > 0);
  CLEAVE_ASSERT(grid->heights.size() == std::size_t{grid->columns} * grid->rows && grid->known() > 0);
  for (const double z : grid->heights) CLEAVE_ASSERT(std::isnan(z) || std::abs(z) <= 1e9);
  if (!is_plain(*grid)) return;
  std::string points;
  for (std::uint32_t row = 0; row < grid->rows; ++row) {
    for (std::uint32_t column = 0; column < grid->columns; ++column) {
      points += fmt::format("{} {} {}\n", grid->x_of(column), grid->y_of(row), *grid->height(column, row));
    }
  }
  const auto again = cleave::io::parse_xyz_grid(points, "again");
  CLEAVE_ASSERT(again.has_value() && same(*grid, *again));
}
