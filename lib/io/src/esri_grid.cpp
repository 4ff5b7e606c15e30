#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/height_grid.hpp"
#include "height_limits.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

enum class Key : std::uint8_t {
  ncols,
  nrows,
  xllcorner,
  xllcenter,
  yllcorner,
  yllcenter,
  cellsize,
  dx,
  dy,
  nodata_value,
  count
};
constexpr std::array<std::string_view, 10> key_names{"ncols",     "nrows",    "xllcorner", "xllcenter", "yllcorner",
                                                     "yllcenter", "cellsize", "dx",        "dy",        "nodata_value"};
static_assert(key_names.size() == static_cast<std::size_t>(Key::count));

std::optional<std::size_t> key_number(std::string_view word) noexcept {
  if (same_word(word, "xllcentre")) word = "xllcenter";
  if (same_word(word, "yllcentre")) word = "yllcenter";
  const auto found = std::ranges::find_if(key_names, [&](std::string_view key) { return same_word(word, key); });
  if (found == key_names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - key_names.begin());
}

class EsriReader final {
 public:
  EsriReader(std::string_view bytes, std::string_view file, const HeightGridOptions& options)
      : lines_{bytes, file}, options_{options} {}

  std::expected<HeightGrid, ReadError> run() {
    CLEAVE_CHECK(read_header());
    CLEAVE_CHECK(place_grid());
    CLEAVE_CHECK(read_heights());
    return std::move(grid_);
  }

 private:
  [[nodiscard]] std::optional<double> value(Key key) const { return values_[static_cast<std::size_t>(key)]; }
  [[nodiscard]] std::uint32_t line_of(Key key) const { return key_lines_[static_cast<std::size_t>(key)]; }

  [[nodiscard]] ReadError at_line(std::optional<std::uint32_t> line, ReadFault fault, std::string what,
                                  std::string remedy) const {
    return {fault, std::string{lines_.file()}, line, {}, std::move(what), std::move(remedy)};
  }

  /// The next word of the file, over line ends; false at the end.
  bool next_word() {
    while ((word_ = take_word(line_)).empty()) {
      if (!lines_.next(line_)) return false;
    }
    return true;
  }

  /// Key and value, until a word is no key.
  std::expected<void, ReadError> read_header() {
    while (next_word()) {
      const auto key = key_number(word_);
      if (!key) break;
      const std::string_view name = key_names[*key];
      if (values_[*key]) {
        return std::unexpected(
            lines_.error(ReadFault::syntax, fmt::format("{} is given twice", name), "remove one of them"));
      }
      if (!next_word()) {
        return std::unexpected(
            lines_.error(ReadFault::truncated, fmt::format("ends after {}", name), "get the whole file again"));
      }
      if (*key == static_cast<std::size_t>(Key::nodata_value) && same_word(word_, "nan")) {
        nan_is_no_data_ = true;
        values_[*key] = 0;
      } else {
        const auto number = number_of(word_);
        if (!number) {
          return std::unexpected(
              lines_.error(ReadFault::bad_number, fmt::format("{}: {}", name, number.error()), "correct the header"));
        }
        values_[*key] = *number;
      }
      key_lines_[*key] = lines_.number();
    }
    return {};
  }

  std::expected<std::uint32_t, ReadError> size(Key key) const {
    const std::string_view name = key_names[static_cast<std::size_t>(key)];
    const auto number = value(key);
    if (!number) {
      return std::unexpected(at_line(1, ReadFault::syntax, fmt::format("its header has no {}", name),
                                     "begin the file with ncols, nrows, xllcorner, yllcorner, cellsize"));
    }
    if (!(*number >= 1 && *number <= 1e9 && *number == std::floor(*number))) {
      return std::unexpected(at_line(line_of(key), ReadFault::out_of_range, fmt::format("{} is {}", name, *number),
                                     "give a whole number from 1 on"));
    }
    return static_cast<std::uint32_t>(*number);
  }

  std::expected<double, ReadError> step(Key axis_key) const {
    const bool own = value(axis_key).has_value();
    const Key key = own ? axis_key : Key::cellsize;
    const std::string_view name = key_names[static_cast<std::size_t>(key)];
    if (!value(key)) {
      return std::unexpected(
          at_line(1, ReadFault::syntax, "its header has no cellsize", "add the size of a cell, in metres"));
    }
    const double length = *value(key);
    if (!(length >= 1e-6 && length <= farthest)) {
      return std::unexpected(at_line(line_of(key), ReadFault::out_of_range, fmt::format("{} is {}", name, length),
                                     "give a length from 1e-6 to 1e9 m"));
    }
    return length;
  }

  /// Centre of the south-western cell along one axis.
  std::expected<double, ReadError> origin(Key corner, Key centre, double length) const {
    const std::string_view corner_name = key_names[static_cast<std::size_t>(corner)];
    const std::string_view centre_name = key_names[static_cast<std::size_t>(centre)];
    if (value(corner).has_value() == value(centre).has_value()) {
      return std::unexpected(at_line(value(corner) ? line_of(centre) : 1, ReadFault::syntax,
                                     fmt::format("its header has {} {} {} {}", value(corner) ? "both" : "neither",
                                                 corner_name, value(corner) ? "and" : "nor", centre_name),
                                     "give one of them"));
    }
    const double place = value(corner) ? *value(corner) + length / 2 : *value(centre);
    if (!(std::abs(place) <= farthest)) {
      return std::unexpected(at_line(line_of(value(corner) ? corner : centre), ReadFault::out_of_range,
                                     fmt::format("{} is {}", value(corner) ? corner_name : centre_name, place),
                                     "coordinates reach from -1e9 to 1e9 m"));
    }
    return place;
  }

  std::expected<void, ReadError> place_grid() {
    CLEAVE_TRY(grid_.columns, size(Key::ncols));
    CLEAVE_TRY(grid_.rows, size(Key::nrows));
    CLEAVE_TRY(grid_.step_x, step(Key::dx));
    CLEAVE_TRY(grid_.step_y, step(Key::dy));
    CLEAVE_TRY(grid_.x, origin(Key::xllcorner, Key::xllcenter, grid_.step_x));
    CLEAVE_TRY(grid_.y, origin(Key::yllcorner, Key::yllcenter, grid_.step_y));
    const double east = grid_.x_of(grid_.columns - 1);
    const double north = grid_.y_of(0);
    if (!(std::abs(east) <= farthest && std::abs(north) <= farthest)) {
      return std::unexpected(at_line(line_of(Key::ncols), ReadFault::out_of_range,
                                     fmt::format("the grid reaches to ({}, {})", east, north),
                                     "coordinates reach from -1e9 to 1e9 m; check ncols, nrows and cellsize"));
    }
    // Each value takes a byte and, but for the last, a blank: a header that promises more is refused before memory is
    // taken for it.
    const std::uint64_t values = std::uint64_t{grid_.columns} * grid_.rows;
    const std::uint64_t bytes = word_.size() + line_.size() + lines_.rest().size() + 1;
    if (values > bytes / 2 + 1) {
      return std::unexpected(at_line(line_of(Key::ncols), ReadFault::truncated,
                                     fmt::format("says it has {} x {} heights, but only {} bytes follow the header",
                                                 grid_.columns, grid_.rows, bytes),
                                     "get the whole file again, or correct ncols and nrows"));
    }
    grid_.heights.reserve(values);
    return {};
  }

  std::expected<void, ReadError> read_heights() {
    const std::size_t values = std::size_t{grid_.columns} * grid_.rows;
    const double stated = value(Key::nodata_value).value_or(-9999);
    for (bool any = !word_.empty(); any; any = next_word()) {
      if (grid_.heights.size() == values) {
        return std::unexpected(
            lines_.error(ReadFault::syntax,
                         fmt::format("{} follows the last of {} x {} heights", shown(word_), grid_.columns, grid_.rows),
                         "correct ncols and nrows, or remove what is too much"));
      }
      CLEAVE_TRY(const double height, read_height(stated));
      grid_.heights.push_back(height);
    }
    if (grid_.heights.size() < values) {
      return std::unexpected(
          lines_.error(ReadFault::truncated,
                       fmt::format("ends after {} of {} x {} heights", grid_.heights.size(), grid_.columns, grid_.rows),
                       "get the whole file again, or correct ncols and nrows"));
    }
    if (grid_.known() == 0) {
      return std::unexpected(at_line({}, ReadFault::empty, "holds no height, all are NODATA", "check NODATA_value"));
    }
    return {};
  }

  std::expected<double, ReadError> read_height(double stated) const {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (nan_is_no_data_ && same_word(word_, "nan")) return none;
    const auto number = number_of(word_);
    if (!number) {
      return std::unexpected(lines_.error(ReadFault::bad_number, number.error(),
                                          "give a height, or the NODATA_value of the header where there is none"));
    }
    if (!nan_is_no_data_ && same_height(*number, stated)) return none;
    if (options_.no_data && same_height(*number, *options_.no_data)) return none;
    if (!(std::abs(*number) <= farthest)) {
      return std::unexpected(lines_.error(ReadFault::out_of_range, fmt::format("a height is {}", *number),
                                          "correct it; where there is none, write the NODATA_value of the header"));
    }
    return *number;
  }

  LineReader lines_;
  const HeightGridOptions& options_;
  std::string_view line_;
  std::string_view word_;
  std::array<std::optional<double>, key_names.size()> values_;
  std::array<std::uint32_t, key_names.size()> key_lines_{};
  bool nan_is_no_data_ = false;
  HeightGrid grid_;
};

}  // namespace

bool is_esri_key(std::string_view word) noexcept { return key_number(word).has_value(); }

std::expected<HeightGrid, ReadError> parse_esri_grid(std::string_view bytes, std::string_view name,
                                                     const HeightGridOptions& options) {
  return EsriReader{without_bom(bytes), name, options}.run();
}

}  // namespace cleave::io
