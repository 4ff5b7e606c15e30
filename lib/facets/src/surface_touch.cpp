#include "detail/surface_touch.hpp"

#include <algorithm>
#include <cmath>

#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Sign;
using geometry::Vec3;

void SurfaceTouch::add(const LatticePolygon& face, bool rock_behind) {
  const auto n = face.plane.unit_normal();
  const Vec3 out = (rock_behind ? 1 : -1) * Vec3{n[0], n[1], n[2]};
  const auto number = static_cast<std::uint32_t>(faces_.size());
  faces_.push_back({face.plane, out, dot(out, as_vec3(face.corners[0]))});
  const auto add = [&](LatticePoint a, LatticePoint b, LatticePoint c) {
    const std::array corners{as_vec3(a), as_vec3(b), as_vec3(c)};
    const bool flat = !(geometry::norm(cross(corners[1] - corners[0], corners[2] - corners[0])) > 0);
    if (!flat) triangles_.push_back({corners, number});
  };
  if (face.convex) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i)
      add(face.corners[0], face.corners[i], face.corners[i + 1]);
    return;
  }
  for (const auto& [a, b, c] : triangulate(face)) add(face.corners[a], face.corners[b], face.corners[c]);
}

void SurfaceTouch::finish(double reach) {
  reach_ = reach;
  for (const Triangle& triangle : triangles_) {
    geometry::Box box;
    for (const Vec3& corner : triangle.corners) box.add(corner);
    boxes_.push_back(box.grown(reach + 1));
  }
  if (!boxes_.empty()) tree_.emplace(boxes_);
}

/// Whether a side lies in the plane of a face, and on this part of it with more than a point.
bool SurfaceTouch::holds(const Triangle& triangle, Vec3 a, Vec3 b) const {
  const Face& face = faces_[triangle.face];
  const auto off = [&](Vec3 p) { return std::abs(dot(face.out_of_rock, p) - face.offset); };
  if (off(a) > reach_ || off(b) > reach_) return false;
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

LatticePoint SurfaceTouch::beyond(LatticePoint corner,
                                  std::span<const std::pair<LatticePoint, std::uint32_t>> on) const {
  const double margin = 8 + reach_ / 4;  // sites; corners of one polygon are brought to one plane afterwards
  constexpr int most_rounds = 32;
  bool moved = true;
  for (int round = 0; round < most_rounds && moved; ++round) {
    moved = false;
    for (const auto& [site, number] : on) {
      const Face& face = faces_[number];
      const double lacking = face.offset + margin - dot(face.out_of_rock, as_vec3(corner));
      if (lacking <= 1) continue;
      const auto by = [&](double n) { return std::llround(n * lacking); };
      corner = corner + LatticePoint{by(face.out_of_rock.x), by(face.out_of_rock.y), by(face.out_of_rock.z)};
      moved = true;
    }
  }
  return corner;
}

bool SurfaceTouch::near(std::span<const LatticePoint> corners) const {
  bool any = false;
  if (tree_) tree_->overlapping(box_of(corners, 1), [&](std::uint32_t) { any = true; });
  return any;
}

void SurfaceTouch::look(const LatticePolygon& polygon) {
  constexpr double least_sine = 1e-3;  // what lies along a face does not end on it
  const auto n = polygon.plane.unit_normal();
  const Vec3 normal{n[0], n[1], n[2]};
  const geometry::Box box = box_of(polygon.corners, 1);
  if (!(geometry::norm(box.max - box.min) > 1000 * reach_)) return;
  std::vector<std::uint32_t> near;
  tree_->overlapping(box, [&](std::uint32_t triangle) {
    const Face& face = faces_[triangles_[triangle].face];
    if (geometry::norm(cross(normal, face.out_of_rock)) >= least_sine) near.push_back(triangle);
  });
  const std::size_t count = polygon.corners.size();
  for (std::size_t i = 0; i < count && !near.empty(); ++i) {
    const LatticePoint a = polygon.corners[i], b = polygon.corners[(i + 1) % count];
    bool exact = polygon.exactly_planar;
    const std::size_t before = touching_.size();
    for (const std::uint32_t number : near) {
      const Triangle& triangle = triangles_[number];
      if (!holds(triangle, as_vec3(a), as_vec3(b))) continue;
      const exact::Plane& plane = faces_[triangle.face].plane;
      exact = exact && plane.side_of(a) == Sign::zero && plane.side_of(b) == Sign::zero;
      touching_.emplace_back(a, triangle.face);
      touching_.emplace_back(b, triangle.face);
    }
    if (exact) touching_.resize(before, {{}, 0});  // it reaches them as it is
  }
}

Moves SurfaceTouch::beyond() {
  std::ranges::sort(touching_);
  const auto again = std::ranges::unique(touching_);
  touching_.erase(again.begin(), again.end());
  Moves moves;
  for (std::size_t first = 0, last = 0; first < touching_.size(); first = last) {
    const LatticePoint corner = touching_[first].first;
    while (last < touching_.size() && touching_[last].first == corner) ++last;
    const LatticePoint to = beyond(corner, std::span{touching_}.subspan(first, last - first));
    if (to != corner && distance(to, corner) <= 16 * (reach_ + 8)) moves.add(corner, to);
  }
  moves.finish();
  return moves;
}

}  // namespace cleave::topology::detail
