#include "plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace cleave::study {
namespace {

constexpr double width = 760, height = 520, left = 80, right = 250, top = 50, bottom = 60;

bool drawable(const std::pair<double, double>& p) {
  return p.first > 0 && p.second > 0 && std::isfinite(p.first) && std::isfinite(p.second);
}

/// A logarithmic axis from a whole power of ten to another.
struct Axis {
  int first = 0, last = 1;
  double from = 0, to = 1;  ///< pixels
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * (std::log10(value) - first) / (last - first);
  }
};

Axis axis_over(const std::vector<double>& values, double from, double to) {
  double lo = std::numeric_limits<double>::infinity(), hi = 0;
  for (const double v : values) {
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  if (values.empty()) lo = 1, hi = 10;
  Axis axis{static_cast<int>(std::floor(std::log10(lo))), static_cast<int>(std::ceil(std::log10(hi))), from, to};
  if (axis.last <= axis.first) axis.last = axis.first + 1;
  return axis;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string label(double x, double y, std::string_view anchor, std::string_view text, std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escaped(text));
}

std::string line(double x1, double y1, double x2, double y2, std::string_view style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2, style);
}

std::string grid(const Axis& x, const Axis& y) {
  std::string out;
  const auto power = [](int e) {
    return e >= -3 && e <= 3 ? fmt::format("{:g}", std::pow(10.0, e)) : fmt::format("1e{}", e);
  };
  const int step_x = std::max(1, (x.last - x.first) / 10), step_y = std::max(1, (y.last - y.first) / 12);
  for (int e = x.first; e <= x.last; e += step_x) {
    const double at = x.at(std::pow(10.0, e));
    out += line(at, y.from, at, y.to, "stroke=\"#ddd\"");
    out += label(at, y.from + 18, "middle", power(e));
  }
  for (int e = y.first; e <= y.last; e += step_y) {
    const double at = y.at(std::pow(10.0, e));
    out += line(x.from, at, x.to, at, "stroke=\"#ddd\"");
    out += label(x.from - 6, at + 4, "end", power(e));
  }
  return out;
}

/// Different in shape as well as in colour, for print and for eyes that see fewer colours.
std::string mark(std::size_t kind, double x, double y, std::string_view colour) {
  const auto shape = [&](std::string_view path) {
    return fmt::format("<path transform=\"translate({:.1f} {:.1f})\" d=\"{}\" fill=\"{}\"/>\n", x, y, path, colour);
  };
  switch (kind % 4) {
    case 0: return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n", x, y, colour);
    case 1: return shape("M-4-4h8v8h-8z");
    case 2: return shape("M0-5L5 4H-5z");
    default: return shape("M0-6L5 0L0 6L-5 0z");
  }
}

}  // namespace

std::optional<PowerLaw> fit_power_law(const std::vector<std::pair<double, double>>& points) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& p : points) {
    if (!drawable(p)) continue;
    const double x = std::log(p.first), y = std::log(p.second);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 2 || !(spread > 1e-12 * (1 + sxx))) return std::nullopt;
  const double power = (n * sxy - sx * sy) / spread;
  return PowerLaw{power, std::exp((sy - power * sx) / n)};
}

std::string svg(const Plot& plot) {
  constexpr std::array<std::string_view, 8> colours{"#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad",
                                                    "#d35400", "#16808a", "#7f6000", "#555555"};
  std::vector<double> xs, ys;
  for (const Series& s : plot.series) {
    for (const auto& p : s.points) {
      if (!drawable(p)) continue;
      xs.push_back(p.first);
      ys.push_back(p.second);
    }
  }
  const Axis x = axis_over(xs, left, width - right), y = axis_over(ys, height - bottom, top);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
  out += label(left, 28, "start", plot.title, " font-size=\"16\"");
  out += grid(x, y);
  out += label((x.from + x.to) / 2, height - 18, "middle", plot.x_label);
  out += label(20, (y.from + y.to) / 2, "middle", plot.y_label,
               fmt::format(" transform=\"rotate(-90 20 {:.1f})\"", (y.from + y.to) / 2));
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const Series& s = plot.series[k];
    const std::string_view colour = colours.at(k % colours.size());
    std::string path;
    double lo = std::numeric_limits<double>::infinity(), hi = 0;
    for (const auto& p : s.points) {
      if (!drawable(p)) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x.at(p.first), y.at(p.second));
      out += mark(k, x.at(p.first), y.at(p.second), colour);
      lo = std::min(lo, p.first);
      hi = std::max(hi, p.first);
    }
    if (s.line && !path.empty()) out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\"/>\n", path, colour);
    std::string name = s.name;
    if (const auto law = s.fit ? fit_power_law(s.points) : std::nullopt) {
      const auto value = [&](double at) { return law->factor * std::pow(at, law->power); };
      out += line(x.at(lo), y.at(value(lo)), x.at(hi), y.at(value(hi)),
                  fmt::format("stroke=\"{}\" stroke-dasharray=\"5 3\"", colour));
      name += fmt::format(": slope {:.2f}", law->power);
    }
    const double row = top + 14 + 20 * static_cast<double>(k);
    out += mark(k, width - right + 16, row - 4, colour);
    out += label(width - right + 26, row, "start", name);
  }
  return out + "</svg>\n";
}

}  // namespace cleave::study
