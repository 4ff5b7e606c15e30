#include "cleave/bem/motion.hpp"

#include <cmath>

#include "cleave/bem/block.hpp"
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
  if (near.distance < 1e-9 * std::sqrt(block.area())) {
    const Gradient g = on_boundary(mesh, u, t, near.element, near.s, elastic.mu, elastic.nu);
    return {g.displacement, mu * g.stress};
  }
  // The inner motions' answers of the plane come off the boundary values and on again inside.
  const Bubbles& bubbles = block.bubbles();
  Bubbles::Value own;
  std::vector<Bubbles::Value> values;
  bubbles.evaluate(point.at, block.material(), values);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double amplitude = freedoms[block.boundary_freedoms() + k];
    own.displacement += amplitude * values[k].displacement;
    own.stress += amplitude * values[k].stress;
    for (std::size_t i = 0; i < u.size(); ++i) {
      u[i] -= amplitude * Vec2{bubbles.on_nodes(2 * i, k), bubbles.on_nodes(2 * i + 1, k)};
    }
    const std::size_t per = mesh.per_element();
    for (std::size_t r = 0; r < per * t.size(); ++r) {
      t[r / per][r % per] -= (amplitude / mu) * Vec2{bubbles.on_elements(2 * r, k), bubbles.on_elements(2 * r + 1, k)};
    }
  }
  const Integrator integrator{mesh, {elastic}, 1e-9};
  return {displacement_inside(integrator, u, t, point.at, near, false) + own.displacement,
          mu * stress_inside(integrator, u, t, point.at, near, false) + own.stress};
}

}  // namespace cleave::bem
