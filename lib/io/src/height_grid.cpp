#include "cleave/io/height_grid.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/core/expected.hpp"
#include "cleave/io/file.hpp"
#include "height_limits.hpp"
#include "text.hpp"

namespace cleave::io {

std::optional<double> HeightGrid::height(std::uint32_t column, std::uint32_t row) const {
  const double value = heights[std::size_t{row} * columns + column];
  return std::isnan(value) ? std::nullopt : std::optional{value};
}

std::size_t HeightGrid::known() const {
  return static_cast<std::size_t>(std::ranges::count_if(heights, [](double z) { return !std::isnan(z); }));
}

std::expected<HeightGrid, ReadError> parse_height_grid(std::string_view bytes, std::string_view name,
                                                       const HeightGridOptions& options) {
  LineReader lines{without_bom(bytes), name};
  std::string_view line;
  std::string_view word;
  while (word.empty() && lines.next(line)) word = take_word(line);
  return is_esri_key(word) ? parse_esri_grid(bytes, name, options) : parse_xyz_grid(bytes, name, options);
}

std::expected<HeightGrid, ReadError> read_height_grid(const std::filesystem::path& path,
                                                      const HeightGridOptions& options) {
  CLEAVE_TRY(const std::string bytes, read_file(path));
  return parse_height_grid(bytes, path.string(), options);
}

}  // namespace cleave::io
