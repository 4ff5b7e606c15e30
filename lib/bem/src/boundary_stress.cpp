#include "cleave/bem/block.hpp"

namespace cleave::bem {

std::vector<std::array<Vec2, 3>> tractions_of(const BlockOperator& block, const std::vector<double>& freedoms) {
  const std::size_t per = block.mesh().per_element();
  const DenseMatrix& m = block.traction_of();
  std::vector<std::array<Vec2, 3>> out(block.mesh().elements.size());
  for (std::size_t e = 0; e < out.size(); ++e) {
    for (std::size_t a = 0; a < per; ++a) {
      const std::size_t row = 2 * (e * per + a);
      for (std::size_t k = 0; k < m.columns; ++k) out[e][a] += freedoms[k] * Vec2{m(row, k), m(row + 1, k)};
    }
  }
  return out;
}

Sym2 boundary_stress(const BlockOperator& block, BoundaryPlace at, const std::vector<double>& freedoms,
                     const std::vector<std::array<Vec2, 3>>& tractions) {
  const Mesh& mesh = block.mesh();
  const Element& e = mesh.elements[at.element];
  const Vec2 n = e.normal(at.s);
  const Vec2 along = turned_left(n);
  const auto value = shape(mesh.order, at.s);
  const auto slope = shape_slope(mesh.order, at.s);
  Vec2 t, du;
  for (std::size_t a = 0; a < mesh.per_element(); ++a) {
    t += value[a] * tractions[at.element][a];
    du += slope[a] * Vec2{freedoms[2 * e.node[a]], freedoms[2 * e.node[a] + 1]};
  }
  const Material& material = block.material();
  const double nu = material.nu();
  const double nn = dot(t, n), nt = dot(t, along);
  const double tt = 2 * material.mu() / (1 - nu) * dot(du, along) / norm(e.derivative(at.s)) + nu / (1 - nu) * nn;
  return {nn * n.x * n.x + 2 * nt * n.x * along.x + tt * along.x * along.x,
          nn * n.x * n.y + nt * (n.x * along.y + n.y * along.x) + tt * along.x * along.y,
          nn * n.y * n.y + 2 * nt * n.y * along.y + tt * along.y * along.y};
}

}  // namespace cleave::bem
