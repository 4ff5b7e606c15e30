#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "water.hpp"
#include "workloads.hpp"

// Steady flow in networks of joints: closed forms, published capacitances, and that the bounds hold.

namespace cleave::testing {
namespace {

TEST(FlowTest, OneJointIsDarcysLaw) {
  const auto built = build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5})}),
                           {.sides = {{west, at(10)}, {east, at(4)}}, .transmissivity = {2e-5}});
  const Flow flow = solved(built.network);
  const double exact = 2e-5 * 3 * (10 - 4) / 4;
  const auto& out = flow.surfaces[built.of_tag(east)];
  EXPECT_NEAR(out.out.si(), exact, 1e-15);
  ASSERT_TRUE(out.bounds.has_value());
  EXPECT_NEAR(out.bounds->low, exact, 1e-15);
  EXPECT_NEAR(out.bounds->high, exact, 1e-15);
  EXPECT_NEAR(flow.surfaces[built.of_tag(west)].out.si(), -exact, 1e-15);
  EXPECT_DOUBLE_EQ(out.open_length.si(), 3);
  EXPECT_EQ(flow.rounds.size(), 1U) << "linear heads need no finer mesh";
  for (std::size_t t = 0; t < flow.mesh.triangles.size(); ++t) {
    EXPECT_NEAR(flow.q[t].x, exact / 3, 1e-15);
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = built.complex.origin().x + flow.mesh.points[flow.mesh.triangles[t][k]].x;
      EXPECT_NEAR(built.complex.origin().z + flow.head[t][k].si(), 10 - 1.5 * x, 1e-12);
    }
  }
}

TEST(FlowTest, ParallelJointsAddAndJointsAcrossChangeNothing) {
  const auto built = build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5}), rectangle(1, 1, {-1, -1}, {5, 5}),
                                          rectangle(0, 2, {-1, -1}, {5, 5}), rectangle(2, 1, {-1, -1}, {5, 5})}),
                           {.sides = {{west, at(3)}, {east, at(2)}}, .transmissivity = {1e-5, 2e-5, 7e-4, 3e-5}});
  const Flow flow = solved(built.network);
  const double exact = ((1e-5 + 3e-5) * 3 + 2e-5 * 2) / 4;  // the first and the last lie on one another
  EXPECT_NEAR(flow.surfaces[built.of_tag(east)].out.si(), exact, 1e-15);
}

TEST(FlowTest, JointsInARowAddTheirResistances) {
  // Level from the west to x = 2, then down a wall of 1 m, then on a lower level to the east.
  const auto built = build(scene(room(), {rectangle(2, 1.5, {-1, -1}, {2, 5}), rectangle(0, 2, {-1, 0.5}, {5, 1.5}),
                                          rectangle(2, 0.5, {2, -1}, {5, 5})}),
                           {.sides = {{west, at(8)}, {east, at(3)}}, .transmissivity = {1e-6, 4e-6, 2e-6}});
  const double exact = 5 * 3 / (2 / 1e-6 + 1 / 4e-6 + 2 / 2e-6);
  const Flow flow = solved(built.network);
  EXPECT_NEAR(flow.surfaces[built.of_tag(east)].out.si(), exact, 1e-12 * exact);
}

TEST(FlowTest, WhatHangsOnNothingStaysDry) {
  // The second one touches no water, the third is a dead end on the first.
  const auto built = build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5}), rectangle(2, 1.5, {1, 1}, {2, 2}),
                                          rectangle(0, 2, {1, 0.5}, {2, 1.25})}),
                           {.sides = {{west, at(10)}, {east, at(6)}}});
  const Flow flow = solved(built.network);
  EXPECT_NEAR(flow.area.si(), 12 + 1 + 0.75, 1e-12);
  EXPECT_NEAR(flow.wet_area.si(), 12 + 0.75, 1e-12);
  EXPECT_NEAR(flow.surfaces[built.of_tag(east)].out.si(), 3e-6, 1e-18);
  for (std::size_t t = 0; t < flow.mesh.triangles.size(); ++t) {
    const auto joint = built.complex.network()->pieces[flow.mesh.part[t]].joints.front();
    EXPECT_EQ(flow.wet[t] != 0, joint != topology::JointId{1U});
    if (joint == topology::JointId{2U}) {
      for (const Length head : flow.head[t]) EXPECT_NEAR(built.complex.origin().z + head.si(), 8, 1e-12) << "at x = 2";
    }
  }
}

TEST(FlowTest, ASquareInASquareIsItsPublishedCapacitance) {
  // Sides 2 and 4: 10.2341 per unit length and permittivity (36.81 ohm, the square coaxial line of ratio 2).
  auto input = scene(box({0, 0, 0}, {4, 4, 2}), {rectangle(2, 1, {-1, -1}, {5, 5})}, {box({1, 1, 0.5}, {3, 3, 1.5})});
  const auto built =
      build(input, {.sides = {{west, at(7)}, {east, at(7)}, {south, at(7)}, {north, at(7)}}, .transmissivity = {1e-6}});
  constexpr double exact = 10.234092569 * 1e-6 * (7 - 1);
  double width = 1;
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    const Flow flow = solved(built.network, tolerance);
    EXPECT_EQ(flow.status, FlowStatus::converged);
    EXPECT_LE(flow.drained.low, exact);
    EXPECT_GE(flow.drained.high, exact);
    EXPECT_LE(0.5 * (flow.drained.high - flow.drained.low), tolerance * exact);
    EXPECT_LE(flow.drained.high - flow.drained.low, width);
    width = flow.drained.high - flow.drained.low;
    // The width falls like one over the triangles, though the corners are sharp.
    const auto& rounds = flow.rounds;
    if (rounds.size() > 8) {
      const auto &early = rounds[rounds.size() / 2], &late = rounds.back();
      EXPECT_GT(std::log(early.width / late.width) /
                    std::log(static_cast<double>(late.triangles) / static_cast<double>(early.triangles)),
                0.85);
    }
  }
}

TEST(FlowTest, BoundsBetweenStandingWatersHoldThatCapacitance) {
  // The same with water in the middle, too: both ends are from the two solutions for one level.
  auto input = scene(box({0, 0, 0}, {4, 4, 2}), {rectangle(2, 1, {-1, -1}, {5, 5})}, {box({1, 1, 0.5}, {3, 3, 1.5})});
  const auto built = build(input, {.sides = {{west, at(7)}, {east, at(7)}, {south, at(7)}, {north, at(7)}},
                                   .excavation = at(2),
                                   .transmissivity = {1e-6}});
  constexpr double exact = 10.234092569 * 1e-6 * (7 - 2);
  for (const double tolerance : {0.2, 0.1, 0.03, 0.01, 0.003}) {
    const Flow flow = solved(built.network, tolerance);
    const auto& out = flow.surfaces[built.of_excavation(0)];
    ASSERT_TRUE(out.bounds.has_value());
    EXPECT_LE(out.bounds->low, exact);
    EXPECT_GE(out.bounds->high, exact);
    EXPECT_LE(0.5 * (out.bounds->high - out.bounds->low), tolerance * exact);
  }
}

TEST(FlowTest, ABoreholeDrawsAsThiemSays) {
  // Prisms of 64 corners, radii 1 and 8: polygons inscribed and circumscribed about the circles bound the closed form.
  constexpr int n = 64;
  const auto prism = [](double r, double lo, double hi) {
    const geometry::CircleSection circle{.diameter = metres(2 * r)};
    return geometry::make_tunnel(circle, {{0, 0, lo}, {0, 0, hi}}, {.segments = n / 2, .up = Vec3{0, 1, 0}}).value();
  };
  auto input = scene(prism(8, -2, 2), {rectangle(2, 0, {-9, -9}, {9, 9})}, {prism(1, -1, 1)});
  Water water{.transmissivity = {3e-6}};
  for (std::uint32_t tag = 0; tag < 200; ++tag) water.sides[tag] = at(5);
  const auto built = build(input, water);
  const Flow flow = solved(built.network, 0.002);
  // The prisms have the areas of the circles: they lie between circles of these shares of the radii.
  const double inner = std::sqrt(std::numbers::pi / n / std::tan(std::numbers::pi / n));
  const double outer = inner / std::cos(std::numbers::pi / n);
  const auto thiem = [](double far, double near) { return 2 * std::numbers::pi * 3e-6 * 5 / std::log(far / near); };
  EXPECT_GT(flow.drained.high, thiem(8 * outer, inner));
  EXPECT_LT(flow.drained.low, thiem(8 * inner, outer));
  EXPECT_NEAR(flow.drained.value, thiem(8, 1), 0.003 * thiem(8, 1));
}

TEST(FlowTest, BoundsOfRandomNetworksHoldThoseOfFinerMeshes) {
  for (const char* name : {"disc-1500", "rect-13"}) {
    SCOPED_TRACE(name);
    auto input = support::cut_input(support::workload_named(name).value());
    const auto corners = std::string{name} == "rect-13" ? Vec3{40, 40, 30} : Vec3{50, 50, 50};
    input.excavations.push_back(box(corners - Vec3{12, 60, 8}, corners + Vec3{12, 60, 8}));
    Water water{.sides = {{west, at(150)}, {east, at(130)}}};
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
      water.transmissivity.push_back(1e-6 * std::pow(10.0, static_cast<double>(j * 7 % 5) - 2));
    }
    const auto built = build(input, water);
    const Flow coarse = solved(built.network, 0.3), fine = solved(built.network, 0.06);
    EXPECT_LT(fine.rounds.front().width, 10) << "even the first mesh says something";
    EXPECT_GT(fine.drained.value, 0);
    EXPECT_GE(fine.drained.value, coarse.drained.low);
    EXPECT_LE(fine.drained.value, coarse.drained.high);
    EXPECT_GE(coarse.drained.high, fine.drained.low);
    EXPECT_LE(coarse.drained.low, fine.drained.high);
    EXPECT_NEAR(fine.wet_area.si(), coarse.wet_area.si(), 1e-6);
    double sum = 0;
    for (const auto& surface : fine.surfaces) sum += surface.out.si();
    EXPECT_LT(std::abs(sum), 0.06 * fine.drained.value);
  }
}

TEST(FlowTest, TurnedSwappedAndScaledNetworksGiveTheSame) {
  auto input = support::cut_input(support::workload_named("disc-1500").value());
  Water water{.sides = {{west, at(150)}, {east, at(110)}}};
  const auto built = build(input, water);
  const Flow flow = solved(built.network, 0.3);
  const auto rate = *flow.surfaces[built.of_tag(east)].bounds;
  const auto overlaps = [](const flow::Rate& a, const flow::Rate& b) { return a.low <= b.high && b.low <= a.high; };
  Water swapped{.sides = {{west, at(110)}, {east, at(150)}}};
  const auto back = build(input, swapped);
  EXPECT_NEAR(solved(back.network, 0.3).surfaces[back.of_tag(west)].out.si(), rate.value, 1e-9 * rate.value);
  Water doubled = water;
  doubled.transmissivity.assign(input.joints.size(), 2e-6);
  const auto twice = build(input, doubled);
  EXPECT_NEAR(solved(twice.network, 0.3).surfaces[twice.of_tag(east)].out.si(), 2 * rate.value, 1e-9 * rate.value);
  std::ranges::reverse(input.joints);
  const auto reversed = build(input, water);
  EXPECT_TRUE(overlaps(*solved(reversed.network, 0.3).surfaces[reversed.of_tag(east)].bounds, rate));
}

TEST(FlowTest, WaterStandsNoHigherThanItsLevel) {
  // An upright joint 4 m wide and 2 m high: water to 1 m in the west, to 0.5 m in the east.
  const auto built = build(scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5})}),
                           {.sides = {{west, at(1)}, {east, at(0.5)}}, .transmissivity = {1e-6}});
  const Flow flow = solved(built.network, 0.005);
  const auto& in = flow.surfaces[built.of_tag(west)];
  EXPECT_DOUBLE_EQ(in.open_length.si(), 1);
  EXPECT_DOUBLE_EQ(in.dry_length.si(), 1);
  EXPECT_DOUBLE_EQ(flow.surfaces[built.of_tag(east)].open_length.si(), 0.5);
  // Less than through the whole height, more than through the lower half metre alone.
  EXPECT_LT(-in.out.si(), 1e-6 * 0.5 * 2 / 4);
  EXPECT_GT(-in.out.si(), 1e-6 * 0.5 * 0.5 / 4);
}

TEST(FlowTest, WaterComesOutOfDrainedSurfacesAndNeverGoesIn) {
  // An upright joint through a chamber: water in the west stands to 1.2 m; the chamber reaches from 0.6 m to 1.8 m.
  auto input = scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5})}, {box({1.5, 0.5, 0.6}, {2.5, 1.5, 1.8})});
  const auto built = build(input, {.sides = {{west, at(1.2)}}, .transmissivity = {1e-6}});
  const Flow flow = solved(built.network, 0.01);
  EXPECT_EQ(flow.status, FlowStatus::converged);
  const auto& chamber = flow.surfaces[built.of_excavation(0)];
  EXPECT_GT(flow.drained.low, 0);
  EXPECT_GT(chamber.dry_length.si(), 1) << "above the water nothing comes out";
  EXPECT_GT(chamber.open_length.si(), 0.6);
  EXPECT_NEAR(chamber.dry_length.si() + chamber.open_length.si(), 2 * (1 + 1.2), 1e-12);
  for (std::size_t b = 0; b < flow.mesh.borders.size(); ++b) {
    EXPECT_LT(flow.mesh.borders[b].surface, flow.surfaces.size());
  }
  // All of it above the water: nothing.
  const auto dry = build(input, {.sides = {{west, at(0.4)}}, .transmissivity = {1e-6}});
  const Flow none = solved(dry.network, 0.01);
  EXPECT_DOUBLE_EQ(none.drained.value, 0);
  EXPECT_DOUBLE_EQ(none.surfaces[dry.of_excavation(0)].open_length.si(), 0);
  EXPECT_NEAR(none.imbalance, 0, 1e-9);
}

TEST(FlowTest, WaterSeepsOutWhereTheFirstMeshHasNoSide) {
  // The only drained side of the first mesh has its middle above the water; water comes out at its foot all the same.
  // Values of fine meshes. Finite differences on grids of 20, 40 and 80 cells a side come down to them: 1.4075, 1.3974,
  // 1.3923 at 4 m, 0.2392, 0.2141, 0.2071 at 1 m.
  constexpr std::array<std::pair<double, double>, 6> cases{
      {{0.5, 0.0848}, {1, 0.204}, {3, 0.9103}, {4, 1.3887}, {5, 1.9469}, {8, 4.052}}};
  for (const auto& [level, exact] : cases) {
    SCOPED_TRACE(level);
    double low = 0, high = 1e9;
    for (const double tolerance : {0.1, 0.02, 0.005}) {
      const Flow flow = solved(seeping(level), tolerance);
      EXPECT_EQ(flow.status, FlowStatus::converged);
      EXPECT_NEAR(flow.drained.value, exact, tolerance * exact);
      EXPECT_LE(flow.drained.low, exact * 1.001);
      EXPECT_GE(flow.drained.high, exact * 0.999);
      EXPECT_LE(0.5 * (flow.drained.high - flow.drained.low), tolerance * flow.drained.value);
      // Coarse meshes promise nothing that finer ones deny.
      EXPECT_GE(flow.drained.high, low);
      EXPECT_LE(flow.drained.low, high);
      low = std::max(low, flow.drained.low);
      high = std::min(high, flow.drained.high);
      EXPECT_GT(flow.surfaces[0].dry_length.si(), 0);
      EXPECT_FALSE(flow.surfaces[1].bounds.has_value()) << "of one surface alone, where some is dry";
      for (std::size_t t = 0; t < flow.mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const geometry::Vec3 p = flow.mesh.points[flow.mesh.triangles[t][k]];
          EXPECT_TRUE(p.x < 10 || flow.head[t][k].si() <= p.z + 1e-9);
        }
      }
      for (std::size_t b = 0; b < flow.mesh.borders.size(); ++b) {
        EXPECT_TRUE(flow.mesh.borders[b].surface != 0 || flow.out_of_border[b].si() >= -1e-12);
      }
    }
  }
}

TEST(FlowTest, ACoarseMeshsBoundsHoldWhateverIsDry) {
  for (const double level : {0.5, 2.0, 4.0, 6.0, 9.0}) {
    SCOPED_TRACE(level);
    const Flow fine = solved(seeping(level), 0.003);
    for (const std::size_t triangles : {2U, 20U, 60U, 150U, 400U, 900U}) {
      const Flow coarse = flow::solve(seeping(level), {.tolerance = 1e-6, .most_triangles = triangles}).value();
      EXPECT_EQ(coarse.status, FlowStatus::too_many_triangles);
      EXPECT_LE(coarse.drained.low, fine.drained.high);
      EXPECT_GE(coarse.drained.high, fine.drained.low);
    }
  }
}

TEST(FlowTest, AFeebleJointsInflowIsAsGoodAsAPermeableOnes) {
  // One joint drains the other way than a far more permeable one: what is rounding there is not rounding here.
  auto input =
      scene(box({0, 0, 0}, {4, 4, 2}), {rectangle(2, 1, {-1, -1}, {5, 5}), rectangle(2, 1.9, {-1, -1}, {5, 5})},
            {box({1, 1, 0.5}, {3, 3, 1.5})});
  const auto built = build(input, {.sides = {{west, at(7)}, {east, at(7)}, {south, at(7)}, {north, at(7)}},
                                   .transmissivity = {1e-18, 1e-2}});
  constexpr double exact = 10.234092569 * 1e-18 * (7 - 1);
  const Flow flow = solved(built.network, 0.01);
  EXPECT_EQ(flow.status, FlowStatus::converged);
  EXPECT_LE(flow.drained.low, exact);
  EXPECT_GE(flow.drained.high, exact);
  EXPECT_LE(0.5 * (flow.drained.high - flow.drained.low), 0.01 * exact);
}

TEST(FlowTest, WhatPassesByADryOpeningIsNoInflow) {
  // Water passes from 1 m to 0.5 m under a chamber that begins at 1.2 m, and under one that begins at 0.8 m.
  for (const double lowest : {1.2, 0.8}) {
    auto input = scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5})}, {box({2.5, 0.5, lowest}, {3.5, 1.5, 1.8})});
    const auto built = build(input, {.sides = {{west, at(1)}, {east, at(0.5)}}, .transmissivity = {1e-6}});
    const Flow flow = solved(built.network, 0.05);
    EXPECT_EQ(flow.status, FlowStatus::converged);
    EXPECT_EQ(flow.drained.value, 0);
    EXPECT_LE(flow.drained.high, 0.05 * -flow.surfaces[built.of_tag(west)].out.si() * 1.1);
    EXPECT_EQ(flow.drained.high == 0, lowest > 1) << "no head is above the highest level";
  }
}

TEST(FlowTest, HeadsAreAsGoodInFeebleJointsAsInPermeableOnes) {
  // Two joints that do not touch; nearly all of the water is in one, so its bounds say nothing of the other.
  flow::NetworkSpec spec;
  const flow::Mesh one = seeping(4).mesh();
  spec.mesh = one;
  for (geometry::Vec3 p : one.points) {
    p.y += 5;
    spec.mesh.points.push_back(p);
  }
  spec.mesh.triangles.push_back({4, 5, 6});
  spec.mesh.triangles.push_back({4, 6, 7});
  spec.mesh.part = {0, 0, 1, 1};
  spec.mesh.borders.push_back({{5, 6}, 2});
  spec.mesh.borders.push_back({{7, 4}, 3});
  spec.transmissivity = {Transmissivity::from_si(1e-9), Transmissivity::from_si(1)};
  spec.surfaces = {Drained{}, at(6), Drained{}, at(30)};
  const auto network = flow::Network::make(std::move(spec)).value();
  const auto pressure = [&](double tolerance, bool pressures) {  // m3, of the feeble one
    const Flow flow = flow::solve(network, {.tolerance = tolerance, .pressures = pressures}).value();
    EXPECT_EQ(flow.status, FlowStatus::converged);
    EXPECT_LE(flow.rounds.back().pressures, tolerance);
    double sum = 0;
    for (std::size_t t = 0; t < flow.mesh.triangles.size(); ++t) {
      if (flow.mesh.part[t] != 0) continue;
      const auto& [a, b, c] = flow.mesh.triangles[t];
      const double area =
          0.5 * norm(cross(flow.mesh.points[b] - flow.mesh.points[a], flow.mesh.points[c] - flow.mesh.points[a]));
      for (std::size_t k = 0; k < 3; ++k) sum += area / 3 * flow.head[t][k].si();
    }
    return sum;
  };
  const double fine = pressure(0.0005, true);
  EXPECT_NEAR(pressure(0.02, true), fine, 0.02 * fine);
  EXPECT_GT(std::abs(pressure(0.02, false) - fine), 0.02 * fine) << "the inflow alone does not ask for it";
}

TEST(FlowTest, HeadsThatMeetAreRefused) {
  const auto built =
      build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5})}), {.sides = {{west, at(3)}, {south, at(2)}}});
  const auto flow = flow::solve(built.network);
  ASSERT_FALSE(flow.has_value());
  const auto* meet = std::get_if<flow::HeadsMeet>(&flow.error());
  ASSERT_NE(meet, nullptr);
  EXPECT_NEAR(std::abs(meet->head - meet->other_head), 1, 1e-12);
  EXPECT_NE(describe(flow.error()).find("close one"), std::string::npos);
  // Of one head they may touch; what passes each alone has no bounds, what passes both has.
  const auto same = build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5})}),
                          {.sides = {{west, at(3)}, {south, at(3)}, {east, at(2)}}});
  EXPECT_FALSE(flow::solve(same.network).has_value()) << "south and east still meet";
  const auto good = build(scene(room(), {rectangle(2, 1, {-1, -1}, {3, 5})}, {box({2, 1, 0.5}, {2.5, 2, 1.5})}),
                          {.sides = {{west, at(3)}, {south, at(3)}}});
  const Flow through = solved(good.network);
  EXPECT_FALSE(through.surfaces[good.of_tag(west)].bounds.has_value());
  EXPECT_TRUE(through.surfaces[good.of_excavation(0)].bounds.has_value());
}

TEST(FlowTest, HeadsThatMeetInAnEdgeOfTheRockAreRefused) {
  // From the edge between west and south to that between east and north, 5 m long.
  const auto input = scene(room(), {joint({{-4, -3, 0}, {8, 6, 0}, {8, 6, 2}, {-4, -3, 2}})});
  const auto passes = [&](std::map<std::uint32_t, flow::Surface> sides) {
    const auto built = build(input, {.sides = std::move(sides), .transmissivity = {2e-5}});
    const Flow flow = solved(built.network);
    double sum = 0;
    for (const auto& surface : flow.surfaces) sum += std::max(surface.out.si(), 0.0);
    return sum;
  };
  const double exact = 2e-5 * 2 * (9 - 7) / 5;
  // The one that water passes counts, whichever it is.
  for (const Tag high : {west, south}) {
    for (const Tag low : {east, north}) EXPECT_NEAR(passes({{high, at(9)}, {low, at(7)}}), exact, 1e-15);
  }
  EXPECT_NEAR(passes({{west, at(9)}, {south, at(9)}, {north, at(7)}}), exact, 1e-15) << "of one head they may meet";
  EXPECT_NEAR(passes({{west, at(9)}, {south, at(0)}, {north, at(7)}}), exact, 1e-15) << "south is dry there";
  for (const flow::Surface& other : {flow::Surface{at(1)}, flow::Surface{Drained{}}}) {
    try {
      passes({{west, at(9)}, {south, other}});
      FAIL() << "two heads in one edge";
    } catch (const flow::HeadsMeet& meet) {
      EXPECT_NEAR(std::abs(meet.head - meet.other_head), std::holds_alternative<Drained>(other) ? 9 : 8, 1e-12);
      EXPECT_NE(meet.surface, meet.other);
    }
  }
}

TEST(FlowTest, WhatIsNoNetworkIsRefused) {
  const auto good = [] {
    flow::NetworkSpec spec;
    spec.mesh = {
        .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .part = {0}, .borders = {{{0, 1}, 0}}};
    spec.transmissivity = {Transmissivity::from_si(1e-6)};
    spec.surfaces = {Drained{}};
    return spec;
  };
  EXPECT_TRUE(flow::Network::make(good()).has_value());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto&& change) {
    auto spec = good();
    change(spec);
    const auto network = flow::Network::make(std::move(spec));
    return network ? std::string{} : describe(network.error());
  };
  EXPECT_EQ(refused([](auto& s) { s.transmissivity[0] = Transmissivity{}; }),
            "part 0 has a transmissivity that is not above 0");
  EXPECT_NE(refused([&](auto& s) { s.transmissivity[0] = Transmissivity::from_si(nan); }), "");
  EXPECT_NE(refused([&](auto& s) { s.mesh.points[1].x = nan; }), "");
  EXPECT_NE(refused([](auto& s) { s.mesh.points[2] = {1, 0, 0}; }), "") << "a side without length";
  EXPECT_NE(refused([](auto& s) { s.mesh.triangles[0][2] = 3; }), "");
  EXPECT_NE(refused([](auto& s) { s.mesh.part[0] = 1; }), "");
  EXPECT_NE(refused([](auto& s) { s.mesh.part.clear(); }), "");
  EXPECT_NE(refused([](auto& s) { s.mesh.borders[0].surface = 1; }), "");
  EXPECT_NE(refused([](auto& s) { s.mesh.borders.push_back({{1, 0}, 0}); }), "") << "twice";
  EXPECT_NE(refused([](auto& s) { s.mesh.borders[0].ends = {0, 0}; }), "");
  EXPECT_NE(refused([&](auto& s) { s.surfaces[0] = Standing{metres(nan)}; }), "");
  EXPECT_FALSE(flow::solve(flow::Network::make(good()).value(), {.tolerance = 0}).has_value());
  EXPECT_FALSE(flow::solve(flow::Network::make(good()).value(), {.tolerance = nan}).has_value());
  EXPECT_TRUE(flow::solve(flow::Network::make({}).value()).has_value()) << "no joints: no water";
}

TEST(FlowTest, TheCubicLaw) {
  // 0.1 mm, water at 20 degrees: 9.81 * 1e-12 / (12 * 1.004e-6).
  EXPECT_NEAR(flow::cubic_law(1e-4, 1.004e-6, 9.81), 8.1424e-7, 1e-11);
}

}  // namespace
}  // namespace cleave::testing
