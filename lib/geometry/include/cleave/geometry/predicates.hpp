#pragma once

#include <cmath>
#include <span>

#include "cleave/core/vec2.hpp"
#include "cleave/exact/integer.hpp"
#include "cleave/geometry/vec3.hpp"

/// Exact orientation signs of points given as doubles, for the checks of polygons and meshes at the border and for
/// drawings (the cutter itself works on lattice points and has its own). A filter in double decides nearly all;
/// expansions (Priest 1991, Shewchuk 1997) decide the rest. Exact for coordinates that `flushed` returns: at most 1e12
/// m, and 0 or at least 1e-60 m, so that no product over- or underflows.
namespace cleave::geometry {

/// Largest coordinate (m) that polygons and solids accept.
inline constexpr double largest_coordinate = 1e12;

[[nodiscard]] inline bool in_range(Vec3 p) noexcept {
  return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
         std::abs(p.z) <= largest_coordinate;
}

[[nodiscard]] inline double flushed(double x) noexcept { return std::abs(x) < 1e-60 ? 0.0 : x; }
[[nodiscard]] inline Vec3 flushed(Vec3 p) noexcept { return {flushed(p.x), flushed(p.y), flushed(p.z)}; }

/// The two coordinates that remain, in cyclic order, when axis 0, 1 or 2 is dropped.
[[nodiscard]] constexpr Vec2 drop(Vec3 p, int axis) noexcept {
  return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
}

/// Axis (0, 1, 2) of the largest component by magnitude; the first one of equals.
[[nodiscard]] int dominant_axis(Vec3 direction) noexcept;

/// Positive when a, b, c turn counter-clockwise.
[[nodiscard]] exact::Sign orient2d(Vec2 a, Vec2 b, Vec2 c) noexcept;

/// Positive when d is on the side of the plane a, b, c to which its right-hand normal (b - a) x (c - a) points.
[[nodiscard]] exact::Sign orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) noexcept;

/// True when the three points are exactly on one line (or in one point).
[[nodiscard]] bool collinear(Vec3 a, Vec3 b, Vec3 c) noexcept;

/// True when the closed segments have a point in common.
[[nodiscard]] bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) noexcept;

/// True when the closed segment p q and the closed triangle a b c (not collinear) have a point in common.
[[nodiscard]] bool segment_meets_triangle(Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) noexcept;

/// True when p is inside the triangle or on its border; the triangle turns counter-clockwise.
[[nodiscard]] bool in_closed_triangle(Vec2 p, Vec2 a, Vec2 b, Vec2 c) noexcept;

/// Whether an outline goes round p (even-odd rule), exactly; of points on the outline some count and some do not.
[[nodiscard]] bool encloses(std::span<const Vec2> outline, Vec2 p) noexcept;

}  // namespace cleave::geometry
