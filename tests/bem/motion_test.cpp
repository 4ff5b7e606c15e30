#include <gtest/gtest.h>

#include "cleave/bem/block.hpp"
#include "cleave/bem/motion.hpp"
#include "drbem.hpp"
#include "shapes.hpp"

namespace cleave::bem {
namespace {

using std::numbers::pi;
using testing::of_shear;

TEST(Schemes, SpectralRadii) {
  const auto at = [](Scheme s, double omega) { return spectral_radius(s, omega * omega); };
  for (const double o : {0.1, 1.0, 3.9}) EXPECT_NEAR(at(Newmark{0.5, 1}, o), 1 / std::sqrt(1 + o * o / 2), 1e-12);
  EXPECT_NEAR(at(Newmark{0.25, 0.5}, 100), 1, 1e-9);
  EXPECT_NEAR(at(Newmark{0.5625, 1}, 10), 0.356, 5e-4);
  EXPECT_NEAR(at(GeneralizedAlpha{0.8}, 1e6), 0.8, 1e-4);
  EXPECT_NEAR(at(GeneralizedAlpha{0.5}, 10), 0.683, 5e-4);
  EXPECT_NEAR(at(Houbolt{}, 1), 0.907, 5e-4);
  EXPECT_NEAR(at(Houbolt{}, 100), 0.048, 5e-4);
  EXPECT_NEAR(at(BackwardEuler{}, 2), 1 / std::sqrt(5.0), 1e-12);
  // Complex eigenvalue of angle 0.02: Newmark (1/2, 1) grows below 4 sin(0.01).
  EXPECT_GT(spectral_radius(Newmark{0.5, 1}, std::polar(0.039 * 0.039, 0.02)), 1);
  EXPECT_LT(spectral_radius(Newmark{0.5, 1}, std::polar(0.041 * 0.041, 0.02)), 1);
}

BlockOperator column(double nu, std::optional<std::size_t> bubbles) {
  BlockOptions o;
  o.bubbles = bubbles;
  return BlockOperator::make({testing::rectangle({-1, 0}, {1, 4}, {0, 0, 0, 0}, {2, 4, 2, 4})},
                             testing::material(1e5, nu, 1), o)
      .value();
}

std::vector<HeldFreedom> base_of(const BlockOperator& b) {
  std::vector<HeldFreedom> held;
  for (std::size_t i = 0; i < b.mesh().nodes.size(); ++i) {
    if (std::abs(b.mesh().nodes[i].x.y + 2) < 1e-9) {
      held.push_back({i, {1, 0}});
      held.push_back({i, {0, 1}});
    }
  }
  return held;
}

std::vector<double> top_load(const BlockOperator& b, Vec2 t) {
  std::vector<std::array<Vec2, 3>> all(b.mesh().elements.size());
  for (std::size_t e = 0; e < all.size(); ++e) {
    if (b.mesh().elements[e].normal(0).y > 0.5) all[e] = {t, t, t};
  }
  return b.forces_of(all);
}

double wave_exact(double t) {  // d'Alembert: triangle wave between 0 and 8e-5, period 16 / c
  const double c = std::sqrt(1e5);
  const double phase = std::fmod(t, 16 / c);
  return 1e-5 * (phase <= 8 / c ? phase : 16 / c - phase) * c;
}

TEST(AxialWave, FollowsDAlembert) {
  const BlockOperator b = column(0, 3);
  Vibration motion{b,
                   supported_modes(b, base_of(b)),
                   GeneralizedAlpha{0.8},
                   5e-5,
                   {},
                   {{top_load(b, {0, 1}), [](double) { return 1.0; }, false}}};
  const BoundaryPlace top = b.place({0, 2});
  double square = 0;
  double peak = 0;
  for (int k = 0; k < 2000; ++k) {
    motion.advance();
    const double u = motion.displacement_at(top).y;
    square += std::pow(u - wave_exact(motion.time()), 2);
    peak = std::max(peak, u);
  }
  EXPECT_LT(std::sqrt(square / 2000) / 4e-5, 0.06);
  EXPECT_NEAR(peak, 7.9e-5, 3e-6);
}

TEST(Spin, ADiscCarriesTheStressOfItsInertia) {
  // Plane stress, settled: radial (3 + nu) / 8 rho w^2 (R^2 - r^2), hoop the same less (1 + 3 nu) / 8 rho w^2 r^2.
  const double nu = 0.3, rho = 7800, w = 100;
  BlockOptions o;
  const BlockOperator b =
      BlockOperator::make({circle({2, -1}, 1, false, 0, 24)}, testing::material(200e9, nu, rho, PlaneState::stress), o)
          .value();
  FreeMotion elastic{b, {.step = 2e-5, .modes = 200, .damping = {.share = 1}, .spin = w}};
  const std::vector<double> radii{0, 0.3, 0.6, 0.9, 0.99};
  for (const double r : radii) elastic.follow({r, 0});
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(elastic.advance().has_value());
  const double unit = rho * w * w;
  const auto radial = [&](double r) { return (3 + nu) / 8 * unit * (1 - r * r); };
  const auto hoop = [&](double r) { return (3 + nu) / 8 * unit - (1 + 3 * nu) / 8 * unit * r * r; };
  EXPECT_NEAR(radial(0), 32.175e6, 1);
  EXPECT_NEAR(hoop(1), 13.65e6, 1);
  for (std::size_t p = 0; p < radii.size(); ++p) {
    const Sym2 s = elastic.inner(p).stress;
    EXPECT_NEAR(s.xx, radial(radii[p]), 2e-3 * radial(0)) << radii[p];
    EXPECT_NEAR(s.yy, hoop(radii[p]), 2e-3 * radial(0)) << radii[p];
  }
  const auto u = elastic.strained();
  const Sym2 rim = boundary_stress(b, b.place({1, 0}), u, tractions_of(b, u));
  EXPECT_NEAR(rim.xx, 0, 2e-3 * radial(0));
  EXPECT_NEAR(rim.yy, hoop(1), 2e-3 * radial(0));
}

TEST(AxialWave, NewmarkOfTheSourceIsDampedAndEveryStepIsStable) {
  const BlockOperator b = column(0.25, std::nullopt);
  const Modes modes = supported_modes(b, base_of(b));
  const auto peak = [&](Scheme s, double step, double until) {
    Vibration motion{b, modes, s, step, {}, {{top_load(b, {0, 1}), [](double) { return 1.0; }, false}}};
    const BoundaryPlace top = b.place({0, 2});
    double most = 0;
    for (int k = 0; k < static_cast<int>(until / step); ++k) {
      motion.advance();
      most = std::max(most, std::abs(motion.displacement_at(top).y));
    }
    return most;
  };
  // Parameters of Fu (2014): peaks of a mesh four times as fine with 72 inner motions.
  EXPECT_NEAR(peak(Newmark{0.5, 1}, 5e-4, 0.1), 6.833e-5, 1.2e-7);
  EXPECT_NEAR(peak(Newmark{0.5, 1}, 2e-4, 0.1), 6.990e-5, 1.2e-7);
  // The static answer twice over is 8e-5. Houbolt, of second order, loses less of it than this Newmark, of first.
  const double houbolt = peak(Houbolt{}, 2e-4, 0.1);
  EXPECT_GT(houbolt, peak(Newmark{0.5, 1}, 2e-4, 0.1) + 5e-7);
  EXPECT_LT(houbolt, peak(Newmark{0.5, 1}, 2e-4, 0.1) + 3e-6);
  for (const double step : {1e-7, 1e-5, 1e-3, 1e-1, 10.0}) {
    for (const double l : modes.eigenvalues) {
      EXPECT_LE(spectral_radius(GeneralizedAlpha{0.8}, l * step * step), 1 + 1e-9);
    }
  }
  EXPECT_LT(peak(GeneralizedAlpha{0.8}, 10, 1000), 1e-4);
}

TEST(Cantilever66, TriangularImpulse) {
  // Source 6.6.2: shear impulse on the top, 2e-4 s steps over 0.3 s; first bending frequency below Euler's 6.595 Hz.
  const BlockOperator b = column(0.25, 3);
  const Modes modes = supported_modes(b, base_of(b));
  EXPECT_LT(std::sqrt(modes.eigenvalues[0]) / (2 * pi), 6.5948);
  EXPECT_GT(std::sqrt(modes.eigenvalues[0]) / (2 * pi), 5.0);
  const auto pulse = [](double t) { return t < 0.01 ? t / 0.01 : std::max(0.0, 2 - t / 0.01); };
  Vibration motion{b, modes, GeneralizedAlpha{0.8}, 2e-4, {}, {{top_load(b, {1, 0}), pulse, false}}};
  // Every mode in closed form (Duhamel): the pulse is three ramps.
  const BoundaryPlace top = b.place({0, 2});
  const auto f = top_load(b, {1, 0});
  std::vector<double> share(modes.eigenvalues.size()), at_top(modes.eigenvalues.size());
  for (std::size_t k = 0; k < share.size(); ++k) {
    std::vector<double> shape(b.freedoms());
    for (std::size_t i = 0; i < shape.size(); ++i) {
      shape[i] = modes.shapes(i, k);
      share[k] += shape[i] * f[i];
    }
    at_top[k] = b.displacement_at(top, shape).x;
  }
  const auto exact = [&](double t) {
    double u = 0;
    for (std::size_t k = 0; k < share.size(); ++k) {
      const double w = std::sqrt(modes.eigenvalues[k]);
      const auto ramp = [&](double s) { return s > 0 ? (s / (w * w) - std::sin(w * s) / (w * w * w)) / 0.01 : 0.0; };
      u += share[k] * at_top[k] * (ramp(t) - 2 * ramp(t - 0.01) + ramp(t - 0.02));
    }
    return u;
  };
  double most = 0, worst = 0;
  for (int k = 0; k < 1500; ++k) {
    motion.advance();
    most = std::max(most, std::abs(exact(motion.time())));
    worst = std::max(worst, std::abs(motion.displacement_at(top).x - exact(motion.time())));
  }
  EXPECT_LT(worst, 0.02 * most);
  EXPECT_GT(most, 1e-4);
  EXPECT_LT(most, 4e-4);
}

TEST(Schemes, OrdersInTheStep) {
  // Free vibration in the first mode, u = sin(w t) / w, after two thirds of a period.
  const BlockOperator b = column(0.25, 0);
  const Modes modes = supported_modes(b, base_of(b));
  const double w = std::sqrt(modes.eigenvalues[0]);
  std::vector<double> shape(b.freedoms());
  for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = modes.shapes(i, 0);
  const BoundaryPlace top = b.place({0, 2});
  const double scale = norm(b.displacement_at(top, shape));
  const auto error = [&](Scheme scheme, int steps) {
    Vibration motion{b, modes, scheme, 4 / w / steps, {}, {}};
    motion.set_velocity(shape);
    for (int k = 0; k < steps; ++k) motion.advance();
    const Vec2 exact = (std::sin(4.0) / w) * b.displacement_at(top, shape);
    return norm(motion.displacement_at(top) - exact) / (scale / w);
  };
  const std::vector<std::pair<Scheme, double>> orders{
      {Newmark{}, 2}, {GeneralizedAlpha{0.8}, 2}, {GeneralizedAlpha{0.0}, 2},
      {Houbolt{}, 2}, {Newmark{0.5, 1}, 1},       {BackwardEuler{}, 1}};
  for (const auto& [scheme, order] : orders) {
    EXPECT_NEAR(std::log2(error(scheme, 400) / error(scheme, 800)), order, 0.02) << name_of(scheme);
    EXPECT_LT(error(scheme, 800), order == 2 ? 1e-4 : 2e-2) << name_of(scheme);
  }
}

TEST(BoundaryStress, OfLinearFieldsIsThatOfTheIntegrals) {
  const BlockOperator b = column(0.25, 0);
  const Mat2 g{1e-3, 2e-3, -5e-4, -7e-4};
  std::vector<double> u(b.freedoms(), 0.0);
  for (std::size_t n = 0; n < b.mesh().nodes.size(); ++n) {
    const Vec2 v = g * b.mesh().nodes[n].x;
    u[2 * n] = v.x;
    u[2 * n + 1] = v.y;
  }
  const Sym2 exact = b.material().stress({g.xx, 0.5 * (g.xy + g.yx), g.yy});
  const auto tractions = tractions_of(b, u);
  for (std::size_t e = 0; e < b.mesh().elements.size(); ++e) {
    for (const double s : {-0.9, 0.0, 0.5}) {
      EXPECT_LT(testing::largest(boundary_stress(b, {e, s}, u, tractions) - exact), 1e-6 * testing::largest(exact));
    }
  }
}

TEST(Relaxation, BackwardEulerReachesTheStaticAnswer) {
  const BlockOperator b = column(0.25, 3);
  const Modes modes = supported_modes(b, base_of(b));
  const double w = std::sqrt(modes.eigenvalues[0]);
  const auto f = top_load(b, {0, 1});
  Vibration motion{b, modes, BackwardEuler{}, 0.5 / w, {.alpha = 2 * w}, {{f, [](double) { return 1.0; }, false}}};
  for (int k = 0; k < 200; ++k) motion.advance();
  const auto u = static_displacement(b, base_of(b), f);
  EXPECT_NEAR(motion.displacement_at(b.place({0, 2})).y / b.displacement_at(b.place({0, 2}), u).y, 1, 1e-8);
}

TEST(Damping, RayleighDecaysAsItShould) {
  const BlockOperator b = column(0.25, 0);
  const Modes modes = supported_modes(b, base_of(b));
  const double w = std::sqrt(modes.eigenvalues[0]);
  Vibration motion{b, modes, Newmark{}, 1e-3 / w, {.alpha = 0.02 * w}, {}};
  std::vector<double> shape(b.freedoms());
  for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = modes.shapes(i, 0);
  motion.set_velocity(shape);
  for (int k = 0; k < 62832; ++k) motion.advance();  // ten periods
  const double energy = motion.kinetic_energy() + motion.elastic_energy();
  EXPECT_NEAR(energy, 0.5 * std::exp(-0.02 * 62.832), 3e-3);
}

TEST(Harmonic, FollowsTheClosedFormOfEveryMode) {
  // From rest under F sin(w t): (sin w t - w / w_k sin w_k t) / (w_k^2 - w^2) in every mode.
  const BlockOperator b = column(0.25, 0);
  const Modes modes = supported_modes(b, base_of(b));
  const double w = 0.6 * std::sqrt(modes.eigenvalues[0]);
  const auto f = top_load(b, {1, 0.3});
  Vibration motion{b, modes, Newmark{}, 0.002 / w, {}, {{f, [w](double t) { return std::sin(w * t); }, false, {}}}};
  const BoundaryPlace top = b.place({0, 2});
  double worst = 0, most = 0;
  for (int k = 0; k < 6000; ++k) {
    (void)motion.advance();
    if (k % 20 != 0) continue;
    Vec2 exact;
    for (std::size_t m = 0; m < modes.eigenvalues.size(); ++m) {
      std::vector<double> shape(b.freedoms());
      double share = 0;
      for (std::size_t i = 0; i < shape.size(); ++i) {
        shape[i] = modes.shapes(i, m);
        share += shape[i] * f[i];
      }
      const double l = modes.eigenvalues[m], own = std::sqrt(l), t = motion.time();
      exact += (share * (std::sin(w * t) - w / own * std::sin(own * t)) / (l - w * w)) * b.displacement_at(top, shape);
    }
    worst = std::max(worst, norm(motion.displacement_at(top) - exact));
    most = std::max(most, norm(exact));
  }
  EXPECT_LT(worst, 2e-4 * most);
}

BlockOperator slab(double mu) {
  BlockOptions o;
  o.bubbles = 2;
  return BlockOperator::make({testing::rectangle({-0.5, -0.15}, {0.5, 0.15}, {0, 0, 0, 0}, {2, 1, 2, 1})},
                             of_shear(mu, 0.25, 2600), o)
      .value();
}

TEST(FreeFall, ExactOverAMillionSteps) {
  const BlockOperator b = slab(4e9);
  FreeMotion motion{
      b,
      {.scheme = GeneralizedAlpha{0.8}, .step = 1e-3, .modes = 0, .gravity = {0, -9.8}, .velocity = {1, 0}, .spin = 3}};
  for (int k = 0; k < 1'000'000; ++k) ASSERT_TRUE(motion.advance().has_value());
  const double t = motion.time();
  EXPECT_NEAR(motion.centroid().y / (-4.9 * t * t), 1, 1e-9);
  EXPECT_NEAR(motion.velocity().y / (-9.8 * t), 1, 1e-9);
  EXPECT_NEAR(motion.centroid().x / t, 1, 1e-9);
  EXPECT_NEAR(motion.rotation() / (3 * t), 1, 1e-9);
  EXPECT_EQ(motion.spin(), 3);
}

TEST(FreeFall, ElasticBodyFallsWithoutStrain) {
  const BlockOperator b = slab(4e6);
  FreeMotion motion{b, {.step = 1e-3, .modes = 8, .gravity = {0, -9.8}}};
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(motion.advance().has_value());
  EXPECT_NEAR(motion.velocity().y, -4.9, 1e-11);
  EXPECT_LT(motion.relative_deformation(), 1e-12);
}

TEST(Spin, FreeBlockKeepsItsSizeAndMomentum) {
  const BlockOperator b = slab(4e7);
  FreeMotion motion{b, {.step = 1e-2, .modes = 6, .spin = 1}};
  const BoundaryPlace corner{0, -1};
  for (int k = 0; k < 100'000; ++k) ASSERT_TRUE(motion.advance().has_value());
  EXPECT_NEAR(norm(motion.position(corner) - motion.centroid()), norm(Vec2{0.5, 0.15}), 1e-5);
  EXPECT_NEAR(motion.angular_momentum() / b.inertia(), 1, 1e-12);
  EXPECT_NEAR(norm(motion.momentum()), 0, 1e-9);
}

TEST(Pendulum, SecondOrderAgainstTheRigidOne) {
  const BlockOperator b = slab(4e9);
  const BoundaryPlace hinge = b.place({-0.5, 0});
  const auto angle = [&](double step, std::size_t modes) {
    FreeMotion motion{b,
                      {.scheme = GeneralizedAlpha{0.6},
                       .step = step,
                       .modes = modes,
                       .gravity = {0, -9.81},
                       .pins = {{hinge, {-0.5, 0}}}}};
    for (int k = 0; k < static_cast<int>(2 / step + 0.5); ++k) EXPECT_TRUE(motion.advance().has_value());
    return motion.rotation();
  };
  EXPECT_NEAR(angle(1e-3, 0), -0.014594, 5e-5);
  const double a = angle(4e-3, 6), c = angle(2e-3, 6), d = angle(1e-3, 6);
  EXPECT_GT(std::log2((a - c) / (c - d)), 1.8);
  EXPECT_NEAR(d, -0.014594, 5e-5);
}

TEST(Pendulum, AMillionStepsWithoutDrift) {
  const BlockOperator b = slab(4e9);
  FreeMotion motion{b,
                    {.scheme = GeneralizedAlpha{0.9},
                     .step = 2e-3,
                     .modes = 0,
                     .gravity = {0, -9.81},
                     .pins = {{b.place({-0.5, 0}), {-0.5, 0}}}}};
  const double start = motion.energy().total();
  double worst = 0;
  double highest = -1;
  for (int k = 0; k < 1'000'000; ++k) {
    ASSERT_TRUE(motion.advance().has_value());
    worst = std::max(worst, std::abs(motion.energy().total() - start));
    if (k > 990'000) highest = std::max(highest, motion.centroid().y);
  }
  // Energy over m g: metres of height.
  EXPECT_LT(worst / (b.mass() * 9.81), 3e-5);
  EXPECT_NEAR(highest, 0, 1e-4);
}

TEST(DualReciprocity, ParticularSolutionsAndManufacturedField) {
  // u'' = constant, r-functions: the operator must give M a + H u = G t for L u = density a, any basis.
  const auto worst_of = [](Basis basis, std::size_t elements) {
    const Region region{.material = of_shear(2, 0.2, 3),
                        .loops = {polygon({{0, 0}, {2, 0}, {2.5, 1}, {0, 1.5}}, 0, elements)},
                        .conditions = {free_surface()}};
    const Drbem d = Drbem::make(region, {}, basis, {{1, 0.6}}).value();
    // Field: density a = L u with a = (1 + x, -y) + (0.5, 0.2): a polynomial field of degree three.
    const double mu = 2, nu = 0.2, l = 2 * mu * nu / (1 - 2 * nu);
    const double rho = 3;
    const auto u = [&](Vec2 p) {
      return Vec2{rho * (p.x * p.x * p.x / 6 + 0.75 * p.x * p.x) / (l + 2 * mu),
                  rho * (-p.y * p.y * p.y / 6 + 0.1 * p.y * p.y) / (l + 2 * mu)};
    };
    const auto a = [](Vec2 p) { return Vec2{1.5 + p.x, 0.2 - p.y}; };
    const auto sigma = [&](Vec2 p) {
      const double ex = rho * (p.x * p.x / 2 + 1.5 * p.x) / (l + 2 * mu),
                   ey = rho * (-p.y * p.y / 2 + 0.2 * p.y) / (l + 2 * mu);
      return Sym2{l * (ex + ey) + 2 * mu * ex, 0, l * (ex + ey) + 2 * mu * ey};
    };
    std::vector<double> uv, av;
    std::vector<std::array<Vec2, 3>> t;
    const double h =
        norm(Vec2{2.5, 1} - Vec2{2, 0}) / static_cast<double>(elements) / (2 * norm(d.mesh().elements[elements].c1));
    const auto world = [&](Vec2 x) { return d.origin() + h * x; };
    const auto push = [&](Vec2 x) {
      uv.push_back(u(x).x);
      uv.push_back(u(x).y);
      av.push_back(a(x).x);
      av.push_back(a(x).y);
    };
    for (const Node& n : d.mesh().nodes) push(world(n.x));
    push({1, 0.6});
    for (const Element& e : d.mesh().elements) {
      std::array<Vec2, 3> v{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double s = local_nodes(Order::quadratic)[k];
        v[k] = sigma(world(e.at(s))) * e.normal(s);
      }
      t.push_back(v);
    }
    const auto ma = d.mass_times(av);
    const auto hu = d.stiffness_times(uv);
    const auto gt = d.load_of(t);
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < ma.size(); ++i) {
      worst = std::max(worst, std::abs(ma[i] + hu[i] - gt[i]));
      size = std::max({size, std::abs(hu[i]), std::abs(gt[i])});
    }
    return worst / size;
  };
  EXPECT_LT(worst_of(Basis::one_plus_r, 4), 4e-2);
  EXPECT_LT(worst_of(Basis::r, 4), 4e-2);
  // r + linear holds this acceleration exactly; what is left is the cubic displacement on quadratic elements.
  EXPECT_LT(worst_of(Basis::r_plus_linear, 4), 2e-3);
  EXPECT_GT(testing::rate(worst_of(Basis::r_plus_linear, 4), worst_of(Basis::r_plus_linear, 8)), 2.5);
  // With 1 + r and r the acceleration inside is known at the one inner node only: a finer boundary does not help.
}

TEST(DualReciprocity, SourceColumnAndItsSpectralRadius) {
  Region region{.material = of_shear(4e4, 0.25, 1),
                .loops = {testing::rectangle({-1, 0}, {1, 4}, {1, 0, 2, 0}, {2, 4, 2, 4})},
                .conditions = {free_surface(), clamped(), traction(Vec2{0, 1})}};
  const Drbem d = Drbem::make(region, {}, Basis::one_plus_r, {}).value();
  EXPECT_EQ(d.eigenvalues().size(), 38U);
  // 35.46 in metres; collocation does not balance forces, so the unit of length (here the body's size) shows a little.
  EXPECT_NEAR(std::sqrt(std::abs(d.eigenvalues()[0])), 35.46, 0.25);
  EXPECT_NEAR(d.radius(Newmark{0.5, 1}, 2e-4) - 1, 0.0076, 2e-4);
  const auto one = [](double) { return 1.0; };
  const auto refused = d.run(Newmark{0.5, 1}, 2e-4, 500, one, {0, 4}, false);
  ASSERT_FALSE(refused.has_value());
  EXPECT_GT(std::get<UnstableStep>(refused.error()).smallest_stable_s, 2e-4);
  // Forced, it runs and grows as its radius says.
  const auto forced = d.run(Newmark{0.5, 1}, 2e-4, 1500, one, {0, 4}, true);
  ASSERT_TRUE(forced.has_value());
  EXPECT_GT(forced->radius, 1);
  EXPECT_GT(std::abs(forced->displacement.back().y), 1e-2);
  // Over the first period a stable step is as good as the curves of Fu (2014): 5e-4 s.
  const auto run = d.run(Newmark{0.5, 1}, 5e-4, 200, one, {0, 4}, false);
  ASSERT_TRUE(run.has_value()) << describe(run.error());
  double peak = 0;
  for (const Vec2 u : run->displacement) peak = std::max(peak, u.y);
  EXPECT_NEAR(peak, 6.9e-5, 3e-6);
  const Drbem inner = Drbem::make(region, {}, Basis::r, {{0, 1}, {0, 2}, {0, 3}}).value();
  EXPECT_EQ(inner.eigenvalues().size(), 44U);
  EXPECT_LT(inner.radius(Newmark{0.5, 1}, 5e-4), 1 + 1e-9);
}

}  // namespace
}  // namespace cleave::bem
