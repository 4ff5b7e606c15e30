#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "cleave/geometry/vec3.hpp"

namespace cleave::assembly {

/// All numbers that a computed one may stand for: every operation rounds outwards.
struct Interval {
  double low = 0, high = 0;

  [[nodiscard]] static Interval of(double x) { return {x, x}; }
  /// x with an error of up to `share` of `scale`.
  [[nodiscard]] static Interval about(double x, double scale, double share) {
    return Interval::of(x) + Interval{-share * scale, share * scale};
  }
  [[nodiscard]] static double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }
  [[nodiscard]] static double up(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }

  friend Interval operator+(Interval a, Interval b) { return {down(a.low + b.low), up(a.high + b.high)}; }
  friend Interval operator-(Interval a) { return {-a.high, -a.low}; }
  friend Interval operator-(Interval a, Interval b) { return a + -b; }
  friend Interval operator*(Interval a, Interval b) {
    const auto [least, most] = std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
    return {down(least), up(most)};
  }
  /// Largest |x|.
  [[nodiscard]] double size() const { return std::max(std::abs(low), std::abs(high)); }
};

struct Interval3 {
  Interval x, y, z;
  [[nodiscard]] static Interval3 of(geometry::Vec3 v) {
    return {Interval::of(v.x), Interval::of(v.y), Interval::of(v.z)};
  }
  [[nodiscard]] static Interval3 about(geometry::Vec3 v, double scale, double share) {
    return {Interval::about(v.x, scale, share), Interval::about(v.y, scale, share), Interval::about(v.z, scale, share)};
  }
  friend Interval3 operator+(const Interval3& a, const Interval3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Interval3 operator-(const Interval3& a, const Interval3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Interval3 operator*(Interval s, const Interval3& a) { return {s * a.x, s * a.y, s * a.z}; }
};
[[nodiscard]] inline Interval dot(const Interval3& a, const Interval3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Interval3 cross(const Interval3& a, const Interval3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// At least the length of every member.
[[nodiscard]] inline double longest(const Interval3& a) {
  const Interval x = Interval::of(a.x.size()), y = Interval::of(a.y.size()), z = Interval::of(a.z.size());
  return Interval::up(std::sqrt((x * x + y * y + z * z).high));
}

}  // namespace cleave::assembly
