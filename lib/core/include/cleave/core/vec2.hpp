#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace cleave {

/// A point or vector of a plane: x to the right, y up. Metres, newtons per metre, pascals, or no unit at all, as its
/// user says.
struct Vec2 {
  double x = 0;
  double y = 0;

  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator-(Vec2 a) noexcept { return {-a.x, -a.y}; }
  friend constexpr Vec2 operator*(double s, Vec2 a) noexcept { return {s * a.x, s * a.y}; }
  friend constexpr Vec2 operator*(Vec2 a, double s) noexcept { return {s * a.x, s * a.y}; }
  friend constexpr Vec2 operator/(Vec2 a, double s) noexcept { return {a.x / s, a.y / s}; }
  constexpr Vec2& operator+=(Vec2 b) noexcept {
    x += b.x;
    y += b.y;
    return *this;
  }
  constexpr Vec2& operator-=(Vec2 b) noexcept {
    x -= b.x;
    y -= b.y;
    return *this;
  }
  friend constexpr bool operator==(Vec2, Vec2) noexcept = default;
};

[[nodiscard]] constexpr double dot(Vec2 a, Vec2 b) noexcept { return a.x * b.x + a.y * b.y; }
/// z component of the cross product: positive when b lies counter-clockwise of a.
[[nodiscard]] constexpr double cross(Vec2 a, Vec2 b) noexcept { return a.x * b.y - a.y * b.x; }
[[nodiscard]] inline double norm(Vec2 a) noexcept { return std::sqrt(dot(a, a)); }
/// A quarter turn counter-clockwise.
[[nodiscard]] constexpr Vec2 turned_left(Vec2 a) noexcept { return {-a.y, a.x}; }
/// A quarter turn clockwise: the outward normal of a boundary tangent (material on the left).
[[nodiscard]] constexpr Vec2 turned_right(Vec2 a) noexcept { return {a.y, -a.x}; }
[[nodiscard]] inline Vec2 rotated(Vec2 a, double radians) noexcept {
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  return {c * a.x - s * a.y, s * a.x + c * a.y};
}

/// Axis-parallel closed box of a plane; empty until a point is added.
struct Box2 {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};

  constexpr void add(Vec2 p) noexcept {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
};
[[nodiscard]] constexpr Box2 box_of(std::span<const Vec2> points) noexcept {
  Box2 box;
  for (const Vec2 p : points) box.add(p);
  return box;
}

}  // namespace cleave
