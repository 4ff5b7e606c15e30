#include "bingham.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::dfn {
namespace {

using detail::dawson;

constexpr double pi = std::numbers::pi;
constexpr std::size_t panels = 512;  // of a quarter turn

/// The exponent at the equator in the direction psi from v1: exp(-steepness sin^2 t).
double steepness(double k1, double k2, double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  return -k1 * c * c - k2 * s * s;
}

/// Integral of exp(-a (1 - c^2)) over c from 0 to 1.
double mass(double a) { return a > 0 ? dawson(std::sqrt(a)) / std::sqrt(a) : 1; }

/// Azimuths are taken at equal steps of an angle theta with tan psi = stretch tan theta: the marginal law, about
/// 1/(1/2 + a(psi)), is then nearly even however narrow a girdle is.
double stretch_of(double k1, double k2) { return std::sqrt((0.5 - k1) / (0.5 - k2)); }
double azimuth_at(double stretch, double theta) { return std::atan2(stretch * std::sin(theta), std::cos(theta)); }
/// d psi/d theta.
double slope_at(double stretch, double theta) {
  const double c = std::cos(theta), s = stretch * std::sin(theta);
  return stretch / (c * c + s * s);
}

}  // namespace

BinghamOrientation BinghamOrientation::make(Dip dip, DipDirection direction, double k1, double k2, Rotation axis) {
  CLEAVE_ASSERT(k1 <= 0 && k1 >= -1e9 && k2 <= 0 && k2 >= -1e9);
  BinghamOrientation law{dip, direction, k1, k2, axis, {}, {}};
  const double stretch = stretch_of(k1, k2), step = pi / 2 / panels;
  double sum = 0;
  for (std::size_t i = 0; i <= panels; ++i) {
    const double theta = static_cast<double>(i) * step;
    const double density = mass(steepness(k1, k2, azimuth_at(stretch, theta))) * slope_at(stretch, theta);
    if (i > 0) sum += (law.density.back() + density) / 2;
    law.density.push_back(density);
    law.cumulative.push_back(sum);
  }
  for (double& d : law.density) d /= sum;
  for (double& c : law.cumulative) c /= sum;
  law.cumulative.back() = 1;
  return law;
}

namespace detail {

double dawson(double x) noexcept {
  const double x2 = x * x;
  if (x < 0.2) {
    return x * (1 - x2 * (2.0 / 3) *
                        (1 - x2 * (2.0 / 5) *
                                 (1 - x2 * (2.0 / 7) *
                                          (1 - x2 * (2.0 / 9) * (1 - x2 * (2.0 / 11) * (1 - x2 * (2.0 / 13)))))));
  }
  if (x > 40) {  // 1/2x (1 + 1/(2x^2) + 3/(2x^2)^2 + 15/(2x^2)^3 ...)
    const double y = 1 / (2 * x2);
    return 1 / (2 * x) * (1 + y * (1 + 3 * y * (1 + 5 * y * (1 + 7 * y * (1 + 9 * y)))));
  }
  // Sum over odd n of exp(-(x - n h)^2)/n, over sqrt(pi): exact to exp(-(pi/2h)^2).
  constexpr double h = 0.25;
  const auto middle = static_cast<int>(std::lround((x / h - 1) / 2));  // n = 2 k + 1
  double sum = 0;
  for (int k = middle - 13; k <= middle + 13; ++k) {
    const double n = 2 * k + 1, d = x - n * h;
    sum += std::exp(-d * d) / n;
  }
  return sum * std::numbers::inv_sqrtpi;
}

BinghamDraw draw_bingham(const BinghamOrientation& law, double u, double v) noexcept {
  // Azimuth: the quarter, then the place in it; between two steps the density is a straight line.
  const double quarters = std::min(4 * u, 4 - 0x1p-50), quarter = std::floor(quarters);
  const double part = quarters - quarter;
  const auto above = std::ranges::upper_bound(law.cumulative, part) - law.cumulative.begin();
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above, 1, panels) - 1);
  const double low = law.density[i], rise = law.density[i + 1] - low, rest = part - law.cumulative[i];
  const double within = std::min(1.0, 2 * rest / (low + std::sqrt(std::max(0.0, low * low + 2 * rise * rest))));
  const double theta = (static_cast<double>(i) + within) * (pi / 2 / panels);
  const double azimuth = azimuth_at(stretch_of(law.k1, law.k2), theta);
  const double a = steepness(law.k1, law.k2, azimuth);
  const double turned = quarter == 0   ? azimuth
                        : quarter == 1 ? pi - azimuth
                        : quarter == 2 ? pi + azimuth
                                       : 2 * pi - azimuth;
  if (a < 1e-12) return {v, turned};
  // Versine w with G(w) = v G(1), G(w) the integral of exp(-a (2x - x^2)) from 0: concave, so Newton's steps from below
  // stay below. Fisher's law of kappa = 2 a begins below.
  const double root = std::sqrt(a), all = mass(a), target = v * all;
  double w = std::min(1.0, -std::log1p(v * std::expm1(-2 * a)) / (2 * a));
  if (!(w >= 0)) w = 0;
  for (int round = 0; round < 100; ++round) {
    const double weight = std::exp(-a * w * (2 - w));
    const double reached = all - weight * dawson(root * (1 - w)) / root;
    const double next = std::clamp(w + (target - reached) / weight, 0.0, 1.0);
    const bool same = std::abs(next - w) <= 4e-16 * w || (round > 60 && next <= w);
    w = next;
    if (same) break;
  }
  return {w, turned};
}

double mean_cosine(const BinghamOrientation& law) noexcept {
  const double stretch = stretch_of(law.k1, law.k2);
  double cosines = 0, all = 0;
  for (std::size_t i = 0; i < panels; ++i) {  // an even function of period pi: midpoints are exact to rounding
    const double theta = (static_cast<double>(i) + 0.5) * (pi / 2 / panels), slope = slope_at(stretch, theta);
    const double a = steepness(law.k1, law.k2, azimuth_at(stretch, theta));
    cosines += slope * (a > 1e-12 ? -std::expm1(-a) / (2 * a) : 0.5);
    all += slope * mass(a);
  }
  return cosines / all;
}

}  // namespace detail
}  // namespace cleave::dfn
