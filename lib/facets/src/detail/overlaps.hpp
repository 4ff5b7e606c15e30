#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"

namespace cleave::topology::detail {

/// Polygons that lie on one another in one plane, but for `within` (sites), over others that do so too.
struct Overlapping {
  std::vector<std::size_t> polygons;  ///< ascending
  std::size_t axis;                   ///< the coordinate along which their plane is seen
};
/// What only touches along sides does not lie on one another. Nothing comes between polygons that lie exactly on one
/// plane of the lattice: those are left out, if no other lies on them. Polygons with holes are not looked at.
[[nodiscard]] std::vector<Overlapping> find_overlaps(std::span<const JointPolygon> polygons,
                                                     const SharedCorners& shared, double within);

/// The common parts of such a group: every polygon is the union of those it covers, and two parts meet in whole sides.
struct Overlay {
  struct Part {
    std::vector<exact::LatticePoint> corners;
    std::vector<std::size_t> of;  ///< which of the rings cover it, ascending
  };
  std::vector<Part> parts;
  std::vector<std::pair<exact::LatticePoint, exact::LatticePoint>> moved;  ///< corners that became one with others
};

/// Nothing where the rings cannot be laid into one plane.
[[nodiscard]] std::optional<Overlay> overlay(std::vector<std::vector<exact::LatticePoint>> rings, std::size_t axis,
                                             double within);

}  // namespace cleave::topology::detail
