#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "discretisation.hpp"

namespace cleave::flow {
namespace {

using geometry::Vec3;
using Triangle = std::array<Index, 3>;

/// Which sides are split at their middles: with a triangle's side always its longest one.
class Splitting {
 public:
  explicit Splitting(const Mesh& mesh) : mesh_{mesh}, sides_{mesh}, middle_(sides_.count(), none) {
    length_.reserve(sides_.count());
    for (Index s = 0; s < sides_.count(); ++s) {
      const auto [a, b] = sides_.ends(s);
      length_.push_back(geometry::norm(mesh.points[b] - mesh.points[a]));
    }
  }

  void mark(Index triangle) { split(longest(triangle)); }
  void close() {
    while (!open_.empty()) {
      const Index side = open_.back();
      open_.pop_back();
      for (const Index t : sides_.triangles(side)) split(longest(t));
    }
  }
  /// Gives the middles numbers, in the order of the sides, behind those of the points.
  void number(std::vector<Vec3>& points) {
    for (Index s = 0; s < sides_.count(); ++s) {
      if (middle_[s] == none) continue;
      const auto [a, b] = sides_.ends(s);
      middle_[s] = static_cast<Index>(points.size());
      points.push_back(0.5 * (points[a] + points[b]));
    }
  }
  [[nodiscard]] const Sides& sides() const noexcept { return sides_; }
  [[nodiscard]] Index middle(Index side) const { return middle_[side]; }

  /// The parts of a triangle.
  template <class Visit>
  void parts(Index t, const Visit& visit) const {
    const Triangle corners = mesh_.triangles[t];
    const auto& own = sides_.of(t);
    if (std::ranges::all_of(own, [&](Index s) { return middle_[s] == none; })) return visit(corners);
    std::size_t k = 0;  // the corner across from the longest side
    while (own[k] != longest(t)) ++k;
    const Index c = corners[k], a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
    const Index m = middle_[own[k]], of_ca = middle_[own[(k + 2) % 3]], of_bc = middle_[own[(k + 1) % 3]];
    halves({m, c, a}, of_ca, visit);
    halves({m, b, c}, of_bc, visit);
  }

 private:
  /// A triangle with a point on the side across from its first corner, or none.
  template <class Visit>
  static void halves(Triangle t, Index middle, const Visit& visit) {
    if (middle == none) return visit(t);
    visit(Triangle{t[0], t[1], middle});
    visit(Triangle{t[0], middle, t[2]});
  }
  [[nodiscard]] Index longest(Index triangle) const {
    const auto& own = sides_.of(triangle);
    return std::ranges::max(own, {}, [&](Index s) { return std::pair{length_[s], s}; });
  }
  void split(Index side) {
    if (middle_[side] != none) return;
    middle_[side] = 0;
    open_.push_back(side);
  }

  const Mesh& mesh_;
  Sides sides_;
  std::vector<double> length_;
  std::vector<Index> middle_;
  std::vector<Index> open_;
};

}  // namespace

void refine(Mesh& mesh, const std::vector<std::uint8_t>& marked, std::vector<std::uint8_t>& states) {
  Splitting splitting{mesh};
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (marked[t] != 0) splitting.mark(t);
  }
  splitting.close();
  std::vector<Vec3> points = mesh.points;
  splitting.number(points);
  Mesh fine{.points = std::move(points)};
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    splitting.parts(t, [&](const Triangle& corners) {
      fine.triangles.push_back(corners);
      fine.part.push_back(mesh.part[t]);
    });
  }
  std::vector<std::uint8_t> handed_down;
  for (std::size_t k = 0; k < mesh.borders.size(); ++k) {
    const Border& border = mesh.borders[k];
    const auto [a, b] = border.ends;
    const Index m = splitting.middle(*splitting.sides().find(a, b));
    if (m == none) {
      fine.borders.push_back(border);
      handed_down.push_back(states[k]);
      continue;
    }
    for (const Index end : {a, b}) {
      fine.borders.push_back({{end, m}, border.surface});
      handed_down.push_back(states[k]);
    }
  }
  mesh = std::move(fine);
  states = std::move(handed_down);
}

void split_at_levels(Mesh& mesh, std::span<const Surface> surfaces) {
  // Where each such side is cut; a triangle with two of them is cut twice.
  std::map<std::array<Index, 2>, Index> cuts;
  std::vector<Border> borders;
  for (const Border& border : mesh.borders) {
    const auto* standing = std::get_if<Standing>(&surfaces[border.surface]);
    const auto [a, b] = border.ends;
    const double lo = mesh.points[a].z, hi = mesh.points[b].z;
    const double level = standing != nullptr ? standing->level.si() : 0;
    if (standing == nullptr || !((lo < level && level < hi) || (hi < level && level < lo))) {
      borders.push_back(border);
      continue;
    }
    const double share = (level - lo) / (hi - lo);
    Vec3 at = mesh.points[a] + share * (mesh.points[b] - mesh.points[a]);
    at.z = level;
    const Index m = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(at);
    cuts[{std::min(a, b), std::max(a, b)}] = m;
    borders.push_back({{a, m}, border.surface});
    borders.push_back({{m, b}, border.surface});
  }
  mesh.borders = std::move(borders);
  if (cuts.empty()) return;
  std::vector<Triangle> triangles;
  std::vector<Index> part;
  std::vector<std::pair<Triangle, Index>> open;
  for (Index t = 0; t < mesh.triangles.size(); ++t) open.emplace_back(mesh.triangles[t], mesh.part[t]);
  std::ranges::reverse(open);
  while (!open.empty()) {
    const auto [corners, own] = open.back();
    open.pop_back();
    bool cut = false;
    for (std::size_t k = 0; k < 3 && !cut; ++k) {
      const Index a = corners[k], b = corners[(k + 1) % 3], c = corners[(k + 2) % 3];
      const auto found = cuts.find({std::min(a, b), std::max(a, b)});
      if (found == cuts.end()) continue;
      open.push_back({{found->second, b, c}, own});
      open.push_back({{a, found->second, c}, own});
      cut = true;
    }
    if (cut) continue;
    triangles.push_back(corners);
    part.push_back(own);
  }
  mesh.triangles = std::move(triangles);
  mesh.part = std::move(part);
}

namespace {

/// Two triangles of one part on a side that nothing else is on.
class Flipper {
 public:
  explicit Flipper(Mesh& mesh) : mesh_{mesh}, changed_(mesh.triangles.size(), 1) {
    for (const Border& border : mesh.borders)
      fixed_.push_back({std::min(border.ends[0], border.ends[1]), std::max(border.ends[0], border.ends[1])});
    std::ranges::sort(fixed_);
  }

  /// Passes over all sides until none is turned; each makes the sum of angles across better, so there is an end.
  void run() {
    constexpr int most = 50;
    for (int pass = 0; pass < most && turned_in_pass() > 0; ++pass) continue;
  }

 private:
  std::size_t turned_in_pass() {
    const Sides sides{mesh_};
    std::vector<std::uint8_t> touched(mesh_.triangles.size(), 0);  // in this pass
    std::size_t turned = 0;
    for (Index s = 0; s < sides.count(); ++s) {
      const auto around = sides.triangles(s);
      if (around.size() != 2 || mesh_.part[around[0]] != mesh_.part[around[1]]) continue;
      if (changed_[around[0]] == 0 && changed_[around[1]] == 0) continue;  // it was looked at
      if (touched[around[0]] != 0 || touched[around[1]] != 0) continue;
      if (std::ranges::binary_search(fixed_, sides.ends(s))) continue;
      if (!turn(around[0], around[1], sides.ends(s))) continue;
      touched[around[0]] = touched[around[1]] = 1;
      ++turned;
    }
    changed_ = std::move(touched);
    return turned;
  }

  bool turn(Index one, Index other, std::array<Index, 2> ends) {
    const Triangle t = from_side(mesh_.triangles[one], ends), u = from_side(mesh_.triangles[other], ends);
    if (t[0] != u[1] || t[1] != u[0]) return false;  // they do not turn the same way round
    const Vec3 a = mesh_.points[t[0]], b = mesh_.points[t[1]], c = mesh_.points[t[2]], d = mesh_.points[u[2]];
    const Vec3 up = geometry::cross(b - a, c - a);
    // Cotangents of the angles across: their sum is below 0 where they add up to more than half a turn.
    const double of_c = geometry::dot(a - c, b - c), of_d = geometry::dot(a - d, b - d);
    const double area_c = geometry::norm(up), area_d = geometry::norm(geometry::cross(b - d, a - d));
    if (!(of_c * area_d + of_d * area_c < -1e-9 * area_c * area_d)) return false;
    // Both new ones must turn the same way, by far.
    const double scale = 1e-9 * (area_c + area_d) * geometry::norm(up);
    if (geometry::dot(geometry::cross(d - a, c - a), up) <= scale) return false;
    if (geometry::dot(geometry::cross(b - d, c - d), up) <= scale) return false;
    mesh_.triangles[one] = {t[0], u[2], t[2]};
    mesh_.triangles[other] = {u[2], t[1], t[2]};
    return true;
  }
  /// Turned round so that it begins with the side.
  static Triangle from_side(Triangle t, std::array<Index, 2> ends) {
    while (std::ranges::find(ends, t[2]) != ends.end()) t = {t[1], t[2], t[0]};
    return t;
  }

  Mesh& mesh_;
  std::vector<std::array<Index, 2>> fixed_;
  std::vector<std::uint8_t> changed_;  ///< of triangles: since their sides were looked at
};

}  // namespace

void flip_sides(Mesh& mesh) { Flipper{mesh}.run(); }

}  // namespace cleave::flow
