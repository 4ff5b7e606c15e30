#include "cleave/stability/block_theory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cleave/core/assert.hpp"
#include "flat.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;

std::vector<Direction> rows_of(std::span<const Direction> planes, std::uint32_t code) {
  std::vector<Direction> rows;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    rows.push_back(((code >> i) & 1U) != 0 ? planes[i].opposite() : planes[i]);
  }
  return rows;
}

/// Collects where a wall's part meets the planes of a block.
class Faces final {
 public:
  Faces(std::span<const Direction> rows, Vec3 apex) : rows_{rows}, apex_{apex}, points_(rows.size(), {apex}) {}

  void meet(const Convex& wall, MaximumBlock& block) {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      for (std::size_t i = 0; i < wall.size(); ++i) {
        const Vec3 a = wall[i], b = wall[(i + 1) % wall.size()];
        if (!on(k, a)) continue;
        points_[k].push_back(a);
        if (on(k, b)) block.traces[k] += norm(b - a);
      }
      for (const Vec3 p : points_[k]) {
        for (const Vec3 q : points_[k]) block.extents[k] = std::max(block.extents[k], norm(p - q));
      }
    }
  }

 private:
  [[nodiscard]] bool on(std::size_t plane, Vec3 at) const {
    return std::abs(dot(rows_[plane].unit(), at - apex_)) < 1e-9 * (1 + norm(at - apex_));
  }
  std::span<const Direction> rows_;
  Vec3 apex_;
  std::vector<std::vector<Vec3>> points_;
};

}  // namespace

void MaximumBlock::scale(double factor) {
  volume *= factor * factor * factor;
  face_area *= factor * factor;
  face_vector = factor * factor * face_vector;
  height *= factor;
  for (std::size_t k = 0; k < 2; ++k) apex[k] = foot[k] + factor * (apex[k] - foot[k]);
  for (double& t : traces) t *= factor;
  for (double& e : extents) e *= factor;
}

std::optional<Direction> direction_of(Vec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !geometry::is_finite(v)) return std::nullopt;
  const auto integer = [&](double c) { return exact::Int128{std::llround(c / largest * 0x1p40)}; };
  return Direction::make({integer(v.x), integer(v.y), integer(v.z)});
}

std::vector<JointPyramid> joint_pyramids(std::span<const Direction> planes, std::span<const double> tan_friction,
                                         std::span<const Direction> free_surfaces, Vec3 force) {
  CLEAVE_ASSERT(planes.size() <= 16 && tan_friction.size() == planes.size());
  std::vector<JointPyramid> pyramids;
  for (std::uint32_t code = 0; code < (1U << planes.size()); ++code) {
    JointPyramid pyramid{.code = code};
    std::vector<Direction> rows = rows_of(planes, code);
    const Cone cone{rows};
    pyramid.dimension = cone.dimension();
    // Blocks are finite when no direction of the pyramid stays in the rock for ever.
    for (const Direction& surface : free_surfaces) rows.push_back(surface.opposite());
    pyramid.finite = Cone{rows}.dimension() == 0;
    if (pyramid.dimension > 0) {
      const Motion motion = project(cone, Resultant::along(force, newtons(norm(force))));
      switch (motion.kind) {
        case MotionKind::none:
        case MotionKind::held: pyramid.mode = Mode::stable; break;
        case MotionKind::free: pyramid.mode = dot(motion.s, force) >= 0 ? Mode::falling : Mode::lifting; break;
        case MotionKind::one_plane: pyramid.mode = Mode::sliding; break;
        case MotionKind::two_planes: pyramid.mode = Mode::wedge; break;
      }
      if (const double driving = norm(motion.s); driving > 0) {
        pyramid.direction = motion.s / driving;
        pyramid.driving = driving / norm(force);
        // Groups are in the order of planes: no two planes of a set of pyramids are parallel in the same sense.
        const std::size_t pressing = motion.kind == MotionKind::two_planes  ? 2
                                     : motion.kind == MotionKind::one_plane ? 1
                                                                            : 0;
        for (std::size_t k = 0; k < pressing; ++k) {
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t row = 0; row < planes.size(); ++row) {
            if (cone.group_of_row()[row] == motion.groups[k]) least = std::min(least, tan_friction[row]);
          }
          pyramid.resistance += motion.reactions[k] * least / norm(force);
        }
      }
    }
    pyramids.push_back(pyramid);
  }
  return pyramids;
}

std::optional<MaximumBlock> maximum_block(std::span<const Direction> planes, std::uint32_t code,
                                          const ConvexTunnel& tunnel) {
  const std::vector<Direction> rows = rows_of(planes, code);
  const Cone cone{rows};
  if (cone.dimension() != 3) return std::nullopt;
  // A pyramid that holds the axis makes blocks without end along the tunnel.
  const auto along = direction_of(tunnel.axis);
  if (!along) return std::nullopt;
  for (const Vec3 end : {tunnel.axis, -tunnel.axis}) {
    if (std::ranges::all_of(rows, [&](const Direction& n) { return dot(n.unit(), end) > -1e-12; })) return std::nullopt;
  }
  // Edges of the pyramid, seen along the axis.
  std::vector<double> angles;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = i + 1; j < rows.size(); ++j) {
      for (const double sign : {1.0, -1.0}) {
        const Vec3 e = sign * stability::cross(rows[i], rows[j]);
        if (!(norm(e) > 0)) continue;
        bool edge = true;
        for (std::size_t k = 0; k < rows.size(); ++k) {
          if (k != i && k != j && dot(rows[k].unit(), e) < -1e-12 * norm(e)) edge = false;
        }
        if (edge) angles.push_back(std::atan2(dot(e, tunnel.up), dot(e, tunnel.right)));
      }
    }
  }
  if (angles.size() < 2) return std::nullopt;
  std::ranges::sort(angles);
  // The sector they lie in is what the widest gap leaves.
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  std::size_t first = 0;
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (angles[i] - angles[i - 1] > gap) {
      gap = angles[i] - angles[i - 1];
      first = i;
    }
  }
  if (gap <= std::numbers::pi + 1e-9) return std::nullopt;
  const double right = angles[first], left = angles[(first + angles.size() - 1) % angles.size()];
  // The rightmost edge touches the section on its right side, the leftmost one on its left; the apex is where both
  // lines meet. A line with direction t leaves the section on its left when it touches at the corner farthest to the
  // right.
  const auto support = [&](double nu, double nv) {
    double most = -std::numeric_limits<double>::infinity();
    for (const auto& c : tunnel.outline) most = std::max(most, nu * c[0] + nv * c[1]);
    return most;
  };
  const double n1u = std::sin(right), n1v = -std::cos(right);  // to the right of the right edge
  const double n2u = -std::sin(left), n2v = std::cos(left);    // to the left of the left edge
  const double h1 = support(n1u, n1v), h2 = support(n2u, n2v);
  const double det = n1u * n2v - n1v * n2u;
  if (std::abs(det) < 1e-12) return std::nullopt;
  MaximumBlock block{.code = code};
  block.traces.assign(rows.size(), 0);
  block.extents.assign(rows.size(), 0);
  block.apex = {(h1 * n2v - h2 * n1v) / det, (n1u * h2 - n2u * h1) / det};
  const Vec3 apex = block.apex[0] * tunnel.right + block.apex[1] * tunnel.up;
  double reach_along = 1;
  for (const auto& c : tunnel.outline) reach_along += std::abs(c[0]) + std::abs(c[1]);
  reach_along = 1e4 * (reach_along + norm(apex));
  Faces faces{rows, apex};
  block.height = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tunnel.outline.size(); ++i) {
    const auto& a = tunnel.outline[i];
    const auto& b = tunnel.outline[(i + 1) % tunnel.outline.size()];
    const Vec3 p = a[0] * tunnel.right + a[1] * tunnel.up, q = b[0] * tunnel.right + b[1] * tunnel.up;
    const Vec3 out = geometry::normalized((b[1] - a[1]) * tunnel.right - (b[0] - a[0]) * tunnel.up);
    const double distance = dot(apex - p, out);
    const Vec3 edge = q - p;
    const double t = std::clamp(dot(apex - p, edge) / dot(edge, edge), 0.0, 1.0);
    if (const double away = norm(apex - p - t * edge); away < block.height) {
      block.height = away;
      block.foot = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
    }
    if (distance <= 0) continue;  // the apex does not see this side
    Convex wall{p - reach_along * tunnel.axis, q - reach_along * tunnel.axis, q + reach_along * tunnel.axis,
                p + reach_along * tunnel.axis};
    for (const Direction& n : rows) wall = clipped(wall, -n.unit(), -dot(n.unit(), apex));
    faces.meet(wall, block);
    const double area = integrate(wall).total;
    block.face_area += area;
    block.face_vector += area * out;
    block.volume += area * distance / 3;
  }
  return block;
}

}  // namespace cleave::stability
