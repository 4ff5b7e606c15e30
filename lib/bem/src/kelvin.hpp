#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "cleave/bem/problem.hpp"

/// Kelvin's solution: displacement, traction and their derivatives for a unit force in the infinite plane (plane
/// strain; Thomson 1848; Brebbia, Telles and Wrobel 1984, chapter 5). d = x - y, from the source y to the field point
/// x; n is the outward unit normal at x. Rows: direction of the force at y; columns: component at x.
namespace cleave::bem {

/// mu in Pa (1 when the equations are scaled), nu of plane strain.
struct Elastic {
  double mu = 1;
  double nu = 0.25;
};

/// Displacement, without the material constant in front: -(3-4nu) ln r delta_ij + g_i g_j.
[[nodiscard]] inline Mat2 kelvin_displacement(Vec2 d, Elastic e) noexcept {
  const double r2 = dot(d, d);
  const double c = 1 / (8 * std::numbers::pi * e.mu * (1 - e.nu));
  const double log_term = -0.5 * (3 - 4 * e.nu) * std::log(r2);
  const double inv = 1 / r2;
  const double xy = c * d.x * d.y * inv;
  return {c * (log_term + d.x * d.x * inv), xy, xy, c * (log_term + d.y * d.y * inv)};
}

[[nodiscard]] inline Mat2 kelvin_traction(Vec2 d, Vec2 n, double nu) noexcept {
  const double inv = 1 / dot(d, d);
  const double c = -inv / (4 * std::numbers::pi * (1 - nu));
  const double a = 1 - 2 * nu;
  const double dn = dot(d, n);
  const double twist = a * (d.x * n.y - d.y * n.x);
  const double both = 2 * dn * inv * d.x * d.y;
  return {c * dn * (a + 2 * d.x * d.x * inv), c * (both - twist), c * (both + twist),
          c * dn * (a + 2 * d.y * d.y * inv)};
}

/// Kernels of the stress at y: sigma = integral of D_k t_k - S_k u_k, k = x, y.
struct StressKernels {
  std::array<Sym2, 2> traction;      ///< D
  std::array<Sym2, 2> displacement;  ///< S
};

[[nodiscard]] inline StressKernels kelvin_stress(Vec2 d, Vec2 n, Elastic e) noexcept {
  const double r = std::sqrt(dot(d, d));
  const double a = 1 - 2 * e.nu;
  const double nu = e.nu;
  const std::array<double, 2> g{d.x / r, d.y / r};
  const std::array<double, 2> m{n.x, n.y};
  const double dn = g[0] * m[0] + g[1] * m[1];
  const double cd = 1 / (4 * std::numbers::pi * (1 - nu) * r);
  const double cs = e.mu / (2 * std::numbers::pi * (1 - nu) * r * r);
  StressKernels out;
  const auto delta = [](std::size_t i, std::size_t j) { return i == j ? 1.0 : 0.0; };
  const auto fill = [&](std::size_t k, std::size_t i, std::size_t j, double& d_out, double& s_out) {
    d_out = cd * (a * (delta(k, i) * g[j] + delta(k, j) * g[i] - delta(i, j) * g[k]) + 2 * g[i] * g[j] * g[k]);
    s_out =
        cs *
        (2 * dn * (a * delta(i, j) * g[k] + nu * (delta(i, k) * g[j] + delta(j, k) * g[i]) - 4 * g[i] * g[j] * g[k]) +
         2 * nu * (m[i] * g[j] * g[k] + m[j] * g[i] * g[k]) +
         a * (2 * m[k] * g[i] * g[j] + m[j] * delta(i, k) + m[i] * delta(j, k)) - (1 - 4 * nu) * m[k] * delta(i, j));
  };
  for (std::size_t k = 0; k < 2; ++k) {
    fill(k, 0, 0, out.traction[k].xx, out.displacement[k].xx);
    fill(k, 0, 1, out.traction[k].xy, out.displacement[k].xy);
    fill(k, 1, 1, out.traction[k].yy, out.displacement[k].yy);
  }
  return out;
}

}  // namespace cleave::bem
