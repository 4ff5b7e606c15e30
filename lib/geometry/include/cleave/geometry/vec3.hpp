#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace cleave::geometry {

/// A position in metres or a direction without unit: x = east, y = north, z = up.
/// Kernel-level type: floating measures only, it decides no topology.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) noexcept { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double s, Vec3 a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, double s) noexcept { return s * a; }
  friend constexpr Vec3 operator/(Vec3 a, double s) noexcept { return {a.x / s, a.y / s, a.z / s}; }
  constexpr Vec3& operator+=(Vec3 b) noexcept { return *this = *this + b; }
  constexpr Vec3& operator-=(Vec3 b) noexcept { return *this = *this - b; }
};

[[nodiscard]] constexpr double dot(Vec3 a, Vec3 b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] constexpr Vec3 cross(Vec3 a, Vec3 b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double norm(Vec3 a) noexcept { return std::sqrt(dot(a, a)); }
/// `a` must not be the zero vector.
[[nodiscard]] inline Vec3 normalized(Vec3 a) noexcept { return a / norm(a); }
[[nodiscard]] inline bool is_finite(Vec3 a) noexcept {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Where a point lies along a direction that is square to nothing likely: an order by it hangs on places, not on
/// numbers or on coordinates that are equal but for rounding.
[[nodiscard]] constexpr double along_generic(Vec3 p) noexcept {
  return dot(p, {1, 0.7548776662466927, 0.5698402909980532});  // powers of 1 over the root of x^3 = x + 1
}

/// Axis-parallel closed box; empty until a point is added. Boxes that touch overlap.
struct Box {
  static constexpr double far = std::numeric_limits<double>::infinity();
  Vec3 min{far, far, far}, max{-far, -far, -far};

  constexpr void add(Vec3 p) noexcept { grow({p, p}); }
  constexpr void grow(const Box& b) noexcept {
    min = {b.min.x < min.x ? b.min.x : min.x, b.min.y < min.y ? b.min.y : min.y, b.min.z < min.z ? b.min.z : min.z};
    max = {max.x < b.max.x ? b.max.x : max.x, max.y < b.max.y ? b.max.y : max.y, max.z < b.max.z ? b.max.z : max.z};
  }
  /// By so much on each side.
  [[nodiscard]] constexpr Box grown(double by) const noexcept {
    return {min - Vec3{by, by, by}, max + Vec3{by, by, by}};
  }
  [[nodiscard]] constexpr Vec3 size() const noexcept { return max - min; }
  [[nodiscard]] constexpr bool overlaps(const Box& b) const noexcept {
    return min.x <= b.max.x && b.min.x <= max.x && min.y <= b.max.y && b.min.y <= max.y && min.z <= b.max.z &&
           b.min.z <= max.z;
  }
};
[[nodiscard]] constexpr Box box_of(const auto& points) noexcept {
  Box box;
  for (const Vec3& p : points) box.add(p);
  return box;
}

}  // namespace cleave::geometry
