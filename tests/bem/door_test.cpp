#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <variant>

#include "cleave/bem/statics.hpp"

namespace cleave::bem {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A square of 2 m with a square hole of 1 m, pressed from outside.
Problem plate() {
  const Material material = Material::make(pascals(1e9), 0.25, {}).value();
  const auto ring = [](double half, bool hole, std::size_t condition) {
    std::vector<Vec2> corners{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
    if (hole) std::swap(corners[1], corners[3]);
    Loop loop = polygon(corners);
    for (Side& side : loop) side.condition = condition;
    return loop;
  };
  Problem problem;
  problem.regions = {{.name = "plate",
                      .material = material,
                      .loops = {ring(1, false, 0), ring(0.5, true, 1)},
                      .conditions = {pressure(1e6), free_surface()}}};
  return problem;
}

Options options() {
  Options held;
  held.restrain = true;
  return held;
}

TEST(DoorTest, AProblemWithoutRegionsIsAnError) {
  const auto solved = solve({}, {});
  ASSERT_FALSE(solved.has_value());
  EXPECT_TRUE(std::holds_alternative<NoRegion>(solved.error()));
  EXPECT_FALSE(describe(solved.error()).empty());
  EXPECT_FALSE(solve_to({}, {}, 1e-3).has_value());
}

TEST(DoorTest, OptionsWithoutMeaningAreErrors) {
  const auto refused = [](auto&& change) {
    Options o = options();
    change(o);
    const auto solved = solve(plate(), o);
    return !solved && std::holds_alternative<BadNumber>(solved.error()) && !describe(solved.error()).empty();
  };
  for (const double bad : {0.0, -1.0, 1.0, nan, infinite, 1e-300}) {
    EXPECT_TRUE(refused([&](Options& o) { o.integration = bad; })) << bad;
  }
  for (const double bad : {nan, infinite}) EXPECT_TRUE(refused([&](Options& o) { o.mesh.element = bad; })) << bad;
  for (const double bad : {0.0, -1.0, nan, infinite}) {
    EXPECT_TRUE(refused([&](Options& o) { o.mesh.arc_degrees = bad; })) << bad;
  }
  EXPECT_TRUE(refused([](Options& o) { o.mesh.subdivide = 0; }));
  EXPECT_TRUE(refused([](Options& o) { o.memory_limit_mb = nan; }));
}

TEST(DoorTest, NumbersOfAProblemWithoutMeaningAreErrors) {
  const auto refused = [](auto&& change) {
    Problem p = plate();
    change(p);
    return !solve(p, options()).has_value();
  };
  for (const double bad : {nan, infinite}) {
    EXPECT_TRUE(refused([&](Problem& p) { p.regions[0].loops[0][1].start.x = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.load.gravity.y = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.load.spin = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.load.centre.x = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.in_situ.stress.xy = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.in_situ.gradient.yy = bad; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.forces = {{0, {1, 0}, {bad, 0}}}; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.forces = {{0, {bad, 0}, {1, 0}}}; }));
    EXPECT_TRUE(refused([&](Problem& p) { p.regions[0].conditions[0] = pressure(bad); }));
  }
  EXPECT_TRUE(refused([](Problem& p) { p.forces = {{7, {1, 0}, {1, 0}}}; }));
  EXPECT_TRUE(refused([](Problem& p) { p.regions[0].loops.clear(); }));
  EXPECT_TRUE(refused([](Problem& p) { p.regions[0].conditions.clear(); }));
}

TEST(DoorTest, OutsideOfABodyAndInItsOpeningsThereIsNoField) {
  const Solution solution = solve(plate(), options()).value();
  for (const Vec2 x :
       {Vec2{0, 0}, Vec2{0.3, -0.2}, Vec2{2, 0}, Vec2{-1.001, 0.5}, Vec2{1e9, 0}, Vec2{nan, 0}, Vec2{0.7, infinite}}) {
    EXPECT_FALSE(solution.stress(0, x).has_value()) << x.x << ' ' << x.y;
    EXPECT_FALSE(solution.displacement(0, x).has_value()) << x.x << ' ' << x.y;
    EXPECT_FALSE(solution.region_at(x).has_value()) << x.x << ' ' << x.y;
  }
  for (const Vec2 x : {Vec2{0.7, 0}, Vec2{1, 0.3}, Vec2{0.5, 0.1}, Vec2{-1, -1}}) {
    EXPECT_TRUE(solution.stress(0, x).has_value()) << x.x << ' ' << x.y;
    EXPECT_TRUE(solution.displacement(0, x).has_value()) << x.x << ' ' << x.y;
  }
  EXPECT_FALSE(solution.stress(1, {0.7, 0}).has_value());
}

}  // namespace
}  // namespace cleave::bem
