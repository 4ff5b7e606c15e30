#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "water.hpp"
#include "workloads.hpp"

// Cells about corners of triangles: two-point fluxes between them are the equations of heads linear in triangles.

namespace cleave::testing {
namespace {

using flow::FlowCells;

FlowCells cells_of(const Built& built, const Flow& flow, std::vector<double> openings = {}) {
  std::vector<Length> of_part;
  for (const auto& piece : built.complex.network()->pieces) {
    double sum = 0;
    for (const auto joint : piece.joints) sum += joint.index() < openings.size() ? openings[joint.index()] : 1e-3;
    of_part.push_back(metres(sum));
  }
  return flow::cells_of(flow, built.network, of_part);
}

/// The same water on the mesh for two-point fluxes.
Flow made_of(const flow::Network& network, const Flow& flow) {
  auto made = flow::solve_for_two_points(network, flow);
  if (!made) throw std::runtime_error{describe(made.error())};
  EXPECT_LT(made->residual, 1e-12);
  EXPECT_EQ(made->status, FlowStatus::converged);
  EXPECT_TRUE(made->q.empty() && made->surfaces.empty()) << "heads alone";
  return *std::move(made);
}
Flow made(const flow::Network& network, double tolerance) { return made_of(network, solved(network, tolerance)); }

double volume(const FlowCells& cells) {
  double sum = 0;
  for (const auto& cell : cells.cells) sum += cell.volume.si();
  return sum;
}

/// What held cells of a surface are sent.
double out_of(const FlowCells& cells, std::size_t surface) {
  double sum = 0;
  for (const auto& held : cells.held) sum += held.surface == surface ? held.out.si() : 0;
  return sum;
}

/// Heads from the connections and the heads of held cells alone: conjugate gradients.
std::vector<double> heads_again(const FlowCells& cells) {
  const std::size_t n = cells.cells.size();
  std::vector<double> head(n, 0), rest(n, 0), along(n, 0), image(n, 0);
  std::vector<char> free(n, 1);
  for (const auto& held : cells.held) {
    free[held.cell] = 0;
    head[held.cell] = cells.cells[held.cell].head.si();
  }
  const auto stay = [&](const std::vector<double>& of, std::vector<double>& in) {
    std::ranges::fill(in, 0);
    for (const auto& c : cells.connections) {
      const double to_first = c.conductance.si() * 1e6 * (of[c.cells[1]] - of[c.cells[0]]);
      in[c.cells[0]] += to_first;
      in[c.cells[1]] -= to_first;
    }
    for (std::size_t k = 0; k < n; ++k) in[k] = free[k] != 0 ? in[k] : 0;
  };
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  };
  stay(head, rest);
  along = rest;
  double size = dot(rest, rest);
  const double small = 1e-26 * size;
  for (int step = 0; step < 20000 && size > small; ++step) {
    stay(along, image);
    const double length = -size / dot(along, image);
    for (std::size_t k = 0; k < n; ++k) {
      head[k] += length * along[k];
      rest[k] += length * image[k];
    }
    const double next = dot(rest, rest);
    for (std::size_t k = 0; k < n; ++k) along[k] = rest[k] + next / size * along[k];
    size = next;
  }
  return head;
}

void expect_the_same_heads(const FlowCells& cells) {
  const std::vector<double> again = heads_again(cells);
  double worst = 0;
  for (std::size_t c = 0; c < again.size(); ++c) worst = std::max(worst, std::abs(again[c] - cells.cells[c].head.si()));
  EXPECT_LT(worst, 1e-7);
  EXPECT_LT(cells.imbalance, 1e-10);
}

TEST(CellsTest, OneJointIsDarcysLaw) {
  const auto built = build(scene(room(), {rectangle(2, 1, {-1, -1}, {5, 5})}),
                           {.sides = {{west, at(10)}, {east, at(4)}}, .transmissivity = {2e-5}});
  const FlowCells cells = cells_of(built, made(built.network, 0.01));
  const double exact = 2e-5 * 3 * (10 - 4) / 4;
  EXPECT_NEAR(out_of(cells, built.of_tag(east)), exact, 1e-15);
  EXPECT_NEAR(out_of(cells, built.of_tag(west)), -exact, 1e-15);
  EXPECT_NEAR(volume(cells), 1e-3 * 12, 1e-15);
  EXPECT_EQ(cells.negative, 0U);
  EXPECT_DOUBLE_EQ(cells.negative_share, 0);
  EXPECT_EQ(cells.held.size(), cells.cells.size()) << "two triangles, four corners";
  EXPECT_EQ(cells.connections.size(), 5U);
  EXPECT_NEAR(cells.cells.front().volume.si() + cells.cells.back().volume.si(), 6e-3, 6e-3) << "thirds of triangles";
  for (const auto& held : cells.held) {
    const double x = built.complex.origin().x + cells.cells[held.cell].at.x;
    EXPECT_NEAR(built.complex.origin().z + cells.cells[held.cell].head.si(), x < 2 ? 10 : 4, 1e-12);
  }
}

TEST(CellsTest, WhatPassesIsTheUpperBoundBetweenTwoLevels) {
  // Joints that cross, one that ends on another, apertures and transmissivities of their own.
  const auto input = scene(
      room(), {rectangle(2, 1, {-1, -1}, {5, 5}), parallelogram({2, 1.5, 1}, {1.5, 0.7, 0}, {0.3, 0, 0.8}),
               parallelogram({2.5, 1.2, 1}, {1.1, -0.4, 0.2}, {0, 1, 0.6}), rectangle(0, 3, {0.5, 0.2}, {2.5, 1})});
  const auto built =
      build(input, {.sides = {{west, at(10)}, {east, at(4)}}, .transmissivity = {1e-6, 3e-5, 2e-7, 8e-6}});
  const std::vector<double> openings{1e-3, 2e-3, 5e-4, 4e-3};
  for (const bool two_point : {false, true}) {
    const Flow solution = solved(built.network, 0.02);
    const auto bounds = solution.surfaces[built.of_tag(east)].bounds.value();
    const Flow flow = two_point ? made_of(built.network, solution) : solution;
    const FlowCells cells = cells_of(built, flow, openings);
    const double out = out_of(cells, built.of_tag(east));
    EXPECT_GT(bounds.high, bounds.low * 1.001) << "or nothing is told apart";
    EXPECT_TRUE(two_point || std::abs(out - bounds.high) <= 1e-10 * bounds.high);
    EXPECT_LE(out, bounds.high * (1 + 1e-12)) << "turned and split sides let the energy fall";
    EXPECT_GE(out, 0.5 * (bounds.low + bounds.high)) << "and not below the exact one";
    EXPECT_NEAR(out_of(cells, built.of_tag(west)), -out, 1e-10 * out);
    expect_the_same_heads(cells);
    double exact = 0;
    for (const auto& piece : built.complex.network()->pieces) {
      exact += piece.area.si() * openings[piece.joints.front().index()];
    }
    EXPECT_NEAR(volume(cells), exact, 1e-12);
    EXPECT_NEAR(flow.wet_area.si(), flow.area.si(), 1e-12);
    EXPECT_EQ(flow.open.size(), flow.mesh.borders.size());
    EXPECT_EQ(flow.held.size(), flow.mesh.triangles.size());
  }
}

TEST(CellsTest, WaterIntoAnOpeningLiesWithinTheBounds) {
  auto input = scene(box({0, 0, 0}, {8, 6, 6}),
                     {rectangle(2, 3, {-1, -1}, {9, 9}), parallelogram({4, 3, 3}, {5, 0, 0.8}, {0, 5, 1.2}),
                      parallelogram({4, 3, 3}, {0.3, 4, 0.2}, {0, 1, 4})},
                     {box({3, 2, 2}, {5, 4, 4})});
  const auto built = build(input, {.sides = {{west, at(9)}, {east, at(9)}}, .transmissivity = {1e-6, 3e-5, 2e-7}});
  const Flow flow = solved(built.network, 0.02);
  const FlowCells cells = cells_of(built, made_of(built.network, flow));
  const double out = out_of(cells, built.of_excavation(0));
  EXPECT_GE(out, flow.drained.low);
  EXPECT_LE(out, flow.drained.high);
  EXPECT_GT(out, 0);
  expect_the_same_heads(cells);
  for (const auto& held : cells.held) {
    const auto& cell = cells.cells[held.cell];
    const bool drained = held.surface == built.of_excavation(0);
    EXPECT_NEAR(cell.head.si(), drained ? cell.at.z : 9 - built.complex.origin().z, 1e-12);
  }
  EXPECT_TRUE(std::ranges::is_sorted(cells.held, {}, &flow::HeldCell::cell));
  EXPECT_TRUE(std::ranges::is_sorted(cells.connections, {}, &flow::FlowConnection::cells));
}

TEST(CellsTest, DryJointsAndDrySidesAreLeftOut) {
  // The second joint touches no water; the first is a wall whose drained chamber is dry above the water.
  auto input = scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5}), rectangle(2, 1.9, {3, 2}, {3.5, 2.5})},
                     {box({1.5, 0.5, 0.6}, {2.5, 1.5, 1.8})});
  const auto built = build(input, {.sides = {{west, at(1.2)}}, .transmissivity = {1e-6}});
  const Flow flow = solved(built.network, 0.01);
  const FlowCells cells = cells_of(built, made_of(built.network, flow));
  EXPECT_NEAR(volume(cells), 1e-3 * (4 * 2 - 1.2), 1e-14);
  EXPECT_NEAR(out_of(cells, built.of_excavation(0)), flow.drained.value, 0.51 * (flow.drained.high - flow.drained.low));
  expect_the_same_heads(cells);
  std::size_t below = 0;
  for (const auto& held : cells.held) {
    const double z = built.complex.origin().z + cells.cells[held.cell].at.z;
    EXPECT_LT(z, 1.2 + 1e-9) << "above the water nothing is imposed";
    below += held.surface == built.of_excavation(0) ? 1U : 0U;
  }
  EXPECT_GT(below, 3U);
  const auto none = build(input, {.sides = {{west, at(-1)}}});
  EXPECT_TRUE(cells_of(none, made(none.network, 0.01)).cells.empty());
}

TEST(CellsTest, WaterIsHeldAtItsHeightWhereItSeepsOutAndNowhereElse) {
  constexpr std::array openings{metres(1e-3)};
  for (const double level : {0.5, 1.0, 4.0, 8.0}) {
    for (const double tolerance : {0.3, 0.03}) {
      SCOPED_TRACE(level);
      const auto network = seeping(level);
      const Flow flow = solved(network, tolerance);
      const FlowCells cells = flow::cells_of(made_of(network, flow), network, openings);
      expect_the_same_heads(cells);
      ASSERT_EQ(cells.negative, 0U);
      const double out = out_of(cells, 0);
      EXPECT_GE(out, flow.drained.low);
      EXPECT_LE(out, flow.drained.high);
      std::vector<char> held(cells.cells.size(), 0);
      for (const auto& own : cells.held) {
        const auto& cell = cells.cells[own.cell];
        held[own.cell] = 1;
        EXPECT_NEAR(cell.head.si(), own.surface == 0 ? cell.at.z : level, 1e-12);
        EXPECT_TRUE(own.surface != 0 || own.out.si() > -1e-12) << "no water goes in";
      }
      std::size_t dry = 0;
      for (std::size_t c = 0; c < held.size(); ++c) {
        const auto& cell = cells.cells[c];
        if (cell.at.x < 10 || held[c] != 0) continue;
        EXPECT_LE(cell.head.si(), cell.at.z + 1e-9);
        ++dry;
      }
      EXPECT_GT(dry, 0U) << "or nothing is closed";
    }
  }
}

TEST(CellsTest, WaterIsHeldWhereContinuousHeadsReachIt) {
  // Two triangles: the middle of the only drained side lies above the water, so balanced rates leave nowhere; its foot
  // lies below.
  const auto network = seeping(2);
  const Flow flow = flow::solve(network, {.tolerance = 1e-6, .most_triangles = 2}).value();
  ASSERT_EQ(flow.mesh.triangles.size(), 3U) << "the level splits the side with the water";
  const std::array openings{metres(1e-3)};
  const FlowCells cells = flow::cells_of(flow, network, openings);
  expect_the_same_heads(cells);
  EXPECT_EQ(flow.drained.low, 0);
  EXPECT_GT(out_of(cells, 0), 0);
  EXPECT_LE(out_of(cells, 0), flow.drained.high);
}

TEST(CellsTest, StandingWaterHoldsNothingAboveItself) {
  const auto built = build(scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5})}),
                           {.sides = {{west, at(1)}, {top, at(5)}}, .transmissivity = {1e-6}});
  const FlowCells cells = cells_of(built, made(built.network, 0.05));
  std::size_t corner = 0;
  for (const auto& held : cells.held) {
    const Vec3 place = built.complex.origin() + cells.cells[held.cell].at;
    EXPECT_EQ(held.surface, built.of_tag(place.z > 1.5 ? top : west));
    corner += norm(place - Vec3{0, 1, 2}) < 1e-9 ? 1U : 0U;
  }
  EXPECT_EQ(corner, 1U) << "of two sides, one of them dry there";
  expect_the_same_heads(cells);
}

TEST(CellsTest, ACellOfTwoSurfacesIsOfTheStandingWater) {
  // Water stands in the west to where the floor of a chamber begins; more comes from the east.
  auto input = scene(room(), {rectangle(1, 1, {-1, -1}, {5, 5})}, {box({-1, 0.5, 1}, {1, 1.5, 1.5})});
  const auto built = build(input, {.sides = {{west, at(1)}, {east, at(5)}}, .transmissivity = {1e-6}});
  const Flow flow = solved(built.network, 0.02);
  const FlowCells cells = cells_of(built, made_of(built.network, flow));
  std::size_t shared = 0;
  for (const auto& held : cells.held) {
    const Vec3 place = built.complex.origin() + cells.cells[held.cell].at;
    if (norm(place - Vec3{0, 1, 1}) > 1e-9) continue;
    EXPECT_EQ(held.surface, built.of_tag(west));
    ++shared;
  }
  EXPECT_EQ(shared, 1U);
  const double out = out_of(cells, built.of_excavation(0));
  EXPECT_GE(out, flow.drained.low);
  EXPECT_LE(out, flow.drained.high);
  expect_the_same_heads(cells);
}

TEST(CellsTest, JointsThatTouchInAPointHaveACellEachThere) {
  // Two upright triangles in one plane whose points meet: no water passes from one to the other.
  const topology::Joint lower = joint({{0, 1, 0}, {4, 1, 0}, {2, 1, 1}}),
                        upper = joint({{2, 1, 1}, {4, 1, 2}, {0, 1, 2}});
  const auto built =
      build(scene(room(), {lower, upper}), {.sides = {{west, at(10)}, {east, at(4)}, {bottom, at(3)}, {top, at(8)}}});
  const FlowCells cells = cells_of(built, made(built.network, 0.05));
  std::size_t there = 0;
  for (const auto& cell : cells.cells) {
    if (norm(built.complex.origin() + cell.at - Vec3{2, 1, 1}) < 1e-9) ++there;
  }
  EXPECT_EQ(there, 2U);
  EXPECT_NEAR(volume(cells), 1e-3 * 4, 1e-14);
}

TEST(CellsTest, TheLastMeshHasFewNegativeConductances) {
  auto input = support::cut_input(support::workload_named("disc-1500").value());
  const auto built = build(input, {.sides = {{west, at(150)}, {east, at(130)}}});
  const Flow plain = solved(built.network, 0.3), made = made_of(built.network, plain);
  const FlowCells before = cells_of(built, plain), after = cells_of(built, made);
  EXPECT_GT(before.negative_share, 20 * after.negative_share);
  EXPECT_LT(after.negative_share, 1e-3);
  EXPECT_NEAR(volume(after), volume(before), 1e-9);
  const auto& bounds = plain.surfaces[built.of_tag(east)].bounds.value();
  EXPECT_NEAR(out_of(before, built.of_tag(east)), bounds.high, 1e-9 * bounds.high);
  EXPECT_LT(out_of(after, built.of_tag(east)), bounds.high) << "the energy falls with sides that are turned or split";
  EXPECT_GT(out_of(after, built.of_tag(east)), bounds.low);
  EXPECT_LT(made.mesh.triangles.size(), 3 * plain.mesh.triangles.size());
}

}  // namespace
}  // namespace cleave::testing
