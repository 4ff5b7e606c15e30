#pragma once

#include <vector>

#include "cleave/bem/problem.hpp"

namespace cleave::bem {

struct DomainPoint {
  Vec2 x;
  double w;  ///< area
};

/// Quadrature over the inside of a mesh of any shape, holes and curved elements included: horizontal slabs between
/// corners (and the highest and lowest points of curved elements), in each slab strips between the sides it crosses,
/// n x n Gauss points a strip, or in as many parts of it as points no further apart than `spacing` need (0: one).
[[nodiscard]] std::vector<DomainPoint> domain_rule(const Mesh& mesh, std::size_t n, double spacing = 0);

/// Area, centroid and second moment of what the elements enclose (curved ones are quadratic, not arcs).
[[nodiscard]] AreaMoments area_moments(const Mesh& mesh);

}  // namespace cleave::bem
