#pragma once

/// Assemblies written down by hand: sections in the plane of x and z (1 m thick), and single blocks in space.

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/assembly/assembly.hpp"

namespace cleave::assembly::test {

using geometry::Vec3;

inline double rad(double degrees) { return degrees * std::numbers::pi / 180; }
inline double tan_deg(double degrees) { return std::tan(rad(degrees)); }
inline double sin_deg(double degrees) { return std::sin(rad(degrees)); }
inline double cos_deg(double degrees) { return std::cos(rad(degrees)); }

struct P2 {
  double x, z;
};
inline constexpr std::optional<std::uint32_t> rock{};
inline constexpr double infinite = std::numeric_limits<double>::infinity();

class Builder {
 public:
  explicit Builder(Freedom freedom) { spec.freedom = freedom; }
  std::uint32_t block(Vec3 force, double mass) {
    spec.bodies.push_back({.centroid = {}, .force = force, .moment = {}, .mass = mass});
    return static_cast<std::uint32_t>(spec.bodies.size() - 1);
  }
  /// Polygon counter-clockwise in x, z; force = `g` times its area times `weight`.
  std::uint32_t polygon(const std::vector<P2>& p, double weight = 1, P2 g = {0, -1}) {
    double area = 0, cx = 0, cz = 0, inertia = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const P2 a = p[k], b = p[(k + 1) % p.size()];
      const double q = a.x * b.z - b.x * a.z;
      area += q / 2;
      cx += (a.x + b.x) * q;
      cz += (a.z + b.z) * q;
      inertia += q * (a.x * a.x + a.x * b.x + b.x * b.x + a.z * a.z + a.z * b.z + b.z * b.z) / 12;
    }
    cx /= 6 * area;
    cz /= 6 * area;
    inertia -= area * (cx * cx + cz * cz);
    const double m = area * weight, j = inertia * weight;
    spec.bodies.push_back({.centroid = {cx, 0, cz},
                           .force = {m * g.x, 0, m * g.z},
                           .moment = {},
                           .mass = m,
                           .inertia = {j, j, j, 0, 0, 0}});
    return static_cast<std::uint32_t>(spec.bodies.size() - 1);
  }
  /// `normal` into `body`.
  Contact& contact(std::uint32_t body, std::optional<std::uint32_t> other, Vec3 normal, double friction,
                   std::vector<Vec3> points = {{}}) {
    spec.contacts.push_back({.body = body,
                             .other = other,
                             .normal = normalized(normal),
                             .points = std::move(points),
                             .friction = friction});
    return spec.contacts.back();
  }
  /// The body lies to the left of p -> q.
  Contact& edge(std::uint32_t body, std::optional<std::uint32_t> other, P2 p, P2 q, double friction) {
    return contact(body, other, {-(q.z - p.z), 0, q.x - p.x}, friction, {{p.x, 0, p.z}, {q.x, 0, q.z}});
  }
  [[nodiscard]] Assembly made() const { return Assembly::make(spec).value(); }

  AssemblySpec spec;
};

/// Upward normal of a plane by dip and dip direction.
inline Vec3 plane(double dip, double direction) {
  return {sin_deg(dip) * sin_deg(direction), sin_deg(dip) * cos_deg(direction), cos_deg(dip)};
}

struct Side {
  Vec3 normal;
  double friction = 0;
  double cohesion = 0;  ///< N
};
/// One block in translation.
inline Builder single(const std::vector<Side>& sides, Vec3 force = {0, 0, -1}) {
  Builder b{Freedom::translation};
  b.block(force, norm(force));
  for (const Side& side : sides) {
    Contact& c = b.contact(0, rock, side.normal, side.friction);
    if (side.cohesion > 0) c.bonds = {{.corners = {}, .cohesion = side.cohesion}};
  }
  return b;
}

}  // namespace cleave::assembly::test
