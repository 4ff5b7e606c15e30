#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cleave/motion/world.hpp"
#include "shapes.hpp"

namespace cleave::motion {
namespace {

constexpr Symmetric asymmetric{6.5, 5, 2.5, 0, 0, 0};  // box 1 x 2 x 3

Vec3 spin_after(const Symmetric& inertia, Vec3 spin, double time, unsigned steps, double* worst = nullptr) {
  Spinning body{{}, inertia * spin};
  const double energy = dot(spin, body.momentum);
  const Vec3 momentum = body.momentum;
  for (unsigned k = 0; k < steps; ++k) {
    body = drift(inertia, body, time / steps);
    body.turn = normalized(body.turn);
    if (worst == nullptr) continue;
    const Vec3 w = solve(inertia, body.momentum);
    *worst = std::max({*worst, std::abs(dot(w, body.momentum) / energy - 1),
                       norm(body.turn * body.momentum - momentum) / norm(momentum)});
  }
  return solve(inertia, body.momentum);
}

TEST(Turning, SymmetricTopPrecesses) {
  const Symmetric j{2.5, 2.5, 0.5, 0, 0, 0};  // 1 x 1 x 3 of mass 3
  const Vec3 w{0.3, 0, 4};
  const double precession = norm(j * w) / 2.5, body_rate = 3.2;
  EXPECT_NEAR(precession, 0.85440037, 1e-8);
  const double time = 2 * std::numbers::pi / body_rate;
  std::array<double, 2> error{};
  for (const unsigned k : {0U, 1U}) error[k] = norm(spin_after(j, w, time, 200U << k) - w);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.02);
  EXPECT_LT(error[1], 1e-4);
  // The axis stays on its cone about the momentum, whatever the step.
  Spinning body{{}, j * w};
  const Vec3 axis = geometry::normalized(j * w);
  for (unsigned k = 0; k < 50; ++k) {
    body = drift(j, body, 0.2);
    EXPECT_NEAR(std::acos(dot(body.turn * Vec3{0, 0, 1}, axis)) / shapes::degree, 20.556045, 1e-6);
  }
}

TEST(Turning, AsymmetricTopComesBackAfterItsPeriod) {
  struct Case {
    Vec3 spin;
    double period;
  };
  for (const auto& [spin, period] : {Case{{0.01, 1, 0}, 46.837819}, Case{{0, 1, 0.01}, 48.689851},
                                     Case{{1, 0.5, 0.2}, 8.8700152}, Case{{0.001, 1, 0.001}, 70.277973}}) {
    double kept = 0;
    std::array<double, 2> error{};
    for (const unsigned k : {0U, 1U}) {
      error[k] = norm(spin_after(asymmetric, spin, period, 2000U << k, &kept) - spin);
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
    EXPECT_LT(error[1], 1e-3);
    EXPECT_LT(kept, 1e-11);
    if (spin.y == 1) {
      EXPECT_LT(spin_after(asymmetric, spin, period / 2, 40'000).y, -0.9);
    }
  }
}

TEST(Turning, KeepsEnergyAtThreeRadiansAStep) {
  double kept = 0;
  (void)spin_after({1, 1, 0.01, 0, 0, 0}, {1, 0.5, 30}, 200, 2000, &kept);
  EXPECT_LT(kept, 1e-11);
}

TEST(Turning, ObliqueAxesTurnAsPrincipalOnes) {
  const Turn q = turn_by({0.3, -0.5, 0.7});
  Symmetric j;
  for (const Vec3 e : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 column = q * (asymmetric * q.back(e));
    if (e.x == 1) j.xx = column.x, j.xy = column.y, j.zx = column.z;
    if (e.y == 1) j.yy = column.y, j.yz = column.z;
    if (e.z == 1) j.zz = column.z;
  }
  const Vec3 w{1, 0.5, 0.2};
  EXPECT_LT(norm(spin_after(j, q * w, 5, 500) - q * spin_after(asymmetric, w, 5, 500)), 1e-11);
}

}  // namespace
}  // namespace cleave::motion
