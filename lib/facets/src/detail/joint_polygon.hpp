#pragma once

#include <vector>

#include "cleave/facets/prepared.hpp"
#include "detail/lattice_polygon.hpp"

namespace cleave::topology::detail {

/// A polygon of a joint on the lattice, on its way to becoming facets.
struct JointPolygon {
  Index joint;
  LatticePolygon polygon;
  std::vector<exact::LatticePoint> corners;  ///< all of them, as given
  std::vector<std::vector<exact::LatticePoint>> holes;
  bool at_border = false;  ///< may have corners on the sides of the domain
  bool folded = false;     ///< shares a side that its plane does not hold
  bool moved = false;      ///< corners of it became one with others, a rounding away
  double bend = 0;         ///< of folded ones: the farthest that a corner lies off the plane, sites
};

}  // namespace cleave::topology::detail
