#include <algorithm>
#include <cmath>

#include "cleave/motion/world.hpp"

namespace cleave::motion {
namespace {

std::string fault_of(const Polyhedron& polyhedron) {
  if (polyhedron.facets.size() < 4) return "it has fewer than four sides";
  if (!std::ranges::all_of(polyhedron.vertices, geometry::is_finite)) return "a vertex is not finite";
  for (const Facet& facet : polyhedron.facets) {
    if (facet.loops.empty()) return "a side has no corners";
    for (const auto& loop : facet.loops) {
      if (loop.size() < 3) return "a side has a loop of fewer than three corners";
      if (std::ranges::any_of(loop, [&](std::uint32_t v) { return v >= polyhedron.vertices.size(); })) {
        return "a side names a vertex that is not there";
      }
    }
  }
  return {};
}

/// Sums of the integrals of 1, x and x x^T over signed tetrahedra.
struct Moments {
  double volume = 0;
  Vec3 first;
  Symmetric second;

  void add(Vec3 a, Vec3 b, Vec3 c) {
    const double d = dot(a, cross(b, c));
    const Vec3 s = a + b + c;
    volume += d / 6;
    first += d / 24 * s;
    for (const Vec3 p : {a, b, c, s}) add_square(second, d / 120, p);
  }
  static void add_square(Symmetric& to, double by, Vec3 p) {
    to.xx += by * p.x * p.x;
    to.yy += by * p.y * p.y;
    to.zz += by * p.z * p.z;
    to.xy += by * p.x * p.y;
    to.yz += by * p.y * p.z;
    to.zx += by * p.z * p.x;
  }
};

}  // namespace

std::expected<MassProperties, BadPolyhedron> mass_properties(const Polyhedron& polyhedron) {
  if (std::string fault = fault_of(polyhedron); !fault.empty()) return std::unexpected(BadPolyhedron{std::move(fault)});
  const Vec3 origin = polyhedron.vertices[polyhedron.facets[0].loops[0][0]];
  const auto at = [&](std::uint32_t v) { return polyhedron.vertices[v] - origin; };
  Moments sum;
  for (const Facet& facet : polyhedron.facets) {
    const Vec3 a = at(facet.loops[0][0]);
    for (const auto& loop : facet.loops) {
      for (std::size_t k = 0; k < loop.size(); ++k) sum.add(a, at(loop[k]), at(loop[(k + 1) % loop.size()]));
    }
  }
  if (!(sum.volume > 0) || !std::isfinite(sum.volume))
    return std::unexpected(BadPolyhedron{"its volume is not positive"});
  const Vec3 c = sum.first / sum.volume;
  Symmetric s = sum.second;
  Moments::add_square(s, -sum.volume, c);
  const double trace = s.xx + s.yy + s.zz;
  const Symmetric inertia{trace - s.xx, trace - s.yy, trace - s.zz, -s.xy, -s.yz, -s.zx};
  const double second = s.xx * s.yy - s.xy * s.xy;
  const double third =
      s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.zx) + s.zx * (s.xy * s.yz - s.yy * s.zx);
  if (!(s.xx > 0 && second > 0 && third > 0)) return std::unexpected(BadPolyhedron{"it is too thin for its inertia"});
  return MassProperties{sum.volume, origin + c, inertia};
}

}  // namespace cleave::motion
