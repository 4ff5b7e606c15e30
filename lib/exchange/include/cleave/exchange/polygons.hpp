#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cleave/exchange/triangulate.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report::detail {

/// A simple polygon without holes of a block's surface.
struct Polygon {
  std::vector<std::uint32_t> corners;  ///< points, counter-clockwise seen from outside
  geometry::Vec3 outward;              ///< of the face it comes from
  std::uint32_t face;                  ///< number of that face within the block
};

/// The surface of a block as simple polygons. `points` are the complex's vertices (indexed by VertexId, any origin).
/// With `triangles_only` every polygon is a triangle.
[[nodiscard]] std::vector<Polygon> surface_of(const topology::BlockComplex& complex, topology::BlockId block,
                                              std::span<const geometry::Vec3> points, bool triangles_only);

/// The triangles of one face of a block, as `surface_of` has them, appended to those that are there. `loops` is room to
/// work in, kept from face to face.
void append_triangles(const topology::BlockComplex& complex, const topology::Face& face,
                      std::span<const geometry::Vec3> points, FaceLoops& loops, std::vector<Triangle>& triangles);

/// Doubles points so that every edge is used once in each direction. `points` grows by the doubles.
void separate_pinches(std::vector<Polygon>& polygons, std::vector<geometry::Vec3>& points);

}  // namespace cleave::report::detail
