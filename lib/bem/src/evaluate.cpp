#include <algorithm>
#include <cmath>

#include "cleave/bem/statics.hpp"
#include "field_values.hpp"
#include "kelvin.hpp"

namespace cleave::bem {

Vec2 Solution::node(std::size_t region, std::size_t node) const {
  return origin_ + scale_ * regions_[region].mesh.nodes[node].x;
}

bool Solution::within(std::size_t region, Vec2 x) const {
  const std::vector<Loop>& loops = regions_[region].loops;
  if (!std::isfinite(x.x) || !std::isfinite(x.y)) return false;
  if (extent_ == Extent::bounded || region > 0) return inside(loops, x);
  if (surface_ && x.y > origin_.y + scale_ * *surface_) return false;
  return std::ranges::none_of(loops, [&](const Loop& loop) { return inside({reversed(loop)}, x); });
}

namespace {

/// Of the size: what counts as on a boundary.
constexpr double on_it = 1e-7;

}  // namespace

std::optional<std::size_t> Solution::region_at(Vec2 x) const {
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (within(r, x)) return r;
  }
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (nearest(regions_[r].mesh, (x - origin_) / scale_).distance < on_it) return r;
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

std::optional<Vec2> Solution::displacement(std::size_t region, Vec2 point) const {
  if (region >= regions_.size()) return std::nullopt;
  const RegionPart& part = regions_[region];
  const Vec2 y = (point - origin_) / scale_;
  const Nearest near = nearest(part.mesh, y);
  if (near.distance < 1e-9) return boundary(region, near.element, near.s).displacement;
  if (near.distance >= on_it && !within(region, point)) return std::nullopt;
  const Vec2 u = displacement_inside(inside_[region]->integrator(), part.u_part, part.t_part, y, near,
                                     extent_ != Extent::bounded && region == 0);
  return scale_ * (u + part.particular.displacement(y));
}

std::optional<Sym2> Solution::stress(std::size_t region, Vec2 point) const {
  if (region >= regions_.size()) return std::nullopt;
  const RegionPart& part = regions_[region];
  const Mesh& mesh = part.mesh;
  const Vec2 y = (point - origin_) / scale_;
  const Nearest near = nearest(mesh, y);
  if (near.distance < 1e-9) return boundary(region, near.element, near.s).stress;
  if (near.distance >= on_it && !within(region, point)) return std::nullopt;
  const Sym2 sigma = stress_inside(inside_[region]->integrator(), part.u_part, part.t_part, y, near,
                                   extent_ != Extent::bounded && region == 0);
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
