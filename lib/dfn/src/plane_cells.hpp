#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/core/vec2.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/geometry/vec3.hpp"

/// Convex polygons that lines cut out of a plane: the tessellations of the Veneziano, Dershowitz, hierarchical and MIT
/// models.
namespace cleave::dfn::detail {

/// The points with cos * x + sin * y = offset.
struct Line2 {
  double cos, sin, offset;
};

/// A convex cell, counter-clockwise. Edge i joins corners i and i + 1; `line[i]` is the number of the line it lies on,
/// `border` on the outline.
struct Cell {
  static constexpr std::size_t border = static_cast<std::size_t>(-1);
  std::vector<Vec2> corners;
  std::vector<std::size_t> line;
};

[[nodiscard]] double area(const Cell& cell) noexcept;
[[nodiscard]] Vec2 centroid(const Cell& cell) noexcept;
/// Smallest and largest width over all directions.
struct Calipers {
  double smallest, largest;
};
[[nodiscard]] Calipers calipers(const Cell& cell) noexcept;
[[nodiscard]] double smallest_angle(const Cell& cell) noexcept;  ///< radians, between neighbouring edges

/// All cells that the lines cut the outline into.
[[nodiscard]] std::vector<Cell> cut_by_lines(Cell outline, const std::vector<Line2>& lines);
/// Lines of an isotropic Poisson process with `density` (line length per area) that meet the disc about the origin.
[[nodiscard]] std::vector<Line2> poisson_lines(double density, double radius, Rng& rng);
/// The whole cells of the lines that reach a convex region, and few others beside it; they end `border` beyond the disc
/// of `radius` that the lines meet. Their edges are not numbered by lines.
[[nodiscard]] std::vector<Cell> cells_reaching(const Cell& region, double radius, const std::vector<Line2>& lines);
/// The part of a cell within a convex region; fewer than three corners: none.
[[nodiscard]] Cell common_part(Cell cell, const Cell& region);
/// The cell of the origin among isotropic Poisson lines of density 1: cells weighted by their area.
[[nodiscard]] Cell cell_at_origin(Rng& rng);

/// A plane whose points with whole coordinates lie exactly in one plane of doubles, so that joints drawn on it are
/// coplanar to the last bit whatever lattice the cutter takes: its axes are vectors of 22-bit numbers times a power of
/// two. Its normal is the wanted one to about 1e-7.
class GridPlane final {
 public:
  /// `reach`: largest distance of a joint's corner from `through`.
  GridPlane(geometry::Vec3 through, geometry::Vec3 strike, geometry::Vec3 normal, double reach);
  [[nodiscard]] geometry::Vec3 at(Vec2 p) const noexcept;  ///< of the nearest grid point
  [[nodiscard]] Vec2 flat(geometry::Vec3 p) const noexcept;
  [[nodiscard]] geometry::Vec3 normal() const noexcept { return normal_; }
  [[nodiscard]] double step() const noexcept { return step_; }
  /// The trace of another plane; none when (almost) parallel.
  [[nodiscard]] std::optional<Line2> trace(geometry::Vec3 through, geometry::Vec3 normal) const noexcept;

 private:
  geometry::Vec3 origin_, a_, b_;  // a_, b_: one grid step
  geometry::Vec3 along_, across_, normal_;
  double step_;
};

/// The part of the plane within the box, about the plane's origin; fewer than three corners: none.
[[nodiscard]] Cell section(const GridPlane& plane, const DomainBox& box);

/// The cell as a joint on its plane, every edge moved outwards by `overshoot` grid steps: what ends on another joint
/// then surely reaches it (the cutter takes the strip behind away again), and neighbours on one plane merge. Empty for
/// cells thinner than some steps.
[[nodiscard]] std::optional<geometry::Polygon> joint_of(const GridPlane& plane, const Cell& cell);

}  // namespace cleave::dfn::detail
