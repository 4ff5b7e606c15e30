#pragma once

#include <cstddef>
#include <functional>

#include "cleave/bem/problem.hpp"
#include "kelvin.hpp"

/// Stress before loading in the boundary integral equation: the term B(y) = integral over the body of eps*_ijk sigma_jk
/// with c u + H u = G t - B (t: total traction; the minus sign is missing in Fu (2014), see docs/bem.md).
namespace cleave::bem {

using StressField = std::function<Sym2(Vec2)>;

/// Without cells: as tractions sigma n, exact for stress without divergence that is a polynomial of the elements' order
/// along them. `target`: relative error of the integrals.
[[nodiscard]] Vec2 initial_stress_by_boundary(const Mesh& mesh, Vec2 y, Elastic elastic, const StressField& stress,
                                              double target = 1e-10);

/// The way of Fu (2014), kept for comparison and for stress of any kind: cells, here the triangles from y to the
/// elements, in coordinates in which the kernel's 1/r is gone (Duffy 1982), points x points Gauss points each, more
/// along elements that y is close to.
[[nodiscard]] Vec2 initial_stress_by_cells(const Mesh& mesh, Vec2 y, Elastic elastic, const StressField& stress,
                                           std::size_t points = 8);

}  // namespace cleave::bem
