#include "initial_stress.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "element_rows.hpp"
#include "gauss.hpp"

namespace cleave::bem {
namespace {

/// Where y lies on the element, if it does.
std::optional<double> place_on(const Element& e, Vec2 y) {
  double s = std::clamp(dot(y - e.c0, e.c1) / dot(e.c1, e.c1), -1.0, 1.0);
  for (int pass = 0; pass < 30 && e.curved; ++pass) {
    const Vec2 t = e.derivative(s);
    s = std::clamp(s + dot(y - e.at(s), t) / dot(t, t), -1.0, 1.0);
  }
  return norm(e.at(s) - y) < 1e-9 * norm(e.c1) ? std::optional{s} : std::nullopt;
}

/// r times sym_jk dU_ij/dx_k sigma_jk, for a unit vector g = d / r.
Vec2 strain_times(Vec2 g, Elastic e, Sym2 s) {
  const double a = 1 - 2 * e.nu;
  const double c = 1 / (8 * std::numbers::pi * e.mu * (1 - e.nu));
  // sym dU_ij,k = -c/r [ a (delta_ij g_k + delta_ik g_j) - delta_jk g_i + 2 g_i g_j g_k ].
  const Vec2 along = s * g;
  const double through = dot(g, along);
  const double trace = s.xx + s.yy;
  return -c * (2 * a * along - trace * g + 2 * through * g);
}

}  // namespace

Vec2 initial_stress_by_boundary(const Mesh& mesh, Vec2 y, Elastic elastic, const StressField& stress, double target) {
  const Integrator integrator{mesh, {elastic, {}}, target};
  const auto local = local_nodes(mesh.order);
  Vec2 sum;
  ElementIntegrals part;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    integrator.integrate(e, y, place_on(element, y), part);
    for (std::size_t a = 0; a < mesh.per_element(); ++a) {
      sum += part.g[a] * (stress(element.at(local[a])) * element.normal(local[a]));
    }
  }
  return sum;
}

Vec2 initial_stress_by_cells(const Mesh& mesh, Vec2 y, Elastic elastic, const StressField& stress, std::size_t points) {
  // As many points along an element as the accuracy of `points` Gauss points on a smooth function asks for.
  const Integrator integrator{mesh, {elastic, {}}, std::pow(10.0, -static_cast<double>(points))};
  const GaussRule& radial = gauss(points);
  std::vector<LocalPoint> along;
  Vec2 sum;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    if (place_on(element, y)) {
      if (!element.curved) continue;  // its triangle has no area
      const GaussRule& rule = gauss(20);
      along.clear();
      for (std::size_t g = 0; g < rule.s.size(); ++g) along.push_back({rule.s[g], rule.w[g]});
    } else {
      integrator.points_for(e, y, 1, along);
    }
    for (const LocalPoint& p : along) {
      const Vec2 ray = element.at(p.s) - y;
      const double length = norm(ray);
      if (length == 0) continue;
      // d = u ray: the area u cross(ray, x') du ds and the kernel's 1 / (u length) leave no u.
      const double w = p.w * cross(ray, element.derivative(p.s)) / length;
      for (std::size_t k = 0; k < radial.s.size(); ++k) {
        const double u = 0.5 * (1 + radial.s[k]);
        sum += (0.5 * radial.w[k] * w) * strain_times(ray / length, elastic, stress(y + u * ray));
      }
    }
  }
  return sum;
}

}  // namespace cleave::bem
