#include "hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace cleave::motion {

std::vector<std::uint32_t> hull_of(const std::vector<Flat>& points, double tolerance) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t k) { return points[k].x; });
  // Columns of points whose x differ by rounding are sorted by y: a chain that went up and down in one would take its
  // ends for points on a line.
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first + 1;
    while (last < order.size() && points[order[last]].x - points[order[last - 1]].x <= tolerance) ++last;
    const auto at = [&](std::size_t k) { return order.begin() + static_cast<std::ptrdiff_t>(k); };
    std::stable_sort(at(first), at(last), [&](std::uint32_t a, std::uint32_t b) { return points[a].y < points[b].y; });
    first = last;
  }
  const auto far = [&](std::uint32_t a, std::uint32_t b) {
    return std::hypot(points[b].x - points[a].x, points[b].y - points[a].y);
  };
  const auto outside = [&](std::uint32_t a, std::uint32_t b, std::uint32_t p) {
    const Flat &o = points[a], &u = points[b], &v = points[p];
    return (u.x - o.x) * (v.y - o.y) - (u.y - o.y) * (v.x - o.x) > tolerance * far(a, p);
  };
  std::vector<std::uint32_t> hull;
  const auto half = [&](std::size_t least) {
    for (const std::uint32_t p : order) {
      while (hull.size() > least + 1 && !outside(hull[hull.size() - 2], hull.back(), p)) hull.pop_back();
      if (hull.empty() || far(hull.back(), p) > tolerance) hull.push_back(p);
    }
  };
  half(0);
  const std::size_t lower = hull.empty() ? 0 : hull.size() - 1;
  std::ranges::reverse(order);
  half(lower);
  if (hull.size() > 1 && far(hull.back(), hull[0]) <= tolerance) hull.pop_back();
  return hull;
}

}  // namespace cleave::motion
