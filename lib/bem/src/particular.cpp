#include <cmath>
#include <complex>
#include <numbers>

#include "cleave/bem/statics.hpp"

namespace cleave::bem {

namespace {

using Complex = std::complex<double>;

Complex number(Vec2 v) { return {v.x, v.y}; }

Vec2 displacement_of(const PointField& f, Vec2 x, double mu, double nu) {
  const double kappa = 3 - 4 * nu;
  Complex z = number(x - f.at);
  const Complex inwards = -number(f.normal);
  if (std::abs(z) < f.cut) z = std::abs(z) > 0 ? z * (f.cut / std::abs(z)) : f.cut * inwards;
  const Complex force = number(f.force);
  const double log = std::log(std::abs(z));
  const double angle = std::arg(z / inwards);  // jumps outside the body
  const Complex turn = z / std::conj(z);
  const Complex u = -force * Complex{(kappa + 1) * log, (kappa - 1) * angle} + std::conj(force) * turn;
  return {u.real() / (4 * std::numbers::pi * mu), u.imag() / (4 * std::numbers::pi * mu)};
}

Sym2 stress_of(const PointField& f, Vec2 x) {
  const Vec2 d = x - f.at;
  const double r = std::max(norm(d), f.cut);
  if (norm(d) == 0) return {};
  const Vec2 e = d / norm(d);
  return (-2 * dot(f.force, e) / (std::numbers::pi * r)) * Sym2{e.x * e.x, e.x * e.y, e.y * e.y};
}

}  // namespace

Vec2 Particular::displacement(Vec2 x) const noexcept {
  const double lambda = 2 * mu * nu / (1 - 2 * nu);
  const double r2 = dot(x, x);
  Vec2 u = (-1 / (2 * (lambda + mu))) * (dot(body, x) * x - (0.5 * r2) * body);
  u += (-spin * r2 / (8 * (lambda + 2 * mu))) * x;
  u += (twist * r2 / (8 * mu)) * turned_left(x);
  for (const PointField& f : points) u += displacement_of(f, x, mu, nu);
  return u;
}

Sym2 Particular::stress(Vec2 x) const noexcept {
  const double lambda = 2 * mu * nu / (1 - 2 * nu);
  const double r2 = dot(x, x);
  Sym2 s = initial_at(x);
  const double weight = -dot(body, x);
  s += Sym2{weight, 0, weight};
  const double c = -spin / (8 * (lambda + 2 * mu));
  s += c * Sym2{(4 * lambda + 2 * mu) * r2 + 4 * mu * x.x * x.x, 4 * mu * x.x * x.y,
                (4 * lambda + 2 * mu) * r2 + 4 * mu * x.y * x.y};
  const Vec2 w = turned_left(x);
  s += 0.25 * twist * Sym2{2 * x.x * w.x, x.x * w.y + x.y * w.x, 2 * x.y * w.y};
  for (const PointField& f : points) s += stress_of(f, x);
  return s;
}

}  // namespace cleave::bem
