#include "detail/overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/vec2.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using geometry::Vec3;

/// A polygon in doubles: good to a fraction of a site.
struct Flat {
  std::vector<Vec3> corners;
  Vec3 normal, middle;  ///< unit normal; none where there is no area
  [[nodiscard]] double off(Vec3 p) const { return std::abs(dot(normal, p - middle)); }
};

Flat flat_of(const JointPolygon& entry) {
  Flat flat{};
  for (const LatticePoint c : entry.corners) flat.corners.push_back(as_vec3(c));
  const Vec3 first = flat.corners.front();
  Vec3 area{}, sum{};
  for (std::size_t i = 0; i < flat.corners.size(); ++i) {
    sum += flat.corners[i] - first;
    if (i + 1 < flat.corners.size()) area += cross(flat.corners[i] - first, flat.corners[i + 1] - first);
  }
  flat.middle = first + sum / static_cast<double>(flat.corners.size());
  const double size = geometry::norm(area);
  if (size > 0) flat.normal = area / size;
  return flat;
}

/// Where the boundary of one polygon runs through the inside of another, seen along the other's normal.
class Inside {
 public:
  Inside(const Flat& of, double within) : of_{of}, within_{within} {
    const Vec3 n = of.normal, helper = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    u_ = geometry::normalized(cross(n, helper));
    v_ = cross(n, u_);
    for (const Vec3& c : of.corners) ring_.push_back(seen(c));
  }

  struct Found {
    bool runs = false;          ///< some of it is inside, farther than the distance from the rim
    bool leaves_plane = false;  ///< and somewhere off the plane by more
  };
  [[nodiscard]] Found boundary_of(const Flat& other) const {
    Found found;
    for (std::size_t i = 0; i < other.corners.size() && !found.leaves_plane; ++i) {
      look_along(other.corners[i], other.corners[(i + 1) % other.corners.size()], found);
    }
    return found;
  }

 private:
  [[nodiscard]] Vec2 seen(Vec3 p) const { return {dot(u_, p - of_.middle), dot(v_, p - of_.middle)}; }
  static double twice_area(Vec2 a, Vec2 b, Vec2 c) { return cross(b - a, c - a); }

  void look_along(Vec3 from, Vec3 to, Found& found) const {
    const Vec2 a = seen(from), b = seen(to);
    std::vector<double> at{0, 1};
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Vec2 p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      const double of_p = twice_area(a, b, p), of_q = twice_area(a, b, q);
      if ((of_p > 0) == (of_q > 0)) continue;
      const double of_a = twice_area(p, q, a), of_b = twice_area(p, q, b);
      if ((of_a > 0) != (of_b > 0)) at.push_back(of_a / (of_a - of_b));
    }
    std::ranges::sort(at);
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      const double middle = (at[k] + at[k + 1]) / 2;
      if (!inside(along(a, b, middle))) continue;
      const bool deep = std::ranges::any_of(std::array{at[k], middle, at[k + 1]},
                                            [&](double t) { return from_rim(along(a, b, t)) > within_; });
      if (!deep) continue;
      found.runs = true;
      const auto off = [&](double t) { return of_.off(from + t * (to - from)); };
      found.leaves_plane = found.leaves_plane || off(at[k]) > within_ || off(at[k + 1]) > within_;
    }
  }
  static Vec2 along(Vec2 a, Vec2 b, double t) { return a + t * (b - a); }
  [[nodiscard]] bool inside(Vec2 c) const {
    bool in = false;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Vec2 p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      if ((p.y > c.y) == (q.y > c.y)) continue;
      in ^= c.x < p.x + (c.y - p.y) / (q.y - p.y) * (q.x - p.x);
    }
    return in;
  }
  [[nodiscard]] double from_rim(Vec2 c) const {
    double least = INFINITY;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Vec2 p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      const Vec2 side = q - p;
      const double square = dot(side, side);
      const double t = square > 0 ? std::clamp(dot(c - p, side) / square, 0.0, 1.0) : 0.0;
      least = std::min(least, std::hypot(c.x - p.x - t * side.x, c.y - p.y - t * side.y));
    }
    return least;
  }

  const Flat& of_;
  double within_;
  Vec3 u_, v_;
  std::vector<Vec2> ring_;
};

bool lie_on_one_another(const Flat& a, const Flat& b, double within) {
  if (std::abs(dot(a.normal, b.normal)) < 0.5) return false;  // also those without area
  const auto of_b = Inside{a, within}.boundary_of(b);
  if (of_b.leaves_plane) return false;
  const auto of_a = Inside{b, within}.boundary_of(a);
  return !of_a.leaves_plane && (of_a.runs || of_b.runs);
}

double component(Vec3 v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
std::size_t axis_of(Vec3 normal) {
  std::size_t axis = 0;
  for (const std::size_t k : {1U, 2U}) {
    if (std::abs(component(normal, k)) > std::abs(component(normal, axis))) axis = k;
  }
  return axis;
}

/// How a polygon lies, roughly: enough to tell most pairs apart.
struct Tilt {
  Vec3 normal{}, corner{};
  double size = 0;           ///< no corner is farther from that one
  double unsure = INFINITY;  ///< what roundings of its corners may turn it by, generously
};
Tilt tilt_of(std::span<const LatticePoint> corners, const geometry::Box& box, double within) {
  const std::size_t third = corners.size() / 3;
  const Vec3 a = as_vec3(corners[0]), u = as_vec3(corners[third]) - a, v = as_vec3(corners[2 * third]) - a;
  const Vec3 area = cross(u, v);
  const double size = geometry::norm(area), square = std::max(dot(u, u), dot(v, v));
  if (!(size > 0x1p-20 * square)) return {};
  return {area / size, a, geometry::norm(box.size()), 64 * within * std::sqrt(square) / size};
}
bool may_share_plane(const Tilt& a, const Tilt& b, double within) {
  const double unsure = a.unsure + b.unsure;
  if (!(unsure < 0.1)) return true;
  const Vec3 sine = cross(a.normal, b.normal);
  return dot(sine, sine) <= unsure * unsure &&
         std::abs(dot(a.normal, b.corner - a.corner)) <= 4 * within + unsure * (a.size + b.size);
}

/// Exactly on one plane of the lattice: nothing comes between them.
bool exactly_flat(std::span<const JointPolygon> polygons, std::span<const std::size_t> group) {
  const auto first = make_lattice_polygon(polygons[group.front()].corners);
  return first && std::ranges::all_of(group, [&](std::size_t k) {
           return std::ranges::all_of(polygons[k].corners,
                                      [&](LatticePoint c) { return first->plane.side_of(c) == exact::Sign::zero; });
         });
}

/// Finds them pair by pair.
class Search {
 public:
  Search(std::span<const JointPolygon> polygons, const SharedCorners& shared, double within)
      : polygons_{polygons}, shared_{shared}, within_{within}, sets_{polygons.size()}, flats_(polygons.size()) {
    // Of those given several times the first stands for all.
    std::vector<geometry::Box> boxes;
    for (std::size_t k = 0; k < polygons.size(); ++k) {
      const JointPolygon& entry = polygons[k];
      if (!entry.holes.empty() || first_of(k) != k) continue;
      looked_at_.push_back(k);
      boxes.push_back(box_of(entry.corners, within + 1));
      tilts_.push_back(tilt_of(entry.corners, boxes.back(), within));
    }
    const geometry::BoxTree tree{boxes};
    for (std::size_t i = 0; i < looked_at_.size(); ++i) {
      tree.overlapping(boxes[i], [&](std::uint32_t j) {
        if (j > i && may_share_plane(tilts_[i], tilts_[j], within)) look(looked_at_[i], looked_at_[j]);
      });
    }
  }

  [[nodiscard]] std::vector<Overlapping> groups() {
    std::map<std::size_t, Overlapping> groups;
    for (std::size_t k = 0; any_ && k < polygons_.size(); ++k) {
      if (polygons_[k].holes.empty()) groups[sets_.find(first_of(k))].polygons.push_back(k);
    }
    std::vector<Overlapping> out;
    for (auto& [set, group] : groups) {
      const auto& own = group.polygons;
      if (std::ranges::all_of(own, [&](std::size_t k) { return first_of(k) == set; })) continue;
      group.axis = axis_of(flat(set).normal);
      const auto steep = [&](std::size_t k) { return std::abs(component(flat(first_of(k)).normal, group.axis)) < 0.2; };
      if (std::ranges::any_of(own, steep) || exactly_flat(polygons_, own)) continue;
      out.push_back(std::move(group));
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t first_of(std::size_t k) const { return shared_.first_like(static_cast<Index>(k)); }
  const Flat& flat(std::size_t k) {
    if (!flats_[k]) flats_[k] = std::make_unique<Flat>(flat_of(polygons_[k]));
    return *flats_[k];
  }
  void look(std::size_t a, std::size_t b) {
    if (sets_.find(a) == sets_.find(b)) return;
    if (!lie_on_one_another(flat(a), flat(b), within_)) return;
    sets_.join(a, b);
    any_ = true;
  }

  std::span<const JointPolygon> polygons_;
  const SharedCorners& shared_;
  double within_;
  DisjointSets<std::size_t> sets_;
  std::vector<std::unique_ptr<Flat>> flats_;
  std::vector<std::size_t> looked_at_;
  std::vector<Tilt> tilts_;
  bool any_ = false;
};

}  // namespace

std::vector<Overlapping> find_overlaps(std::span<const JointPolygon> polygons, const SharedCorners& shared,
                                       double within) {
  if (polygons.size() < 2) return {};
  return Search{polygons, shared, within}.groups();
}

}  // namespace cleave::topology::detail
