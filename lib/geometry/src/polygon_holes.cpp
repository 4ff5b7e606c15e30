#include "cleave/geometry/polygon_holes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cleave/geometry/predicates.hpp"

namespace cleave::geometry {
namespace {

using Ring = std::vector<Vec2>;

Vec3 area_of(std::span<const Vec3> corners) {
  Vec3 sum{};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return sum;
}

Ring ring_of(const Polygon& polygon, int axis) {
  Ring ring;
  for (const Vec3& c : polygon.corners()) ring.push_back(drop(flushed(c), axis));
  return ring;
}

bool rings_meet(const Ring& a, const Ring& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (segments_meet(a[i], a[(i + 1) % a.size()], b[k], b[(k + 1) % b.size()])) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<HoleFault> check_holes(const Polygon& polygon, std::span<const Polygon> holes) {
  const auto corners = polygon.corners();
  const Vec3 normal = normalized(area_of(corners));
  const int axis = dominant_axis(normal);
  double size = 0, largest = 0;
  for (const Vec3& c : corners) {
    size = std::max(size, norm(c - corners[0]));
    largest = std::max({largest, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  }
  const double allowed = std::max(2e-6 * size, 16 * 0x1p-52 * largest);
  const Ring outline = ring_of(polygon, axis);
  std::vector<Ring> rings;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    double furthest = 0;
    for (const Vec3& c : holes[h].corners()) furthest = std::max(furthest, std::abs(dot(normal, c - corners[0])));
    if (furthest > allowed) return HoleFault{h, HoleFault::Kind::off_plane, metres(furthest)};
    rings.push_back(ring_of(holes[h], axis));
    if (rings_meet(outline, rings[h]) || !encloses(outline, rings[h][0])) return HoleFault{h, HoleFault::Kind::outside};
    for (std::size_t g = 0; g < h; ++g) {
      if (rings_meet(rings[g], rings[h]) || encloses(rings[g], rings[h][0]) || encloses(rings[h], rings[g][0])) {
        return HoleFault{h, HoleFault::Kind::overlaps};
      }
    }
  }
  return std::nullopt;
}

std::string describe(const HoleFault& fault) {
  switch (fault.kind) {
    case HoleFault::Kind::off_plane:
      return fmt::format("hole {} lies up to {:.3g} m off the polygon's plane; move its corners into the plane",
                         fault.hole + 1, fault.distance.si());
    case HoleFault::Kind::outside:
      return fmt::format("hole {} does not lie wholly inside the polygon; a hole may not touch its outline",
                         fault.hole + 1);
    case HoleFault::Kind::overlaps:
      return fmt::format("hole {} meets another hole; join them to one outline", fault.hole + 1);
  }
  std::unreachable();
}

}  // namespace cleave::geometry
