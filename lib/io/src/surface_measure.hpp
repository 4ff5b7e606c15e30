#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::io {

/// Of a surface of polygons, each as a fan about its first corner.
struct SurfaceMeasure {
  double volume = 0;  ///< m3, that it encloses with its faces outwards
  double area = 0;    ///< m2
  double reach = 0;   ///< m, largest coordinate of a corner
  /// What corners that are rounded by this part of the reach may add to the volume.
  [[nodiscard]] double noise(double rounding) const { return rounding * reach * area; }
};
/// `face(f)`: the numbers of its corners, at least three; one face or more.
template <class FaceAt>
[[nodiscard]] SurfaceMeasure measure_surface(std::size_t faces, FaceAt face,
                                             const std::vector<geometry::Vec3>& points) {
  const geometry::Vec3 origin = points[face(0)[0]];
  SurfaceMeasure sum;
  for (std::size_t f = 0; f < faces; ++f) {
    const auto& corners = face(f);
    const auto at = [&](std::size_t i) { return points[corners[i]] - origin; };
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      sum.volume += dot(at(0), cross(at(i), at(i + 1))) / 6;
      sum.area += norm(cross(at(i) - at(0), at(i + 1) - at(0))) / 2;
    }
    for (const auto corner : corners) {
      const geometry::Vec3 p = points[corner];
      sum.reach = std::max({sum.reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  return sum;
}

}  // namespace cleave::io
