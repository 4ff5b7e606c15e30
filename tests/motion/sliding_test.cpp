#include <cmath>

#include "worlds.hpp"

namespace cleave::motion {
namespace {

using namespace worlds;

double tangent(double degrees) { return std::tan(degrees * degree); }

TEST(Sliding, ThrownBodyFallsExactly) {
  for (const double step : {0.1, 0.01}) {
    World w = world({body(block(1, 2, 3), {1, 2, 3}, {0.3, -0.2, 0.4})}, 0, {.step = step, .displacement = 10});
    const Vec3 momentum = w.angular_momentum();
    ASSERT_TRUE(run(w, 1));
    expect_near(w.centroid(0), {1, 2, -1.905}, 1e-12);
    const Vec3 moved = w.mass(0) * cross(w.centroid(0), w.velocity(0));
    expect_near(w.angular_momentum() - moved, momentum, 1e-12);
  }
}

TEST(Sliding, DownAPlaneOfAnyDirection) {
  struct Case {
    double dip, direction, friction;
    Vec3 path;
  };
  for (const Case& c :
       {Case{30, 0, 10, {0, 1.4752644, -0.85174431}}, Case{30, 137, 10, {1.0061279, -1.0789401, -0.85174431}},
        Case{35, 222.5, 20, {-0.74764820, -0.81591483, -0.77489120}},
        Case{50, 313, 30, {-0.91065741, 0.84920177, -1.4839321}}, Case{35, 222.5, 36, {0, 0, 0}}}) {
    const Turn plane = slope(c.dip, c.direction);
    const Turn turn = plane * turn_by({0, 0, 25 * degree});
    World w = world({floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, turn))}, tangent(c.friction));
    ASSERT_TRUE(run(w, 1));
    expect_near(w.displacement(1), c.path, 1e-7);
    EXPECT_LT(norm(w.spin(1)), 1e-8);
  }
}

TEST(Sliding, AcrossASlopeTheSlipTurns) {
  // Of order 1 in the step: what is left after extrapolation is compared.
  std::vector<Vec3> half, path;
  const Turn plane = slope(30, 90);
  const Vec3 down = downhill(30, 90), across = plane * Vec3{1, 0, 0};
  for (const double step : {0.01, 0.005, 0.0025}) {
    World w = world({floor(plane), body(moved(block(1, 1, 0.1), plane * Vec3{0, 0, 0.05}, plane), 2 * across)},
                    tangent(30), {.step = step});
    ASSERT_TRUE(run(w, 0.5));
    half.push_back({dot(w.velocity(1), down), dot(w.velocity(1), across), 0});
    ASSERT_TRUE(run(w, 1));
    path.push_back({dot(w.displacement(1), down), dot(w.displacement(1), across), 0});
  }
  const Vec3 exact_half{0.98025287, 0.28104896, 0}, exact_path{0.84711001, 0.53868197, 0};
  expect_near(2 * half[2] - half[1], exact_half, 1e-4);
  expect_near(2 * path[2] - path[1], exact_path, 1e-4);
  EXPECT_NEAR(std::log2(norm(half[0] - exact_half) / norm(half[1] - exact_half)), 1, 0.1);
  EXPECT_LT(norm(half[2] - exact_half), 0.005);
}

TEST(Sliding, ComesToRestOnTheLevel) {
  World w = world({floor(), body(moved(block(1, 2, 0.5), {0, 0, 0.25}), {1, 1, 0})}, 0.3, {.step = 0.005});
  ASSERT_TRUE(run(w, 0.47));
  EXPECT_GT(norm(w.velocity(1)), 0.02);
  ASSERT_TRUE(run(w, 0.6));
  EXPECT_LT(norm(w.velocity(1)), 1e-9);
  EXPECT_NEAR(norm(w.displacement(1)), 0.33978933, 1e-4);
  EXPECT_NEAR(w.displacement(1).x, w.displacement(1).y, 1e-9);
}

/// Tetrahedral wedge on two planes: acceleration along their line, by one step.
double wedge(double first, double second) {
  const double step = 0.01;
  const Vec3 n1 = slope(45, 105) * Vec3{0, 0, 1}, n2 = slope(70, 235) * Vec3{0, 0, 1};
  Vec3 line = geometry::normalized(cross(n1, n2));
  if (line.z > 0) line = -line;
  expect_near(line, {0.32413751, -0.79160395, -0.51797497}, 1e-8);
  const Vec3 top = 2 / line.z * line;
  Vec3 a = geometry::normalized(cross(n1, {0, 0, 1})), b = geometry::normalized(cross(n2, {0, 0, 1}));
  if (dot(n2, a) < 0) a = -a;
  if (dot(n1, b) < 0) b = -b;
  const Polyhedron shape = hull({{0, 0, 0}, top, top + 2.5 * a, top + 2.5 * b});
  EXPECT_NEAR(mass_properties(shape)->volume, 1.595926, 1e-6);
  std::vector<BodySpec> bodies{floor(slope(45, 105)), floor(slope(70, 235)), body(shape)};
  for (Facet& f : bodies[1].shape.facets) f.surface = 1;
  for (Facet& f : bodies[2].shape.facets) f.surface = 2;
  auto made = World::make({.bodies = std::move(bodies), .surfaces = {{tangent(first)}, {tangent(second)}, {10}}},
                          {.step = step, .theta = 1});
  EXPECT_TRUE(made.has_value());
  EXPECT_TRUE(made->step(step).has_value());
  EXPECT_LT(norm(made->spin(2)), 1e-9);
  EXPECT_LT(norm(cross(line, made->velocity(2))), 1e-9);
  return dot(line, made->velocity(2)) / step;
}

TEST(Sliding, WedgeOnTwoPlanes) {
  EXPECT_NEAR(wedge(0, 0), 5.0813344, 1e-7);
  EXPECT_NEAR(wedge(10, 10), 2.8539313, 1e-7);
  EXPECT_NEAR(wedge(20, 10), 1.3852550, 1e-7);
  EXPECT_NEAR(wedge(20, 20), 0.48357848, 1e-7);
  EXPECT_NEAR(wedge(20, 30), 0, 1e-7);
  EXPECT_NEAR(wedge(30, 20), 0, 1e-7);
}

TEST(Sliding, OnATurntable) {
  // At radius 1 seen from the table: the spin squared pushes outwards.
  for (const double spin : {2.2147, 2.2148, 2.23}) {
    World w = world({floor(), body(box({-0.1, -0.1, 0}, {0.1, 0.1, 0.1}))}, 0.5,
                    {.gravity = {spin * spin, 0, -9.81}, .step = 1e-3, .theta = 1, .sleep = false});
    ASSERT_TRUE(w.step(1e-3).has_value());
    EXPECT_NEAR(w.velocity(1).x / 1e-3, spin > 2.2147235 ? spin * spin - 4.905 : 0, 1e-7) << spin;
    EXPECT_LT(norm(w.spin(1)), 1e-9);
  }
}

// What is let go may be all that is free.
TEST(Sliding, AWorldInWhichNothingIsFreeYetGoesOn) {
  const Turn plane = slope(40, 90);
  BodySpec held = body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane));
  held.fixed = true;
  World w = world({floor(plane), std::move(held)}, 0.3, {.step = 0.01});
  ASSERT_TRUE(run(w, 0.1));
  EXPECT_NEAR(w.time(), 0.1, 1e-12);
  w.set_fixed(1, false);
  ASSERT_TRUE(run(w, 0.5));
  const double a = 9.81 * (std::sin(40 * degree) - 0.3 * std::cos(40 * degree));
  EXPECT_NEAR(norm(w.displacement(1)), 0.5 * a * 0.16, 1e-6);
}

// What is held while it moves takes its motion along; what it lost of its height stays in the books.
TEST(Sliding, EnergyOfWhatIsHeldIsCarriedAway) {
  const Turn plane = slope(40, 90);
  World w = world({floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane))}, 0.3, {.step = 0.01});
  ASSERT_TRUE(run(w, 0.4));
  const double mass = w.mass(1), speed = norm(w.velocity(1)), fall = -w.displacement(1).z;
  const double lost = w.energy().start - w.energy().potential;
  EXPECT_NEAR(lost, mass * 9.81 * fall, 1e-9 * lost);
  w.set_fixed(1, true);
  EXPECT_NEAR(w.energy().carried, 0.5 * mass * speed * speed, 1e-9 * lost);
  EXPECT_NEAR(w.energy().start - w.energy().potential, lost, 1e-12 * lost);
  ASSERT_TRUE(run(w, 0.5));
  EXPECT_EQ(w.energy().kinetic, 0);
}

}  // namespace
}  // namespace cleave::motion
