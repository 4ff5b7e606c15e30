#include "detail/snapping.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;

std::array<double, 3> difference(LatticePoint a, LatticePoint b) {
  const LatticePoint d = a - b;
  return {static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
}
double length(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

std::size_t Snapper::CellHash::operator()(const Cell& cell) const noexcept {
  std::uint64_t h = 0x9E3779B97F4A7C15U;
  for (const std::int64_t c : cell) {
    h = (h ^ static_cast<std::uint64_t>(c)) * 0xFF51AFD7ED558CCDU;
    h ^= h >> 32U;
  }
  return h;
}

Snapper::Snapper(const exact::Lattice& lattice, double distance_m)
    : lattice_{lattice}, distance_{distance_m}, distance_sites_{distance_m / lattice.pitch()} {}

LatticePoint Snapper::site(geometry::Vec3 p) {
  LatticePoint site = lattice_.snap(p.x, p.y, p.z);
  if (active()) {
    const double size = std::max(distance_sites_, 1.0);
    const auto cell_of = [&](std::int64_t c) {
      return static_cast<std::int64_t>(std::floor(static_cast<double>(c) / size));
    };
    const Cell home{cell_of(site.x), cell_of(site.y), cell_of(site.z)};
    const LatticePoint* found = nullptr;
    for (std::int64_t i = -1; i <= 1 && found == nullptr; ++i) {
      for (std::int64_t j = -1; j <= 1 && found == nullptr; ++j) {
        for (std::int64_t k = -1; k <= 1 && found == nullptr; ++k) {
          const auto entry = cells_.find(Cell{home[0] + i, home[1] + j, home[2] + k});
          if (entry == cells_.end()) continue;
          for (const LatticePoint& known : entry->second) {
            if (length(difference(known, site)) <= distance_sites_) {
              found = &known;
              break;
            }
          }
        }
      }
    }
    if (found != nullptr) {
      if (const double moved = length(difference(*found, site)); moved > 0 && joint_ != none) {
        note(moved * lattice_.pitch());
      }
      site = *found;
    } else {
      cells_[home].push_back(site);
    }
  }
  const auto [x, y, z] = lattice_.position(site);
  largest_move_ = std::max({largest_move_, std::abs(x - p.x), std::abs(y - p.y), std::abs(z - p.z)});
  return site;
}

SnappedJoint& Snapper::note(double moved_m) {
  largest_move_ = std::max(largest_move_, moved_m);
  SnappedJoint& entry = changed_.try_emplace(joint_, SnappedJoint{JointId{joint_}, metres(0), false, 0}).first->second;
  entry.moved = std::max(entry.moved, metres(moved_m));
  return entry;
}

std::vector<SnappedJoint> Snapper::changed() const {
  std::vector<SnappedJoint> all;
  for (const auto& [joint, entry] : changed_) all.push_back(entry);
  return all;
}

double Snapper::distance_sites(const Plane& plane, LatticePoint p) const {
  const auto n = plane.unit_normal();
  const auto& a = plane.approx();
  const double scale = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return std::abs(n[0] * static_cast<double>(p.x) + n[1] * static_cast<double>(p.y) + n[2] * static_cast<double>(p.z) +
                  std::ldexp(a[3] / scale, 48));
}

void Snapper::remember(const LatticePolygon& polygon) {
  if (active()) surfaces_.push_back(polygon);
}

void Snapper::remember(const Plane& persistent) {
  // No corners: it goes on for ever.
  if (!active()) return;
  persistent_.push_back(surfaces_.size());
  surfaces_.push_back({persistent, direction_along(persistent), {}, true, true});
}

geometry::Bounds Snapper::bounds_of(std::span<const LatticePoint> corners) const {
  const auto position = [](LatticePoint p) {
    return geometry::Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  };
  geometry::Bounds box = geometry::Bounds::of(position(corners.front()));
  for (const LatticePoint c : corners) box.grow(geometry::Bounds::of(position(c)));
  const geometry::Vec3 margin{distance_sites_ + 1, distance_sites_ + 1, distance_sites_ + 1};
  return {box.lo - margin, box.hi + margin};
}

void Snapper::begin_merging(std::span<const LatticePolygon* const> polygons) {
  const auto add = [&](std::size_t number, const LatticePolygon& polygon) {
    boxed_.push_back(number);
    boxes_.push_back(bounds_of(polygon.corners));
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (!surfaces_[k].corners.empty()) add(k, surfaces_[k]);
  }
  for (std::size_t k = 0; k < polygons.size(); ++k) add(surfaces_.size() + k, *polygons[k]);
  tree_ = std::make_unique<geometry::BoxTree>(boxes_);
}

std::vector<std::size_t> Snapper::near(const geometry::Bounds& box) const {
  std::vector<std::size_t> found = persistent_;
  tree_->overlapping(box, [&](std::uint32_t k) {
    if (boxed_[k] < surfaces_.size()) found.push_back(boxed_[k]);
  });
  std::ranges::sort(found);
  return found;
}

void Snapper::merge_plane(LatticePolygon& polygon) {
  for (const std::size_t k : near(bounds_of(polygon.corners))) {
    const LatticePolygon& earlier = surfaces_[k];
    if (earlier.plane.coincides_with(polygon.plane)) break;
    double furthest = 0;
    for (const LatticePoint c : polygon.corners) furthest = std::max(furthest, distance_sites(earlier.plane, c));
    if (furthest > distance_sites_) continue;
    const auto a = earlier.plane.unit_normal(), b = polygon.plane.unit_normal();
    const bool same = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0;
    polygon.plane = same ? earlier.plane : earlier.plane.flipped();
    polygon.along = same ? earlier.along : LatticePoint{} - earlier.along;
    polygon.exactly_planar = false;
    ++merged_planes_;
    note(furthest * lattice_.pitch()).plane_merged = true;
    break;
  }
  surfaces_.push_back(polygon);
}

bool Snapper::near_polygon(const LatticePolygon& polygon, LatticePoint p) const {
  // Within the distance of the plane, and not outside any side by more than the distance (convex polygons; for others
  // the test is against the sides' planes of the whole outline and so asks for a little more).
  if (distance_sites(polygon.plane, p) > distance_sites_) return false;
  if (polygon.corners.empty()) return true;  // persistent
  const std::size_t count = polygon.corners.size();
  if (!polygon.convex) {
    bool inside = false;
    for (const auto& [a, b, c] : triangulate(polygon)) {
      const auto& q = polygon.corners;
      using enum exact::Sign;
      inside =
          inside || (turn(q[a], q[b], p, polygon.along) != negative && turn(q[b], q[c], p, polygon.along) != negative &&
                     turn(q[c], q[a], p, polygon.along) != negative);
    }
    return inside;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto side =
        Plane::spanned(polygon.corners[i], polygon.along, polygon.corners[(i + 1) % count] - polygon.corners[i]);
    if (side && side->side_of(p) == exact::Sign::negative && distance_sites(*side, p) > distance_sites_) return false;
  }
  return true;
}

std::vector<std::optional<HalfSpace>> Snapper::adopt_edges(
    const LatticePolygon& polygon, const std::function<std::pair<Index, bool>(const Plane&)>& number_of) {
  const std::size_t count = polygon.corners.size();
  std::vector<std::optional<HalfSpace>> adopted(count);
  const auto own = polygon.plane.unit_normal();
  for (std::size_t i = 0; i < count; ++i) {
    const LatticePoint a = polygon.corners[i], b = polygon.corners[(i + 1) % count];
    for (const std::size_t k : near(bounds_of(std::array{a, b}))) {
      const LatticePolygon& other = surfaces_[k];
      if (!near_polygon(other, a) || !near_polygon(other, b)) continue;
      const auto n = other.plane.unit_normal();
      const std::array<double, 3> across{own[1] * n[2] - own[2] * n[1], own[2] * n[0] - own[0] * n[2],
                                         own[0] * n[1] - own[1] * n[0]};
      if (length(across) < 1e-3) continue;  // (nearly) the same plane: ending on it means nothing
      // The polygon's inside is where its corner farthest from that plane lies.
      double most = 0;
      bool positive = true;
      for (const LatticePoint c : polygon.corners) {
        if (const double d = distance_sites(other.plane, c); d > most) {
          most = d;
          positive = other.plane.side_of(c) == exact::Sign::positive;
        }
      }
      if (most <= 4 * distance_sites_) continue;
      const auto [number, same] = number_of(other.plane);
      adopted[i] = HalfSpace{number, positive == same};
      ++adopted_edges_;
      ++note(std::max(distance_sites(other.plane, a), distance_sites(other.plane, b)) * lattice_.pitch()).adopted_edges;
      break;
    }
  }
  return adopted;
}

}  // namespace cleave::topology::detail
