#include <algorithm>
#include <cmath>

#include "cleave/bem/kelvin.hpp"
#include "cleave/bem/statics.hpp"
#include "element_rows.hpp"

namespace cleave::bem {
namespace {

struct Nearest {
  std::size_t element = 0;
  double s = 0;
  double distance = 1e300;
};

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

/// Derivative along the boundary of displacement, per unit of length of the frame the mesh is in.
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

struct Gradient {
  Vec2 displacement;
  Mat2 gradient;  // u_i,j
  Sym2 stress;
};

/// Displacement, its gradient and stress at a boundary point from fields without initial stress, in the given material.
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

}  // namespace

Vec2 Solution::node(std::size_t region, std::size_t node) const {
  return origin_ + scale_ * regions_[region].mesh.nodes[node].x;
}

std::optional<std::size_t> Solution::region_at(Vec2 x) const {
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (extent_ != Extent::bounded && r == 0) {
      if (surface_ && x.y > origin_.y + scale_ * *surface_) continue;
      bool opening = false;
      for (const Loop& loop : regions_[r].loops) opening = opening || inside({reversed(loop)}, x);
      if (!opening) return r;
      continue;
    }
    if (inside(regions_[r].loops, x)) return r;
  }
  // On a boundary: within a millionth of the size.
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (nearest(regions_[r].mesh, (x - origin_) / scale_).distance < 1e-7) return r;
  }
  return std::nullopt;
}

BoundaryPoint Solution::boundary(std::size_t region, std::size_t element, double s) const {
  const RegionPart& part = regions_[region];
  const Element& e = part.mesh.elements[element];
  const Vec2 x = e.at(s);
  const Vec2 n = e.normal(s);
  // The whole field less the initial stress obeys Hooke's law: u scaled back, stress in Pa.
  std::vector<std::array<Vec2, 3>> t(1);
  BoundaryPoint out{.x = origin_ + scale_ * x, .normal = n, .displacement = {}, .traction = {}, .stress = {}};
  const auto shapes = shape(part.mesh.order, s);
  for (std::size_t a = 0; a < part.mesh.per_element(); ++a) {
    out.displacement += shapes[a] * part.displacement[e.node[a]];
    out.traction += shapes[a] * part.traction[element][a];
  }
  if (!part.particular.points.empty()) {
    // Near a point force no shape function follows the field: what is left after it is smooth.
    const Gradient rest =
        on_boundary(part.mesh, part.u_part, part.t_part, element, s, part.particular.mu, part.particular.nu);
    out.displacement = scale_ * (rest.displacement + part.particular.displacement(x));
    out.stress = mu_ * (rest.stress + part.particular.stress(x));
    return out;
  }
  const Sym2 initial = mu_ * part.particular.initial_at(x);
  const Vec2 elastic = out.traction - initial * n;
  const Vec2 along = turned_left(n);
  const Vec2 slope = slope_along(part.mesh, part.displacement, element, s) / scale_;
  const double mu = part.material.mu();
  const double nu = part.material.nu();
  const double nn = dot(elastic, n);
  const double nt = dot(elastic, along);
  const double tt = 2 * mu / (1 - nu) * dot(slope, along) + nu / (1 - nu) * nn;
  out.stress = initial + Sym2{nn * n.x * n.x + 2 * nt * n.x * along.x + tt * along.x * along.x,
                              nn * n.x * n.y + nt * (n.x * along.y + n.y * along.x) + tt * along.x * along.y,
                              nn * n.y * n.y + 2 * nt * n.y * along.y + tt * along.y * along.y};
  return out;
}

Vec2 Solution::displacement(std::size_t region, Vec2 point) const {
  const RegionPart& part = regions_[region];
  const Vec2 y = (point - origin_) / scale_;
  const Nearest near = nearest(part.mesh, y);
  if (near.distance < 1e-9) return boundary(region, near.element, near.s).displacement;
  const Medium medium{{part.particular.mu, part.particular.nu},
                      surface_ ? std::optional{HalfPlane{*surface_}} : std::nullopt};
  const Integrator integrator{part.mesh, medium, integration_};
  // Without the field's value at the nearest boundary point, whose integral is known: u(y) = u_b + ...
  const Vec2 base = on_boundary(part.mesh, part.u_part, part.t_part, near.element, near.s, 1, 0.25).displacement;
  const bool outer = extent_ != Extent::bounded && region == 0;
  Vec2 u = outer ? Vec2{} : base;
  ElementIntegrals integrals;
  for (std::size_t e = 0; e < part.mesh.elements.size(); ++e) {
    integrator.integrate(e, y, std::nullopt, integrals);
    for (std::size_t a = 0; a < part.mesh.per_element(); ++a) {
      u += integrals.g[a] * part.t_part[e][a] - integrals.h[a] * (part.u_part[part.mesh.elements[e].node[a]] - base);
    }
  }
  return scale_ * (u + part.particular.displacement(y));
}

Sym2 Solution::stress(std::size_t region, Vec2 point) const {
  const RegionPart& part = regions_[region];
  const Mesh& mesh = part.mesh;
  const Vec2 y = (point - origin_) / scale_;
  const Nearest near = nearest(mesh, y);
  if (near.distance < 1e-9) return boundary(region, near.element, near.s).stress;
  const Elastic elastic{part.particular.mu, part.particular.nu};
  const Medium medium{elastic, surface_ ? std::optional{HalfPlane{*surface_}} : std::nullopt};
  const Integrator integrator{mesh, medium, integration_};
  const double length = 2 * norm(mesh.elements[near.element].c1);
  const bool close = near.distance < length && mesh.order != Order::constant;
  const Vec2 xb = mesh.elements[near.element].at(near.s);
  const Gradient linear =
      close ? on_boundary(mesh, part.u_part, part.t_part, near.element, near.s, elastic.mu, elastic.nu) : Gradient{};
  const bool outer = extent_ != Extent::bounded && region == 0;
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
        u += shapes[a] * part.u_part[element.node[a]];
        t += shapes[a] * part.t_part[e][a];
      }
      if (close) {
        u -= linear.displacement + linear.gradient * (x - xb);
        t -= linear.stress * n;
      }
      StressKernels k = kelvin_stress(x - y, n, elastic);
      if (surface_) {
        const StressKernels more = half_plane_stress(x, y, n, elastic, HalfPlane{*surface_});
        for (std::size_t c = 0; c < 2; ++c) {
          k.traction[c] += more.traction[c];
          k.displacement[c] += more.displacement[c];
        }
      }
      sigma += w * (t.x * k.traction[0] + t.y * k.traction[1] - (u.x * k.displacement[0] + u.y * k.displacement[1]));
    }
  }
  return mu_ * (sigma + part.particular.stress(y));
}

double Solution::largest_displacement() const noexcept {
  double largest = 0;
  for (const RegionPart& part : regions_) {
    for (const Vec2 u : part.displacement) largest = std::max(largest, norm(u));
  }
  return largest;
}

}  // namespace cleave::bem
