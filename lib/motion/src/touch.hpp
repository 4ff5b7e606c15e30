#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cells.hpp"
#include "cleave/geometry/box_tree.hpp"

/// Where convex cells touch, or would soon.
namespace cleave::motion {

/// A cell where it is now.
struct Placed {
  const Cell* cell = nullptr;
  std::uint32_t body = 0, number = 0;  ///< of the body; of the cell among all cells
  std::vector<Vec3> vertices = {}, normals = {};
  geometry::Box box = {};
  double size = 0;
};
void place(Placed& placed, Vec3 centroid, Turn turn);

/// A contact point of two cells. Normal out of `other` into `body`.
struct Touch {
  std::uint32_t body = 0, other = 0, cell = 0, other_cell = 0;  ///< cells among all cells
  Vec3 point = {}, normal = {};
  double gap = 0;
  std::uint32_t surface = 0, other_surface = 0;
  double size = 0;    ///< of the smaller cell
  Vec3 impulse = {};  ///< of the last step, scene axes
};

/// Features that decide how far two cells are apart: a side of one, or an edge of each.
struct Axis {
  enum class Kind : std::uint8_t { side_of_first, side_of_second, edges };
  Kind kind = Kind::side_of_first;
  std::uint32_t first = 0, second = 0;  ///< side, or edges
  Vec3 normal;                          ///< out of the second cell into the first
  double gap = 0;
};
/// The axis with the largest gap; of nearly equal ones a side. None where a border to another cell of the same body
/// parts the two: they cannot touch there.
[[nodiscard]] std::optional<Axis> widest_axis(const Placed& first, const Placed& second);

/// Points along an axis with a gap of at most `reach`. `strict`: only where features overlap, not merely touch at
/// their rims: what is at a rim may pass by.
void touches_along(const Placed& first, const Placed& second, const Axis& axis, double reach, bool strict,
                   std::vector<Touch>& out);

}  // namespace cleave::motion
