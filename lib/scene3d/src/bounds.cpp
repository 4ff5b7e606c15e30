#include "cleave/scene3d/bounds.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/geometry/triangulate.hpp"

namespace cleave::scene {

Box box_of(const geometry::Solid& solid) noexcept { return geometry::box_of(solid.vertices()); }

geometry::Vec3 upward(geometry::Vec3 n) noexcept {
  const bool down = n.z < 0 || (n.z == 0 && (n.y < 0 || (n.y == 0 && n.x < 0)));
  return down ? -n : n;
}

geometry::Vec3 area_vector(const geometry::Polygon& polygon) { return geometry::area_vector(polygon.corners()); }

namespace {

/// The part of a loop of corners within a half space. Loops that fold are taken piece by piece with their sign, so the
/// area stays right.
std::vector<geometry::Vec3> clipped(std::span<const geometry::Vec3> corners, double geometry::Vec3::* axis, double at,
                                    double sign) {
  std::vector<geometry::Vec3> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const geometry::Vec3 p = corners[i], q = corners[(i + 1) % corners.size()];
    const double a = sign * (p.*axis - at), b = sign * (q.*axis - at);
    if (a >= 0) kept.push_back(p);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.push_back(p + (a / (a - b)) * (q - p));
  }
  return kept;
}

}  // namespace

geometry::Vec3 area_within(std::vector<geometry::Vec3> corners, const Box& box) {
  using geometry::Vec3;
  for (double Vec3::* const axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    corners = clipped(corners, axis, box.min.*axis, 1);
    corners = clipped(corners, axis, box.max.*axis, -1);
  }
  Vec3 twice{0, 0, 0};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    twice += geometry::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return twice / 2;
}

namespace {

/// The plane of a face of `a` has all of `a` behind it and all of `b` before it, up to rounding.
bool face_parts(const geometry::Solid& a, const geometry::Solid& b) noexcept {
  const Box box = box_of(a);
  const double rounding = 1e-9 * geometry::norm(box.max - box.min);
  const auto corner = [&](const geometry::SolidFace& face, std::size_t k) { return a.vertices()[face.corners[k]]; };
  return std::ranges::any_of(a.faces(), [&](const geometry::SolidFace& face) {
    geometry::Vec3 normal{0, 0, 0};
    for (std::size_t k = 1; k + 1 < face.corners.size(); ++k) {
      normal += geometry::cross(corner(face, k) - corner(face, 0), corner(face, k + 1) - corner(face, 0));
    }
    if (!(geometry::norm(normal) > 0)) return false;
    normal = geometry::normalized(normal);
    const auto height = [&](geometry::Vec3 v) { return geometry::dot(normal, v - corner(face, 0)); };
    return std::ranges::all_of(a.vertices(), [&](geometry::Vec3 v) { return height(v) <= rounding; }) &&
           std::ranges::all_of(b.vertices(), [&](geometry::Vec3 v) { return height(v) >= -rounding; });
  });
}

}  // namespace

bool parted(const geometry::Solid& a, const geometry::Solid& b) noexcept {
  return !box_of(a).overlaps(box_of(b)) || face_parts(a, b) || face_parts(b, a);
}

}  // namespace cleave::scene
