#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cleave/core/special.hpp"
#include "cleave/survey/orientation.hpp"

/// Bingham's law, and the intervals of what the orientation tensor tells.
namespace cleave::survey {

using geometry::Vec3;

namespace {

constexpr double pi = std::numbers::pi;

/// The integral of exp(k1 x^2 + k2 y^2) over the half sphere, and the means of x^2 and y^2 under that law; k1 <= k2 <=
/// 0 or near. Rings lie where a Fisher law of kappa = -k2 has them, at equal shares: laws that hold to a point do not
/// fall between them.
std::array<double, 3> bingham_moments(double k1, double k2) {
  constexpr int rings = 200, around = 64;
  static const std::array<double, around> cosines = [] {
    std::array<double, around> out{};
    for (std::size_t j = 0; j < out.size(); ++j) out.at(j) = std::cos(pi * (static_cast<double>(j) + 0.5) / around);
    return out;
  }();
  const double kappa = std::max(1e-3, -std::max(k1, k2)), all = -std::expm1(-kappa);
  double f = 0, x2 = 0, y2 = 0;
  for (int i = 0; i < rings; ++i) {
    const double versine = -std::log1p(-all * (i + 0.5) / rings) / kappa, s2 = versine * (2 - versine);
    for (const double c : cosines) {
      const double xx = s2 * c * c, yy = s2 - xx;
      const double w = std::exp(k1 * xx + k2 * yy + kappa * versine);
      f += w;
      x2 += w * xx;
      y2 += w * yy;
    }
  }
  return {f * all / (kappa * rings), x2 / f, y2 / f};
}

/// How much (n.v)^2 scatters about axes i and j of the tensor: covariance of their weighted means as of leaving out one
/// joint after the other, which allows for the axes and values being fitted to these joints.
double covariance(const OrientationTensor& tensor, std::span<const Vec3> normals, std::span<const double> weights,
                  std::size_t i, std::size_t j) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  double products = 0;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const double p = dot(normals[k], tensor.vectors.at(i)), q = dot(normals[k], tensor.vectors.at(j));
    const double rest = sum - weights[k];
    if (!(rest > 0)) continue;
    const double share = weights[k] / rest;
    products += share * share * (p * p - tensor.values.at(i)) * (q * q - tensor.values.at(j));
  }
  return products;
}

/// So many joints of equal weight are these worth.
double worth(std::span<const double> weights) {
  double sum = 0, squares = 0;
  for (const double w : weights) {
    sum += w;
    squares += w * w;
  }
  return sum * sum / squares;
}
double quantile_of(std::span<const double> weights, double confidence) {
  return special::student_t_quantile(0.5 + confidence / 2, std::max(1.0, worth(weights) - 1));
}

}  // namespace

BinghamFit fit_bingham(const OrientationTensor& tensor) {
  // Moment equations E x^2 = smallest, E y^2 = middle eigenvalue; Newton with numeric derivatives, damped.
  double k1 = -1 / (2 * std::max(tensor.values[2], 1e-6)), k2 = -1 / (2 * std::max(tensor.values[1], 1e-6));
  for (int round = 0; round < 60; ++round) {
    const auto at = bingham_moments(k1, k2);
    const double e1 = at[1] - tensor.values[2], e2 = at[2] - tensor.values[1];
    if (std::abs(e1) + std::abs(e2) < 1e-10) break;
    const double h1 = 1e-4 * (1 + std::abs(k1)), h2 = 1e-4 * (1 + std::abs(k2));
    const auto d1 = bingham_moments(k1 + h1, k2), d2 = bingham_moments(k1, k2 + h2);
    const double a = (d1[1] - at[1]) / h1, b = (d2[1] - at[1]) / h2, c = (d1[2] - at[2]) / h1, d = (d2[2] - at[2]) / h2;
    const double det = a * d - b * c;
    if (det == 0) break;
    const auto step = [](double s, double k) {
      return std::clamp(s, -0.5 * (1 + std::abs(k)), 0.5 * (1 + std::abs(k)));
    };
    k1 -= step((d * e1 - b * e2) / det, k1);
    k2 -= step((a * e2 - c * e1) / det, k2);
  }
  return {k1, k2};
}

BinghamFit fit_bingham(std::span<const Vec3> normals, std::span<const double> weights, double confidence) {
  const OrientationTensor tensor = orientation_tensor(normals, weights);
  BinghamFit fit = fit_bingham(tensor);
  // d(E x^2, E y^2)/d(k1, k2) = [a b; c d], inverted on the covariance of the two means.
  const auto at = bingham_moments(fit.k1, fit.k2);
  const double h1 = 1e-4 * (1 + std::abs(fit.k1)), h2 = 1e-4 * (1 + std::abs(fit.k2));
  const auto d1 = bingham_moments(fit.k1 + h1, fit.k2), d2 = bingham_moments(fit.k1, fit.k2 + h2);
  const double a = (d1[1] - at[1]) / h1, b = (d2[1] - at[1]) / h2, c = (d1[2] - at[2]) / h1, d = (d2[2] - at[2]) / h2;
  const double det = a * d - b * c;
  if (det == 0 || !std::isfinite(det)) return fit;
  const double s11 = covariance(tensor, normals, weights, 2, 2), s22 = covariance(tensor, normals, weights, 1, 1),
               s12 = covariance(tensor, normals, weights, 2, 1);
  double v1 = (d * d * s11 - 2 * d * b * s12 + b * b * s22) / (det * det);
  double v2 = (c * c * s11 - 2 * c * a * s12 + a * a * s22) / (det * det);
  // The few joints of large weight are missing in most samples: no less than the law itself says.
  if (const double n = worth(weights); n < 0.999 * static_cast<double>(normals.size())) {
    v1 = std::max(v1, d / det / n);
    v2 = std::max(v2, a / det / n);
  }
  // On log(shift - k): the standard error grows as |k| for strong laws and is even for weak ones.
  constexpr double shift = 2.4;
  const double z = quantile_of(weights, confidence);
  const auto interval = [&](double k, double variance) {
    const double off = z * std::sqrt(std::max(0.0, variance)) / (shift - k);
    return std::array{shift - (shift - k) * std::exp(off), std::min(0.0, shift - (shift - k) * std::exp(-off))};
  };
  if (!std::isfinite(v1) || !std::isfinite(v2)) return fit;
  fit.first = interval(std::min(fit.k1, 0.0), v1);
  fit.second = interval(std::min(fit.k2, 0.0), v2);
  return fit;
}

std::array<std::array<double, 2>, 3> tensor_intervals(const OrientationTensor& tensor, std::span<const Vec3> normals,
                                                      std::span<const double> weights, double confidence) {
  const double z = quantile_of(weights, confidence);
  std::array<std::array<double, 2>, 3> all{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = std::clamp(tensor.values.at(i), 0.0, 1.0);
    const double error = std::sqrt(std::max(0.0, covariance(tensor, normals, weights, i, i)));
    if (!(t > 1e-12) || !(t < 1 - 1e-12)) {
      all.at(i) = {t, t};
      continue;
    }
    // On log(t/(1 - t)): stays between 0 and 1.
    const double off = z * error / (t * (1 - t)), odds = t / (1 - t);
    const double low = odds * std::exp(-off), high = odds * std::exp(off);
    all.at(i) = {low / (1 + low), std::isfinite(high) ? high / (1 + high) : 1};
  }
  return all;
}

}  // namespace cleave::survey
