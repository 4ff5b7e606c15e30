#include "detail/sheets.hpp"

#include <algorithm>
#include <cmath>

#include "detail/folds.hpp"
#include "detail/side_users.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Plane;

namespace {

/// Whether `next` lies beyond the side a b of `entry`, about along the plane, and not back over it.
bool goes_on(const JointPolygon& entry, const JointPolygon& next, LatticePoint a, LatticePoint b, const Plane& plane) {
  const auto n = plane.unit_normal();
  const auto sense = [&](const JointPolygon& polygon) {
    const auto m = polygon.polygon.plane.unit_normal();
    const double cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
    if (std::abs(cosine) < 0.999) return 0;
    const std::size_t count = polygon.corners.size();
    for (std::size_t i = 0; i < count; ++i) {
      const LatticePoint p = polygon.corners[i], q = polygon.corners[(i + 1) % count];
      if (p == a && q == b) return cosine > 0 ? 1 : -1;
      if (p == b && q == a) return cosine > 0 ? -1 : 1;
    }
    return 0;
  };
  return sense(entry) * sense(next) < 0;
}

}  // namespace

std::vector<std::optional<Plane>> find_sheets(std::span<const JointPolygon> polygons,
                                              const std::vector<std::uint8_t>& left_out, const SharedCorners& shared,
                                              double flat, double& bend_of_all) {
  std::vector<std::optional<Plane>> sheets(polygons.size());
  if (!shared.any_side() && std::ranges::none_of(polygons, &JointPolygon::folded)) return sheets;
  const SideUsers users{polygons, shared};
  const auto bend = [](const JointPolygon& entry, const Plane& plane) {
    double most = 0;
    for (const LatticePoint c : entry.corners) most = std::max(most, distance_sites(plane, c));
    return most;
  };
  std::vector<std::uint8_t> seen = left_out;
  for (std::size_t first = 0; first < polygons.size(); ++first) {
    const Plane& plane = polygons[first].polygon.plane;
    if (seen[first] != 0 || bend(polygons[first], plane) > flat) continue;
    std::vector<std::size_t> reached{first};
    seen[first] = 1;
    bool bent = false;
    double most = 0;
    for (std::size_t at = 0; at < reached.size(); ++at) {
      const JointPolygon& entry = polygons[reached[at]];
      bent = bent || entry.folded || !entry.polygon.plane.coincides_with(plane);
      most = std::max(most, bend(entry, plane));
      SideUsers::for_each_side(entry, [&](LatticePoint a, LatticePoint b) {
        for (const auto& [side, user] : users.of(a, b)) {
          if (seen[user] != 0 || !goes_on(entry, polygons[user], a, b, plane)) continue;
          if (bend(polygons[user], plane) > flat) continue;
          seen[user] = 1;
          reached.push_back(user);
        }
      });
    }
    if (!bent) continue;
    for (const std::size_t k : reached) sheets[k] = plane;
    bend_of_all = std::max(bend_of_all, most);
  }
  return sheets;
}

}  // namespace cleave::topology::detail
