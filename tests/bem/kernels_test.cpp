#include <gtest/gtest.h>

#include "../../lib/bem/src/element_rows.hpp"
#include "../../lib/bem/src/gauss.hpp"
#include "shapes.hpp"

namespace cleave::bem {
namespace {

using testing::rate;

struct KernelRow {
  Vec2 d, n;
  Mat2 u, t;
};

TEST(Kelvin, TabulatedValues) {
  // Independent numbers (mpmath), mu = 1, nu = 1/4.
  const std::vector<KernelRow> rows{
      {{1, 0}, {1, 0}, {0.0530516476972984, 0, 0, 0}, {-0.265258238486492, 0, 0, -0.0530516476972984}},
      {{0.3, 0.4},
       {0.6, 0.8},
       {0.0926437932219113, 0.0254647908947033, 0.0254647908947033, 0.107498254577155},
       {-0.258892040762816, -0.203718327157626, -0.203718327157626, -0.377727731604765}},
      {{3, 4},
       {0, 1},
       {-0.151668073071231, 0.0254647908947033, 0.0254647908947033, -0.136813611715988},
       {-0.0207113632610253, -0.00993126844893427, -0.0226636638962859, -0.0302182185283812}},
      {{-1, 2},
       {0.28, -0.96},
       {-0.0747730035816697, -0.0212206590789194, -0.0212206590789194, -0.0429420149632906},
       {0.0420169049762604, -0.0331042281631142, -0.041592491794682, 0.0980394449446075}}};
  for (const KernelRow& row : rows) {
    const Mat2 u = kelvin_displacement(row.d, {1, 0.25});
    const Mat2 t = kelvin_traction(row.d, row.n, 0.25);
    for (const auto& [got, want] : {std::pair{u, row.u}, std::pair{t, row.t}}) {
      EXPECT_NEAR(got.xx, want.xx, 1e-14);
      EXPECT_NEAR(got.xy, want.xy, 1e-14);
      EXPECT_NEAR(got.yx, want.yx, 1e-14);
      EXPECT_NEAR(got.yy, want.yy, 1e-14);
    }
  }
  const StressKernels k = kelvin_stress({3, 4}, {0, 1}, {1, 0.25});
  EXPECT_NEAR(k.traction[0].xx, 0.015533522445769, 1e-15);
  EXPECT_NEAR(k.traction[0].xy, 0.0207113632610253, 1e-15);
  EXPECT_NEAR(k.traction[0].yy, 0.00993126844893427, 1e-15);
  EXPECT_NEAR(k.traction[1].yy, 0.0302182185283812, 1e-15);
  EXPECT_NEAR(k.displacement[0].xx, -0.00358544255797422, 1e-15);
  EXPECT_NEAR(k.displacement[0].xy, -0.00715730389413793, 1e-15);
  EXPECT_NEAR(k.displacement[0].yy, -0.0127120236146359, 1e-15);
  EXPECT_NEAR(k.displacement[1].yy, 0.00240387626045998, 1e-15);
}

TEST(HalfPlane, SurfaceCarriesNoTraction) {
  const Elastic e{2.5, 0.31};
  const HalfPlane h{0.7};
  const Vec2 y{0.2, -0.4};
  for (const double at : {-3.0, -0.5, 0.2, 0.9, 7.0}) {
    const Vec2 x{at, h.level};
    const Mat2 t = kelvin_traction(x - y, {0, 1}, e.nu) + half_plane_traction(x, y, {0, 1}, e, h);
    EXPECT_NEAR(t.xx, 0, 1e-14);
    EXPECT_NEAR(t.xy, 0, 1e-14);
    EXPECT_NEAR(t.yx, 0, 1e-14);
    EXPECT_NEAR(t.yy, 0, 1e-14);
  }
}

TEST(HalfPlane, TractionFollowsFromDisplacement) {
  const Elastic e{1.7, 0.2};
  const HalfPlane h{0};
  const Vec2 y{0.1, -1.1};
  const Vec2 x{0.9, -0.5};
  const double step = 1e-5;
  const auto u = [&](Vec2 p) { return half_plane_displacement(p, y, e, h); };
  const Mat2 dx = (0.5 / step) * (u(x + Vec2{step, 0}) - u(x - Vec2{step, 0}));
  const Mat2 dy = (0.5 / step) * (u(x + Vec2{0, step}) - u(x - Vec2{0, step}));
  const double lambda = 2 * e.mu * e.nu / (1 - 2 * e.nu);
  const Vec2 n{0.6, 0.8};
  const Mat2 t = half_plane_traction(x, y, n, e, h);
  const auto check = [&](double ux_x, double uy_x, double ux_y, double uy_y, double tx, double ty) {
    const double v = lambda * (ux_x + uy_y);
    const Sym2 s{v + 2 * e.mu * ux_x, e.mu * (ux_y + uy_x), v + 2 * e.mu * uy_y};
    EXPECT_NEAR((s * n).x, tx, 1e-8);
    EXPECT_NEAR((s * n).y, ty, 1e-8);
  };
  check(dx.xx, dx.xy, dy.xx, dy.xy, t.xx, t.xy);
  check(dx.yx, dx.yy, dy.yx, dy.yy, t.yx, t.yy);
}

TEST(HalfPlane, ReciprocalAndStressKernelsAreTheGradient) {
  const Elastic e{1.7, 0.2};
  const HalfPlane h{0};
  const Vec2 y{0.1, -1.1};
  const Vec2 x{0.9, -0.5};
  const Vec2 n{0.6, 0.8};
  // Betti: U_ij(x, y) = U_ji(y, x), up to the rigid motion that is free in a half plane: none is added here.
  const Mat2 a = half_plane_displacement(x, y, e, h);
  const Mat2 b = half_plane_displacement(y, x, e, h);
  EXPECT_NEAR(a.xx, b.xx, 1e-13);
  EXPECT_NEAR(a.xy, b.yx, 1e-13);
  EXPECT_NEAR(a.yx, b.xy, 1e-13);
  EXPECT_NEAR(a.yy, b.yy, 1e-13);
  const double step = 1e-5;
  const double lambda = 2 * e.mu * e.nu / (1 - 2 * e.nu);
  const auto gradient = [&](auto&& kernel) {
    const Mat2 dx = (0.5 / step) * (kernel(y + Vec2{step, 0}) - kernel(y - Vec2{step, 0}));
    const Mat2 dy = (0.5 / step) * (kernel(y + Vec2{0, step}) - kernel(y - Vec2{0, step}));
    const auto stress = [&](double gxx, double gxy, double gyx, double gyy) {
      const double v = lambda * (gxx + gyy);
      return Sym2{v + 2 * e.mu * gxx, e.mu * (gxy + gyx), v + 2 * e.mu * gyy};
    };
    return std::array{stress(dx.xx, dy.xx, dx.yx, dy.yx), stress(dx.xy, dy.xy, dx.yy, dy.yy)};
  };
  const StressKernels k = half_plane_stress(x, y, n, e, h);
  const auto d = gradient([&](Vec2 p) { return half_plane_displacement(x, p, e, h); });
  const auto s = gradient([&](Vec2 p) { return half_plane_traction(x, p, n, e, h); });
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(testing::largest(k.traction[c] - d[c]), 1e-8);
    EXPECT_LT(testing::largest(k.displacement[c] - s[c]), 1e-8);
  }
}

TEST(Gauss, IntegratesPolynomials) {
  for (const std::size_t n : {1U, 2U, 5U, 20U, 33U, 64U}) {
    const GaussRule& rule = gauss(n);
    for (const std::size_t power : {std::size_t{0}, 2 * n - 2}) {
      double sum = 0;
      for (std::size_t k = 0; k < n; ++k) sum += rule.w[k] * std::pow(rule.s[k], static_cast<double>(power));
      EXPECT_NEAR(sum, 2 / (static_cast<double>(power) + 1), 1e-14) << n << " " << power;
    }
  }
}

TEST(Integrator, StraightAndCurvedSingularRulesAgree) {
  // A straight element integrated in closed form, and as a quadratic one by the general rule.
  Mesh mesh = make_mesh({polygon({{0, 0}, {1, 0}, {1, 1}}, 0, 1)}, {});
  Mesh same = mesh;
  for (Element& e : same.elements) e.curved = true;
  const Integrator a{mesh, {{1.3, 0.3}}, 1e-12};
  const Integrator b{same, {{1.3, 0.3}}, 1e-12};
  for (const double s : {-1.0, 0.0, 1.0, 0.4, -2.0 / 3}) {
    ElementIntegrals p, q;
    a.integrate(1, mesh.elements[1].at(s), s, p);
    b.integrate(1, mesh.elements[1].at(s), s, q);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(p.g[k].xx, q.g[k].xx, 1e-14);
      EXPECT_NEAR(p.g[k].yy, q.g[k].yy, 1e-14);
      EXPECT_NEAR(p.g[k].xy, q.g[k].xy, 1e-14);
      EXPECT_NEAR(p.h[k].xy, q.h[k].xy, 1e-13);
      EXPECT_NEAR(p.h[k].yx, q.h[k].yx, 1e-13);
      EXPECT_NEAR(p.h[k].xx, q.h[k].xx, 1e-13);
    }
  }
}

TEST(Integrator, MeetsItsTargetAtAnyDistance) {
  const Mesh mesh = make_mesh({circle({0, 0}, 1, false, 0, 8)}, {});
  const Integrator sharp{mesh, {{1, 0.3}}, 1e-15};
  for (const double tolerance : {1e-6, 1e-10}) {
    const Integrator rough{mesh, {{1, 0.3}}, tolerance};
    for (const double distance : {3.0, 0.3, 1e-2, 1e-4, 1e-6}) {
      ElementIntegrals p, q;
      const Vec2 y = (1 - distance) * mesh.elements[3].at(0.3);
      sharp.integrate(3, y, std::nullopt, p);
      rough.integrate(3, y, std::nullopt, q);
      double worst = 0;
      double size = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        for (const auto& [m, w] : {std::pair{p.g[k], q.g[k]}, std::pair{p.h[k], q.h[k]}}) {
          const Mat2 d = m - w;
          worst = std::max({worst, std::abs(d.xx), std::abs(d.xy), std::abs(d.yx), std::abs(d.yy)});
          size = std::max({size, std::abs(m.xx), std::abs(m.xy), std::abs(m.yx), std::abs(m.yy)});
        }
      }
      EXPECT_LT(worst, 10 * tolerance * size) << "distance " << distance << " target " << tolerance;
    }
  }
}

}  // namespace
}  // namespace cleave::bem
