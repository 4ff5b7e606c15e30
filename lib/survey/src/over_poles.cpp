#include "over_poles.hpp"

#include <cmath>

#include "cleave/core/rng.hpp"

namespace cleave::survey::detail {
namespace {

double weighed(std::span<const geometry::Vec3> normals, std::span<const double> weights, const OfNormal& figure) {
  double sum = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) sum += weights[i] * figure(normals[i]);
  return sum;
}

}  // namespace

double mean_over_poles(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                       const OfNormal& figure) {
  return weighed(normals, weights, figure) / weighed(normals, weights, [](geometry::Vec3) { return 1.0; });
}

Estimate over_poles(std::span<const geometry::Vec3> normals, std::span<const double> weights, const OfNormal& above,
                    const OfNormal& below, double confidence) {
  const double top = weighed(normals, weights, above), bottom = weighed(normals, weights, below);
  Estimate e{"", top / bottom, 0, 0, "", ""};
  e.low = e.high = *e.value;
  if (!(top > 0)) return e;
  double square = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    square += std::pow(weights[i] * (above(normals[i]) / top - below(normals[i]) / bottom), 2);
  }
  const double half = std::exp(normal_quantile(0.5 + confidence / 2) * std::sqrt(square));
  e.low = *e.value / half;
  e.high = *e.value * half;
  return e;
}

}  // namespace cleave::survey::detail
