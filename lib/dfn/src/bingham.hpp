#pragma once

#include "cleave/dfn/joint_set.hpp"

/// Drawing from Bingham's law by inversion.
namespace cleave::dfn::detail {

/// A normal about the mean one, v3: 1 - cos of the angle to it, in [0, 1], and the azimuth about it from v1 (radians).
struct BinghamDraw {
  double versine, azimuth;
};
/// 0 < u, v < 1. The azimuth by its tabulated marginal law (relative error of the density below 1e-5), the angle given
/// the azimuth by Newton's method to rounding.
[[nodiscard]] BinghamDraw draw_bingham(const BinghamOrientation& law, double u, double v) noexcept;
/// E |n.v3|, by quadrature to rounding.
[[nodiscard]] double mean_cosine(const BinghamOrientation& law) noexcept;

/// exp(-x^2) times the integral of exp(t^2) from 0 to x >= 0 (Rybicki 1989).
[[nodiscard]] double dawson(double x) noexcept;

}  // namespace cleave::dfn::detail
