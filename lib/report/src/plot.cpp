#include "plot.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/exchange/text.hpp"
#include "svg.hpp"

namespace cleave::report::detail {
namespace {

constexpr double left = 74, right = 504, top = 14, bottom = 262;

double share(const Axis& axis, double v) {
  const double s =
      axis.log ? (std::log(std::max(v, axis.low)) - std::log(axis.low)) / (std::log(axis.high) - std::log(axis.low))
               : (v - axis.low) / (axis.high - axis.low);
  return std::clamp(s, 0.0, 1.0);
}

std::string path_of(const std::vector<PlotPoint>& points, auto&& at_x, auto&& at_y, bool reversed) {
  std::string path;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PlotPoint& p = points[reversed ? points.size() - 1 - i : i];
    path += (path.empty() ? (reversed ? "L" : "M") : "L") + fixed(at_x(p.x)) + ',' + fixed(at_y(p.y));
  }
  return path;
}

}  // namespace

Plot::Plot(Axis x, Axis y, std::string_view description) : x_{std::move(x)}, y_{std::move(y)} {
  out_ = "<svg viewBox=\"0 0 520 320\" role=\"img\" aria-label=\"" + escape_xml(description) + "\">";
  ticks(x_, true);
  ticks(y_, false);
  out_ += text((left + right) / 2, bottom + 44, "middle", escape_xml(x_.label));
  out_ += "<text x=\"14\" y=\"" + fixed((top + bottom) / 2) + "\" text-anchor=\"middle\" transform=\"rotate(-90 14 " +
          fixed((top + bottom) / 2) + ")\">" + escape_xml(y_.label) + "</text>";
}

double Plot::at_x(double v) const { return left + (right - left) * share(x_, v); }
double Plot::at_y(double v) const { return bottom - (bottom - top) * share(y_, v); }

void Plot::ticks(const Axis& axis, bool horizontal) {
  const auto tick = [&](double v, const std::string& label) {
    if (horizontal) {
      out_ += "<path class=\"grid\" d=\"M" + fixed(at_x(v)) + ',' + fixed(top) + 'V' + fixed(bottom) + "\"/>" +
              text(at_x(v), bottom + 20, "middle", label);
    } else {
      out_ += "<path class=\"grid\" d=\"M" + fixed(left) + ',' + fixed(at_y(v)) + 'H' + fixed(right) + "\"/>" +
              text(left - 6, at_y(v) + 5, "end", label);
    }
  };
  if (axis.log) {
    const int low = static_cast<int>(std::ceil(std::log10(axis.low) - 1e-9));
    const int high = static_cast<int>(std::floor(std::log10(axis.high) + 1e-9));
    const int step = std::max(1, (high - low + 6) / 7);
    for (int e = low; e <= high; e += step) tick(std::pow(10.0, e), power_of_ten(e));
    return;
  }
  const double step = tick_step(axis.high - axis.low, 5);
  for (double v = std::ceil(axis.low / step) * step; v <= axis.high * (1 + 1e-12); v += step) tick(v, display(v, 3));
}

void Plot::line(const std::vector<PlotPoint>& points, LineStyle style) {
  if (points.empty()) return;
  out_ += "<path class=\"";
  out_ += style == LineStyle::solid ? "line-a" : "line-b";
  out_ +=
      "\" d=\"" + path_of(points, [&](double v) { return at_x(v); }, [&](double v) { return at_y(v); }, false) + "\"/>";
}

void Plot::band(const std::vector<PlotPoint>& low, const std::vector<PlotPoint>& high) {
  if (low.empty()) return;
  const auto x = [&](double v) { return at_x(v); };
  const auto y = [&](double v) { return at_y(v); };
  out_ += "<path fill=\"#0072B2\" fill-opacity=\".2\" d=\"" + path_of(low, x, y, false) + path_of(high, x, y, true) +
          "Z\"/>";
}

void Plot::bar(double from, double to, double height, std::string_view colour) {
  const double x0 = at_x(from), x1 = at_x(to), y = at_y(height);
  out_ += "<rect x=\"" + fixed(x0) + "\" y=\"" + fixed(y) + "\" width=\"" + fixed(std::max(0.5, x1 - x0 - 0.7)) +
          "\" height=\"" + fixed(bottom - y) + "\" fill=\"";
  out_ += colour;
  out_ += "\" fill-opacity=\".65\"/>";
}

void Plot::whisker(double x, double low, double high) {
  out_ += "<path stroke=\"currentColor\" stroke-width=\"1.3\" d=\"M" + fixed(at_x(x)) + ',' + fixed(at_y(low)) + 'V' +
          fixed(at_y(high)) + "\"/>";
}

void Plot::dot(double x, double y, std::string_view colour) {
  out_ += "<circle cx=\"" + fixed(at_x(x)) + "\" cy=\"" + fixed(at_y(y)) + "\" r=\"3.5\" fill=\"";
  out_ += colour;
  out_ += "\"/>";
}

std::string Plot::svg() && { return std::move(out_) + "</svg>"; }

Axis from_zero(double high, std::string label) {
  if (!(high > 0)) high = 1;
  const double step = tick_step(high, 5);
  return {0, std::ceil(high / step) * step, false, std::move(label)};
}

Axis decades(double low, double high, std::string label) {
  const double from = std::floor(std::log10(low) + 1e-9), to = std::ceil(std::log10(high) - 1e-9);
  return {std::pow(10.0, from), std::pow(10.0, std::max(to, from + 1)), true, std::move(label)};
}

}  // namespace cleave::report::detail
