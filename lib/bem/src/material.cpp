#include "cleave/bem/problem.hpp"

#include <fmt/format.h>

#include <cmath>

#include "cleave/core/overloaded.hpp"

namespace cleave::bem {

std::string describe(const MaterialError& error) {
  return std::visit(
      overloaded{
          [](const BadModulus& e) {
            return fmt::format("Young's modulus is {} Pa; it must be a finite number above 0", e.young_pa);
          },
          [](const BadPoisson& e) {
            return fmt::format(
                "Poisson's ratio is {}; it must lie above -1 and below 0.5 (at 0.5 the material "
                "is incompressible and plane strain has no answer of this kind)",
                e.poisson);
          },
          [](const BadDensity& e) { return fmt::format("the density is {} kg/m3; it must be 0 or more", e.density); }},
      error);
}

std::expected<Material, MaterialError> Material::make(Stress young, double poisson, Density density, PlaneState state) {
  if (!std::isfinite(young.si()) || !(young.si() > 0)) return std::unexpected(BadModulus{young.si()});
  const bool low_enough = state == PlaneState::strain ? poisson < 0.5 : poisson <= 0.5;
  if (!(poisson > -1) || !low_enough) return std::unexpected(BadPoisson{poisson});
  if (!std::isfinite(density.si()) || density.si() < 0) return std::unexpected(BadDensity{density.si()});
  return Material{young.si(), poisson, density.si(), state};
}

}  // namespace cleave::bem
