#include "detail/extents.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::topology::detail {

using geometry::Vec3;

bool far_apart(const Bounds& polygon, const Bounds& region, double slack) {
  double size = 0, farthest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    size += polygon.hi[k] - polygon.lo[k];
    farthest = std::max({farthest, std::abs(polygon.lo[k]), std::abs(polygon.hi[k])});
  }
  const double margin = 1e-5 * size + 1e-13 * farthest + slack;
  for (std::size_t k = 0; k < 3; ++k) {
    if (polygon.lo[k] - margin > region.hi[k] || polygon.hi[k] + margin < region.lo[k]) return true;
  }
  return false;
}

bool beside(std::span<const Vec3> corners, const Bounds& region, double pitch) {
  const Vec3 o = corners[0];
  Vec3 n{};
  double size = 0;
  for (std::size_t i = 2; i < corners.size(); ++i) n += cross(corners[i - 1] - o, corners[i] - o);
  for (const Vec3& c : corners) size = std::max({size, std::abs(c.x - o.x), std::abs(c.y - o.y), std::abs(c.z - o.z)});
  const Vec3 lo{region.lo[0], region.lo[1], region.lo[2]}, hi{region.hi[0], region.hi[1], region.hi[2]};
  const Vec3 half = 0.5 * (hi - lo);
  const double length = norm(n), distance = std::abs(dot(n, lo + half - o));
  const double across = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
  const double farthest = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)});
  return length > 0 && distance > across + (1e-4 * size + 1e-12 * farthest + 64 * pitch) * length;
}

}  // namespace cleave::topology::detail
