#include "stereonet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/survey/orientation.hpp"
#include "svg.hpp"

namespace cleave::report {
namespace {

using detail::fixed;
using geometry::Vec3;

constexpr double radius = 220;
constexpr double centre = 256;
constexpr double pi = std::numbers::pi;

std::string point(NetPoint p) { return fixed(centre + radius * p.x) + ',' + fixed(centre - radius * p.y); }

std::string polyline(const std::vector<NetPoint>& points, std::string_view attributes) {
  std::string out = "<path d=\"M";
  for (std::size_t i = 0; i < points.size(); ++i) out += (i == 0 ? "" : "L") + point(points[i]);
  out += "\" ";
  out += attributes;
  return out + "/>";
}

Vec3 normal_of(double dip, double dip_direction) {
  const double d = dip * pi / 180, a = dip_direction * pi / 180;
  return {std::sin(d) * std::sin(a), std::sin(d) * std::cos(a), std::cos(d)};
}

std::string frame(Net net, double north) {
  std::string out = "<circle cx=\"256\" cy=\"256\" r=\"220\" class=\"net-rim\"/>";
  for (const double dip : {30.0, 60.0}) {
    const NetPoint p = project(normal_of(dip, 0), net);
    out += "<circle cx=\"256\" cy=\"256\" r=\"" + fixed(radius * std::hypot(p.x, p.y)) + "\" class=\"net-grid\"/>";
  }
  for (int degrees = 0; degrees < 360; degrees += 10) {
    const double t = degrees * pi / 180, from = degrees % 90 == 0 ? 0.96 : 0.98;
    out += "<path class=\"net-tick\" d=\"M" + point({from * std::sin(t), from * std::cos(t)}) + 'L' +
           point({std::sin(t), std::cos(t)}) + "\"/>";
  }
  out += "<path class=\"net-grid\" d=\"M36,256H476M256,36V476\"/>";
  const std::array<std::pair<std::string_view, double>, 4> marks{{{"N", 0}, {"E", 90}, {"S", 180}, {"W", 270}}};
  for (const auto& [text, degrees] : marks) {
    const double t = (degrees + north) * pi / 180;
    out += "<text x=\"" + fixed(centre + 238 * std::sin(t)) + "\" y=\"" + fixed(centre - 238 * std::cos(t) + 6) +
           "\" class=\"net-mark\">";
    out += text;
    out += "</text>";
  }
  return out;
}

}  // namespace

std::vector<NetPoint> great_circle(Vec3 normal, Net net, std::size_t count) {
  CLEAVE_ASSERT(count >= 2);
  Vec3 n = normal / norm(normal);
  if (n.z < 0) n = -n;
  const double horizontal = std::hypot(n.x, n.y);
  const Vec3 strike = horizontal == 0 ? Vec3{1, 0, 0} : Vec3{-n.y / horizontal, n.x / horizontal, 0};
  const Vec3 down = cross(strike, n).z < 0 ? cross(strike, n) : cross(n, strike);
  std::vector<NetPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = pi * static_cast<double>(i) / static_cast<double>(count - 1);
    Vec3 line = std::cos(t) * strike + std::sin(t) * down;
    // On the rim both ends of a line plot; keep the one we walk along.
    if (line.z >= 0) line.z = -1e-300;
    points.push_back(project(line, net));
  }
  return points;
}

MeanPole mean_of(std::span<const Vec3> poles) {
  CLEAVE_ASSERT(!poles.empty());
  std::vector<Vec3> normals;
  for (const Vec3& p : poles) normals.push_back(normalized(p));
  const std::vector<double> weights(normals.size(), 1);
  Vec3 mean = normalized(survey::orientation_tensor(normals, weights).vectors[0]);
  if (mean.z < 0) mean = -mean;
  Vec3 sum{};
  for (const Vec3& n : normals) sum += (dot(n, mean) < 0 ? -1.0 : 1.0) * n;
  const auto n = static_cast<double>(poles.size());
  const double spread = n - norm(sum);
  double direction = std::atan2(mean.x, mean.y) * 180 / pi;
  if (direction < 0) direction += 360;
  return {.normal = mean,
          .dip_degrees = std::acos(std::min(1.0, mean.z)) * 180 / pi,
          .dip_direction_degrees = direction,
          .kappa = poles.size() > 1 && spread > 1e-12 * n ? (n - 1) / spread : std::numeric_limits<double>::infinity(),
          .count = poles.size()};
}

std::string set_colour(std::size_t set) {
  constexpr std::array<std::string_view, 6> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};
  return std::string{colours[set % colours.size()]};
}

std::string set_marker(std::size_t set, double x, double y, double r) {
  const std::string fill = "fill=\"" + set_colour(set) + "\"";
  switch (set % 4) {
    case 0: return "<circle cx=\"" + fixed(x) + "\" cy=\"" + fixed(y) + "\" r=\"" + fixed(r) + "\" " + fill + "/>";
    case 1:
      return "<path d=\"M" + fixed(x - r) + ',' + fixed(y - r) + 'h' + fixed(2 * r) + 'v' + fixed(2 * r) + 'h' +
             fixed(-2 * r) + "z\" " + fill + "/>";
    case 2:
      return "<path d=\"M" + fixed(x) + ',' + fixed(y - 1.3 * r) + 'l' + fixed(1.2 * r) + ',' + fixed(2.2 * r) + 'h' +
             fixed(-2.4 * r) + "z\" " + fill + "/>";
    default:
      return "<path d=\"M" + fixed(x) + ',' + fixed(y - 1.4 * r) + 'l' + fixed(1.3 * r) + ',' + fixed(1.4 * r) + 'l' +
             fixed(-1.3 * r) + ',' + fixed(1.4 * r) + 'l' + fixed(-1.3 * r) + ',' + fixed(-1.4 * r) + "z\" " + fill +
             "/>";
  }
}

std::string stereonet_svg(std::span<const Pole> poles, std::span<const NetSet> sets, Net net, double north) {
  std::string out = "<svg viewBox=\"0 0 512 512\" role=\"img\" aria-label=\"";
  out += net == Net::equal_area ? "Equal-area" : "Equal-angle";
  out += " lower-hemisphere stereonet of joint poles\">";
  out += frame(net, north);
  const std::size_t step = (poles.size() + max_plotted_poles - 1) / max_plotted_poles;
  out += "<g opacity=\".75\">";
  for (std::size_t i = 0; i < poles.size(); i += std::max<std::size_t>(step, 1)) {
    const NetPoint p = project(poles[i].normal, net);
    out += set_marker(poles[i].set, centre + radius * p.x, centre - radius * p.y, 2.4);
  }
  out += "</g>";
  for (std::size_t set = 0; set < sets.size(); ++set) {
    std::vector<Vec3> normals;
    for (const Pole& pole : poles) {
      if (pole.set == set) normals.push_back(pole.normal);
    }
    if (normals.empty()) continue;
    const MeanPole mean = mean_of(normals);
    out += polyline(great_circle(mean.normal, net, 91),
                    "fill=\"none\" stroke-width=\"2.2\" stroke=\"" + set_colour(set) + "\"");
    const NetPoint p = project(mean.normal, net);
    out += "<g class=\"net-mean\">" + set_marker(set, centre + radius * p.x, centre - radius * p.y, 7) + "</g>";
  }
  return out + "</svg>";
}

}  // namespace cleave::report
