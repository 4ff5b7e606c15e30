#include "cleave/bem/inner_point.hpp"

#include <cmath>

#include "cleave/bem/boundary_stress.hpp"
#include "field_values.hpp"

namespace cleave::bem {

InnerState inner_state(const BlockOperator& block, const InnerPoint& point, const std::vector<double>& freedoms) {
  const Mesh& mesh = block.mesh();
  const double mu = block.material().mu();
  std::vector<Vec2> u(mesh.nodes.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = {freedoms[2 * i], freedoms[2 * i + 1]};
  auto t = tractions_of(block, freedoms);
  for (auto& element : t) {
    for (Vec2& v : element) v = v / mu;
  }
  const Nearest near = nearest(mesh, point.at);
  const Elastic elastic{1, block.material().nu()};
  InnerState out;
  if (near.distance < 1e-9 * std::sqrt(block.area())) {
    const Gradient g = on_boundary(mesh, u, t, near.element, near.s, elastic.mu, elastic.nu);
    return {g.displacement, mu * g.stress};
  }
  const Integrator integrator{mesh, {elastic}, 1e-9};
  out.displacement = displacement_inside(integrator, u, t, point.at, near, false);
  out.stress = mu * stress_inside(integrator, u, t, point.at, near, false);
  std::vector<Bubbles::Value> values;
  if (block.bubbles().count() > 0) block.bubbles().evaluate(point.reference, values);
  Vec2 dx, dy;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Vec2 amplitude{freedoms[block.boundary_freedoms() + 2 * k], freedoms[block.boundary_freedoms() + 2 * k + 1]};
    out.displacement += values[k].value * amplitude;
    dx += values[k].slope.x * amplitude;
    dy += values[k].slope.y * amplitude;
  }
  out.stress += block.material().stress({dx.x, 0.5 * (dx.y + dy.x), dy.y});
  return out;
}

}  // namespace cleave::bem
