#pragma once

#include "cleave/core/vec2.hpp"

/// Small values of the plane. x to the right, y up; metres, newtons per metre, pascals, as the user of them says.
namespace cleave::bem {

using cleave::Vec2;

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
