#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "cleave/bem/statics.hpp"

/// Plane-strain problems with exact answers that the studies of boundary elements share; shear modulus 1.
namespace cleave::study {

using namespace bem;

constexpr double nu = 0.3;

inline Material of_shear(double mu, double poisson, double density = 0) {
  return Material::make(pascals(2 * mu * (1 + poisson)), poisson, kilograms_per_cubic_metre(density)).value();
}

struct Exact {
  std::string name;
  Problem problem;
  std::function<Vec2(Vec2)> displacement;
  std::size_t base_elements;                          ///< of the coarsest mesh
  std::function<Vec2(Vec2 x, Vec2 n)> traction = {};  ///< on the sides where it is given
};

inline Exact kirsch() {
  Region region{.material = of_shear(1, nu), .loops = {circle({0, 0}, 1, true, 0, 8)}, .conditions = {free_surface()}};
  Problem problem{.regions = {region}, .extent = Extent::plane};
  problem.in_situ.stress = {1, 0, 0};
  return {"kirsch", problem,
          [](Vec2 x) {
            const double kappa = 3 - 4 * nu;
            const double r = norm(x);
            const double t = std::atan2(x.y, x.x);
            const double ur = 0.25 * (1 / r + ((kappa + 1) / r - 1 / (r * r * r)) * std::cos(2 * t));
            const double ut = -0.25 * ((kappa - 1) / r + 1 / (r * r * r)) * std::sin(2 * t);
            return Vec2{ur * std::cos(t) - ut * std::sin(t), ur * std::sin(t) + ut * std::cos(t)};
          },
          8, [](Vec2, Vec2 n) { return Vec2{-n.x, 0}; }};  // what the excavation takes away
}

inline Exact lame() {
  const auto u = [](Vec2 x) {
    const double a = 1.0 / 3;
    const double r = norm(x);
    return (((1 - 2 * nu) * a * r + 4 * a / r) / 2 / r) * x;
  };
  Region region{.material = of_shear(1, nu),
                .loops = {circle({0, 0}, 2, false, 0, 8), circle({0, 0}, 1, true, 1, 4)},
                .conditions = {bem::displacement(u), pressure(1)}};
  return {"lame", Problem{.regions = {region}}, u, 12, [](Vec2, Vec2 n) { return -1.0 * n; }};
}

inline Exact cantilever() {
  const double l = 4, c = 0.5, p = 1, inertia = 2 * c * c * c / 3;
  const double young = 2 * (1 + nu) / (1 - nu * nu), poisson = nu / (1 - nu);
  const auto u = [=](Vec2 x) {
    return Vec2{
        p * x.y / (6 * young * inertia) * ((6 * l - 3 * x.x) * x.x + (2 + poisson) * (x.y * x.y - c * c)),
        -p / (6 * young * inertia) *
            (3 * poisson * x.y * x.y * (l - x.x) + (4 + 5 * poisson) * c * c * x.x + (3 * l - x.x) * x.x * x.x)};
  };
  const auto t = [=](Vec2 x, Vec2 n) {
    return Sym2{p * (l - x.x) * x.y / inertia, -p / (2 * inertia) * (c * c - x.y * x.y), 0} * n;
  };
  Loop loop = polygon({{0, -c}, {l, -c}, {l, c}, {0, c}}, 1, 2);
  loop[0].elements = loop[2].elements = 8;
  loop[3].condition = 0;
  Region region{.material = of_shear(1, nu), .loops = {loop}, .conditions = {bem::displacement(u), traction(t)}};
  return {"cantilever", Problem{.regions = {region}}, u, 20, t};
}

}  // namespace cleave::study
