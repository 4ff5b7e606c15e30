#include "field_values.hpp"

#include <algorithm>
#include <cmath>

#include "kelvin.hpp"

namespace cleave::bem {

Nearest nearest(const Mesh& mesh, Vec2 x) {
  Nearest best;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    const double reach = norm(element.c1) + norm(element.c2);
    if (norm(x - element.c0) - reach > best.distance) continue;
    double s = std::clamp(dot(x - element.c0, element.c1) / dot(element.c1, element.c1), -1.0, 1.0);
    for (int pass = 0; pass < 30 && element.curved; ++pass) {
      const Vec2 t = element.derivative(s);
      const double next = std::clamp(s + dot(x - element.at(s), t) / dot(t, t), -1.0, 1.0);
      if (std::abs(next - s) < 1e-15) break;
      s = next;
    }
    if (const double d = norm(element.at(s) - x); d < best.distance) best = {e, s, d};
  }
  return best;
}

Vec2 slope_along(const Mesh& mesh, const std::vector<Vec2>& u, std::size_t element, double s) {
  const Element& e = mesh.elements[element];
  if (mesh.order != Order::constant) {
    const auto d = shape_slope(mesh.order, s);
    Vec2 slope;
    for (std::size_t a = 0; a < mesh.per_element(); ++a) slope += d[a] * u[e.node[a]];
    return slope / norm(e.derivative(s));
  }
  // One value an element: differences to the neighbours on the same side.
  const std::size_t n = mesh.elements.size();
  const auto same = [&](std::size_t k) { return mesh.elements[k].loop == e.loop && mesh.elements[k].side == e.side; };
  const std::size_t before = element > 0 && same(element - 1) ? element - 1 : element;
  const std::size_t after = element + 1 < n && same(element + 1) ? element + 1 : element;
  if (before == after) return {};
  double length = 0;
  for (std::size_t k = before; k < after; ++k) length += norm(mesh.elements[k].c1) + norm(mesh.elements[k + 1].c1);
  return (u[mesh.elements[after].node[0]] - u[mesh.elements[before].node[0]]) / length;
}

Gradient on_boundary(const Mesh& mesh, const std::vector<Vec2>& u, const std::vector<std::array<Vec2, 3>>& t,
                     std::size_t element, double s, double mu, double nu) {
  const Element& e = mesh.elements[element];
  const Vec2 n = e.normal(s);
  const Vec2 along = turned_left(n);
  const auto shapes = shape(mesh.order, s);
  Gradient out;
  Vec2 traction;
  for (std::size_t a = 0; a < mesh.per_element(); ++a) {
    out.displacement += shapes[a] * u[e.node[a]];
    traction += shapes[a] * t[element][a];
  }
  const Vec2 slope = slope_along(mesh, u, element, s);
  const double nn = dot(traction, n);
  const double nt = dot(traction, along);
  const double tt = 2 * mu / (1 - nu) * dot(slope, along) + nu / (1 - nu) * nn;
  const auto turned = [&](double a, double b, double c) {  // of nn, nt, tt parts
    return Sym2{a * n.x * n.x + 2 * b * n.x * along.x + c * along.x * along.x,
                a * n.x * n.y + b * (n.x * along.y + n.y * along.x) + c * along.x * along.y,
                a * n.y * n.y + 2 * b * n.y * along.y + c * along.y * along.y};
  };
  out.stress = turned(nn, nt, tt);
  const double trace = nu * (nn + tt);
  const Sym2 strain = turned((nn - trace) / (2 * mu), nt / (2 * mu), (tt - trace) / (2 * mu));
  // n.(grad u).tau is n.strain.tau less the rotation.
  const double turn = nt / (2 * mu) - dot(n, slope);
  out.gradient = {strain.xx, strain.xy - turn, strain.xy + turn, strain.yy};
  return out;
}

Vec2 displacement_inside(const Integrator& integrator, const std::vector<Vec2>& u_nodes,
                         const std::vector<std::array<Vec2, 3>>& t_nodes, Vec2 y, const Nearest& near, bool outer) {
  const Mesh& mesh = integrator.mesh();
  // Without the field's value at the nearest boundary point, whose integral is known: u(y) = u_b + ...
  const Vec2 base = on_boundary(mesh, u_nodes, t_nodes, near.element, near.s, 1, 0.25).displacement;
  Vec2 u = outer ? Vec2{} : base;
  ElementIntegrals integrals;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    integrator.integrate(e, y, std::nullopt, integrals);
    for (std::size_t a = 0; a < mesh.per_element(); ++a) {
      u += integrals.g[a] * t_nodes[e][a] - integrals.h[a] * (u_nodes[mesh.elements[e].node[a]] - base);
    }
  }
  return u;
}

Sym2 stress_inside(const Integrator& integrator, const std::vector<Vec2>& u_nodes,
                   const std::vector<std::array<Vec2, 3>>& t_nodes, Vec2 y, const Nearest& near, bool outer) {
  const Mesh& mesh = integrator.mesh();
  const Medium& medium = integrator.medium();
  const Elastic elastic = medium.elastic;
  const double length = 2 * norm(mesh.elements[near.element].c1);
  const bool close = near.distance < length && mesh.order != Order::constant;
  const Vec2 xb = mesh.elements[near.element].at(near.s);
  const Gradient linear =
      close ? on_boundary(mesh, u_nodes, t_nodes, near.element, near.s, elastic.mu, elastic.nu) : Gradient{};
  Sym2 sigma = outer ? Sym2{} : linear.stress;
  std::vector<LocalPoint> rule;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    // The kernels are 1/r^2 where values are of the size of the element over r: a sharper rule close by.
    const double distance = std::max(norm(y - element.c0) - norm(element.c1) - norm(element.c2), near.distance);
    integrator.points_for(e, y, std::min(1.0, distance / norm(element.c1)), rule);
    for (const LocalPoint& p : rule) {
      const Vec2 x = element.at(p.s);
      const Vec2 tangent = element.derivative(p.s);
      const double w = p.w * norm(tangent);
      const Vec2 n = element.normal(p.s);
      const auto shapes = shape(mesh.order, p.s);
      Vec2 u, t;
      for (std::size_t a = 0; a < mesh.per_element(); ++a) {
        u += shapes[a] * u_nodes[element.node[a]];
        t += shapes[a] * t_nodes[e][a];
      }
      if (close) {
        u -= linear.displacement + linear.gradient * (x - xb);
        t -= linear.stress * n;
      }
      StressKernels k = kelvin_stress(x - y, n, elastic);
      if (medium.surface) {
        const StressKernels more = half_plane_stress(x, y, n, elastic, *medium.surface);
        for (std::size_t c = 0; c < 2; ++c) {
          k.traction[c] += more.traction[c];
          k.displacement[c] += more.displacement[c];
        }
      }
      sigma += w * (t.x * k.traction[0] + t.y * k.traction[1] - (u.x * k.displacement[0] + u.y * k.displacement[1]));
    }
  }
  return sigma;
}

}  // namespace cleave::bem
