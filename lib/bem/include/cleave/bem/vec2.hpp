#pragma once

#include <cmath>

/// Small values of the plane. x to the right, y up; metres, newtons per metre, pascals, as the user of them says.
namespace cleave::bem {

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
/// z component of the cross product: positive when b lies anticlockwise of a.
[[nodiscard]] constexpr double cross(Vec2 a, Vec2 b) noexcept { return a.x * b.y - a.y * b.x; }
[[nodiscard]] inline double norm(Vec2 a) noexcept { return std::sqrt(dot(a, a)); }
/// A quarter turn anticlockwise.
[[nodiscard]] constexpr Vec2 turned_left(Vec2 a) noexcept { return {-a.y, a.x}; }
/// A quarter turn clockwise: the outward normal of a boundary tangent (material on the left).
[[nodiscard]] constexpr Vec2 turned_right(Vec2 a) noexcept { return {a.y, -a.x}; }
[[nodiscard]] inline Vec2 rotated(Vec2 a, double radians) noexcept {
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  return {c * a.x - s * a.y, s * a.x + c * a.y};
}

/// A 2x2 matrix by rows.
struct Mat2 {
  double xx = 0, xy = 0, yx = 0, yy = 0;

  friend constexpr Mat2 operator+(Mat2 a, Mat2 b) noexcept {
    return {a.xx + b.xx, a.xy + b.xy, a.yx + b.yx, a.yy + b.yy};
  }
  friend constexpr Mat2 operator-(Mat2 a, Mat2 b) noexcept {
    return {a.xx - b.xx, a.xy - b.xy, a.yx - b.yx, a.yy - b.yy};
  }
  friend constexpr Mat2 operator*(double s, Mat2 a) noexcept { return {s * a.xx, s * a.xy, s * a.yx, s * a.yy}; }
  constexpr Mat2& operator+=(Mat2 b) noexcept { return *this = *this + b; }
  friend constexpr Vec2 operator*(Mat2 a, Vec2 v) noexcept {
    return {a.xx * v.x + a.xy * v.y, a.yx * v.x + a.yy * v.y};
  }
};

/// In-plane stress or strain, tension positive; the part out of the plane follows from the plane state.
struct Sym2 {
  double xx = 0, xy = 0, yy = 0;

  friend constexpr Sym2 operator+(Sym2 a, Sym2 b) noexcept { return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy}; }
  friend constexpr Sym2 operator-(Sym2 a, Sym2 b) noexcept { return {a.xx - b.xx, a.xy - b.xy, a.yy - b.yy}; }
  friend constexpr Sym2 operator*(double s, Sym2 a) noexcept { return {s * a.xx, s * a.xy, s * a.yy}; }
  constexpr Sym2& operator+=(Sym2 b) noexcept { return *this = *this + b; }
  /// Traction on the face of unit normal n.
  friend constexpr Vec2 operator*(Sym2 a, Vec2 n) noexcept {
    return {a.xx * n.x + a.xy * n.y, a.xy * n.x + a.yy * n.y};
  }
  friend constexpr bool operator==(Sym2, Sym2) noexcept = default;
};

}  // namespace cleave::bem
