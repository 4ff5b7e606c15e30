#include "detail/surface_touch.hpp"

#include <algorithm>
#include <cmath>

#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

namespace {

constexpr double least_sine = 1e-3;  // of an angle: what lies along faces alone does not end on them

Vec3 normal_of(const Plane& plane) {
  const auto n = plane.unit_normal();
  return {n[0], n[1], n[2]};
}

/// Mean of the corners, in sites.
Vec3 middle_of(const LatticePolygon& polygon) {
  Vec3 sum{};
  for (const LatticePoint corner : polygon.corners) sum += as_vec3(corner);
  return sum / static_cast<double>(polygon.corners.size());
}

}  // namespace

void SurfaceFaces::add_triangles(const LatticePolygon& face) {
  const auto number = static_cast<std::uint32_t>(faces.size()) - 1;
  const auto add = [&](LatticePoint a, LatticePoint b, LatticePoint c) {
    const std::array corners{as_vec3(a), as_vec3(b), as_vec3(c)};
    const bool flat = !(geometry::norm(cross(corners[1] - corners[0], corners[2] - corners[0])) > 0);
    if (!flat) triangles.push_back({corners, number});
  };
  if (face.convex) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i)
      add(face.corners[0], face.corners[i], face.corners[i + 1]);
    return;
  }
  for (const auto& [a, b, c] : triangulate(face)) add(face.corners[a], face.corners[b], face.corners[c]);
}

void SurfaceFaces::add(const LatticePolygon& face, bool rock_behind) {
  const Vec3 out = (rock_behind ? 1 : -1) * normal_of(face.plane);
  faces.push_back({face.plane, out, dot(out, as_vec3(face.corners[0]))});
  add_triangles(face);
}

void SurfaceFaces::add(const LatticePolygon& face, Index joint) {
  const Vec3 normal = normal_of(face.plane);
  faces.push_back({face.plane, normal, dot(normal, as_vec3(face.corners[0])), joint});
  add_triangles(face);
}

void SurfaceFaces::add(const Plane& plane, Index joint) {
  const auto& a = plane.approx();
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  endless.push_back(static_cast<std::uint32_t>(faces.size()));
  faces.push_back({plane, normal_of(plane), std::ldexp(-a[3] / length, 48), joint});
}

SurfaceTouch::SurfaceTouch(const SurfaceFaces& on, double reach) : on_{on}, reach_{reach} {
  for (const SurfaceFaces::Triangle& triangle : on_.triangles) {
    geometry::Box box;
    for (const Vec3& corner : triangle.corners) box.add(corner);
    boxes_.push_back(box.grown(reach + 1));
  }
  if (!boxes_.empty()) tree_.emplace(boxes_);
}

bool SurfaceTouch::in_plane(const SurfaceFaces::Face& face, Vec3 a, Vec3 b) const {
  const auto off = [&](Vec3 p) { return std::abs(dot(face.normal, p) - face.offset); };
  return off(a) <= reach_ && off(b) <= reach_;
}

/// Whether a side lies in the plane of a face, and on this part of it with more than a point.
bool SurfaceTouch::holds(const SurfaceFaces::Triangle& triangle, Vec3 a, Vec3 b) const {
  if (!in_plane(on_.faces[triangle.face], a, b)) return false;
  const auto& [p, q, r] = triangle.corners;
  const Vec3 normal = cross(q - p, r - p);
  double from = 0, to = 1;  // what lies within its three sides
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 start = triangle.corners[k];
    const Vec3 inwards = cross(normal, triangle.corners[(k + 1) % 3] - start);
    const double grown = reach_ * geometry::norm(inwards);
    const double at_a = dot(inwards, a - start) + grown, at_b = dot(inwards, b - start) + grown;
    if (at_a < 0 && at_b < 0) return false;
    if (at_a < 0) from = std::max(from, at_a / (at_a - at_b));
    if (at_b < 0) to = std::min(to, at_a / (at_a - at_b));
  }
  return (to - from) * geometry::norm(b - a) > 4 * reach_;
}

bool SurfaceTouch::near(std::span<const LatticePoint> corners) const {
  bool any = !on_.endless.empty();
  if (tree_) tree_->overlapping(box_of(corners, 1), [&](std::uint32_t) { any = true; });
  return any;
}

/// Triangles that sides of the polygon may lie on.
std::vector<std::uint32_t> SurfaceTouch::near(const LatticePolygon& polygon, std::span<const Index> joints) const {
  std::vector<std::uint32_t> found;
  if (!tree_) return found;
  const Vec3 normal = normal_of(polygon.plane);
  tree_->overlapping(box_of(polygon.corners, 1), [&](std::uint32_t triangle) {
    const SurfaceFaces::Face& face = on_.faces[on_.triangles[triangle].face];
    if (!joints.empty() && !std::ranges::binary_search(joints, face.joint)) return;
    const bool along = geometry::norm(cross(normal, face.normal)) < least_sine;
    if (face.joint == none || !along) found.push_back(triangle);
  });
  return found;
}

void SurfaceTouch::look(const LatticePolygon& polygon) { look(polygon, {}, nullptr); }

void SurfaceTouch::look(const LatticePolygon& polygon, std::span<const Index> joints, const SharedCorners& shared) {
  look(polygon, joints, &shared);
}

void SurfaceTouch::look(const LatticePolygon& polygon, std::span<const Index> joints, const SharedCorners* shared) {
  const geometry::Box box = box_of(polygon.corners, 1);
  if (!(geometry::norm(box.max - box.min) > 1000 * reach_)) return;
  const std::vector<std::uint32_t> triangles = near(polygon, joints);
  const Vec3 normal = normal_of(polygon.plane), middle = middle_of(polygon);
  const std::size_t count = polygon.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LatticePoint a = polygon.corners[i], b = polygon.corners[(i + 1) % count];
    if (shared != nullptr && shared->shared(a, b)) continue;
    const Vec3 from = as_vec3(a), to = as_vec3(b);
    bool exact = polygon.exactly_planar, ends = false;
    const std::size_t before = touching_.size();
    const auto touches = [&](std::uint32_t number) {
      const SurfaceFaces::Face& face = on_.faces[number];
      ends = ends || geometry::norm(cross(normal, face.normal)) >= least_sine;
      exact = exact && face.plane.side_of(a) == Sign::zero && face.plane.side_of(b) == Sign::zero;
      const bool against = face.joint != none && dot(face.normal, middle) > face.offset;
      touching_.push_back({a, number, against});
      touching_.push_back({b, number, against});
    };
    for (const std::uint32_t triangle : triangles) {
      if (holds(on_.triangles[triangle], from, to)) touches(on_.triangles[triangle].face);
    }
    for (const std::uint32_t face : on_.endless) {
      if (!joints.empty() && !std::ranges::binary_search(joints, on_.faces[face].joint)) continue;
      const bool along = geometry::norm(cross(normal, on_.faces[face].normal)) < least_sine;
      if (!along && in_plane(on_.faces[face], from, to)) touches(face);
    }
    // It reaches them as it is, or lies along them.
    if (exact || !ends) touching_.resize(before, {{}, 0, false});
  }
}

LatticePoint SurfaceTouch::beyond(LatticePoint corner, std::span<const Touching> on) const {
  const double margin = 8 + reach_ / 4;  // sites; corners of one polygon are brought to one plane afterwards
  constexpr int most_rounds = 32;
  bool moved = true;
  for (int round = 0; round < most_rounds && moved; ++round) {
    moved = false;
    for (const Touching& touching : on) {
      const SurfaceFaces::Face& face = on_.faces[touching.face];
      const double sense = touching.against ? -1 : 1;
      const double lacking = sense * (face.offset - dot(face.normal, as_vec3(corner))) + margin;
      if (lacking <= 1) continue;
      const auto by = [&](double n) { return std::llround(sense * n * lacking); };
      corner = corner + LatticePoint{by(face.normal.x), by(face.normal.y), by(face.normal.z)};
      moved = true;
    }
  }
  return corner;
}

Moves SurfaceTouch::beyond() {
  std::ranges::sort(touching_);
  const auto again = std::ranges::unique(touching_);
  touching_.erase(again.begin(), again.end());
  Moves moves;
  for (std::size_t first = 0, last = 0; first < touching_.size(); first = last) {
    const LatticePoint corner = touching_[first].corner;
    while (last < touching_.size() && touching_[last].corner == corner) ++last;
    const std::span on = std::span{touching_}.subspan(first, last - first);
    const LatticePoint to = beyond(corner, on);
    if (to != corner && distance(to, corner) <= 16 * (reach_ + 8)) moves.add(corner, to);
  }
  moves.finish();
  return moves;
}

}  // namespace cleave::topology::detail
