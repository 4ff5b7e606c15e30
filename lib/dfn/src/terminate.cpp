#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "models.hpp"

namespace cleave::dfn::detail {

using geometry::Polygon;
using geometry::Vec3;

namespace {

/// Where a line p + t d lies within a convex polygon in the polygon's plane: [low, high], or nothing.
std::optional<std::pair<double, double>> within(const Polygon& polygon, Vec3 normal, Vec3 p, Vec3 d) {
  double low = -INFINITY, high = INFINITY;
  const auto corners = polygon.corners();
  Vec3 middle{0, 0, 0};
  for (const Vec3 c : corners) middle += c / static_cast<double>(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    Vec3 inwards = cross(normal, b - a);
    if (dot(inwards, middle - a) < 0) inwards = -inwards;
    const double at = dot(inwards, p - a), slope = dot(inwards, d);
    if (slope == 0) {
      if (at < 0) return std::nullopt;
    } else if (slope > 0) {
      low = std::max(low, -at / slope);
    } else {
      high = std::min(high, -at / slope);
    }
  }
  if (low >= high) return std::nullopt;
  return std::pair{low, high};
}

/// The part of a convex polygon where dot(n, x - through) >= -beyond.
std::vector<Vec3> clipped(std::span<const Vec3> corners, Vec3 through, Vec3 n, double beyond) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = corners[i], q = corners[(i + 1) % corners.size()];
    const double a = dot(n, p - through) + beyond, b = dot(n, q - through) + beyond;
    if (a >= 0) kept.push_back(p);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.push_back(p + (a / (a - b)) * (q - p));
  }
  return kept;
}

}  // namespace

void terminate(std::vector<SampledJoint>& joints, std::span<const std::span<const SampledJoint>> older,
               double probability, const SetStreams& streams) {
  struct Meeting {
    double distance;  // from the joint's centre to the other plane, within the joint
    const SampledJoint* other;
  };
  std::vector<Meeting> meetings;
  for (SampledJoint& joint : joints) {
    auto* polygon = std::get_if<Polygon>(&joint.shape);
    if (polygon == nullptr) continue;
    double reach = 0;
    for (const Vec3 c : polygon->corners()) reach = std::max(reach, norm(c - joint.centre));
    meetings.clear();
    for (const auto& set : older) {
      for (const SampledJoint& other : set) {
        const Vec3 direction = cross(joint.normal, other.normal);
        const double sine = norm(direction);
        const double away = std::abs(dot(other.normal, joint.centre - other.centre));
        if (sine < 1e-6 || away / sine > reach) continue;
        meetings.push_back({away / sine, &other});
      }
    }
    std::ranges::stable_sort(meetings, {}, &Meeting::distance);
    Rng rng = streams.of(Draw::termination, joint.index);
    for (const Meeting& meeting : meetings) {
      // One number a candidate, met or not: an older joint elsewhere changes nothing.
      const bool ends = rng.uniform() < probability;
      const SampledJoint& other = *meeting.other;
      const Vec3 d = normalized(cross(joint.normal, other.normal));
      // A point of both planes, nearest to the joint's centre.
      const Vec3 down = cross(joint.normal, d);
      const Vec3 p = joint.centre + dot(other.normal, other.centre - joint.centre) / dot(other.normal, down) * down;
      const auto own = within(*polygon, joint.normal, p, d);
      if (!own || !ends) continue;
      if (const auto* that = std::get_if<Polygon>(&other.shape)) {
        const auto met = within(*that, other.normal, p, d);
        if (!met || met->first >= own->second || met->second <= own->first) continue;
      }
      const double side = dot(other.normal, joint.centre - other.centre) < 0 ? -1 : 1;
      // A hair beyond the older plane: the cutter takes the strip behind it away, so the joint ends exactly there.
      auto rest = Polygon::make(clipped(polygon->corners(), other.centre, side * other.normal, 1e-6 * reach));
      if (rest) *polygon = *std::move(rest);
    }
  }
}

}  // namespace cleave::dfn::detail
