#include "detail/rounded_corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using geometry::Vec3;

std::vector<LatticePoint> corners_of(const JointPolygon& entry) {
  std::vector<LatticePoint> corners = entry.corners;
  for (const auto& hole : entry.holes) corners.insert(corners.end(), hole.begin(), hole.end());
  std::ranges::sort(corners);
  const auto again = std::ranges::unique(corners);
  corners.erase(again.begin(), again.end());
  return corners;
}

/// Sites that others are near to. Sorted along a direction that grids have no two corners across.
std::vector<LatticePoint> crowded(std::span<const JointPolygon> polygons, double within) {
  constexpr Vec3 direction{0.4837, 0.5391, 0.6893};  // shorter than 1
  std::vector<LatticePoint> points;
  for (const JointPolygon& entry : polygons) {
    points.insert(points.end(), entry.corners.begin(), entry.corners.end());
    for (const auto& hole : entry.holes) points.insert(points.end(), hole.begin(), hole.end());
  }
  std::vector<std::pair<double, std::uint32_t>> sites;
  sites.reserve(points.size());
  for (const LatticePoint& p : points) {
    sites.emplace_back(dot(direction, as_vec3(p)), static_cast<std::uint32_t>(sites.size()));
  }
  std::ranges::sort(sites, {}, &std::pair<double, std::uint32_t>::first);
  std::vector<LatticePoint> found;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (std::size_t j = i + 1; j < sites.size() && sites[j].first - sites[i].first <= within + 1; ++j) {
      const LatticePoint a = points[sites[i].second], b = points[sites[j].second];
      if (a == b || geometry::norm(as_vec3(b - a)) > within) continue;
      found.push_back(a);
      found.push_back(b);
    }
  }
  std::ranges::sort(found);
  const auto repeated = std::ranges::unique(found);
  found.erase(repeated.begin(), repeated.end());
  return found;
}

}  // namespace

Moves unite_rounded_corners(std::span<const JointPolygon> polygons, double within) {
  Moves moves;
  const std::vector<LatticePoint> sites = crowded(polygons, within);
  if (sites.empty()) return moves;
  Weld weld{within};
  for (const LatticePoint site : sites) weld.add(site, false);
  weld.finish();
  std::vector<LatticePoint> kept_apart;  // what these classes would become
  for (const JointPolygon& entry : polygons) {
    std::vector<LatticePoint> becomes;
    for (const LatticePoint c : corners_of(entry)) {
      if (std::ranges::binary_search(sites, c)) becomes.push_back(weld(c));
    }
    std::ranges::sort(becomes);
    for (std::size_t i = 1; i < becomes.size(); ++i) {
      if (becomes[i] == becomes[i - 1]) kept_apart.push_back(becomes[i]);
    }
  }
  std::ranges::sort(kept_apart);
  for (const LatticePoint site : sites) {
    const LatticePoint to = weld(site);
    if (to != site && !std::ranges::binary_search(kept_apart, to)) moves.add(site, to);
  }
  moves.finish();
  return moves;
}

}  // namespace cleave::topology::detail
