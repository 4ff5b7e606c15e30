#include "system_parts.hpp"

#include <algorithm>
#include <cmath>

#include "gauss.hpp"

namespace cleave::bem {

std::vector<std::array<double, 3>> free_motions(const std::vector<std::array<double, 3>>& rows) {
  // Gauss elimination with column order rotation, x, y so that translations stay free longest.
  std::vector<std::array<double, 3>> basis;
  const auto project = [&](std::array<double, 3> v) {
    for (const auto& b : basis) {
      const double c = v[0] * b[0] + v[1] * b[1] + v[2] * b[2];
      for (std::size_t i = 0; i < 3; ++i) v[i] -= c * b[i];
    }
    return v;
  };
  const auto length = [](const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
  while (basis.size() < 3) {
    std::array<double, 3> best{};
    double largest = 0;
    for (const auto& row : rows) {
      const auto v = project(row);
      if (const double l = length(v); l > largest) {
        largest = l;
        best = v;
      }
    }
    if (largest < 1e-7) break;
    for (double& c : best) c /= largest;
    basis.push_back(best);
  }
  std::vector<std::array<double, 3>> free;
  for (const std::array<double, 3>& unit : {std::array<double, 3>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    if (basis.size() == 3) break;
    auto v = project(unit);
    const double l = length(v);
    if (l < 1e-6) continue;
    for (double& c : v) c /= l;
    basis.push_back(v);
    free.push_back(v);
  }
  return free;
}

bool at_force(const Particular& particular, Vec2 x) {
  return std::ranges::any_of(particular.points, [&](const PointField& f) { return norm(f.at - x) < 1e3 * f.cut; });
}

void keep_momentum(ScaledRegion& region) {
  const Mesh& mesh = region.mesh;
  const GaussRule& rule = gauss(12);
  double length = 0, polar = 0, moment = 0;
  Vec2 middle, force;
  const auto along = [&](const auto& visit) {
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      for (std::size_t k = 0; k < rule.s.size(); ++k) {
        visit(e, rule.s[k], rule.w[k] * norm(mesh.elements[e].derivative(rule.s[k])));
      }
    }
  };
  along([&](std::size_t e, double s, double w) {
    length += w;
    middle += w * mesh.elements[e].at(s);
  });
  middle = middle / length;
  Particular forces = region.particular;
  forces.body = {};
  forces.spin = forces.twist = 0;
  forces.initial = forces.initial_slope = {};
  const auto local = local_nodes(mesh.order);
  along([&](std::size_t e, double s, double w) {
    const Element& element = mesh.elements[e];
    const auto n = shape(mesh.order, s);
    Vec2 t;
    for (std::size_t a = 0; a < local.size(); ++a) {
      const double at = at_force(forces, element.at(local[a])) ? 0.98 * local[a] : local[a];
      t += n[a] * (forces.stress(element.at(at)) * element.normal(at));
    }
    const Vec2 arm = element.at(s) - middle;
    force += w * t;
    moment += w * cross(arm, t);
    polar += w * dot(arm, arm);
  });
  for (const PointField& f : region.particular.points) {
    force += f.force;
    moment += cross(f.at - middle, f.force);
  }
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    for (std::size_t a = 0; a < local.size(); ++a) {
      const Vec2 arm = mesh.elements[e].at(local[a]) - middle;
      region.t_particular[e][a] -= force / length + (moment / polar) * turned_left(arm);
    }
  }
}

bool flamant_fits(const ScaledRegion& region, Vec2 at, Vec2 normal, std::size_t on) {
  if (region.mesh.order == Order::constant) return false;
  for (const Node& node : region.mesh.nodes) {
    if (node.corner && norm(node.x - at) < 0.25 * norm(region.mesh.elements[on].c1)) return false;
  }
  for (std::size_t e = 0; e < region.mesh.elements.size(); ++e) {
    const Element& element = region.mesh.elements[e];
    for (int k = 0; k < 8; ++k) {
      const Vec2 a = element.at(-1 + 0.25 * k) - at, b = element.at(-0.75 + 0.25 * k) - at;
      const double ca = cross(normal, a), cb = cross(normal, b);
      if ((ca < 0) == (cb < 0)) continue;
      const double way = dot(normal, a) + ca / (ca - cb) * dot(normal, b - a);
      if (way > 1e-3 * norm(region.mesh.elements[on].c1)) return false;
    }
  }
  return true;
}

}  // namespace cleave::bem
