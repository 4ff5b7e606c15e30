#include "pyramid_net.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "stereonet.hpp"
#include "svg.hpp"

namespace cleave::report {
namespace {

using detail::fixed;
using geometry::cross;
using geometry::dot;
using geometry::Vec3;

/// Of the rim, and of the square that is shown.
constexpr double radius = 100, reach = 2.45, centre = radius * reach;

/// Straight down is the middle, the horizon the rim, straight up infinitely far.
Vec2 plot(Vec3 d) {
  const double f = radius / std::max(1 - d.z, 1e-4);
  return {centre + f * d.x, centre - f * d.y};
}
std::string text(Vec2 p) { return fixed(p.x) + ',' + fixed(p.y); }

std::string path(const std::vector<Vec3>& directions) {
  std::string out = "M";
  for (std::size_t i = 0; i < directions.size(); ++i) out += (i == 0 ? "" : "L") + text(plot(directions[i]));
  return out;
}

/// From one direction to another along their great circle.
void add_arc(Vec3 from, Vec3 to, std::vector<Vec3>& points) {
  const Vec3 across = to - dot(from, to) * from;
  if (!(norm(across) > 1e-12)) return;
  const Vec3 side = geometry::normalized(across);
  const double angle = std::atan2(norm(across), dot(from, to));
  constexpr int steps = 48;
  for (int i = 0; i < steps; ++i) {
    const double t = angle * i / steps;
    points.push_back(std::cos(t) * from + std::sin(t) * side);
  }
}

/// The spherical triangle on the side of each plane that the code names: its corners are lines of two planes.
std::array<Vec3, 3> corners_of(const std::array<Vec3, 3>& upward, std::uint32_t code) {
  std::array<Vec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 line = geometry::normalized(cross(upward[(i + 1) % 3], upward[(i + 2) % 3]));
    const bool above = ((code >> i) & 1U) == 0;
    corners[i] = (dot(line, upward[i]) > 0) == above ? line : -line;
  }
  return corners;
}

std::string_view colour(stability::Mode mode) {
  switch (mode) {
    case stability::Mode::falling:
    case stability::Mode::lifting: return "#D55E00";
    case stability::Mode::sliding: return "#0072B2";
    case stability::Mode::wedge: return "#009E73";
    case stability::Mode::stable:
    case stability::Mode::tapered: return "#888";
  }
  std::unreachable();
}

}  // namespace

std::string pyramid_net(std::span<const scene::MaximumRow> rows) {
  const std::array<Vec3, 3>& upward = rows.front().block.upward;
  const double size = 2 * centre;
  std::string out = "<svg viewBox=\"0 0 " + fixed(size) + ' ' + fixed(size) +
                    "\" role=\"img\" aria-label=\"Joint pyramids\"><rect x=\"0.5\" y=\"0.5\" width=\"" +
                    fixed(size - 1) + "\" height=\"" + fixed(size - 1) + "\" class=\"net-rim\"/>";
  std::string labels;
  for (std::uint32_t code = 0; code < 8; ++code) {
    const std::array<Vec3, 3> corners = corners_of(upward, code);
    std::string digits;
    for (std::size_t i = 0; i < 3; ++i) digits += ((code >> i) & 1U) != 0 ? '1' : '0';
    const auto row = std::ranges::find(rows, code, [](const scene::MaximumRow& r) { return r.block.block.code; });
    if (row != rows.end()) {
      std::vector<Vec3> around;
      for (std::size_t i = 0; i < 3; ++i) add_arc(corners[i], corners[(i + 1) % 3], around);
      std::string area = path(around) + "Z";
      // A pyramid that holds straight up lies outside its outline.
      bool up = true;
      for (std::size_t i = 0; i < 3; ++i) up = up && ((upward[i].z > 0) == (((code >> i) & 1U) == 0));
      if (up) area += "M0,0H" + fixed(size) + "V" + fixed(size) + "H0Z";
      out += "<path data-code=\"" + digits + "\" d=\"" + area + "\" fill=\"" + std::string{colour(row->block.mode)} +
             "\" fill-opacity=\"0.35\" fill-rule=\"evenodd\"/>";
      if (norm(row->block.direction) > 0) {
        const Vec2 p = plot(row->block.direction);
        labels += "<path d=\"M" + fixed(p.x - 5) + ',' + fixed(p.y) + "h10M" + fixed(p.x) + ',' + fixed(p.y - 5) +
                  "v10\" stroke=\"#009E73\" stroke-width=\"3\"/>";
      }
    }
    // In the middle of the triangle, or as near to it as the square reaches.
    Vec2 at = plot(geometry::normalized(corners[0] + corners[1] + corners[2]));
    const double away = std::max(std::abs(at.x - centre), std::abs(at.y - centre)), most = centre - 18;
    if (away > most) at = {centre + (at.x - centre) * most / away, centre + (at.y - centre) * most / away};
    labels += "<text x=\"" + fixed(at.x) + "\" y=\"" + fixed(at.y + 5) + "\" text-anchor=\"middle\"" +
              (row != rows.end() ? " font-weight=\"700\"" : " opacity=\"0.6\"") + '>' + digits + "</text>";
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 n = upward[i];
    const Vec3 strike = std::hypot(n.x, n.y) > 1e-9 ? geometry::normalized(Vec3{-n.y, n.x, 0}) : Vec3{1, 0, 0};
    const Vec3 dip = cross(n, strike);
    std::vector<Vec3> circle;
    for (int k = 0; k <= 180; ++k) {
      const double t = 2 * std::numbers::pi * k / 180;
      circle.push_back(std::cos(t) * strike + std::sin(t) * dip);
    }
    out += "<path fill=\"none\" d=\"" + path(circle) + "\" stroke=\"" + set_colour(i) + "\" stroke-width=\"1.6\"/>";
  }
  out += "<circle cx=\"" + fixed(centre) + "\" cy=\"" + fixed(centre) + "\" r=\"" + fixed(radius) +
         "\" class=\"net-rim\" stroke-dasharray=\"4 3\"/>" + labels;
  for (std::size_t i = 0; i < 3; ++i) {
    out += "<path d=\"M10," + fixed(16 + 16.0 * static_cast<double>(i)) + "h16\" stroke=\"" + set_colour(i) +
           "\" stroke-width=\"3\"/><text x=\"31\" y=\"" + fixed(20 + 16.0 * static_cast<double>(i)) + "\">" +
           escape_xml(rows.front().sets[i]) + "</text>";
  }
  return out + "</svg>";
}

}  // namespace cleave::report
