#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "cleave/core/vec2.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {

/// A plane with axes: a point x lies at (right . (x - origin), up . (x - origin)). Unit vectors at right angles.
struct SectionPlane {
  geometry::Vec3 origin;
  geometry::Vec3 right, up;
};

using SectionPoint = Vec2;  ///< m

/// What lies behind a side of a polygon.
struct SectionSide {
  Role role = Role::joint;
  std::optional<JointId> joint;
  bool cut = false;  ///< through rock: a block with a hole in the section was parted there
};

/// A part of a block in the plane: simple, counter-clockwise; side k runs from corner k to the next.
struct SectionPolygon {
  BlockId block;
  std::vector<SectionPoint> corners;
  std::vector<SectionSide> sides;
};

struct Section {
  std::vector<SectionPolygon> polygons;  ///< by block
  double area = 0;                       ///< m2, of all polygons before any was left out
  std::size_t parted = 0;                ///< blocks with holes that were cut into polygons without
  std::size_t left_out = 0;              ///< polygons thinner than 1e-7 of the section, and ones that are not simple
  double left_out_area = 0;              ///< m2
};

/// Where the plane cuts the blocks. A vertex is on one side of the plane for all faces it belongs to (on the plane
/// counts as above), so neighbours share their corners and nothing is missing or double; corners are exact to rounding.
[[nodiscard]] Section section(const BlockComplex& complex, const SectionPlane& plane);

}  // namespace cleave::topology
