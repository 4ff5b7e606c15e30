#include "window_outline.hpp"

#include <algorithm>
#include <variant>
#include <vector>

namespace cleave::scene {
namespace {

using survey::MapPoint;

struct Side {
  MapPoint from, to;
  std::size_t number;
  [[nodiscard]] double left() const { return std::min(from.x, to.x); }
  [[nodiscard]] double right() const { return std::max(from.x, to.x); }
};

double turn(MapPoint a, MapPoint b, MapPoint c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Each with its ends on both sides of the other: sides that meet at a corner do not cross.
bool cross(const Side& one, const Side& other) {
  const double a = turn(one.from, one.to, other.from), b = turn(one.from, one.to, other.to);
  const double c = turn(other.from, other.to, one.from), d = turn(other.from, other.to, one.to);
  return ((a > 0 && b < 0) || (a < 0 && b > 0)) && ((c > 0 && d < 0) || (c < 0 && d > 0));
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> sides_that_cross(const survey::Window& window) {
  const auto* polygon = std::get_if<survey::PolygonWindow>(&window);
  if (polygon == nullptr) return std::nullopt;
  std::vector<Side> sides;
  const std::size_t n = polygon->corners.size();
  for (std::size_t i = 0; i < n; ++i) sides.push_back({polygon->corners[i], polygon->corners[(i + 1) % n], i});
  std::ranges::sort(sides, {}, &Side::left);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n && sides[j].left() <= sides[i].right(); ++j) {
      if (cross(sides[i], sides[j])) return std::minmax({sides[i].number, sides[j].number});
    }
  }
  return std::nullopt;
}

}  // namespace cleave::scene
