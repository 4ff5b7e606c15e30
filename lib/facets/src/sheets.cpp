#include "detail/sheets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "detail/folds.hpp"
#include "detail/side_users.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Plane;

namespace {

/// Which way a polygon has the side a b, seen along the plane's normal: on its left 1, on its right -1; 0 where it is
/// not about along the plane.
int sense_of(const JointPolygon& entry, LatticePoint a, LatticePoint b, const Plane& plane) {
  const auto n = plane.unit_normal(), m = entry.polygon.plane.unit_normal();
  const double cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
  if (std::abs(cosine) < 0.999) return 0;
  const std::size_t count = entry.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LatticePoint p = entry.corners[i], q = entry.corners[(i + 1) % count];
    if (p == a && q == b) return cosine > 0 ? 1 : -1;
    if (p == b && q == a) return cosine > 0 ? -1 : 1;
  }
  return 0;
}

/// Whether `next` lies beyond the side a b of `entry`, about along the plane, and not back over it.
bool goes_on(const JointPolygon& entry, const JointPolygon& next, LatticePoint a, LatticePoint b, const Plane& plane) {
  return sense_of(entry, a, b, plane) * sense_of(next, a, b, plane) < 0;
}

double bend_of(const JointPolygon& entry, const Plane& plane) {
  double most = 0;
  for (const LatticePoint c : entry.corners) most = std::max(most, distance_sites(plane, c));
  return most;
}

/// The square of twice the vector area: the same number whichever corner came first.
double squared_area(std::span<const LatticePoint> corners) {
  std::array<exact::Int128, 3> sum{};
  const auto product = [](std::int64_t p, std::int64_t q) { return static_cast<exact::Int128>(p) * q; };
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const LatticePoint u = corners[i] - corners[0], v = corners[i + 1] - corners[0];
    sum[0] += product(u.y, v.z) - product(u.z, v.y);
    sum[1] += product(u.z, v.x) - product(u.x, v.z);
    sum[2] += product(u.x, v.y) - product(u.y, v.x);
  }
  const double x = static_cast<double>(sum[0]), y = static_cast<double>(sum[1]), z = static_cast<double>(sum[2]);
  return x * x + y * y + z * z;
}

/// Largest first: the planes of small ones, and of needles above all, are turned by roundings.
std::vector<std::size_t> leaders(std::span<const JointPolygon> polygons) {
  std::vector<std::pair<double, LatticePoint>> keys;
  for (const JointPolygon& entry : polygons) {
    keys.emplace_back(-squared_area(entry.corners), std::ranges::min(entry.corners));
  }
  std::vector<std::size_t> order(polygons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return keys[k]; });
  return order;
}

class Sheets {
 public:
  Sheets(std::span<const JointPolygon> polygons, const SharedCorners& shared, std::vector<std::uint8_t> taken,
         double flat)
      : polygons_{polygons}, users_{polygons, shared}, taken_{std::move(taken)}, flat_{flat} {
    leave_out_turned_back();
  }

  struct Sheet {
    std::vector<std::size_t> polygons;  ///< in the order in which they were reached
    Plane plane;
  };
  /// From this polygon as far as one plane goes. The leader's own plane is only as good as the leader is large, so it
  /// is laid through corners farther and farther apart while that holds more.
  std::optional<Sheet> from(std::size_t leader) {
    constexpr int rounds = 64;
    const Plane& own = polygons_[leader].polygon.plane;
    if (taken_[leader] != 0 || bend_of(polygons_[leader], own) > flat_) return std::nullopt;
    Sheet sheet = reached(leader, own);
    for (int round = 0; round < rounds && sheet.polygons.size() > 1; ++round) {
      const auto wider = through_far_corners(sheet);
      if (!wider || bend_of(polygons_[leader], *wider) > flat_) break;
      Sheet more = reached(leader, *wider);
      if (more.polygons.size() <= sheet.polygons.size()) break;
      sheet = std::move(more);
    }
    for (const std::size_t k : sheet.polygons) taken_[k] = 1;
    return sheet;
  }

 private:
  /// Where polygons lie on one another beyond a side that they share, as where a corner was moved past another: layers
  /// of one plane would have no order about that side, so all of them are cut and shown on planes of their own; so are
  /// polygons that cross themselves.
  void leave_out_turned_back() {
    std::vector<std::size_t> layers, found;
    for (std::size_t k = 0; k < polygons_.size(); ++k) {
      if (taken_[k] != 0) continue;
      const JointPolygon& entry = polygons_[k];
      if (entry.folded && !entry.polygon.convex && crosses_itself(entry.corners)) found.push_back(k);
      SideUsers::for_each_side(entry, [&](LatticePoint a, LatticePoint b) {
        bool turned_back = false;
        layers.assign(1, k);
        for (const auto& [side, user] : users_.of(a, b)) {
          if (user == k || taken_[user] != 0) continue;
          const int sense = sense_beside(entry, polygons_[user], a, b);
          if (sense != 0) layers.push_back(user);
          turned_back = turned_back || sense > 0;
        }
        if (turned_back) found.insert(found.end(), layers.begin(), layers.end());
      });
    }
    for (const std::size_t k : found) taken_[k] = 1;
  }
  /// 1 where two polygons lie on one another beside their side, -1 where they go on from one another, 0 where they are
  /// not about in one plane or exactly so.
  [[nodiscard]] int sense_beside(const JointPolygon& one, const JointPolygon& other, LatticePoint a,
                                 LatticePoint b) const {
    const Plane &p = one.polygon.plane, &q = other.polygon.plane;
    if (p.coincides_with(q) || std::min(bend_of(one, q), bend_of(other, p)) > flat_) return 0;
    return sense_of(one, a, b, p) * sense_of(other, a, b, p);
  }
  Sheet reached(std::size_t leader, const Plane& plane) {
    Sheet sheet{{leader}, plane};
    taken_[leader] = 1;
    for (std::size_t at = 0; at < sheet.polygons.size(); ++at) {
      const JointPolygon& entry = polygons_[sheet.polygons[at]];
      SideUsers::for_each_side(entry, [&](LatticePoint a, LatticePoint b) {
        for (const auto& [side, user] : users_.of(a, b)) {
          if (taken_[user] != 0 || !goes_on(entry, polygons_[user], a, b, plane)) continue;
          if (bend_of(polygons_[user], plane) > flat_) continue;
          taken_[user] = 1;
          sheet.polygons.push_back(user);
        }
      });
    }
    for (const std::size_t k : sheet.polygons) taken_[k] = 0;
    return sheet;
  }
  [[nodiscard]] std::optional<Plane> through_far_corners(const Sheet& sheet) const {
    std::vector<LatticePoint> corners;
    for (const std::size_t k : sheet.polygons) {
      corners.insert(corners.end(), polygons_[k].corners.begin(), polygons_[k].corners.end());
    }
    std::ranges::iter_swap(corners.begin(), std::ranges::min_element(corners));
    return plane_of(corners, {});
  }

  std::span<const JointPolygon> polygons_;
  SideUsers users_;
  std::vector<std::uint8_t> taken_;
  double flat_;
};

}  // namespace

std::vector<std::optional<Plane>> find_sheets(std::span<const JointPolygon> polygons,
                                              const std::vector<std::uint8_t>& left_out, const SharedCorners& shared,
                                              double flat, double& bend) {
  std::vector<std::optional<Plane>> planes(polygons.size());
  if (!shared.any_side() && std::ranges::none_of(polygons, &JointPolygon::folded)) return planes;
  Sheets sheets{polygons, shared, left_out, flat};
  for (const std::size_t leader : leaders(polygons)) {
    const auto sheet = sheets.from(leader);
    if (!sheet) continue;
    const bool bent = std::ranges::any_of(sheet->polygons, [&](std::size_t k) {
      return polygons[k].folded || !polygons[k].polygon.plane.coincides_with(sheet->plane);
    });
    if (!bent) continue;
    for (const std::size_t k : sheet->polygons) {
      planes[k] = sheet->plane;
      bend = std::max(bend, bend_of(polygons[k], sheet->plane));
    }
  }
  return planes;
}

}  // namespace cleave::topology::detail
