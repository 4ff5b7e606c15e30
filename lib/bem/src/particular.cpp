#include <cmath>

#include "cleave/bem/statics.hpp"

namespace cleave::bem {

Vec2 Particular::displacement(Vec2 x) const noexcept {
  const double lambda = 2 * mu * nu / (1 - 2 * nu);
  const double r2 = dot(x, x);
  Vec2 u = (-1 / (2 * (lambda + mu))) * (dot(body, x) * x - (0.5 * r2) * body);
  u += (-spin * r2 / (8 * (lambda + 2 * mu))) * x;
  u += (twist * r2 / (8 * mu)) * turned_left(x);
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
  return s;
}

}  // namespace cleave::bem
