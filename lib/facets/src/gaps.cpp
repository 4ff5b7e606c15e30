#include "cleave/facets/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "cleave/geometry/vec3.hpp"

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

Vec3 as_vec3(const Vec& p) { return {p[0], p[1], p[2]}; }

/// Two points, of one set each, that are as near to each other as any.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 on_first{}, on_second{};
  void take(Vec3 p, Vec3 q) {
    const double d = geometry::norm(p - q);
    if (d < distance) *this = {d, p, q};
  }
};

/// Of p q and r s.
void between_segments(Vec3 p, Vec3 q, Vec3 r, Vec3 s, Nearest& nearest) {
  const Vec3 u = q - p, v = s - r, w = p - r;
  const double a = dot(u, u), b = dot(u, v), c = dot(v, v), d = dot(u, w), e = dot(v, w);
  const auto share = [](double value, double of) { return of > 0 ? std::clamp(value / of, 0.0, 1.0) : 0.0; };
  const double across = a * c - b * b;
  double along = across > 1e-14 * a * c ? share(b * e - c * d, across) : 0;
  double other = share(b * along + e, c);
  along = share(b * other - d, a);
  other = share(b * along + e, c);
  nearest.take(p + along * u, r + other * v);
  // Those that run side by side have no one nearest pair: their ends will do.
  nearest.take(p, r + share(e, c) * v);
  nearest.take(q, r + share(dot(v, q - r), c) * v);
}

/// The corners of a facet, in units; one without corners is its plane, cut by what ends it.
class Outline {
 public:
  Outline(const Prepared& prepared, const Facet& facet)
      : corners_{std::span{prepared.corners}.subspan(facet.first_corner, facet.corner_count)} {
    const exact::Plane& plane = prepared.planes[facet.plane];
    const auto n = plane.unit_normal();
    const auto& a = plane.approx();
    normal_ = {n[0], n[1], n[2]};
    offset_ = size() > 0 ? -dot(normal_, corner(0)) : a[3] / std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  }
  [[nodiscard]] std::size_t size() const { return corners_.size(); }
  [[nodiscard]] Vec3 corner(std::size_t i) const { return as_vec3(corners_[i % corners_.size()]); }
  /// How far from its plane.
  [[nodiscard]] double off(Vec3 p) const { return std::abs(dot(normal_, p) + offset_); }
  /// The foot of p, where that lies inside.
  [[nodiscard]] bool above(Vec3 p, Vec3& foot) const {
    foot = p - (dot(normal_, p) + offset_) * normal_;
    bool left = true, right = true;
    for (std::size_t i = 0; i < size(); ++i) {
      const double turn = dot(normal_, cross(corner(i + 1) - corner(i), foot - corner(i)));
      left = left && turn >= 0;
      right = right && turn <= 0;
    }
    return left || right;
  }

 private:
  std::span<const Vec> corners_;
  Vec3 normal_;
  double offset_ = 0;
};

/// Between a side of the one and the other as a whole.
Nearest to_outline(Vec3 p, Vec3 q, const Outline& other) {
  Nearest nearest;
  Vec3 foot;
  if (other.above(p, foot)) nearest.take(p, foot);
  if (other.above(q, foot)) nearest.take(q, foot);
  for (std::size_t k = 0; k < other.size(); ++k) {
    between_segments(p, q, other.corner(k), other.corner(k + 1), nearest);
  }
  return nearest;
}

}  // namespace

void Gaps::add(const Gaps& other) {
  sides += other.sides;
  endings.insert(endings.end(), other.endings.begin(), other.endings.end());
  if (other.largest > largest ||
      (!(other.largest < largest) && std::pair{other.first, other.second} < std::pair{first, second})) {
    largest = other.largest;
    first = other.first;
    second = other.second;
  }
}

GapFinder::GapFinder(const Prepared& prepared) noexcept : prepared_{prepared}, limit_{0} {
  Vec lo{1, 1, 1}, hi{-1, -1, -1};
  for (const Facet& facet : prepared.facets) {
    if (facet.owner == Owner::joint || facet.owner == Owner::excavation) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], facet.lo[k]);
      hi[k] = std::max(hi[k], facet.hi[k]);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) limit_ = std::max(limit_, near_miss * (hi[k] - lo[k]));
}

void GapFinder::look(Index i, Index j, Gaps& found) const {
  const Facet &f = prepared_.facets[i], &g = prepared_.facets[j];
  const bool of_joint = f.owner == Owner::joint, other_of_joint = g.owner == Owner::joint;
  if (!of_joint && !other_of_joint) return;
  if (f.sheet != none && f.sheet == g.sheet) return;  // pieces of one flat face
  const Outline own{prepared_, f}, other{prepared_, g};
  const auto height = [&](const HalfSpace& edge, Vec3 p) {
    const auto& n = prepared_.planes[edge.plane].approx();
    const double above = n[0] * p.x + n[1] * p.y + n[2] * p.z + n[3];
    return edge.inside_positive ? above : -above;
  };
  const auto edges_of = [&](const Facet& facet) {
    return std::span{prepared_.edges}.subspan(facet.first_edge, facet.edge_count);
  };
  // The part of a side that is left when all that ends the facet has cut, the domain's sides among it.
  const auto left_of_side = [&](const Facet& facet, Vec3& p, Vec3& q) {
    constexpr double rounding = 0x1p-40;
    for (const HalfSpace& edge : edges_of(facet)) {
      const double at_p = height(edge, p), at_q = height(edge, q);
      if (at_p >= -rounding && at_q >= -rounding) continue;
      if (at_p < -rounding && at_q < -rounding) return false;
      const Vec3 between = p + (at_p / (at_p - at_q)) * (q - p);
      (at_p < at_q ? p : q) = between;
    }
    return true;
  };
  const auto there = [&](const Facet& facet, Vec3 p) {
    return std::ranges::all_of(edges_of(facet), [&](const HalfSpace& e) { return height(e, p) >= -2 * limit_; });
  };
  constexpr double touching = 0x1p-46;
  // There is no rock there: corners on a side of the domain are put just beyond it.
  const auto outside = [&](Vec3 p) {
    return std::ranges::any_of(prepared_.clip, [&](const HalfSpace& side) { return height(side, p) < -touching; });
  };
  // Nor behind the face of a solid: what ends there has reached it.
  const auto has_reached = [&](const Facet& face, Vec3 p) {
    if (face.owner != Owner::excavation && face.owner != Owner::domain) return false;
    const bool rock_is_positive = face.outward_positive == (face.owner == Owner::excavation);
    return height({face.plane, rock_is_positive}, p) < -touching;
  };
  std::uint64_t sides = 0;
  Nearest nearest;
  const auto look_from = [&](const Outline& from, const Facet& its, const Outline& to, const Facet& beyond) {
    bool any = false;
    for (std::size_t k = 0; k < from.size(); ++k) {
      Vec3 p = from.corner(k), q = from.corner(k + 1);
      if (!left_of_side(its, p, q)) continue;
      const Nearest own_nearest = to_outline(p, q, to);
      if (own_nearest.distance > limit_) continue;
      if (!there(beyond, own_nearest.on_second) || outside(own_nearest.on_first)) continue;
      if (has_reached(beyond, own_nearest.on_first)) continue;
      if (own_nearest.distance < nearest.distance) nearest = own_nearest;
      any = true;
      const double off = std::max(to.off(p), to.off(q));
      if (beyond.owner == Owner::joint && std::max(off, own_nearest.distance) <= prepared_.roundings * 0x1p-48) {
        found.endings.push_back({its.owner_index, beyond.owner_index});
      }
      // A side that only starts near is not the one that misses.
      if (std::max(to_outline(p, p, to).distance, to_outline(q, q, to).distance) <= limit_) ++sides;
    }
    return any;
  };
  const bool from_own = of_joint && !f.rim_shared && look_from(own, f, other, g);
  const std::uint64_t sides_of_own = sides;
  const bool from_other = sides_of_own == 0 && other_of_joint && !g.rim_shared && look_from(other, g, own, f);
  if ((!from_own && !from_other) || (f.plane == g.plane && nearest.distance < touching)) return;
  found.add({std::max<std::uint64_t>(sides, 1), nearest.distance, std::min(i, j), std::max(i, j), {}});
}

}  // namespace cleave::topology::detail
