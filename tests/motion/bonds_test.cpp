#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "interior.hpp"
#include "solver.hpp"
#include "worlds.hpp"

/// Bonds: pull linear over the patch, pressure in its core, cohesion spread over it.
namespace cleave::motion {
namespace {

using namespace worlds;

constexpr double cube = 2600 * 9.81;  ///< N, weight of a cubic metre

/// On the plane z = 0, for a body below it (body 1) that hangs from body 0.
Bond below(double cohesion, double tension) {
  return {.body = 1,
          .other = 0,
          .normal = {0, 0, -1},
          .shares = {},
          .cohesion = cohesion,
          .tension = tension,
          .friction = 0.5};
}
void add_rectangle(Bond& bond, double x0, double y0, double x1, double y1, Vec3 from = {}) {
  add_triangle(from + Vec3{x0, y0, 0}, from + Vec3{x1, y0, 0}, from + Vec3{x1, y1, 0}, bond.shares);
  add_triangle(from + Vec3{x0, y0, 0}, from + Vec3{x1, y1, 0}, from + Vec3{x0, y1, 0}, bond.shares);
}
BodySpec heavy(Polyhedron shape, bool fixed = false) {
  return {.shape = std::move(shape), .density = kilograms_per_cubic_metre(2600), .fixed = fixed};
}
World hung(std::vector<BodySpec> bodies, Bond bond, Vec3 gravity = {0, 0, -9.81}, WorldOptions options = {}) {
  options.gravity = gravity;
  auto made = World::make({.bodies = std::move(bodies), .surfaces = {{0.5, 0}}, .bonds = {std::move(bond)}}, options);
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}
bool stays(World w) {
  EXPECT_TRUE(run(w, 0.3));
  return norm(w.displacement(1)) < 1e-6;
}
/// A cube under an open roof: the bond alone carries it.
bool hangs(Bond bond) {
  return stays(
      hung({heavy(box({-5, -5, 2}, {5, 5, 3}), true), heavy(box({-0.5, -0.5, -1}, {0.5, 0.5, 0}))}, std::move(bond)));
}

TEST(Bonds, ASquareOffTheMiddleBearsLess) {
  // 1 / (1 + 6 e / b), also where part of it is pressed (e > b / 6).
  for (const double off : {0.0, 0.05, 0.2, 0.7}) {
    for (const double share : {0.99, 1.01}) {
      Bond bond = below(1e9, share * cube * (1 + 6 * off));
      add_rectangle(bond, off - 0.5, -0.5, off + 0.5, 0.5);
      EXPECT_EQ(hangs(std::move(bond)), share > 1) << off;
    }
  }
}

TEST(Bonds, APatchOfAnyShapeBearsWhatItsLargestPullAllows) {
  // An L of 4 m with a hole, area 10.3, and a triangle: 1 + e . S^-1 (corner - middle), largest over the corners, with
  // the covariance S of the patch (from rectangles, and from 10^6 random points).
  const Vec3 middle{1.5825242718446602, 1.7140776699029125, 0};
  for (const auto& [x, y, factor] : {std::array{0.3, 0.2, 1.9094006067943865}, std::array{-0.5, 1.0, 2.729161367607353},
                                     std::array{1.5, -0.4, 4.353144594661444}}) {
    for (const double share : {0.99, 1.01}) {
      Bond bond = below(1e9, share * cube / 10.3 * factor);
      const Vec3 from = -middle - Vec3{x, y, 0};
      add_rectangle(bond, 0, 0, 4, 0.5, from);
      add_rectangle(bond, 0, 0.5, 0.5, 1.2, from);
      add_rectangle(bond, 1.5, 0.5, 4, 1.2, from);
      add_rectangle(bond, 0, 1.2, 4, 1.5, from);
      add_rectangle(bond, 0, 1.5, 2, 4, from);
      EXPECT_EQ(hangs(std::move(bond)), share > 1) << x << " " << y;
    }
  }
  for (const auto& [x, y, factor] : {std::array{0.3, 0.1, 2.0}, std::array{-0.8, 0.4, 3.4}}) {
    for (const double share : {0.99, 1.01}) {
      Bond bond = below(1e9, share * cube / 3 * factor);
      const Vec3 from{-4.0 / 3 - x, -2.0 / 3 - y, 0};
      add_triangle(from, from + Vec3{3, 0, 0}, from + Vec3{1, 2, 0}, bond.shares);
      EXPECT_EQ(hangs(std::move(bond)), share > 1) << x << " " << y;
    }
  }
}

TEST(Bonds, APatchMayBeGivenApartFromItsShares) {
  // Four points with the moments of the square, and its corners without area; cohesion acts nearer to the middle.
  for (const double share : {0.99, 1.01}) {
    Bond bond = below(1e9, share * cube * 2.2);
    const double off = 0.2, spread = std::sqrt(1.0 / 6);
    for (const auto& [x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      bond.shares.push_back({{off + 0.3 * x, 0.3 * y, 0}, 0.25});
      bond.patch.push_back({{off + spread * x, spread * y, 0}, 0.25});
    }
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) bond.patch.push_back({{off + x, y, 0}, 0});
    }
    EXPECT_EQ(hangs(std::move(bond)), share > 1);
  }
}

TEST(Bonds, ACantileverBendsItsBond) {
  // Two cubic metres on a wall that they touch: no pull on the whole, a moment alone. Largest pull 6 M / b^3; the
  // points where the two touch bear none of it.
  for (const double share : {0.99, 1.01}) {
    Bond bond{.body = 1,
              .other = 0,
              .normal = {1, 0, 0},
              .shares = {},
              .cohesion = 1e6,
              .tension = share * 6 * 2 * cube,
              .friction = 0.5};
    add_triangle({0, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0.5, 0.5}, bond.shares);
    add_triangle({0, -0.5, -0.5}, {0, 0.5, 0.5}, {0, -0.5, 0.5}, bond.shares);
    EXPECT_EQ(
        stays(hung({heavy(box({-1, -3, -3}, {0, 3, 3}), true), heavy(box({0, -0.5, -0.5}, {2, 0.5, 0.5}))}, bond)),
        share > 1);
  }
}

TEST(Bonds, PullEndsAtTheApex) {
  // No more than cohesion / friction counts, and nothing where there is no cohesion.
  for (const double share : {0.99, 1.01}) {
    Bond bond = below(share * 0.5 * cube, 1e9);
    add_rectangle(bond, -0.5, -0.5, 0.5, 0.5);
    EXPECT_EQ(hangs(std::move(bond)), share > 1);
  }
  Bond bond = below(0, 1e9);
  add_rectangle(bond, -0.5, -0.5, 0.5, 0.5);
  EXPECT_FALSE(hangs(bond));
  bond.friction = 0;  // its line has no apex
  EXPECT_TRUE(hangs(bond));
}

TEST(Bonds, WhereTensionIsGoneCohesionStays) {
  // A cube that stands over the edge of a ledge with its weight outside the core of what they share, pulled along it:
  // the tension of the far rim gives, its cohesion holds on; so it is without tension. More tension keeps all.
  for (const auto& [cohesion, tension, whole, holds] : {std::tuple{2e4, 10.0, false, true},
                                                        {2e4, 0.0, false, true},
                                                        {2e4, 6e4, true, true},
                                                        {1e3, 10.0, false, false}}) {
    Bond bond{.body = 1,
              .other = 0,
              .normal = {0, 0, 1},
              .shares = {},
              .cohesion = cohesion,
              .tension = tension,
              .friction = 0.1};
    add_rectangle(bond, 0, 0, 0.7, 1);
    World w =
        hung({heavy(box({-3, -3, -1}, {0.7, 4, 0}), true), heavy(box({0, 0, 0}, {1, 1, 1}))}, bond, {0, 3, -9.81});
    const auto report = w.step();
    ASSERT_TRUE(report.has_value());
    EXPECT_EQ(std::ranges::any_of(w.contacts(), &Contact::bonded), whole);
    if (whole) {
      Vec3 force, moment;
      for (const Contact& c : w.contacts()) {
        EXPECT_TRUE(c.bonded);
        const double sign = c.body == 1 ? 1 : -1;
        force += sign * c.force;
        moment += cross(c.point - Vec3{0.5, 0.5, 0.5}, sign * c.force);
      }
      expect_near(force, {0, -2600.0 * 3, cube}, 1e-2);
      expect_near(moment, {}, 1e-2);
    }
    ASSERT_TRUE(run(w, 0.3));
    EXPECT_EQ(norm(w.displacement(1)) < 1e-6, holds) << cohesion << " " << tension;
  }
}

TEST(Bonds, CohesionBesideATensionResistsTwisting) {
  // Pushed along the roof 2 m off the middle of the bond. Its shares stand for a mean radius of 0.368 m, the core for
  // 0.167 m, which would take 12 times the weight by area.
  for (const auto& [share, holds] : {std::pair{8.0, true}, {5.0, false}}) {
    Bond bond = below(share * cube, 1e5);
    add_rectangle(bond, -0.5, 1.5, 0.5, 2.5);
    EXPECT_EQ(stays(hung({heavy(box({-5, -5, 2}, {5, 5, 3}), true), heavy(box({-0.5, -0.5, -1}, {0.5, 0.5, 0}))}, bond,
                         {9.81, 0, 0})),
              holds);
  }
}

TEST(Bonds, GoesOnFromBytes) {
  // Saved after its tension gave, and saved whole: the same from then on, to the last bit.
  for (const double tension : {10.0, 6e4}) {
    Bond bond{
        .body = 1, .other = 0, .normal = {0, 0, 1}, .shares = {}, .cohesion = 2e4, .tension = tension, .friction = 0.1};
    add_rectangle(bond, 0, 0, 0.7, 1);
    const auto make = [&] {
      return hung({heavy(box({-3, -3, -1}, {0.7, 4, 0}), true), heavy(box({0, 0, 0}, {1, 1, 1})),
                   heavy(box({0.2, 0.2, 1.01}, {0.6, 0.6, 1.4}))},
                  bond, {0, 3, -9.81}, {.step = 0.004});
    };
    World whole = make(), again = make();
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(whole.step().has_value());
    ASSERT_TRUE(again.restore(whole.saved()).has_value());
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(whole.step().has_value());
      ASSERT_TRUE(again.step().has_value());
      ASSERT_EQ(whole.saved(), again.saved()) << k;
    }
  }
}

TEST(Bonds, ShearAloneByInteriorPoints) {
  // A unit mass on three smooth points, pushed along the plane, held by two points of shear alone.
  for (const double cohesion : {0.2, 1.0}) {
    Group group;
    group.mass.push_back(Matrix6::Identity());
    Vector6 free = Vector6::Zero();
    free[0] = 1;
    free[2] = -1;
    group.free.push_back(free);
    const Frame frame = frame_of({0, 0, 1});
    for (const Vec3 arm : {Vec3{1, 0, 0}, Vec3{-0.5, 0.8, 0}, Vec3{-0.5, -0.8, 0}}) {
      group.points.push_back({.body = 0, .on_body = rows_of(frame, arm)});
    }
    for (const double y : {-0.3, 0.3}) {
      Point p{
          .body = 0, .on_body = rows_of(frame, {0, y, 0}), .cohesion = cohesion, .tension = cohesion, .shear = true};
      p.on_body.col(0).setZero();
      group.points.push_back(p);
    }
    const double left = std::max(0.0, 1 - 2 * cohesion);
    const Scaled scaled{group};
    for (const bool coupled : {true, false}) {
      std::vector<Eigen::Vector3d> x(group.points.size(), Eigen::Vector3d::Zero());
      Interior interior{scaled};
      EXPECT_LT(interior.solve(x, {.weight = 1e-9, .goal = 1e-10, .coupled = coupled}), 1e-6);
      for (std::size_t k = 0; k < x.size(); ++k) x[k] *= scaled.elements[k].scale;
      EXPECT_LT(natural_residual(group, x), 1e-4) << cohesion << " " << coupled;
    }
    const Solution found = solve(group, {});
    EXPECT_EQ(found.report.status, SolveReport::Status::converged);
    EXPECT_NEAR(found.velocity[0][0], left, 1e-7);
    EXPECT_NEAR(found.velocity[0][2], 0, 1e-7);
  }
}

}  // namespace
}  // namespace cleave::motion
