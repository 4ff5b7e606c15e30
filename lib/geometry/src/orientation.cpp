#include "cleave/geometry/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cleave::geometry {
namespace {

constexpr double to_radians = std::numbers::pi / 180;
constexpr double to_degrees = 180 / std::numbers::pi;

double azimuth_of(double east, double north) { return wrap_degrees(std::atan2(east, north) * to_degrees); }

}  // namespace

double wrap_degrees(double degrees) noexcept {
  const double wrapped = std::fmod(degrees, 360.0);
  const double positive = wrapped < 0 ? wrapped + 360.0 : wrapped;
  return positive >= 360.0 ? 0.0
                           : positive + 0.0;  // a tiny negative angle rounds up to 360; + 0.0 drops the sign of -0
}

double sin_degrees(double degrees) noexcept {
  const double angle = wrap_degrees(degrees);
  if (angle > 180) return -sin_degrees(angle - 180);
  const double acute = angle > 90 ? 180 - angle : angle;
  // Near 90 the cosine of the rest is the more accurate, and 1 at 90.
  return acute > 45 ? std::cos((90 - acute) * to_radians) : std::sin(acute * to_radians);
}

double cos_degrees(double degrees) noexcept {
  const double angle = wrap_degrees(degrees);
  const double half = angle > 180 ? 360 - angle : angle;
  return half > 90 ? -sin_degrees(half - 90) : sin_degrees(90 - half);
}

Vec3 upward_normal(Attitude plane) noexcept {
  const double d = plane.dip.degrees();
  const double a = plane.direction.degrees();
  return {sin_degrees(d) * sin_degrees(a), sin_degrees(d) * cos_degrees(a), cos_degrees(d)};
}

Vec3 dip_vector(Attitude plane) noexcept {
  const double d = plane.dip.degrees();
  const double a = plane.direction.degrees();
  return {cos_degrees(d) * sin_degrees(a), cos_degrees(d) * cos_degrees(a), -sin_degrees(d)};
}

Vec3 strike_vector(DipDirection direction) noexcept {
  return {-cos_degrees(direction.degrees()), sin_degrees(direction.degrees()), 0};
}

Attitude attitude_of(Vec3 normal) noexcept {
  // Scaled first, so that the squares below neither overflow nor vanish.
  const Vec3 scaled = normal / std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  const Vec3 up = scaled.z < 0 ? -scaled : scaled;
  const double horizontal = std::hypot(up.x, up.y);
  if (horizontal == 0) return {Dip::degrees(0), DipDirection::degrees(0)};
  return {Dip::degrees(std::atan2(horizontal, up.z) * to_degrees), DipDirection::degrees(azimuth_of(up.x, up.y))};
}

DipDirection dip_direction_of(Strike strike) noexcept {
  return DipDirection::degrees(wrap_degrees(strike.degrees() + 90));
}

Strike strike_of(DipDirection direction) noexcept { return Strike::degrees(wrap_degrees(direction.degrees() - 90)); }

Vec3 line_vector(LineAttitude line) noexcept {
  const double t = line.trend.degrees();
  const double p = line.plunge.degrees();
  return {cos_degrees(p) * sin_degrees(t), cos_degrees(p) * cos_degrees(t), -sin_degrees(p)};
}

LineAttitude line_attitude_of(Vec3 direction) noexcept {
  const Vec3 v = direction / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  const double horizontal = std::hypot(v.x, v.y);
  const double trend = horizontal == 0 ? 0 : azimuth_of(v.x, v.y);
  return {Trend::degrees(trend), Plunge::degrees(std::atan2(-v.z, horizontal) * to_degrees)};
}

LineAttitude pole_of(Attitude plane) noexcept {
  return {Trend::degrees(wrap_degrees(plane.direction.degrees() + 180)), Plunge::degrees(90 - plane.dip.degrees())};
}

DipDirection from_true_north(DipDirection direction, North north) noexcept {
  return DipDirection::degrees(wrap_degrees(direction.degrees() + north.degrees()));
}

DipDirection to_true_north(DipDirection direction, North north) noexcept {
  return DipDirection::degrees(wrap_degrees(direction.degrees() - north.degrees()));
}

NetPoint project(Vec3 direction, Net net) noexcept {
  Vec3 d = direction / norm(direction);
  if (d.z > 0) d = -d;
  const double horizontal = std::hypot(d.x, d.y);
  if (horizontal == 0) return {0, 0};
  // theta from the downward vertical; tan(theta/2) = sin/(1 + cos), sqrt 2 sin(theta/2) = sqrt(1 - cos).
  const double r = net == Net::equal_angle ? horizontal / (1 - d.z) : horizontal / std::sqrt(1 - d.z);
  return {r * d.x / horizontal, r * d.y / horizontal};
}

NetPoint project(LineAttitude line, Net net) noexcept { return project(line_vector(line), net); }

std::vector<NetPoint> great_circle(Attitude plane, Net net, int segments) {
  const Vec3 strike = strike_vector(plane.direction);
  const Vec3 dip = dip_vector(plane);
  std::vector<NetPoint> points;
  for (int i = 0; i <= segments; ++i) {
    const double rake = 180.0 * i / segments;
    Vec3 line = cos_degrees(rake) * strike + sin_degrees(rake) * dip;
    if (line.z > 0) line.z = 0;  // rounding must not throw the ends to the other side
    points.push_back(project(line, net));
  }
  return points;
}

}  // namespace cleave::geometry
