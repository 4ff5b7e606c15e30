#include "detail/snapping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "detail/as_vec3.hpp"
#include "detail/folds.hpp"
#include "detail/side_users.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

double length(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
double sine(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return length({a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]});
}

/// Whether what lies left of a -> b in the plane with this normal is on the plane's positive side, which goes through
/// both.
bool to_the_left(const std::array<double, 3>& normal, LatticePoint a, LatticePoint b, const Plane& plane) {
  const Vec3 side{static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y), static_cast<double>(b.z - a.z)};
  const auto n = plane.unit_normal();
  return geometry::dot(geometry::cross({normal[0], normal[1], normal[2]}, side), {n[0], n[1], n[2]}) > 0;
}

/// Puts planes in an order of their own.
auto key_of(const Plane& plane) { return std::tuple{plane.normal(), plane.offset().words}; }

/// Largest first, then by corners: whatever the order they came in.
std::vector<std::size_t> ranked(std::span<const JointPolygon> polygons) {
  struct Key {
    double size;
    std::vector<LatticePoint> corners;
  };
  std::vector<Key> keys;
  for (const JointPolygon& entry : polygons) {
    Key key{0, entry.corners};
    std::ranges::sort(key.corners);
    for (const LatticePoint c : key.corners) key.size = std::max(key.size, distance(c, key.corners.front()));
    keys.push_back(std::move(key));
  }
  std::vector<std::size_t> order(polygons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return keys[a].size > keys[b].size || (!(keys[b].size > keys[a].size) && keys[a].corners < keys[b].corners);
  });
  return order;
}

/// A side shared with a polygon outside the group must lie on the group's plane; those of the group whose sides do not
/// are left out, until all that are left can have the plane without opening what is closed.
void leave_out(std::vector<std::size_t>& group, std::span<const JointPolygon> polygons, const SideUsers& users,
               const SharedCorners& shared, const Plane& plane) {
  const auto comes_off = [&](std::size_t k) {
    bool off = false;
    SideUsers::for_each_side(polygons[k], [&](LatticePoint a, LatticePoint b) {
      if (off || !shared.shared(a, b)) return;
      if (plane.side_of(a) == Sign::zero && plane.side_of(b) == Sign::zero) return;
      const auto all = users.of(a, b);
      std::size_t others = 0;
      for (const auto& [side, user] : all) {
        others += user != k ? 1 : 0;
        off = off || !std::ranges::binary_search(group, user);
      }
      off = off || others == 0;  // a closed surface has it
    });
    return off;
  };
  for (bool again = true; again;) {
    std::vector<std::size_t> kept;
    std::ranges::copy_if(group, std::back_inserter(kept), [&](std::size_t k) { return !comes_off(k); });
    again = kept.size() < group.size();
    group = std::move(kept);
  }
}

}  // namespace

Snapper::Snapper(const exact::Lattice& lattice, double distance_m)
    : lattice_{lattice},
      distance_{distance_m},
      distance_sites_{distance_m / lattice.pitch()},
      weld_{distance_m / lattice.pitch()} {}

void Snapper::add_corner(geometry::Vec3 p, bool of_solid) {
  if (active()) weld_.add(lattice_.snap(p.x, p.y, p.z), of_solid);
}

LatticePoint Snapper::site(geometry::Vec3 p, Index joint) {
  LatticePoint site = lattice_.snap(p.x, p.y, p.z);
  if (active()) {
    const LatticePoint welded = weld_(site);
    if (welded != site && joint != none) note(joint, distance(welded, site) * lattice_.pitch());
    site = welded;
  }
  const auto [x, y, z] = lattice_.position(site);
  largest_move_ = std::max({largest_move_, std::abs(x - p.x), std::abs(y - p.y), std::abs(z - p.z)});
  return site;
}

void Snapper::compare(std::span<const geometry::Vec3> corners, Index joint) {
  if (!active()) return;
  bool any = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const geometry::Vec3 p = corners[i], q = corners[(i + 1) % corners.size()];
    const double side = geometry::norm(q - p);
    if (side >= 2 * distance_ || lattice_.snap(p.x, p.y, p.z) == lattice_.snap(q.x, q.y, q.z)) continue;
    if (coarse_.polygons == 0 || side < coarse_.shortest.si()) {
      coarse_.shortest = metres(side);
      coarse_.joint = JointId{joint};
    }
    any = true;
  }
  if (any) ++coarse_.polygons;
}

SnappedJoint& Snapper::note(Index joint, double moved_m) {
  largest_move_ = std::max(largest_move_, moved_m);
  SnappedJoint& entry = changed_.try_emplace(joint, SnappedJoint{JointId{joint}, metres(0), false, 0}).first->second;
  entry.moved = std::max(entry.moved, metres(moved_m));
  return entry;
}

std::vector<SnappedJoint> Snapper::changed() const {
  std::vector<SnappedJoint> all;
  for (const auto& [joint, entry] : changed_) all.push_back(entry);
  return all;
}

void Snapper::remember(const LatticePolygon& polygon, bool reached_by_corners) {
  if (!active()) return;
  if (reached_by_corners) by_corners_.push_back(surfaces_.size());
  surfaces_.push_back(polygon);
}

void Snapper::remember(const Plane& persistent) {
  // No corners: it goes on for ever.
  if (!active()) return;
  persistent_.push_back(surfaces_.size());
  surfaces_.push_back({persistent, direction_along(persistent), {}, true, true});
}

geometry::Box Snapper::bounds_of(std::span<const LatticePoint> corners) const {
  return box_of(corners, distance_sites_ + 1);
}

void Snapper::index(std::span<const JointPolygon> polygons) {
  tree_.reset();
  boxed_.clear();
  boxes_.clear();
  const auto add = [&](std::size_t number, const LatticePolygon& polygon) {
    boxed_.push_back(number);
    boxes_.push_back(bounds_of(polygon.corners));
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (!surfaces_[k].corners.empty()) add(k, surfaces_[k]);
  }
  for (std::size_t k = 0; k < polygons.size(); ++k) add(surfaces_.size() + k, polygons[k].polygon);
  tree_ = std::make_unique<geometry::BoxTree>(boxes_);
}

std::vector<std::size_t> Snapper::near(const geometry::Box& box) const {
  std::vector<std::size_t> found = persistent_;
  tree_->overlapping(box, [&](std::uint32_t k) { found.push_back(boxed_[k]); });
  std::ranges::sort(found);
  return found;
}

bool Snapper::near_plane(const LatticePolygon& polygon, const Plane& plane) const {
  return std::ranges::all_of(polygon.corners,
                             [&](LatticePoint c) { return distance_sites(plane, c) <= distance_sites_; });
}

/// The polygons not yet on a plane that can be reached from the leader over polygons near its plane; ascending.
std::vector<std::size_t> Snapper::group_about(std::span<const JointPolygon> polygons, std::size_t leader,
                                              const std::vector<std::uint8_t>& taken) const {
  const std::size_t first = surfaces_.size();
  const Plane& plane = surface(polygons, leader).plane;
  std::vector<std::size_t> group;
  std::vector<std::uint8_t> seen(polygons.size(), 0);
  const auto reach = [&](std::size_t k) {
    if (k < first || seen[k - first] != 0 || taken[k - first] != 0) return;
    seen[k - first] = 1;
    if (near_plane(polygons[k - first].polygon, plane)) group.push_back(k - first);
  };
  if (leader >= first) {
    reach(leader);
  } else if (surfaces_[leader].corners.empty()) {
    for (std::size_t k = 0; k < polygons.size(); ++k) reach(first + k);
  } else {
    for (const std::size_t k : near(bounds_of(surfaces_[leader].corners))) reach(k);
  }
  for (std::size_t at = 0; at < group.size(); ++at) {
    for (const std::size_t k : near(bounds_of(polygons[group[at]].polygon.corners))) reach(k);
  }
  std::ranges::sort(group);
  return group;
}

void Snapper::take_plane(JointPolygon& entry, const LatticePolygon& leader) {
  LatticePolygon& polygon = entry.polygon;
  if (leader.plane.coincides_with(polygon.plane)) return;
  double furthest = 0;
  for (const LatticePoint c : polygon.corners) furthest = std::max(furthest, distance_sites(leader.plane, c));
  const auto a = leader.plane.unit_normal(), b = polygon.plane.unit_normal();
  const bool same = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0;
  polygon.plane = same ? leader.plane : leader.plane.flipped();
  polygon.along = same ? leader.along : LatticePoint{} - leader.along;
  polygon.exactly_planar = false;
  ++merged_planes_;
  note(entry.joint, furthest * lattice_.pitch()).plane_merged = true;
}

void Snapper::merge_planes(std::vector<JointPolygon>& polygons, const SharedCorners& shared) {
  index(polygons);
  const SideUsers users{polygons, shared};
  std::vector<std::uint8_t> taken(polygons.size(), 0);
  const std::size_t first = surfaces_.size();
  std::ranges::sort(persistent_, [&](std::size_t a, std::size_t b) {
    return key_of(surfaces_[a].plane) < key_of(surfaces_[b].plane);
  });
  std::vector<std::size_t> leaders;  // solids, persistent joints, then polygons
  for (std::size_t k = 0; k < first; ++k) {
    if (!surfaces_[k].corners.empty()) leaders.push_back(k);
  }
  leaders.insert(leaders.end(), persistent_.begin(), persistent_.end());
  for (const std::size_t k : ranked(polygons)) leaders.push_back(first + k);
  for (const std::size_t leader : leaders) {
    if (leader >= first && taken[leader - first] != 0) continue;
    auto group = group_about(polygons, leader, taken);
    const LatticePolygon plane = surface(polygons, leader);
    leave_out(group, polygons, users, shared, plane.plane);
    // The plane is the leader's: without it there is nothing to take.
    if (leader >= first && !std::ranges::binary_search(group, leader - first)) continue;
    for (const std::size_t k : group) {
      taken[k] = 1;
      take_plane(polygons[k], plane);
    }
  }
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
      inside = inside || (orient2d(q[a], q[b], p, polygon.along) != negative &&
                          orient2d(q[b], q[c], p, polygon.along) != negative &&
                          orient2d(q[c], q[a], p, polygon.along) != negative);
    }
    return inside;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto side =
        Plane::spanned(polygon.corners[i], polygon.along, polygon.corners[(i + 1) % count] - polygon.corners[i]);
    if (side && side->side_of(p) == Sign::negative && distance_sites(*side, p) > distance_sites_) return false;
  }
  return true;
}

std::vector<std::optional<HalfSpace>> Snapper::adopt_edges(
    std::span<const JointPolygon> polygons, std::size_t which, const SharedCorners& shared,
    const std::function<std::pair<Index, bool>(const Plane&)>& number_of) {
  const LatticePolygon& polygon = polygons[which].polygon;
  const std::size_t count = polygon.corners.size();
  std::vector<std::optional<HalfSpace>> adopted(count);
  const auto own = polygon.plane.unit_normal();
  for (std::size_t i = 0; i < count; ++i) {
    const LatticePoint a = polygon.corners[i], b = polygon.corners[(i + 1) % count];
    if (shared.shared(a) && shared.shared(b)) continue;  // it goes through, with its neighbours, or ends on them
    const LatticePolygon* nearest = nullptr;
    double least = 0, most = 0;
    bool positive = true;
    for (const std::size_t k : near(bounds_of(std::array{a, b}))) {
      if (k == which + surfaces_.size()) continue;
      const LatticePolygon& other = surface(polygons, k);
      if (k >= surfaces_.size() && polygons[k - surfaces_.size()].folded) continue;
      if (!near_polygon(other, a) || !near_polygon(other, b)) continue;
      // Where a polygon goes round a corner of an opening, its pieces would end on two walls with a slit between them.
      if (!polygon.convex && std::ranges::binary_search(by_corners_, k)) continue;
      if (sine(own, other.plane.unit_normal()) < 1e-3) continue;  // the same plane: ending on it means nothing
      const double off = std::max(distance_sites(other.plane, a), distance_sites(other.plane, b));
      if (nearest != nullptr && (off > least || (!(off < least) && key_of(nearest->plane) <= key_of(other.plane))))
        continue;
      // The inside of a convex polygon is where its corner farthest from that plane lies; of others what is left of the
      // side.
      double farthest = 0;
      bool side = true;
      for (const LatticePoint c : polygon.corners) {
        if (const double d = distance_sites(other.plane, c); d > farthest) {
          farthest = d;
          side = other.plane.side_of(c) == Sign::positive;
        }
      }
      if (!polygon.convex) side = to_the_left(own, a, b, other.plane);
      if (farthest <= 4 * distance_sites_) continue;
      nearest = &other;
      least = off;
      most = farthest;
      positive = side;
    }
    if (nearest == nullptr || most <= 0) continue;
    const auto [number, same] = number_of(nearest->plane);
    adopted[i] = HalfSpace{number, positive == same};
    ++adopted_edges_;
    ++note(polygons[which].joint, least * lattice_.pitch()).adopted_edges;
  }
  return adopted;
}

Moves Snapper::moves_through(std::span<const JointPolygon> polygons, const SharedCorners& shared) {
  index(polygons);
  std::vector<std::pair<LatticePoint, std::size_t>> users;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    for (const LatticePoint c : polygons[k].corners) {
      if (shared.shared(c) || polygons[k].folded) users.emplace_back(c, k);
    }
  }
  std::ranges::sort(users);
  Moves moves;
  for (std::size_t begin = 0, end = 0; begin < users.size(); begin = end) {
    const LatticePoint corner = users[begin].first;
    while (end < users.size() && users[end].first == corner) ++end;
    const auto own = std::span{users}.subspan(begin, end - begin);
    LatticePoint to = corner;
    for (const std::size_t k : near(bounds_of(std::array{corner}))) {
      const LatticePolygon& other = surface(polygons, k);
      if (std::ranges::find(other.corners, corner) != other.corners.end() || !near_polygon(other, corner)) continue;
      // All on one side of it, and not along it.
      bool above = true, below = true;
      for (const auto& [site, user] : own) {
        double highest = 0, lowest = 0;
        for (const LatticePoint c : polygons[user].corners) {
          const double h = distance_sites(other.plane, c) * (other.plane.side_of(c) == Sign::negative ? -1 : 1);
          highest = std::max(highest, h);
          lowest = std::min(lowest, h);
        }
        above = above && highest > 4 * distance_sites_ && -lowest <= distance_sites_;
        below = below && -lowest > 4 * distance_sites_ && highest <= distance_sites_;
      }
      if (above == below) continue;
      const auto n = other.plane.unit_normal();
      const double h = distance_sites(other.plane, corner) * (other.plane.side_of(corner) == Sign::negative ? -1 : 1);
      const double beyond = 16 + (k >= surfaces_.size() ? polygons[k - surfaces_.size()].bend : 0);  // sites
      const double by = above ? -std::max(h + beyond, 0.0) : std::max(beyond - h, 0.0);
      const auto moved = [&](std::int64_t x, double c) { return x + static_cast<std::int64_t>(std::llround(c * by)); };
      to = {moved(to.x, n[0]), moved(to.y, n[1]), moved(to.z, n[2])};
    }
    if (to == corner) continue;
    moves.add(corner, to);
    for (const auto& [site, user] : own) note(polygons[user].joint, distance(corner, to) * lattice_.pitch());
  }
  moves.finish();
  return moves;
}

}  // namespace cleave::topology::detail
