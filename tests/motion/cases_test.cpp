#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hull.hpp"
#include "overlap.hpp"
#include "solver.hpp"
#include "worlds.hpp"

namespace cleave::motion {
namespace {

using namespace worlds;

TEST(Cases, SpinningPrismStops) {
  World w = world({floor(), body(prism(regular(6, 1), 0, 0.4), {}, {0, 0, 5})}, 0.3, {.step = 2e-3});
  ASSERT_TRUE(run(w, 0.2));
  EXPECT_NEAR((5 - w.spin(1).z) / 0.2, 7.0632, 0.01);
  // Evenly slower, to rest at 0.70789444 s and 1.7697361 rad.
  ASSERT_TRUE(run(w, 0.7));
  EXPECT_NEAR(w.spin(1).z, 7.0632 * 0.00789444, 2e-3);
  ASSERT_TRUE(run(w, 0.712));
  EXPECT_LT(norm(w.spin(1)), 1e-6);
  EXPECT_NEAR(angle_of(w.turn(1)), 1.7697361, 2e-3);
}

TEST(Cases, CornerHitsTheFloor) {
  const Turn turn = turn_by({0, 0, 0.3}) * turn_by({0, 0.4, 0}) * turn_by({0.5, 0, 0});
  Polyhedron shape = moved(block(1, 2, 3), {}, turn);
  double low = 0;
  for (const Vec3 v : shape.vertices) low = std::min(low, v.z);
  shape = moved(std::move(shape), {0, 0, -low});
  const auto hit = [&](double friction) {
    World w = world({floor(), body(shape, {0, 0, -1})}, friction, {.gravity = {}, .step = 1e-7, .theta = 1});
    EXPECT_TRUE(w.step().has_value());
    return std::pair{w.velocity(1), w.spin(1)};
  };
  const auto [v, w] = hit(0);
  EXPECT_NEAR(v.z, -0.11250997, 1e-6);
  expect_near(w, {-0.28887331, 0.26695906, -0.15912853}, 1e-6);
  for (const double friction : {0.2, 10.0}) {
    const auto [vs, ws] = hit(friction);
    expect_near(vs, {0.083289122, 0.096432118, -0.019744001}, 1e-6);
    expect_near(ws, {-0.054822102, 0.041793685, -0.027138938}, 1e-6);
  }
}

TEST(Cases, OverhangOfBricks) {
  for (const bool diagonal : {false, true}) {
    for (const double share : {0.99, 1.01}) {
      std::vector<BodySpec> bodies{floor()};
      std::vector<double> offset{0};
      for (int k = 2; k > 0; --k) offset.push_back(offset.back() + share * 0.5 / k);
      for (int k = 0; k < 3; ++k) {
        const double x = offset[static_cast<std::size_t>(k)], y = diagonal ? x : 0;
        bodies.push_back(body(box({x, y, 0.2 * k}, {x + 1, y + 1, 0.2 * k + 0.2})));
      }
      World w = world(std::move(bodies), 0.6, {.step = 0.01, .theta = 1, .sleep = false});
      ASSERT_TRUE(w.step().has_value());
      double fastest = 0;
      for (std::size_t b = 1; b < 4; ++b) fastest = std::max(fastest, norm(w.spin(b)));
      EXPECT_EQ(fastest > 1e-6, share > 1) << diagonal << " " << fastest;
    }
  }
}

TEST(Cases, CohesionHoldsOrBreaks) {
  const Turn plane = slope(35, 222.5);
  const double dip = 35 * degree, weight = 9.81, area = 2;
  const double needed = weight * (std::sin(dip) - std::cos(dip) * std::tan(20 * degree)) / area;
  for (const double share : {0.99, 1.01}) {
    Bond bond{.body = 1,
              .other = 0,
              .normal = plane * Vec3{0, 0, 1},
              .shares = {},
              .cohesion = share * needed,
              .tension = 0,
              .friction = std::tan(20 * degree)};
    const auto at = [&](double x, double y) { return plane * Vec3{x, y, 0}; };
    add_triangle(at(-0.5, -1), at(0.5, -1), at(0.5, 1), bond.shares);
    add_triangle(at(-0.5, -1), at(0.5, 1), at(-0.5, 1), bond.shares);
    auto made = World::make({.bodies = {floor(plane), body(moved(block(1, 2, 0.5), plane * Vec3{0, 0, 0.25}, plane))},
                             .surfaces = {{std::tan(20 * degree), 0}},
                             .bonds = {bond}},
                            {});
    ASSERT_TRUE(made.has_value());
    ASSERT_TRUE(run(*made, 0.3));
    EXPECT_EQ(norm(made->displacement(1)) > 1e-3, share < 1) << share;
  }
}

/// Over an L of 4 m with arms of 1.5 and 2 m and a hole of 0.7 m2.
Polyhedron angle_with_hole(double height) {
  const std::vector<std::pair<double, double>> outer{{0, 0}, {4, 0}, {4, 1.5}, {2, 1.5}, {2, 4}, {0, 4}};
  const std::vector<std::pair<double, double>> hole{{0.5, 0.5}, {0.5, 1.2}, {1.5, 1.2}, {1.5, 0.5}};
  Polyhedron out = prism(outer, 0, height);
  Polyhedron in = prism(hole, 0, height);  // clockwise: its sides look inwards
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  const std::size_t sides = outer.size(), holes = hole.size();
  for (std::size_t k = 0; k < in.facets.size(); ++k) {
    for (std::uint32_t& v : in.facets[k].loops[0]) v += first;
    if (k < holes) {
      out.facets.push_back(in.facets[k]);
    } else {
      out.facets[sides + k - holes].loops.push_back(in.facets[k].loops[0]);
    }
  }
  out.vertices.insert(out.vertices.end(), in.vertices.begin(), in.vertices.end());
  return out;
}

TEST(Cases, PatchWithAHole) {
  const auto mass = mass_properties(angle_with_hole(2));
  ASSERT_TRUE(mass.has_value());
  EXPECT_NEAR(mass->volume, 2 * 10.3, 1e-12);
  expect_near(mass->centroid, {1.5825243, 1.7140777, 1}, 1e-7);
  // It rests: forces add up to the weight under the centroid, and its hull has five corners.
  World w = world({floor(), body(angle_with_hole(2))}, 0.5, {.step = 0.01, .sleep = false});
  ASSERT_TRUE(run(w, 0.05));
  Vec3 force, moment;
  std::vector<std::pair<double, double>> corners;
  for (const Contact& c : w.contacts()) {
    const double sign = c.body == 1 ? 1 : -1;
    force += sign * c.force;
    moment += cross(c.point, sign * c.force);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {4.0, 0.0}, {4.0, 1.5}, {2.0, 4.0}, {0.0, 4.0}}) {
      if (std::hypot(c.point.x - x, c.point.y - y) < 1e-6) corners.emplace_back(x, y);
    }
  }
  std::ranges::sort(corners);
  corners.erase(std::ranges::unique(corners).begin(), corners.end());
  EXPECT_EQ(corners.size(), 5U);
  EXPECT_NEAR(force.z, 20.6 * 9.81, 1e-6);
  EXPECT_NEAR(-moment.y / force.z, 1.5825243, 1e-6);
  EXPECT_NEAR(moment.x / force.z, 1.7140777, 1e-6);
  EXPECT_LT(norm(w.displacement(1)), 1e-9);
}

TEST(Cases, RoundingTakesNoCornerOfAHull) {
  // A square with more points on its sides, in all orders that rounding may give those on one line.
  const std::vector<std::pair<double, double>> square{{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                                      {0, 0.4}, {1, 0.7}, {0.3, 0}, {0, 0.9}};
  for (unsigned way = 0; way < 6561; ++way) {
    std::vector<Flat> points;
    unsigned left = way;
    for (const auto& [x, y] : square) {
      points.push_back({x + 1e-15 * static_cast<double>(left % 3), y});
      left /= 3;
    }
    std::vector<std::uint32_t> hull = hull_of(points, 1e-9);
    std::ranges::sort(hull);
    ASSERT_EQ(hull, (std::vector<std::uint32_t>{0, 1, 2, 3})) << way;
  }
}

TEST(Cases, ConcaveBodiesFallInAHeap) {
  std::vector<BodySpec> bodies{floor()};
  for (int k = 0; k < 6; ++k) {
    const Polyhedron shape = prism({{0, 0}, {0.9, 0}, {0.9, 0.3}, {0.3, 0.3}, {0.3, 0.6}, {0, 0.6}}, 0, 0.3);
    bodies.push_back(
        body(moved(shape, {0.1 * (k % 2), 0.1 * (k % 3), 0.2 + 1.1 * k}, turn_by({0.3 * k, 0.2 * k, 0.5 * k}))));
  }
  World w = world(std::move(bodies), 0.5, {.step = 5e-3, .solver = {.accept = 1e-6}});
  ASSERT_TRUE(run(w, 1.2));
  for (std::size_t b = 1; b < w.size(); ++b) EXPECT_GT(w.centroid(b).z, 0.1);
  EXPECT_LT(w.energy().largest_gain, 1e-9 * w.energy().start + 1e-9);
}

TEST(Cases, CloudWithoutWalls) {
  std::vector<BodySpec> bodies;
  for (int k = 0; k < 27; ++k) {
    const Vec3 at{0.8 * (k % 3 - 1), 0.8 * (k / 3 % 3 - 1), 0.8 * (k / 9 - 1)};
    bodies.push_back(body(moved(icosahedron(0.3), at, turn_by({0.1 * k, 0.2 * k, 0.3})), -1.0 * at,
                          {0.3 * (k % 4), 0.2 * (k % 5), -0.1 * k}));
  }
  World w = world(std::move(bodies), 0.4, {.gravity = {}, .step = 5e-3});
  const Vec3 p = w.momentum(), l = w.angular_momentum();
  const double scale = std::sqrt(w.energy().start);
  ASSERT_TRUE(run(w, 1));
  EXPECT_LT(norm(w.momentum() - p), 1e-12 * scale * 10);
  EXPECT_LT(norm(w.angular_momentum() - l), 1e-4 * scale);  // parting overlaps turns a little
  EXPECT_LT(w.energy().largest_gain, 1e-10 * w.energy().start);
  EXPECT_LT(w.energy().kinetic, 0.9 * w.energy().start);
}

TEST(Cases, OverlapIsSeenApartFromContacts) {
  // At the start it is refused; its depth is the least width of what is shared.
  const auto made = World::make({.bodies = {body(block(1, 1, 1)), body(moved(block(1, 1, 1), {0.2, 0.1, 0.999}))}}, {});
  ASSERT_FALSE(made.has_value());
  EXPECT_NE(describe(made.error()).find("overlap"), std::string::npos);
  const auto apart = World::make({.bodies = {body(block(1, 1, 1)), body(moved(block(1, 1, 1), {0.2, 0.1, 1}))}}, {});
  EXPECT_TRUE(apart.has_value());
  const auto cells = convex_cells(block(1, 1, 1), 1);
  ASSERT_TRUE(cells.has_value() && cells->size() == 1);
  Placed a{.cell = &(*cells)[0], .size = std::sqrt(3.0)}, b = a;
  place(a, {}, {});
  place(b, {0.85, 0.85, 0.9}, turn_by({0.7, -0.5, 0.2}));
  EXPECT_EQ(overlap_depth(a, b, 1e-9), 0);
  place(b, {0.2, 0.1, 0.97}, {});
  EXPECT_NEAR(overlap_depth(a, b, 1e-9), 0.03, 1e-12);
}

TEST(Cases, TheDeepestOfSeveralOverlapsIsNamed) {
  std::vector<BodySpec> bodies;
  for (const double x : {0.0, 1.0, 1.99, 4.0, 4.9, 7.0, 7.95}) bodies.push_back(body(box({x, 0, 0}, {x + 1, 1, 1})));
  const auto made = World::make({.bodies = std::move(bodies)}, {});
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().bodies, (std::vector<std::uint32_t>{3, 4}));
}

TEST(Cases, WidestAxisOfTwoCubes) {
  const auto cells = convex_cells(block(1, 1, 1), 1);
  Placed a{.cell = &(*cells)[0], .size = std::sqrt(3.0)}, b = a;
  place(a, {}, {});
  place(b, {0.85, 0.85, 0.9}, turn_by({0.7, -0.5, 0.2}));
  const auto axis = widest_axis(b, a);
  ASSERT_TRUE(axis.has_value());
  EXPECT_NEAR(axis->gap, 0.0075637513, 1e-9);
  expect_near(axis->normal, {0.86418333, 0.01107871, 0.50305509}, 1e-7);
}

TEST(Cases, SidesThatAreNearlyParallelMeetAroundTheCrossingOfTheirEdges) {
  // A slab on another, tilted by a thousandth: the widest gap is that of two edges, but the sides lie on each other.
  const auto cells = convex_cells(block(1, 1, 0.2), 0.2);
  ASSERT_TRUE(cells.has_value());
  for (const double tilt : {1e-3, -1e-3}) {
    for (const double turn : {0.2, 1.0, 1.3}) {
      Placed above{.cell = cells->data(), .body = 0, .size = std::sqrt(2.04)}, below = above;
      below.body = below.number = 1;
      place(below, {}, {});
      place(above, {0.6, 0.5, 0.2004}, turn_by({tilt, 0.4 * tilt, 0}) * turn_by({0, 0, turn}));
      const auto axis = widest_axis(above, below);
      ASSERT_TRUE(axis && axis->kind == Axis::Kind::edges);
      std::vector<Touch> touches;
      touches_along(above, below, *axis, 0.01, true, touches);
      ASSERT_EQ(touches.size(), 4U);
      for (std::size_t k = 1; k < 4; ++k) {
        EXPECT_GT(touches[k].gap, axis->gap);
        EXPECT_NEAR(touches[k].gap, (touches[k].point.z - 0.1) / axis->normal.z, 1e-15);
        EXPECT_GT(norm(touches[k].point - touches[0].point), 0.1);
      }
      // No farther than they are asked for.
      touches.clear();
      touches_along(above, below, *axis, axis->gap + 1e-6, true, touches);
      EXPECT_EQ(touches.size(), 1U);
    }
  }
}

TEST(Cases, ConcaveBodiesAreTheirCells) {
  const Polyhedron shape = prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1);
  const auto cells = convex_cells(shape, 4);
  ASSERT_TRUE(cells.has_value());
  EXPECT_EQ(cells->size(), 2U);
  EXPECT_FALSE(convex_cells(shape, 5).has_value());
}

TEST(Cases, PegInANotch) {
  // A cube dropped into the notch of an L: floor and wall of the notch both hold it.
  Polyhedron notch = prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, -1, 1);
  notch = moved(std::move(notch), {}, turn_by({90 * degree, 0, 0}));
  World w = world({{.shape = notch, .fixed = true}, body(box({1, -0.4, 1.5}, {1.8, 0.4, 2.3}), {-0.5, 0, 0})}, 0.3,
                  {.step = 5e-3});
  ASSERT_TRUE(run(w, 0.8));
  expect_near(w.displacement(1), {0, 0, -0.5}, 1e-6);
}

}  // namespace
}  // namespace cleave::motion
