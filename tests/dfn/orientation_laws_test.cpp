#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "bingham.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/dfn/joint_set.hpp"
#include "orientation.hpp"

// Bingham's law and the bivariate normal law against closed forms and independent quadrature. Seeds are fixed.

namespace cleave::dfn {
namespace {

using geometry::Vec3;

constexpr double pi = std::numbers::pi;

TEST(DawsonTest, AgreesWithItsTable) {  // Abramowitz & Stegun (1964), table 7.5; beyond, the asymptotic series
  EXPECT_NEAR(detail::dawson(0.1), 0.0993359924, 5e-11);
  EXPECT_NEAR(detail::dawson(0.5), 0.4244363835, 5e-11);
  EXPECT_NEAR(detail::dawson(1), 0.5380795069, 5e-11);
  EXPECT_NEAR(detail::dawson(2), 0.3013403889, 5e-11);
  EXPECT_NEAR(detail::dawson(0.2 - 1e-12), detail::dawson(0.2 + 1e-12), 1e-11);
  EXPECT_NEAR(detail::dawson(40 - 1e-9) / detail::dawson(40 + 1e-9), 1, 1e-10);
  // F' = 1 - 2 x F
  for (const double x : {0.05, 0.3, 1.7, 6.0, 25.0, 60.0}) {
    const double h = 1e-4 * (1 + x);
    const double slope = (detail::dawson(x + h) - detail::dawson(x - h)) / (2 * h);
    EXPECT_NEAR(slope, 1 - 2 * x * detail::dawson(x), 2e-8 / (x * x + 0.1)) << x;
  }
}

struct Shares {
  double first = 0, second = 0, cosine = 0;     ///< E (n.v1)^2, E (n.v2)^2, E |n.v3|
  std::array<std::array<double, 6>, 8> bins{};  ///< azimuth, cosine
};

constexpr std::array<double, 7> steps_of(double k) {
  // Cosines that part the law in pieces of some size, however narrow it is.
  std::array<double, 7> c{0, 0, 0, 0, 0, 0, 1};
  for (std::size_t i = 1; i < 6; ++i)
    c[i] = k > 4 ? 1 - (6 - static_cast<double>(i)) * 0.6 / k : static_cast<double>(i) / 6;
  return c;
}
std::size_t bin_of(const std::array<double, 7>& steps, double c) {
  std::size_t i = 0;
  while (i < 5 && c >= steps[i + 1]) ++i;
  return i;
}

/// By midpoints in (psi, 1 - c), independent of the way it is drawn.
Shares quadrature(double k1, double k2, const std::array<double, 7>& steps) {
  Shares shares;
  double all = 0;
  constexpr int around = 720, up = 4000;
  const double steep = std::max(1.0, -std::max(k1, k2));
  for (int j = 0; j < around; ++j) {
    const double psi = 2 * pi * (j + 0.5) / around;
    const double a = -k1 * std::cos(psi) * std::cos(psi) - k2 * std::sin(psi) * std::sin(psi);
    for (int i = 0; i < up; ++i) {
      // x in (0, 1) to versine w: dense near the pole.
      const double x = (i + 0.5) / up, w = std::expm1(x * std::log1p(20 * steep)) / (20 * steep);
      const double dw = std::exp(x * std::log1p(20 * steep)) * std::log1p(20 * steep) / (20 * steep);
      const double c = 1 - w, s2 = w * (2 - w), p = std::exp(-a * s2) * dw;
      all += p;
      shares.first += p * s2 * std::cos(psi) * std::cos(psi);
      shares.second += p * s2 * std::sin(psi) * std::sin(psi);
      shares.cosine += p * c;
      shares.bins[static_cast<std::size_t>(8 * psi / (2 * pi))][bin_of(steps, c)] += p;
    }
  }
  shares.first /= all;
  shares.second /= all;
  shares.cosine /= all;
  for (auto& row : shares.bins) {
    for (double& share : row) share /= all;
  }
  return shares;
}

TEST(BinghamTest, DrawsHaveTheLaw) {
  struct Law {
    double k1, k2;
  };
  for (const auto& [k1, k2] :
       {Law{0, 0}, Law{-3, -1}, Law{-20, -20}, Law{-60, -15}, Law{-40, -0.5}, Law{-2, -30}, Law{-500, -3}}) {
    SCOPED_TRACE(k1);
    SCOPED_TRACE(k2);
    const BinghamOrientation law = BinghamOrientation::make(Dip::degrees(0), DipDirection::degrees(0), k1, k2, {});
    const auto steps = steps_of(-std::max(k1, k2));
    const Shares exact = quadrature(k1, k2, steps);
    constexpr int n = 40'000;
    Shares drawn;
    double first2 = 0, second2 = 0, cosine2 = 0;
    for (int i = 0; i < n; ++i) {
      Rng rng{{.seed = 5, .realization = static_cast<std::uint64_t>(i)}};
      const double u = rng.uniform(), v = rng.uniform();
      const detail::BinghamDraw d = detail::draw_bingham(law, u, v);
      ASSERT_TRUE(d.versine >= 0 && d.versine <= 1);
      const double s2 = d.versine * (2 - d.versine), x = s2 * std::pow(std::cos(d.azimuth), 2), y = s2 - x;
      drawn.first += x / n;
      drawn.second += y / n;
      drawn.cosine += (1 - d.versine) / n;
      first2 += x * x / n;
      second2 += y * y / n;
      cosine2 += (1 - d.versine) * (1 - d.versine) / n;
      drawn.bins[std::min<std::size_t>(7, static_cast<std::size_t>(8 * d.azimuth / (2 * pi)))]
                [bin_of(steps, 1 - d.versine)] += 1.0 / n;
    }
    const auto near = [](double mean, double square, double truth) {
      EXPECT_NEAR(mean, truth, 4.5 * std::sqrt((square - mean * mean) / n) + 1e-12);
    };
    near(drawn.first, first2, exact.first);
    near(drawn.second, second2, exact.second);
    near(drawn.cosine, cosine2, exact.cosine);
    EXPECT_NEAR(detail::mean_cosine(law), exact.cosine, 2e-5);
    double chi2 = 0;
    int bins = -1;
    for (std::size_t j = 0; j < 8; ++j) {
      for (std::size_t i = 0; i < 6; ++i) {
        const double expected = n * exact.bins[j][i];
        if (expected < 5) continue;
        ++bins;
        chi2 += std::pow(n * drawn.bins[j][i] - expected, 2) / expected;
      }
    }
    EXPECT_GT(bins, 20);
    EXPECT_GT(special::chi_squared_above(chi2, bins), 1e-4) << chi2 << " in " << bins;
  }
}

TEST(BinghamTest, EqualOnBothAxesIsWatsonsLaw) {  // E c^2 of exp(k c^2) on the sphere: F'/F of Dawson's integral
  const double k = 12, f = detail::dawson(std::sqrt(k)) / std::sqrt(k);
  const double c2 = (1 - f) / (2 * k) / f;
  const BinghamOrientation law = BinghamOrientation::make(Dip::degrees(0), DipDirection::degrees(0), -k, -k, {});
  double mean = 0, square = 0;
  constexpr int n = 40'000;
  for (int i = 0; i < n; ++i) {
    Rng rng{{.seed = 6, .realization = static_cast<std::uint64_t>(i)}};
    const double u = rng.uniform(), v = rng.uniform();
    const double c = 1 - detail::draw_bingham(law, u, v).versine;
    mean += c * c / n;
    square += std::pow(c, 4) / n;
  }
  EXPECT_NEAR(mean, c2, 4.5 * std::sqrt((square - mean * mean) / n));
  EXPECT_NEAR(detail::mean_cosine(law), -std::expm1(-k) / (2 * k) / f, 1e-12);
}

TEST(BinghamTest, AxesLieInTheMeanPlane) {
  // Dip 40 to 070, axis of k1 at 25 degrees from the strike: normals stay away from it and spread across.
  const OrientationLaw law =
      BinghamOrientation::make(Dip::degrees(40), DipDirection::degrees(70), -400, -20, Rotation::degrees(25));
  const detail::Frame mean = detail::mean_frame(law);
  const Vec3 up_dip = cross(mean.normal, mean.strike);
  const double c = std::cos(25 * pi / 180), s = std::sin(25 * pi / 180);
  const Vec3 v1 = c * mean.strike + s * up_dip, v2 = c * up_dip - s * mean.strike;
  double first = 0, second = 0;
  constexpr int n = 4'000;
  for (int i = 0; i < n; ++i) {
    Rng rng{{.seed = 7, .realization = static_cast<std::uint64_t>(i)}};
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3 normal = detail::draw(law, u, v).normal;
    EXPECT_NEAR(norm(normal), 1, 1e-12);
    first += std::pow(dot(normal, v1), 2) / n;
    second += std::pow(dot(normal, v2), 2) / n;
  }
  EXPECT_NEAR(first, 1.0 / 800, 1e-4);  // normal law of variance 1/(2 k)
  EXPECT_NEAR(second, 1.0 / 40, 3e-3);
}

TEST(BinghamTest, ExtremesStayFinite) {
  for (const double k1 : {0.0, -1e-9, -1.0, -1e5, -1e9}) {
    for (const double k2 : {0.0, -1e-9, -1.0, -1e5, -1e9}) {
      const BinghamOrientation law = BinghamOrientation::make(Dip::degrees(0), DipDirection::degrees(0), k1, k2, {});
      for (const double u : {0x1p-53, 0.1, 0.25, 0.5, 0.9999, 1 - 0x1p-53}) {
        for (const double v : {0x1p-53, 0.3, 0.99, 1 - 0x1p-53}) {
          const detail::BinghamDraw d = detail::draw_bingham(law, u, v);
          EXPECT_TRUE(d.versine >= 0 && d.versine <= 1 && std::isfinite(d.azimuth)) << k1 << " " << k2;
        }
      }
      const double cosine = detail::mean_cosine(law);
      EXPECT_TRUE(cosine > 0.49 && cosine <= 1) << k1 << " " << k2 << " " << cosine;
    }
  }
}

TEST(NormalOrientationTest, DipAndDirectionAreBivariateNormal) {
  for (const double r : {-0.8, 0.0, 0.5, 1.0}) {
    const NormalOrientation law{Dip::degrees(45), DipDirection::degrees(180), Dip::degrees(4),
                                DipDirection::degrees(10), r};
    double sum = 0, one = 0, two = 0;
    double chi2 = 0;
    std::array<double, 16> squares{};
    constexpr int n = 20'000;
    for (int i = 0; i < n; ++i) {
      Rng rng{{.seed = 8, .realization = static_cast<std::uint64_t>(i)}};
      const double u = rng.uniform(), v = rng.uniform();
      const Vec3 normal = detail::draw(OrientationLaw{law}, u, v).normal;
      const double x = (std::acos(normal.z) * 180 / pi - 45) / 4;
      const double y = std::remainder(std::atan2(normal.x, normal.y) * 180 / pi - 180, 360) / 10;
      sum += x * y / n;
      one += x * x / n;
      two += y * y / n;
      if (std::abs(r) < 1) {  // Mahalanobis' distance is exponential
        const double q = (x * x - 2 * r * x * y + y * y) / (1 - r * r);
        squares[std::min<std::size_t>(15, static_cast<std::size_t>(16 * -std::expm1(-q / 2)))] += 1;
      }
    }
    EXPECT_NEAR(sum, r, 4.5 * std::sqrt((1 + r * r) / n));
    EXPECT_NEAR(one, 1, 4.5 * std::sqrt(2.0 / n));
    EXPECT_NEAR(two, 1, 4.5 * std::sqrt(2.0 / n));
    if (std::abs(r) == 1) continue;
    for (const double in : squares) chi2 += std::pow(in - n / 16.0, 2) / (n / 16.0);
    EXPECT_GT(special::chi_squared_above(chi2, 15), 1e-4) << r;
  }
}

}  // namespace
}  // namespace cleave::dfn
