#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/height_grid.hpp"
#include "text.hpp"
#include "xyz_points.hpp"

namespace cleave::io {
namespace {

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
  XyzReader(XyzPoints points, std::string_view file) : samples_{std::move(points.samples)}, file_{file} {
    grid_.notes = std::move(points.notes);
  }

  std::expected<HeightGrid, ReadError> run() {
    CLEAVE_CHECK(find_grid());
    CLEAVE_CHECK(fill_grid());
    return std::move(grid_);
  }

 private:
  [[nodiscard]] ReadError whole(ReadFault fault, std::string what, std::string remedy) const {
    return whole_file(fault, file_, std::move(what), std::move(remedy));
  }

  std::expected<void, ReadError> find_grid() {
    std::vector<double> xs;
    std::vector<double> ys;
    for (const XyzPoints::Sample& sample : samples_) {
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
    for (const XyzPoints::Sample& sample : samples_) {
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
                      std::string{file_},
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

  std::vector<XyzPoints::Sample> samples_;
  std::string_view file_;
  Axis x_axis_;
  Axis y_axis_;
  HeightGrid grid_;
};

}  // namespace

std::expected<HeightGrid, ReadError> parse_xyz_grid(std::string_view bytes, std::string_view name,
                                                    const HeightGridOptions& options) {
  CLEAVE_TRY(XyzPoints points, read_xyz_points(bytes, name, options));
  return XyzReader{std::move(points), name}.run();
}

}  // namespace cleave::io
