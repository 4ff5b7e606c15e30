#include <gtest/gtest.h>

#include "cleave/bem/block.hpp"
#include "shapes.hpp"

namespace cleave::bem {
namespace {

using testing::of_shear;

BlockOptions per_side(std::optional<std::size_t> bubbles) {
  BlockOptions o;
  o.bubbles = bubbles;
  return o;
}

TEST(Block, UnitSquareReferenceNumbers) {
  // Independent reference: Galerkin stiffness of 2 quadratic elements a side, mu = 1, nu = 1/4.
  BlockOptions o = per_side(0);
  o.outer_points = 28;
  const BlockOperator b =
      BlockOperator::make({polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 2)}, of_shear(1, 0.25, 1), o).value();
  const DenseMatrix& k = b.stiffness();
  EXPECT_NEAR(k(0, 0), 0.891065522655, 1e-6);
  EXPECT_NEAR(k(0, 1), 0.206803563838, 1e-6);
  EXPECT_NEAR(k(2, 2), 2.363036913227, 1e-6);
  double trace = 0;
  for (std::size_t i = 0; i < k.rows; ++i) trace += k(i, i);
  EXPECT_NEAR(trace, 56.137948004375, 1e-4);
  EXPECT_NEAR(b.mass_matrix()(0, 0), 0.007165958, 1e-5);
  const Modes m = free_modes(b);
  const std::vector<double> want{17.87849, 20.42761, 20.42761, 22.66339, 28.61274};
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(m.eigenvalues[i], want[i], 1.5e-3 * want[i]) << i;
}

TEST(Block, ModesOfTheColumnAgainstRitz) {
  // 2 x 4 m, G = 4e4, nu = 1/4, density 1; Ritz of degree 12: free 166.849, 252.732, 277.288, clamped 35.4263.
  const BlockOperator b = BlockOperator::make({testing::rectangle({-1, 0}, {1, 4}, {0, 0, 0, 0}, {2, 4, 2, 4})},
                                              of_shear(4e4, 0.25, 1), per_side(3))
                              .value();
  const Modes free = free_modes(b);
  EXPECT_NEAR(std::sqrt(free.eigenvalues[0]) / 166.849, 1, 2e-3);
  EXPECT_NEAR(std::sqrt(free.eigenvalues[1]) / 252.732, 1, 4e-3);
  EXPECT_NEAR(std::sqrt(free.eigenvalues[2]) / 277.288, 1, 2e-2);
  std::vector<HeldFreedom> held;
  for (std::size_t i = 0; i < b.mesh().nodes.size(); ++i) {
    if (std::abs(b.mesh().nodes[i].x.y + 2) < 1e-9) {
      held.push_back({i, {1, 0}});
      held.push_back({i, {0, 1}});
    }
  }
  EXPECT_NEAR(std::sqrt(supported_modes(b, held).eigenvalues[0]) / 35.4263, 1, 2e-3);
  // Static: unit tension on top.
  std::vector<std::array<Vec2, 3>> t(b.mesh().elements.size());
  for (std::size_t e = 0; e < t.size(); ++e) {
    if (b.mesh().elements[e].normal(0).y > 0.5) t[e] = {Vec2{0, 1}, Vec2{0, 1}, Vec2{0, 1}};
  }
  const auto u = static_displacement(b, held, b.forces_of(t));
  EXPECT_NEAR(b.displacement_at(b.place({0, 2}), u).y, 3.7196e-5, 2e-8);
}

/// First frequencies (Hz) of NAFEMS FV32: a membrane of 10 m that tapers from 5 to 1 m, clamped at its wide end.
std::vector<double> tapered_membrane(std::size_t along, std::optional<std::size_t> bubbles = {}) {
  const Material m = testing::material(200e9, 0.3, 8000, PlaneState::stress);
  const BlockOperator b =
      BlockOperator::make({polygon({{0, -2.5}, {10, -0.5}, {10, 0.5}, {0, 2.5}}, 0, along)}, m, per_side(bubbles))
          .value();
  std::vector<HeldFreedom> held;
  for (std::size_t i = 0; i < b.mesh().nodes.size(); ++i) {
    if (std::abs(b.mesh().nodes[i].x.x + b.centroid().x) < 1e-9) {
      held.push_back({i, {1, 0}});
      held.push_back({i, {0, 1}});
    }
  }
  std::vector<double> out;
  for (const double l : supported_modes(b, held).eigenvalues) out.push_back(std::sqrt(l) / (2 * std::numbers::pi));
  return out;
}

TEST(Block, FrequenciesOfATaperedMembrane) {
  const std::vector<double> nafems{44.623, 130.03, 162.70, 246.05, 379.90, 391.44};
  std::vector<double> worst;
  for (const std::size_t along : {4U, 8U, 12U}) {
    const auto f = tapered_membrane(along);
    worst.push_back(0);
    for (std::size_t k = 0; k < nafems.size(); ++k)
      worst.back() = std::max(worst.back(), std::abs(f[k] / nafems[k] - 1));
  }
  EXPECT_LT(worst[0], 2e-2);
  EXPECT_LT(worst[1], 1e-3);
  EXPECT_LT(worst[2], 7e-4);
  // Two more degrees of inner motions on the same mesh.
  EXPECT_GT(std::abs(tapered_membrane(8, 4)[4] / nafems[4] - 1), 1e-2);
}

TEST(Block, GravityExcitesNoElasticModeAndShapesMayBeAnything) {
  const std::vector<std::vector<Loop>> shapes{
      {polygon({{0, 0}, {3, -0.4}, {3.5, 1.1}, {1.7, 0.9}, {0.4, 2}}, 0, 2)},                              // concave
      {polygon({{0, 0}, {10, 0}, {10, 0.5}}, 0, 3)},                                                       // needle
      {polygon({{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 0, 2), polygon({{1, 1}, {1, 2}, {2, 2}, {2, 1}}, 0, 1)},  // hole
      {circle({1e3, 2}, 1.5, false, 0, 16)}};
  for (const auto& loops : shapes) {
    const auto made = BlockOperator::make(loops, testing::material(1e9, 0.2, 2600), per_side(2));
    ASSERT_TRUE(made.has_value()) << describe(made.error());
    const Modes m = free_modes(*made);
    EXPECT_GT(m.eigenvalues.front(), 0);
    const auto f = made->forces_of_acceleration({0.3, -9.81});
    double force = 0;
    for (std::size_t i = 1; i < made->boundary_freedoms(); i += 2) force += f[i];
    EXPECT_NEAR(force / (-9.81 * made->mass()), 1, 1e-5);
    for (std::size_t k = 0; k < 5; ++k) {
      double work = 0;
      for (std::size_t i = 0; i < f.size(); ++i) work += f[i] * m.shapes(i, k);
      EXPECT_LT(std::abs(work) / (9.81 * std::sqrt(made->mass())), 1e-8);
    }
  }
}

TEST(Block, AFineMeshKeepsRigidMotionsAndSlowModes) {
  // A free beam of 4 x 0.1 m, 82 elements: the first bending frequencies are Euler's (less shear and rotary inertia,
  // below 1, 2 and 4 %), whatever the quadrature of the mass makes of waves shorter than its points.
  const Material m = testing::material(10e9, 0, 2500);
  BlockOptions o;
  o.mesh.element = 0.1;
  const BlockOperator b = BlockOperator::make({polygon({{0, 0}, {4, 0}, {4, 0.1}, {0, 0.1}})}, m, o).value();
  const Modes all = supported_modes(b, {});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(all.eigenvalues[k], 0) << k;
  const double unit = std::sqrt(10e9 * 0.01 / 12 / 2500) / 16;  // sqrt(E I / (rho A)) / L^2
  const std::vector<double> roots{4.730040745, 7.853204624, 10.99560784};
  for (std::size_t k = 0; k < roots.size(); ++k) {
    const double euler = roots[k] * roots[k] * unit;
    EXPECT_NEAR(std::sqrt(all.eigenvalues[3 + k]) / euler, 1, 0.01 * static_cast<double>(k + 1)) << k;
  }
  // Compliance of all modes is that of the stiffness: a balanced pull along the beam stretches it by q L / E.
  std::vector<std::array<Vec2, 3>> t(b.mesh().elements.size());
  for (std::size_t e = 0; e < t.size(); ++e) {
    const double n = b.mesh().elements[e].normal(0).x;
    if (std::abs(n) > 0.5) t[e] = {Vec2{1e6 * n, 0}, Vec2{1e6 * n, 0}, Vec2{1e6 * n, 0}};
  }
  const auto f = b.forces_of(t);
  double stretch = 0;  // work of the pull, twice the energy, over the force
  for (std::size_t k = 3; k < all.eigenvalues.size(); ++k) {
    double amplitude = 0;
    for (std::size_t i = 0; i < f.size(); ++i) amplitude += all.shapes(i, k) * f[i];
    stretch += amplitude * amplitude / all.eigenvalues[k] / 1e5;
  }
  EXPECT_NEAR(stretch, 1e6 * 4 / 10e9, 1e-6 * 4e-4);
}

TEST(Block, SlenderBeamIsNotTooSoft) {
  // 36 x 2 m clamped at both ends under its weight, 20 elements: within 1 % of the fine direct solution 0.03243.
  const Material m = testing::material(10e9, 0.25, 2600);
  const BlockOperator b =
      BlockOperator::make({testing::rectangle({0, 0}, {36, 2}, {0, 0, 0, 0}, {9, 1, 9, 1})}, m, per_side(0)).value();
  std::vector<HeldFreedom> held;
  for (std::size_t i = 0; i < b.mesh().nodes.size(); ++i) {
    if (std::abs(std::abs(b.mesh().nodes[i].x.x) - 18) < 1e-9) {
      held.push_back({i, {1, 0}});
      held.push_back({i, {0, 1}});
    }
  }
  const auto u = static_displacement(b, held, b.forces_of_acceleration({0, -9.81}));
  EXPECT_NEAR(b.displacement_at(b.place({0, -1}), u).y, -0.03243, 4e-4);
}

}  // namespace
}  // namespace cleave::bem
