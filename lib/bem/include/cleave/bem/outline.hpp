#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/vec2.hpp"

namespace cleave::bem {

// Small values of the plane. x to the right, y up; metres, newtons per metre, pascals, as the user of them says.

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

/// One side of a loop: from `start` to the start of the next side (the last one closes the loop), straight or on the
/// arc of a circle through `through`.
struct Side {
  Vec2 start;  ///< m
  std::optional<Vec2> through = {};
  std::size_t condition = 0;                 ///< index into Region::conditions
  std::optional<std::size_t> elements = {};  ///< empty: from the element size of the problem
  /// 1: even lengths; larger: element ends at (k/n)^grade from that end, which makes elements near it shorter.
  double grade_start = 1;
  double grade_end = 1;
  friend bool operator==(const Side&, const Side&) = default;
};

/// A closed curve. The material lies on its left: the outer loop of a body runs counter-clockwise, holes clockwise.
using Loop = std::vector<Side>;

/// A full circle as two arcs; clockwise for a hole or an opening.
[[nodiscard]] Loop circle(Vec2 centre, double radius, bool clockwise, std::size_t condition = 0,
                          std::optional<std::size_t> elements = {});
/// A polygon with one condition on all sides.
[[nodiscard]] Loop polygon(const std::vector<Vec2>& corners, std::size_t condition = 0,
                           std::optional<std::size_t> elements = {});
[[nodiscard]] Loop reversed(const Loop& loop);

/// Loops and sides count from 0.
struct TooFewSides {
  std::size_t loop;
};
struct NotFinite {
  std::size_t loop, side;
};
struct SideWithoutLength {
  std::size_t loop, side;
};
struct SidesCross {
  std::size_t loop_a, side_a, loop_b, side_b;
  Vec2 at;
};
struct HoleOutside {
  std::size_t loop;
};
using OutlineError = std::variant<TooFewSides, NotFinite, SideWithoutLength, SidesCross, HoleOutside>;
[[nodiscard]] std::string describe(const OutlineError& error);

struct CheckedLoops {
  std::vector<Loop> loops;
  std::vector<std::size_t> turned;  ///< loops that ran the wrong way and were reversed
};

/// Checks that loops are simple, do not touch each other and nest; turns those that run the wrong way. The first loop
/// is the outer one unless `exterior` (then all loops are openings in an infinite region). O(n log n) is not needed at
/// the sizes of boundary elements: O(n^2) in the number of chords (an arc counts as 16).
[[nodiscard]] std::expected<CheckedLoops, OutlineError> check_loops(std::vector<Loop> loops, bool exterior);

/// Area (m2), centroid and second moment about the centroid (m4) enclosed by the loops, arcs exact to 1e-12.
struct AreaMoments {
  double area = 0;
  Vec2 centroid;
  double polar = 0;
};
[[nodiscard]] AreaMoments area_moments(const std::vector<Loop>& loops);

/// Point and derivative on a side at t in [0, 1].
struct SidePoint {
  Vec2 x;
  Vec2 derivative;
};
[[nodiscard]] SidePoint point_on(const Loop& loop, std::size_t side, double t);
[[nodiscard]] double length_of(const Loop& loop, std::size_t side);
/// Signed angle swept by an arc, 0 for a straight side.
[[nodiscard]] double sweep_of(const Loop& loop, std::size_t side);
/// Whether the point lies inside (winding number of the chords and arcs together).
[[nodiscard]] bool inside(const std::vector<Loop>& loops, Vec2 point);

}  // namespace cleave::bem
