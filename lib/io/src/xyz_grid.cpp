#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/height_grid.hpp"
#include "height_limits.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

struct Sample {
  Vec3 at;
  std::uint32_t line;
};

/// Where the columns (or rows) of a grid stand.
struct Axis {
  double first = 0;
  double step = 1;
  std::uint32_t count = 1;

  /// The nearest column; empty further than 5 % of a step from it.
  [[nodiscard]] std::optional<std::uint32_t> index(double value) const {
    const double number = (value - first) / step;
    const double nearest = std::round(number);
    if (!(std::abs(number - nearest) <= 0.05) || nearest < 0 || nearest >= count) return std::nullopt;
    return static_cast<std::uint32_t>(nearest);
  }
};

bool is_separator(char c) { return is_blank(c) || c == ',' || c == ';'; }

std::string_view take_field(std::string_view& line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  std::size_t end = 0;
  while (end < line.size() && !is_separator(line[end])) ++end;
  const std::string_view field = line.substr(0, end);
  line.remove_prefix(end);
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  if (!line.empty() && is_separator(line.front())) line.remove_prefix(1);
  return field;
}

/// The grid on which all values lie, from their usual distance; its last digits are those of the whole length, since
/// a step of 1/3 m written with two decimals is 0.33 or 0.34.
std::optional<Axis> axis_of(std::vector<double> values) {
  std::ranges::sort(values);
  const double largest = std::max(std::abs(values.front()), std::abs(values.back()));
  const double noise = 1e-9 * largest;  // nearer ones are one column: coordinates that went through other programs
  std::vector<double> gaps;
  double last = values.front();
  for (const double value : values) {
    if (value - last <= noise) continue;
    gaps.push_back(value - last);
    last = value;
  }
  if (gaps.empty()) return Axis{values.front(), 1, 1};
  std::vector<double> sorted = gaps;
  std::ranges::sort(sorted);
  const double usual = sorted[sorted.size() / 2];
  double count = 0;
  for (const double gap : gaps) count += std::round(gap / usual);
  if (!(count < 1e9)) return std::nullopt;
  return Axis{values.front(), (values.back() - values.front()) / count, static_cast<std::uint32_t>(count) + 1};
}

class XyzReader final {
 public:
  XyzReader(std::string_view bytes, std::string_view file, const HeightGridOptions& options)
      : lines_{bytes, file}, options_{options} {}

  std::expected<HeightGrid, ReadError> run() {
    CLEAVE_CHECK(read_samples());
    CLEAVE_CHECK(find_grid());
    CLEAVE_CHECK(fill_grid());
    return std::move(grid_);
  }

 private:
  [[nodiscard]] ReadError whole(ReadFault fault, std::string what, std::string remedy) const {
    return whole_file(fault, lines_.file(), std::move(what), std::move(remedy));
  }

  std::expected<void, ReadError> read_samples() {
    bool may_be_names = true;
    std::string_view line;
    while (lines_.next(line)) {
      std::string_view rest = trimmed(line.substr(0, line.find('#')));
      if (rest.empty()) continue;
      const bool names = std::exchange(may_be_names, false) && is_names(rest);
      if (names) continue;
      std::array<double, 3> p{};
      for (double& coordinate : p) {
        const auto number = number_of(take_field(rest));
        if (!number) {
          return std::unexpected(lines_.error(ReadFault::bad_number, number.error(),
                                              "give x, y and z on each line, in metres, with a decimal point"));
        }
        coordinate = *number;
      }
      CLEAVE_CHECK(add({p[0], p[1], p[2]}));
    }
    if (samples_.empty()) return std::unexpected(whole(ReadFault::empty, "holds no height", "give lines of x y z"));
    return {};
  }

  /// A first line such as "x,y,z" or "X Y Elevation": begins with a letter and has no digits at the start of any field.
  static bool is_names(std::string_view line) {
    while (!line.empty()) {
      const std::string_view field = take_field(line);
      if (number_of(field)) return false;
      if (!field.empty()) {
        const char c = field.front();
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"' || c == '/';
        if (!letter) return false;
        if (same_word(field, "nan") || same_word(field, "inf")) return false;
      }
    }
    return true;
  }

  std::expected<void, ReadError> add(Vec3 p) {
    const bool none = options_.no_data && same_height(p.z, *options_.no_data);
    if (!(std::abs(p.x) <= farthest && std::abs(p.y) <= farthest && (none || std::abs(p.z) <= farthest))) {
      return std::unexpected(lines_.error(ReadFault::out_of_range,
                                          fmt::format("({}, {}, {}) is too far", p.x, p.y, p.z),
                                          "coordinates and heights reach from -1e9 to 1e9 m"));
    }
    if (!none) samples_.push_back({p, lines_.number()});
    return {};
  }

  std::expected<void, ReadError> find_grid() {
    std::vector<double> xs;
    std::vector<double> ys;
    for (const Sample& sample : samples_) {
      xs.push_back(sample.at.x);
      ys.push_back(sample.at.y);
    }
    const auto x_axis = axis_of(std::move(xs));
    const auto y_axis = axis_of(std::move(ys));
    if (!x_axis || !y_axis || !(x_axis->step > 0) || !(y_axis->step > 0)) return std::unexpected(not_a_grid());
    const double places = static_cast<double>(x_axis->count) * static_cast<double>(y_axis->count);
    // Points anywhere, not on a grid, make a grid of almost only empty places. This also bounds the memory.
    if (places > 10.0 * static_cast<double>(samples_.size()) + 100) return std::unexpected(not_a_grid());
    x_axis_ = *x_axis;
    y_axis_ = *y_axis;
    return {};
  }

  [[nodiscard]] ReadError not_a_grid() const {
    return whole(ReadFault::out_of_range,
                 fmt::format("its {} points do not lie on a rectangular grid along x and y", samples_.size()),
                 "interpolate them to a grid, or triangulate them and give the surface as .obj, .ts or .dxf");
  }

  std::expected<void, ReadError> fill_grid() {
    grid_.columns = x_axis_.count;
    grid_.rows = y_axis_.count;
    grid_.x = x_axis_.first;
    grid_.y = y_axis_.first;
    grid_.step_x = x_axis_.step;
    grid_.step_y = y_axis_.step;
    grid_.heights.assign(std::size_t{grid_.columns} * grid_.rows, std::numeric_limits<double>::quiet_NaN());
    std::uint64_t repeated = 0;
    for (const Sample& sample : samples_) {
      const auto column = x_axis_.index(sample.at.x);
      const auto from_south = y_axis_.index(sample.at.y);
      if (!column || !from_south) {
        ReadError error = not_a_grid();
        error.line = sample.line;
        error.what = fmt::format("({}, {}) is off the grid of {} x {} points with steps of {:.6g} and {:.6g} m",
                                 sample.at.x, sample.at.y, grid_.columns, grid_.rows, grid_.step_x, grid_.step_y);
        return std::unexpected(std::move(error));
      }
      double& height = grid_.heights[std::size_t{grid_.rows - 1 - *from_south} * grid_.columns + *column];
      if (!std::isnan(height) && height != sample.at.z) {
        return std::unexpected(
            ReadError{ReadFault::out_of_range,
                      std::string{lines_.file()},
                      sample.line,
                      {},
                      fmt::format("({}, {}) has two heights, {} and {}", sample.at.x, sample.at.y, height, sample.at.z),
                      "remove one of them"});
      }
      if (!std::isnan(height)) ++repeated;
      height = sample.at.z;
    }
    if (repeated > 0) grid_.notes.push_back(fmt::format("{} points are given twice with the same height", repeated));
    return {};
  }

  LineReader lines_;
  const HeightGridOptions& options_;
  std::vector<Sample> samples_;
  Axis x_axis_;
  Axis y_axis_;
  HeightGrid grid_;
};

}  // namespace

std::expected<HeightGrid, ReadError> parse_xyz_grid(std::string_view bytes, std::string_view name,
                                                    const HeightGridOptions& options) {
  return XyzReader{without_bom(bytes), name, options}.run();
}

}  // namespace cleave::io
