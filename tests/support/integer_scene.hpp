#pragma once

/// Small scenes with integer coordinates: what the oracle, the comparison tests and the fuzz target share.
///
/// Knows nothing of the library: the oracle reads these scenes too and must not depend on what it checks.

#include <compare>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cleave::testing {

struct IntegerPoint {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const IntegerPoint&, const IntegerPoint&) = default;
  friend IntegerPoint operator+(IntegerPoint a, IntegerPoint b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend IntegerPoint operator-(IntegerPoint a, IntegerPoint b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend IntegerPoint operator*(std::int32_t s, IntegerPoint a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// Corners of a simple polygon in order, exactly on one plane; convex or not.
using IntegerPolygon = std::vector<IntegerPoint>;

/// Closed polyhedron; faces counter-clockwise seen from outside, exactly planar.
struct IntegerSolid {
  std::vector<IntegerPoint> vertices;
  std::vector<std::vector<std::uint32_t>> faces;
};
[[nodiscard]] IntegerSolid integer_box(IntegerPoint min, IntegerPoint max);

struct IntegerScene {
  IntegerPoint min, max;  ///< the domain's box
  std::vector<IntegerPolygon> joints;
  std::vector<IntegerSolid> excavations;
  std::optional<IntegerSolid> domain;  ///< instead of the box (which must contain it)
};

/// Axis-parallel rectangle: `axis` is the constant coordinate; lo and hi are those of the other two axes in order.
[[nodiscard]] IntegerPolygon rectangle(int axis, int at, int lo0, int lo1, int hi0, int hi1);
/// Parallelogram that covers every point of the plane a x + b y + c z = d within `reach` of the point of the plane it
/// is given: exactly planar, integer corners.
[[nodiscard]] IntegerPolygon covering_plane(IntegerPoint through, IntegerPoint normal, int reach);

/// The six sides of a box as joints.
void add_closed_box(IntegerScene& scene, IntegerPoint lo, IntegerPoint hi);

/// Is it what the cutter accepts: >= 3 corners, planar, area > 0, simple (no two edges touch but neighbours at their
/// corner).
[[nodiscard]] bool is_valid_polygon(const IntegerPolygon& polygon);

/// Uniform integer in [lo, hi]; the source of choices of the generator.
using Choose = std::function<std::int32_t(std::int32_t lo, std::int32_t hi)>;

struct SceneLimits {
  int max_joints = 10;
  int max_excavations = 1;
};
/// A scene that is degenerate on purpose: repeated, parallel, coplanar, touching, concave joints, closed boxes. Corners
/// in [-8, 8]. Every polygon passes is_valid_polygon. Same choices, same scene.
[[nodiscard]] IntegerScene make_integer_scene(const Choose& choose, const SceneLimits& limits = {});
/// The same from bytes (a fuzzer's): each choice takes one byte; when they run out, the lowest value.
[[nodiscard]] IntegerScene integer_scene_from_bytes(std::span<const std::uint8_t> bytes,
                                                    const SceneLimits& limits = {});

// ---- relations that keep the block system (up to the map) ----
[[nodiscard]] IntegerScene translated(IntegerScene scene, IntegerPoint by);
/// x -> y -> z -> x, an even permutation: faces of solids stay outwards.
[[nodiscard]] IntegerScene axes_rotated(IntegerScene scene);
/// x <-> y, a mirror: the loops of solids are turned round.
[[nodiscard]] IntegerScene axes_swapped(IntegerScene scene);

/// A readable dump for failure messages.
[[nodiscard]] std::string describe(const IntegerScene& scene);

}  // namespace cleave::testing
