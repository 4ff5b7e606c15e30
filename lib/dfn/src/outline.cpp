#include "outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::dfn {

using geometry::Polygon;
using geometry::Vec3;

namespace detail {

std::vector<FlatPoint> unit_corners(std::uint32_t sides) {
  if (sides == 0) return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  std::vector<FlatPoint> corners;
  corners.reserve(sides);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    corners.push_back({std::cos(angle), std::sin(angle)});
  }
  return corners;
}

std::vector<Vec3> corners_of(const JointOutline& outline, Vec3 centre, std::span<const FlatPoint> unit) {
  std::vector<Vec3> corners;
  corners.reserve(unit.size());
  for (const FlatPoint& p : unit) {
    corners.push_back(centre + outline.first * p.x * outline.along + outline.second * p.y * outline.across);
  }
  return corners;
}

JointOutline outline_of(const Frame& frame, double rotation, const HalfAxes& half, std::uint32_t sides) noexcept {
  const Vec3 up_dip = cross(frame.normal, frame.strike);
  const double c = std::cos(rotation), s = std::sin(rotation);
  return {c * frame.strike + s * up_dip, c * up_dip - s * frame.strike, half.first, half.second, sides};
}

bool surely_valid(const JointOutline& outline, Vec3 centre) noexcept {
  const double far =
      std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}) + std::max(outline.first, outline.second);
  return far < 1e11 && std::min(outline.first, outline.second) > 1e-9 * std::max(outline.sides, 4U) * far;
}

Vec3 half_extents(const JointOutline& outline) noexcept {
  const Vec3 u = outline.first * outline.along, v = outline.second * outline.across;
  if (outline.sides == 0)
    return {std::abs(u.x) + std::abs(v.x), std::abs(u.y) + std::abs(v.y), std::abs(u.z) + std::abs(v.z)};
  return {std::sqrt(u.x * u.x + v.x * v.x), std::sqrt(u.y * u.y + v.y * v.y), std::sqrt(u.z * u.z + v.z * v.z)};
}

}  // namespace detail

std::vector<SampledJoint> with_polygons(std::vector<SampledJoint> joints) {
  std::vector<detail::FlatPoint> unit;
  std::uint32_t sides = 0;
  for (SampledJoint& joint : joints) {
    const auto* outline = std::get_if<JointOutline>(&joint.shape);
    if (outline == nullptr) continue;
    if (unit.empty() || sides != outline->sides) {
      sides = outline->sides;
      unit = detail::unit_corners(sides);
    }
    auto polygon = Polygon::make(detail::corners_of(*outline, joint.centre, unit));
    CLEAVE_ASSERT(polygon.has_value());
    joint.shape = *std::move(polygon);
  }
  return joints;
}

}  // namespace cleave::dfn
