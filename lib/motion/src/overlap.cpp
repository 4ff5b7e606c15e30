#include "overlap.hpp"

#include <algorithm>
#include <limits>

namespace cleave::motion {
namespace {

bool beyond_a_side(const Placed& of, const Placed& other, double enough) {
  for (std::size_t s = 0; s < of.normals.size(); ++s) {
    const Vec3 n = of.normals[s], foot = of.vertices[of.cell->sides[s].corners[0]];
    if (std::ranges::all_of(other.vertices, [&](Vec3 p) { return dot(n, p - foot) >= -enough; })) return true;
  }
  return false;
}

}  // namespace

double overlap_depth(const Placed& a, const Placed& b, double enough) {
  if (beyond_a_side(a, b, enough) || beyond_a_side(b, a, enough)) return 0;
  // About a corner of the first: lengths, not places, are rounded.
  const Vec3 origin = a.vertices[0];
  Piece common;
  for (std::size_t s = 0; s < a.normals.size(); ++s) {
    Piece::Polygon polygon{{}, a.normals[s], 0};
    for (const std::uint32_t v : a.cell->sides[s].corners) polygon.corners.push_back(a.vertices[v] - origin);
    common.polygons.push_back(std::move(polygon));
  }
  for (std::size_t s = 0; s < b.normals.size() && !common.polygons.empty(); ++s) {
    const Vec3 foot = b.vertices[b.cell->sides[s].corners[0]] - origin;
    common = clip(common, b.normals[s], dot(b.normals[s], foot), 1e-13 * a.size, 0);
  }
  if (common.polygons.empty()) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (const Placed* of : {&a, &b}) {
    for (const Vec3 n : of->normals) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const auto& polygon : common.polygons) {
        for (const Vec3 p : polygon.corners) {
          low = std::min(low, dot(n, p));
          high = std::max(high, dot(n, p));
        }
      }
      least = std::min(least, high - low);
    }
  }
  return std::max(least, 0.0);
}

}  // namespace cleave::motion
