#include "half_plane.hpp"

#include <complex>

namespace cleave::bem {
namespace {

using Complex = std::complex<double>;

/// Correction potentials phi1, psi1 at z for a force F (complex) at z0 in the lower half plane, and what displacement
/// and stress need of their derivatives. With Kelvin's
///   phi0 = -k F ln(z - z0),  psi0 = k kappa conj(F) ln(z - z0) + k F conj(z0) / (z - z0),  k = 1 / (2 pi (1 + kappa)),
/// freedom of the real axis from traction gives
///   phi1 = -(z conj(phi0')(z) + conj(psi0)(z)),  psi1 = -conj(phi0)(z) - z phi1'(z).
/// All of them are linear in F and conj(F) and depend on z0, conj(z0); the derivatives by the source follow.
struct Potentials {
  Complex phi, dphi, ddphi, psi, dpsi;
};

Potentials potentials(Complex z, Complex z0, Complex f, double kappa) {
  const double k = 1 / (2 * std::numbers::pi * (1 + kappa));
  const Complex b = std::conj(z0);  // the mirror image: the only singular point
  const Complex g = std::conj(f);
  const Complex r = z - b;
  const Complex i1 = 1.0 / r;
  const Complex i2 = i1 * i1;
  // The cut points away from the rock; the constant that turns ln(i r) into ln r would be a rigid translation.
  const Complex log_r = std::log(Complex{0, 1} * r);
  // conj(phi0)(z) = -k g ln r; its derivative -k g / r; conj(psi0)(z) = k kappa f ln r + k g z0 / r.
  Potentials p;
  p.phi = k * (g * z * i1 - kappa * f * log_r - g * z0 * i1);
  p.dphi = k * (g * i1 - g * (z - z0) * i2 - kappa * f * i1);
  p.ddphi = k * (-2.0 * g * i2 + 2.0 * g * (z - z0) * i2 * i1 + kappa * f * i2);
  p.psi = k * g * log_r - z * p.dphi;
  p.dpsi = k * g * i1 - p.dphi - z * p.ddphi;
  return p;
}

/// Derivatives by the real and imaginary part of the source, by the product rule written out.
Potentials source_slope(Complex z, Complex z0, Complex f, double kappa, bool by_y) {
  const double k = 1 / (2 * std::numbers::pi * (1 + kappa));
  const Complex a = by_y ? Complex{0, 1} : Complex{1, 0};  // change of z0
  const Complex c = std::conj(a);                          // change of its image
  const Complex g = std::conj(f);
  const Complex r = z - std::conj(z0);
  const Complex i1 = 1.0 / r;
  const Complex i2 = i1 * i1;
  const Complex i3 = i2 * i1;
  const Complex w = z - z0;
  // d(1/r) = c / r^2, d(ln r) = -c / r, d(1/r^2) = 2c / r^3, d(1/r^3) = 3c / r^4, dw = -a.
  Potentials p;
  p.phi = k * (g * (-a * i1 + w * c * i2) + kappa * f * c * i1);
  p.dphi = k * (g * c * i2 - g * (-a * i2 + 2.0 * w * c * i3) - kappa * f * c * i2);
  p.ddphi = k * (-4.0 * g * c * i3 + 2.0 * g * (-a * i3 + 3.0 * w * c * i2 * i2) + 2.0 * kappa * f * c * i3);
  p.psi = -k * g * c * i1 - z * p.dphi;
  p.dpsi = k * g * c * i2 - p.dphi - z * p.ddphi;
  return p;
}

Vec2 displacement_of(const Potentials& p, Complex z, double kappa, double mu) {
  const Complex u = (kappa * p.phi - z * std::conj(p.dphi) - std::conj(p.psi)) / (2 * mu);
  return {u.real(), u.imag()};
}

Sym2 stress_of(const Potentials& p, Complex z) {
  const double sum = 4 * p.dphi.real();
  const Complex difference = 2.0 * (std::conj(z) * p.ddphi + p.dpsi);
  return {(sum - difference.real()) / 2, difference.imag() / 2, (sum + difference.real()) / 2};
}

constexpr Complex unit_x{1, 0};
constexpr Complex unit_y{0, 1};

}  // namespace

Mat2 half_plane_displacement(Vec2 x, Vec2 y, Elastic e, HalfPlane h) {
  const double kappa = 3 - 4 * e.nu;
  // Measured from the point of the surface above the source: a shift along the surface changes nothing.
  const Complex z{x.x - y.x, x.y - h.level};
  const Complex z0{0, y.y - h.level};
  const Vec2 a = displacement_of(potentials(z, z0, unit_x, kappa), z, kappa, e.mu);
  const Vec2 b = displacement_of(potentials(z, z0, unit_y, kappa), z, kappa, e.mu);
  return {a.x, a.y, b.x, b.y};
}

Mat2 half_plane_traction(Vec2 x, Vec2 y, Vec2 n, Elastic e, HalfPlane h) {
  const double kappa = 3 - 4 * e.nu;
  const Complex z{x.x - y.x, x.y - h.level};
  const Complex z0{0, y.y - h.level};
  const Vec2 a = stress_of(potentials(z, z0, unit_x, kappa), z) * n;
  const Vec2 b = stress_of(potentials(z, z0, unit_y, kappa), z) * n;
  return {a.x, a.y, b.x, b.y};
}

StressKernels half_plane_stress(Vec2 x, Vec2 y, Vec2 n, Elastic e, HalfPlane h) {
  const double kappa = 3 - 4 * e.nu;
  const Complex z{x.x - y.x, x.y - h.level};
  const Complex z0{0, y.y - h.level};
  const double lambda = 2 * e.mu * e.nu / (1 - 2 * e.nu);
  // u_i(y) = integral of U_ij t_j - T_ij u_j; sigma from its gradient by y. slope[i][l][k]: of U_ik (or T_ik) by y_l.
  std::array<std::array<Vec2, 2>, 2> u{};
  std::array<std::array<Vec2, 2>, 2> t{};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t l = 0; l < 2; ++l) {
      const Potentials p = source_slope(z, z0, i == 0 ? unit_x : unit_y, kappa, l == 1);
      u[i][l] = displacement_of(p, z, kappa, e.mu);
      t[i][l] = stress_of(p, z) * n;
      // Moving the source along the surface is moving z back: the potentials were written with z measured from the
      // source, but source_slope moves z0 with z held, which is the same derivative.
    }
  }
  StressKernels out;
  const auto stress = [&](double gxx, double gxy, double gyx, double gyy) {
    const double volume = lambda * (gxx + gyy);
    return Sym2{volume + 2 * e.mu * gxx, e.mu * (gxy + gyx), volume + 2 * e.mu * gyy};
  };
  out.traction[0] = stress(u[0][0].x, u[0][1].x, u[1][0].x, u[1][1].x);
  out.traction[1] = stress(u[0][0].y, u[0][1].y, u[1][0].y, u[1][1].y);
  out.displacement[0] = stress(t[0][0].x, t[0][1].x, t[1][0].x, t[1][1].x);
  out.displacement[1] = stress(t[0][0].y, t[0][1].y, t[1][0].y, t[1][1].y);
  return out;
}

}  // namespace cleave::bem
