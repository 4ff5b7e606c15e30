#include <gtest/gtest.h>

#include "shapes.hpp"

namespace cleave::bem {
namespace {

using testing::largest;
using testing::of_shear;

const std::vector<Vec2> concave{{0, 0}, {3, -0.4}, {3.5, 1.1}, {1.7, 0.9}, {0.4, 2.0}};

Vec2 linear_field(Vec2 x) { return {1e-3 + 0.3 * x.x - 0.7 * x.y, 0.2 * x.x + 0.5 * x.y - 2e-3}; }

Sym2 linear_stress(const Material& m) { return m.stress({0.3, -0.25, 0.5}); }

/// Each kind of support on one side, the exact field everywhere: mixed, oblique, springs.
Problem patch(const Material& m) {
  const Sym2 s = linear_stress(m);
  Condition given = displacement(linear_field);
  Condition loaded = traction([s](Vec2, Vec2 n) { return s * n; });
  Condition slide;  // normal displacement, tangential traction
  slide.axes = Axes::normal;
  slide.component[0] = {Given::displacement, [](Vec2 x, Vec2 n) { return dot(linear_field(x), n); }, 0};
  slide.component[1].value = [s](Vec2, Vec2 n) { return dot(s * n, turned_left(n)); };
  Condition oblique;
  oblique.turn = 0.4;
  oblique.component[0].value = [s](Vec2, Vec2 n) { return dot(s * n, rotated({1, 0}, 0.4)); };
  oblique.component[1] = {Given::displacement, [](Vec2 x, Vec2) { return dot(linear_field(x), rotated({0, 1}, 0.4)); },
                          0};
  Condition sprung;
  sprung.axes = Axes::normal;
  sprung.component[0] = {Given::spring, [s](Vec2 x, Vec2 n) { return dot(s * n, n) + 3 * dot(linear_field(x), n); }, 3};
  sprung.component[1] = {Given::spring,
                         [s](Vec2 x, Vec2 n) {
                           const Vec2 t = turned_left(n);
                           return dot(s * n, t) + 0.7 * dot(linear_field(x), t);
                         },
                         0.7};
  Loop loop = polygon(concave, 0, 3);
  for (std::size_t k = 0; k < loop.size(); ++k) loop[k].condition = k;
  return Problem{
      .regions = {Region{.material = m, .loops = {loop}, .conditions = {given, loaded, slide, oblique, sprung}}}};
}

class Patch : public ::testing::TestWithParam<std::tuple<Order, double, PlaneState>> {};

TEST_P(Patch, LinearFieldIsExactWithEveryKindOfCondition) {
  const auto [order, nu, state] = GetParam();
  const Material m = testing::material(2.5, nu, 0, state);
  Options options;
  options.mesh.order = order;
  options.integration = 1e-14;
  const Solution solution = solve(patch(m), options).value();
  double size = 0;
  double error = 0;
  for (std::size_t n = 0; n < solution.regions()[0].mesh.nodes.size(); ++n) {
    const Vec2 u = linear_field(solution.node(0, n));
    size = std::max(size, norm(u));
    error = std::max(error, norm(solution.regions()[0].displacement[n] - u));
  }
  EXPECT_LT(error / size, 1e-12 * (nu > 0.49 ? 100 : 1));
  const Sym2 s = linear_stress(m);
  for (std::size_t e = 0; e < solution.regions()[0].mesh.elements.size(); ++e) {
    EXPECT_LT(largest(solution.boundary(0, e, 0.37).stress - s) / largest(s), 1e-10 * (nu > 0.49 ? 100 : 1));
  }
  for (const Vec2 y : {Vec2{1.2, 0.5}, Vec2{3, 0.2}, Vec2{0.3, 0.2}, Vec2{1.5, -0.19}}) {
    EXPECT_LT(largest(solution.stress(0, y).value() - s) / largest(s), 1e-10 * (nu > 0.49 ? 100 : 1));
    EXPECT_LT(norm(solution.displacement(0, y).value() - linear_field(y)) / size, 1e-11);
  }
  EXPECT_LT(solution.diagnostics().residual, 1e-13);
}

INSTANTIATE_TEST_SUITE_P(All, Patch,
                         ::testing::Combine(::testing::Values(Order::linear, Order::quadratic),
                                            ::testing::Values(0.0, 0.3, 0.4999),
                                            ::testing::Values(PlaneState::strain, PlaneState::stress)));

TEST(Patch, RigidMotionGivesNoTraction) {
  Region region{.material = of_shear(1, 0.25), .loops = {polygon(concave, 0, 2)}, .conditions = {}};
  region.conditions = {displacement([](Vec2 x) { return Vec2{2 - 0.3 * x.y, -1 + 0.3 * x.x}; })};
  Options options;
  options.integration = 1e-14;
  const Solution solution = solve(Problem{.regions = {region}}, options).value();
  for (const auto& t : solution.regions()[0].traction) {
    for (const Vec2 v : t) EXPECT_LT(norm(v), 1e-12 * 10);  // of shear modulus times displacement over element length
  }
}

TEST(Patch, TwoBondedMaterialsCarryOneStress) {
  // A bar of two halves pulled along x, free to narrow: strains differ, stress is the same.
  const Material stiff = testing::material(10, 0);
  const Material soft = testing::material(1, 0);
  const auto bar = [](double from, double to, std::size_t left, std::size_t right) {
    return testing::rectangle({from, 0}, {to, 1}, {0, right, 0, left}, {4, 2, 4, 2});
  };
  const Condition pull = traction(Vec2{3, 0});
  const Problem problem{
      .regions = {Region{"left", stiff, {bar(0, 2, 1, 2)}, {free_surface(), clamped(), bonded()}},
                  Region{"right", soft, {bar(2, 5, 2, 3)}, {free_surface(), clamped(), bonded(), pull}}}};
  const Solution solution = solve(problem, {}).value();
  EXPECT_NEAR(solution.displacement(1, {5, 0.5}).value().x, 3 * 2 / 10.0 + 3 * 3 / 1.0, 1e-9);
  EXPECT_NEAR(solution.displacement(0, {1, 0.5}).value().x, 0.3, 1e-9);
  EXPECT_LT(largest(solution.stress(0, {1, 0.3}).value() - Sym2{3, 0, 0}), 1e-8);
  EXPECT_LT(largest(solution.stress(1, {4, 0.3}).value() - Sym2{3, 0, 0}), 1e-8);
}

TEST(Patch, InclusionOfTheSameRockIsNotThere) {
  // A square inclusion, corners and all, bonded into a hole of the same material.
  const Material m = of_shear(1, 0.3);
  const Sym2 s{1, 0.4, -2};
  Loop hole = polygon({{1, 1}, {1, 2}, {2, 2}, {2, 1}}, 1, 2);
  const Condition loaded = traction([s](Vec2, Vec2 n) { return s * n; });
  const Problem problem{.regions = {Region{"outer",
                                           m,
                                           {polygon({{0, 0}, {3, 0}, {3, 3}, {0, 3}}, 0, 3), hole},
                                           {loaded, bonded(), displacement([&](Vec2 x) {
                                              const Sym2 e = m.strain(s);
                                              return Vec2{e.xx * x.x + e.xy * x.y, e.xy * x.x + e.yy * x.y};
                                            })}},
                                    Region{"inner", m, {reversed(hole)}, {loaded, bonded()}}}};
  Problem held = problem;
  held.regions[0].loops[0][0].condition = 2;
  const Solution solution = solve(held, {}).value();
  for (const Vec2 y : {Vec2{1.5, 1.5}, Vec2{1.1, 1.9}}) EXPECT_LT(largest(solution.stress(1, y).value() - s), 1e-8);
  for (const Vec2 y : {Vec2{0.5, 0.5}, Vec2{2.5, 1.9}}) EXPECT_LT(largest(solution.stress(0, y).value() - s), 1e-8);
}

TEST(Patch, FreeBodyUnderBalancedLoad) {
  const Material m = of_shear(1, 0.25, 2000);
  const Sym2 s{1, 0.3, -2};
  Region region{
      .material = m, .loops = {polygon(concave, 0, 2)}, .conditions = {traction([s](Vec2, Vec2 n) { return s * n; })}};
  Problem problem{.regions = {region}};
  const auto refused = solve(problem, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(std::get<FreeMotions>(refused.error()).motions.size(), 3U);
  Options options;
  options.restrain = true;
  const Solution solution = solve(problem, options).value();
  EXPECT_LT(largest(solution.stress(0, {1.2, 0.5}).value() - s), 1e-10);
  // In free fall nothing is stressed further: inertia relief meets gravity exactly.
  problem.load.gravity = {0, -9.81};
  const Solution falling = solve(problem, options).value();
  EXPECT_LT(largest(falling.stress(0, {1.2, 0.5}).value() - s), 1e-9);
}

TEST(Patch, OffsetAndUnitsChangeNothing) {
  const Material m = testing::material(60e9, 0.25);
  const auto tip = [&](Vec2 offset, double size, double load) {
    Region region{.material = m,
                  .loops = {testing::rectangle(offset, offset + size * Vec2{2, 1}, {0, 2, 0, 1}, {4, 2, 4, 2})},
                  .conditions = {free_surface(), clamped(), traction(Vec2{0, load})}};
    const Solution solution = solve(Problem{.regions = {region}}, {}).value();
    return solution.displacement(0, offset + size * Vec2{2, 1}).value().y / size / load;
  };
  const double reference = tip({0, 0}, 1, 1);
  EXPECT_NEAR(tip({1e6, -1e6}, 1, 1) / reference, 1, 1e-8);
  EXPECT_NEAR(tip({0, 0}, 1e-3, 1) / reference, 1, 1e-11);
  EXPECT_NEAR(tip({0, 0}, 1e3, 1e9) / reference, 1, 1e-11);
}

}  // namespace
}  // namespace cleave::bem
