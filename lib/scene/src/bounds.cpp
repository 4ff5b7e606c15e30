#include "bounds.hpp"

#include <cmath>

namespace cleave::scene {

Box box_of(std::span<const geometry::Vec3> points) noexcept {
  Box box{points.front(), points.front()};
  for (const geometry::Vec3 p : points) {
    box.min = {std::fmin(box.min.x, p.x), std::fmin(box.min.y, p.y), std::fmin(box.min.z, p.z)};
    box.max = {std::fmax(box.max.x, p.x), std::fmax(box.max.y, p.y), std::fmax(box.max.z, p.z)};
  }
  return box;
}
Box box_of(const geometry::Solid& solid) noexcept { return box_of(solid.vertices()); }

bool apart(const Box& a, const Box& b) noexcept {
  return a.max.x < b.min.x || b.max.x < a.min.x || a.max.y < b.min.y || b.max.y < a.min.y || a.max.z < b.min.z ||
         b.max.z < a.min.z;
}

}  // namespace cleave::scene
