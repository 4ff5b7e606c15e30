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
  if (near.distance < 1e-9 * std::sqrt(block.area())) {
    const Gradient g = on_boundary(mesh, u, t, near.element, near.s, elastic.mu, elastic.nu);
    return {g.displacement, mu * g.stress};
  }
  // The inner motions' answers of the plane come off the boundary values and on again inside.
  const Bubbles& bubbles = block.bubbles();
  std::vector<Bubbles::Value> values;
  const auto answer = [&](Vec2 x) {
    Bubbles::Value sum;
    bubbles.evaluate(x, block.material(), values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double amplitude = freedoms[block.boundary_freedoms() + k];
      sum.displacement += amplitude * values[k].displacement;
      sum.stress += amplitude * values[k].stress;
    }
    return sum;
  };
  if (bubbles.count() > 0) {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] -= answer(mesh.nodes[i].x).displacement;
    const auto local = local_nodes(mesh.order);
    for (std::size_t e = 0; e < t.size(); ++e) {
      for (std::size_t a = 0; a < local.size(); ++a) {
        const Element& element = mesh.elements[e];
        t[e][a] -= (1 / mu) * (answer(element.at(local[a])).stress * element.normal(local[a]));
      }
    }
  }
  const Integrator integrator{mesh, {elastic}, 1e-9};
  const Bubbles::Value own = answer(point.at);
  return {displacement_inside(integrator, u, t, point.at, near, false) + own.displacement,
          mu * stress_inside(integrator, u, t, point.at, near, false) + own.stress};
}

}  // namespace cleave::bem
