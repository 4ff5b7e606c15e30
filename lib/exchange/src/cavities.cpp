#include "cavities.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "cleave/core/disjoint_sets.hpp"
#include "plane_split.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;
using Surface = std::vector<Polygon>;

constexpr std::array<double Vec3::*, 3> axes{&Vec3::x, &Vec3::y, &Vec3::z};

// The parts of a surface that hang together by edges, in the order of their first polygons.
std::vector<Surface> shells_of(const Surface& polygons) {
  DisjointSets<> shells{polygons.size()};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> first_use;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const auto& corners = polygons[p].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto edge = std::minmax(corners[i], corners[(i + 1) % corners.size()]);
      shells.join(first_use.try_emplace(edge, p).first->second, p);
    }
  }
  std::map<std::size_t, Surface> by_root;  // a root is the smallest member
  for (std::size_t p = 0; p < polygons.size(); ++p) by_root[shells.find(p)].push_back(polygons[p]);
  std::vector<Surface> out;
  for (auto& [root, surface] : by_root) out.push_back(std::move(surface));
  return out;
}

struct Interval {
  double low, high;
};

Interval extent(const Surface& surface, double Vec3::* axis, std::span<const Vec3> points) {
  Interval range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Polygon& polygon : surface) {
    for (const std::uint32_t corner : polygon.corners) {
      range.low = std::min(range.low, points[corner].*axis);
      range.high = std::max(range.high, points[corner].*axis);
    }
  }
  return range;
}

// The fewest open intervals that meet every cavity (greedy by upper ends), each common to its cavities.
std::vector<Interval> stabs(std::vector<Interval> cavities) {
  std::ranges::sort(cavities, {}, [](const Interval& i) { return std::pair{i.high, i.low}; });
  std::vector<Interval> out;
  while (!cavities.empty()) {
    Interval common = cavities.front();
    std::vector<Interval> rest;
    for (const Interval& i : cavities) {
      if (i.low < common.high) {
        common.low = std::max(common.low, i.low);
      } else {
        rest.push_back(i);
      }
    }
    out.push_back(common);
    cavities = std::move(rest);
  }
  return out;
}

// The middle of the widest gap between the points' coordinates within the interval: as far as can be from all of them.
std::optional<double> clear_position(Interval within, const std::vector<double>& sorted) {
  const auto begin = std::ranges::lower_bound(sorted, within.low);
  const auto end = std::ranges::upper_bound(sorted, within.high);
  double best = 0, width = 0;
  for (auto at = begin; at != end && std::next(at) != end; ++at) {
    const double gap = *std::next(at) - *at;
    const double middle = *at + gap / 2;
    if (gap > width && middle > *at && middle < *std::next(at)) {
      width = gap;
      best = middle;
    }
  }
  if (width == 0) return std::nullopt;
  return best;
}

std::vector<double> positions(const std::vector<Surface>& cavities, const Surface& whole, double Vec3::* axis,
                              std::span<const Vec3> points) {
  std::vector<Interval> extents;
  for (const Surface& cavity : cavities) extents.push_back(extent(cavity, axis, points));
  std::vector<double> coordinates;
  for (const Polygon& polygon : whole) {
    for (const std::uint32_t corner : polygon.corners) coordinates.push_back(points[corner].*axis);
  }
  std::ranges::sort(coordinates);
  std::vector<double> out;
  for (const Interval& stab : stabs(std::move(extents))) {
    if (const auto position = clear_position(stab, coordinates)) out.push_back(*position);
  }
  return out;
}

// Cuts by all positions; cavities that are left (there should be none) stay in their part.
std::vector<Surface> cut_at(Surface whole, double Vec3::* axis, const std::vector<double>& at,
                            std::vector<Vec3>& points) {
  std::vector<Surface> parts;
  for (const double position : at) {  // ascending: what lies below is done
    auto [lower, upper] = split(whole, axis, position, points);
    if (!lower.empty()) parts.push_back(std::move(lower));
    whole = std::move(upper);
  }
  if (!whole.empty()) parts.push_back(std::move(whole));
  return parts;
}

}  // namespace

double volume_of(std::span<const Polygon> polygons, std::span<const Vec3> points) {
  if (polygons.empty()) return 0;
  const Vec3 o = points[polygons.front().corners.front()];
  double six_volumes = 0;
  for (const Polygon& polygon : polygons) {
    const auto& c = polygon.corners;
    for (std::size_t i = 1; i + 1 < c.size(); ++i) {
      six_volumes += dot(points[c[0]] - o, cross(points[c[i]] - o, points[c[i + 1]] - o));
    }
  }
  return six_volumes / 6;
}

std::optional<std::vector<Surface>> cut_through_cavities(Surface triangles, std::vector<Vec3>& points) {
  // Flat scraps without volume, left where a plane meets two faces that touch, are no cells.
  const double nothing = 1e-14 * volume_of(triangles, points);
  std::vector<Surface> cavities;
  for (Surface& shell : shells_of(triangles)) {
    if (volume_of(shell, points) < 0) cavities.push_back(std::move(shell));
  }
  double Vec3::* best = axes.front();
  std::vector<double> at = positions(cavities, triangles, best, points);
  for (const auto axis : axes) {
    if (auto other = positions(cavities, triangles, axis, points); other.size() < at.size()) {
      at = std::move(other);
      best = axis;
    }
  }
  if (at.size() > most_planes) return std::nullopt;
  std::ranges::sort(at);
  std::vector<Surface> cells;
  for (Surface& part : cut_at(std::move(triangles), best, at, points)) {
    separate_pinches(part, points);
    for (Surface& shell : shells_of(part)) {
      const double volume = volume_of(shell, points);
      if (volume < -nothing) return std::nullopt;
      if (volume > nothing) cells.push_back(std::move(shell));
    }
  }
  return cells;
}

}  // namespace cleave::report::detail
