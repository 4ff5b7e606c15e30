#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/vec2.hpp"

namespace cleave::report::detail {

/// One axis of a drawing: from `low` to `high`, linear or logarithmic (then both > 0).
struct Axis {
  double low = 0, high = 1;
  bool log = false;
  std::string label = {};
};

using PlotPoint = Vec2;

/// A drawing with two axes as inline SVG, 520 x 320. Values beyond the axes are drawn on their border.
enum class LineStyle : std::uint8_t { solid, dashed };

class Plot final {
 public:
  Plot(Axis x, Axis y, std::string_view description);
  void line(const std::vector<PlotPoint>& points, LineStyle style = LineStyle::solid);
  /// Between `low` and `high`, whose points share their x.
  void band(const std::vector<PlotPoint>& low, const std::vector<PlotPoint>& high);
  /// A rectangle from the x axis up to `height`.
  void bar(double from, double to, double height, std::string_view colour = "#0072B2");
  void whisker(double x, double low, double high);
  void dot(double x, double y, std::string_view colour = "#0072B2");
  [[nodiscard]] std::string svg() &&;

 private:
  [[nodiscard]] double at_x(double v) const;
  [[nodiscard]] double at_y(double v) const;
  void ticks(const Axis& axis, bool horizontal);
  Axis x_, y_;
  std::string out_;
};

/// An axis that holds [0, high] or, logarithmic, [low, high] with round ends.
[[nodiscard]] Axis from_zero(double high, std::string label);
[[nodiscard]] Axis decades(double low, double high, std::string label);

}  // namespace cleave::report::detail
