#include "detail/domain_touch.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Sign;

DomainTouch::DomainTouch(const Prepared& prepared, std::span<const HalfSpace> sides, double farthest)
    : prepared_{prepared}, pitch_{prepared.lattice.pitch()} {
  constexpr double roundings = 16;  // of a rotation and a shift, and as many sites
  reach_ = roundings * (1 + farthest * 0x1p-52 / pitch_);
  for (const HalfSpace& side : sides) {
    const auto& q = prepared.planes[side.plane].approx();
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) * (side.inside_positive ? 1 : -1);
    sides_.push_back({side, {q[0] / length, q[1] / length, q[2] / length}, std::ldexp(q[3] / length, 48)});
  }
}

bool DomainTouch::on(const DomainSide& side, LatticePoint p) const {
  return prepared_.planes[side.inside.plane].side_of(p) == Sign::zero;
}

LatticePoint DomainTouch::beyond(LatticePoint corner) const {
  constexpr double margin = 8;  // sites
  std::vector<const DomainSide*> near;
  for (const DomainSide& side : sides_) {
    if (std::abs(height(side, corner)) <= reach_ && !on(side, corner)) near.push_back(&side);
  }
  for (int round = 0; round < 8 && !near.empty(); ++round) {
    for (const DomainSide* side : near) {
      const double h = height(*side, corner) + margin;
      if (h <= 0) continue;
      const auto moved = [&](std::int64_t x, double n) { return x - static_cast<std::int64_t>(std::llround(n * h)); };
      corner = {moved(corner.x, side->normal[0]), moved(corner.y, side->normal[1]), moved(corner.z, side->normal[2])};
    }
  }
  return corner;
}

std::vector<std::optional<HalfSpace>> DomainTouch::ends(const LatticePolygon& polygon) const {
  std::vector<std::optional<HalfSpace>> found;
  const auto n = polygon.plane.unit_normal();
  for (const DomainSide& side : sides_) {
    const auto near = [&](LatticePoint p) { return std::abs(height(side, p)) <= reach_; };
    const std::size_t count = polygon.corners.size();
    for (std::size_t i = 0; i < count; ++i) {
      const LatticePoint a = polygon.corners[i], b = polygon.corners[(i + 1) % count];
      if (!near(a) || !near(b)) continue;
      if (polygon.exactly_planar && on(side, a) && on(side, b)) continue;
      // A polygon that lies along the side does not end on it.
      const double across = n[0] * side.normal[0] + n[1] * side.normal[1] + n[2] * side.normal[2];
      if (std::abs(across) > 1 - 1e-6) continue;
      found.resize(count);
      found[i] = side.inside;
    }
  }
  return found;
}

}  // namespace cleave::topology::detail
