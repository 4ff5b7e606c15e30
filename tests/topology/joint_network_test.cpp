#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "complexes.hpp"
#include "workloads.hpp"

// CutInput::keep_network: the joints cut along each other, in triangles. What is known of discs in a box by clipping
// polygons in doubles is the oracle: areas, lengths of intersections, lengths of traces on the sides.

namespace cleave::testing {
namespace {

using topology::JointNetwork;
using topology::Role;
using topology::VertexId;
using Side = std::pair<VertexId, VertexId>;

Side side(VertexId a, VertexId b) { return std::minmax(a, b); }

topology::BlockComplex with_network(topology::CutInput input) {
  const auto plain = certified(input).complex();
  input.keep_network = true;
  auto kept = certified(input).complex();
  EXPECT_EQ(canonical_hash(kept), canonical_hash(plain)) << "the blocks are the same";
  EXPECT_FALSE(kept.dangling().has_value()) << "was not asked for";
  return kept;
}

/// Sides of triangles with the pieces on them, each piece once or twice.
std::map<Side, std::vector<std::uint32_t>> sides_of(const JointNetwork& network) {
  std::map<Side, std::vector<std::uint32_t>> sides;
  for (std::uint32_t p = 0; p < network.pieces.size(); ++p) {
    const auto& piece = network.pieces[p];
    for (std::uint32_t t = piece.first_triangle; t < piece.first_triangle + piece.triangle_count; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        sides[side(network.triangles[t][k], network.triangles[t][(k + 1) % 3])].push_back(p);
      }
    }
  }
  return sides;
}

double length(const topology::BlockComplex& complex, Side s) {
  return geometry::norm(complex.vertices()[s.second] - complex.vertices()[s.first]);
}

/// What must hold of every network.
void check(const topology::BlockComplex& complex) {
  const JointNetwork& network = *complex.network();
  const double extent = geometry::norm(geometry::box_of(complex.vertices()).size());
  std::uint32_t next = 0;
  for (const auto& piece : network.pieces) {
    EXPECT_EQ(piece.first_triangle, next);
    next += piece.triangle_count;
    EXPECT_FALSE(piece.joints.empty());
    EXPECT_GT(piece.triangle_count, 0U);
    const auto n = complex.planes()[piece.plane].unit_normal();
    Vec3 sum{};
    double area = 0;
    std::map<Side, int> within;
    for (std::uint32_t t = piece.first_triangle; t < next; ++t) {
      const auto [a, b, c] = network.triangles[t];
      const Vec3 own = 0.5 * geometry::cross(complex.vertices()[b] - complex.vertices()[a],
                                             complex.vertices()[c] - complex.vertices()[a]);
      // Decided exactly; what doubles tell of it may be rounding.
      EXPECT_GT(geometry::dot(own, Vec3{n[0], n[1], n[2]}), -1e-13 * extent * extent) << "the other way round";
      sum += own;
      area += geometry::norm(own);
      for (const Side& s : {side(a, b), side(b, c), side(c, a)}) EXPECT_LE(++within[s], 2) << "no side is used thrice";
    }
    EXPECT_NEAR(piece.area.si(), area, 1e-12 * area);
    EXPECT_NEAR(geometry::norm(sum), area, 1e-9 * area + 1e-12 * extent * extent) << "all in one plane";
  }
  EXPECT_EQ(next, network.triangles.size());
  const auto sides = sides_of(network);
  std::set<Side> borders;
  for (const auto& border : network.borders) {
    EXPECT_TRUE(borders.insert(side(border.ends[0], border.ends[1])).second) << "each once";
    EXPECT_TRUE(sides.contains(side(border.ends[0], border.ends[1]))) << "a side of a triangle";
    EXPECT_NE(border.role, Role::joint);
  }
}

double area_of_joint(const topology::BlockComplex& complex, std::size_t joint) {
  double area = 0;
  for (const auto& piece : complex.network()->pieces) {
    if (std::ranges::find(piece.joints, topology::JointId{joint}) != piece.joints.end()) area += piece.area.si();
  }
  return area;
}

double border_length(const topology::BlockComplex& complex, auto&& counts) {
  double sum = 0;
  for (const auto& border : complex.network()->borders) {
    if (counts(border)) sum += length(complex, {border.ends[0], border.ends[1]});
  }
  return sum;
}

geometry::Solid cube() { return box({0, 0, 0}, {4, 4, 4}); }

TEST(JointNetworkTest, ThreePlanesThroughACube) {
  auto input = scene(cube(), {rectangle(0, 2, {-1, -1}, {5, 5}), rectangle(1, 2, {-1, -1}, {5, 5}),
                              rectangle(2, 2, {-1, -1}, {5, 5})});
  input.free_domain_tags = {5};
  const auto complex = with_network(input);
  check(complex);
  const auto& network = *complex.network();
  EXPECT_EQ(network.pieces.size(), 12U);
  EXPECT_EQ(network.triangles.size(), 24U) << "squares";
  for (std::size_t j = 0; j < 3; ++j) EXPECT_DOUBLE_EQ(area_of_joint(complex, j), 16);
  double crossings = 0;
  for (const auto& [s, pieces] : sides_of(network)) {
    if (pieces.size() == 4) crossings += length(complex, s);
  }
  EXPECT_DOUBLE_EQ(crossings, 12);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return b.role == Role::fixed; }), 40);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return b.role == Role::free && b.tag == 5U; }), 8);
  for (const auto& piece : network.pieces) EXPECT_NE(piece.blocks[0], piece.blocks[1]);
}

TEST(JointNetworkTest, BordersInAnEdgeOfTheRockKnowAllItsSurfaces) {
  // Upright, from the edge between two sides to the one across; a chamber's corner touches it.
  auto input = scene(cube(), {joint({{-1, -1, -1}, {5, 5, -1}, {5, 5, 5}, {-1, -1, 5}})}, {box({1, 2, 1}, {2, 3, 3})});
  input.free_domain_tags = {1};
  const auto complex = with_network(input);
  check(complex);
  const auto& network = *complex.network();
  std::set<std::vector<std::uint32_t>> edges;
  for (std::uint32_t b = 0; b < network.borders.size(); ++b) {
    const auto number = [](const auto& side) { return side.excavation ? 100 + *side.excavation : *side.tag; };
    std::vector<std::uint32_t> surfaces{number(network.borders[b])};
    for (const auto& other : network.others) {
      if (other.border == b) surfaces.push_back(number(other));
    }
    if (surfaces.size() > 1) edges.insert(surfaces);
  }
  // West and south; east, which is free, and north. All of the chamber's faces are one surface.
  EXPECT_EQ(edges, (std::set<std::vector<std::uint32_t>>{{0, 2}, {1, 3}}));
  EXPECT_EQ(network.others.size(), 2U);
  EXPECT_EQ(network.others[1].role, Role::fixed);
}

TEST(JointNetworkTest, LinesThatEndInAJointAreSidesOfTriangles) {
  // A level joint with three that stand on it, apart from each other and from its outline; two of them cross.
  const auto complex =
      with_network(scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5}), rectangle(0, 1, {1, 1}, {2, 3}),  // (1, 1..2)
                                  rectangle(0, 3, {1, 2}, {3, 3}),                                     // (3, 1..3)
                                  rectangle(1, 2, {2, 1}, {3.5, 3})}));                                // (2..3.5, 2)
  check(complex);
  const auto& network = *complex.network();
  const auto sides = sides_of(network);
  double on_both_sides = 0;
  for (const auto& [s, pieces] : sides) {
    const std::set<std::uint32_t> several{pieces.begin(), pieces.end()};
    if (several.size() > 1) on_both_sides += length(complex, s);
  }
  EXPECT_DOUBLE_EQ(on_both_sides, 1 + 2 + 1.5 + 1) << "traces of the three, and where two of them cross";
  EXPECT_DOUBLE_EQ(area_of_joint(complex, 0), 16);
  EXPECT_EQ(network.pieces[0].triangle_count, 4U + 2 + (4 + 4) + 2 * 2 - 2)
      << "corners as they are passed, and two holes";
  EXPECT_EQ(complex.blocks().size(), 2U);
}

TEST(JointNetworkTest, AnExcavationTakesJointsAway) {
  auto input = scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5})}, {box({1, 1, 1}, {3, 3, 3})});
  const auto complex = with_network(input);
  check(complex);
  EXPECT_DOUBLE_EQ(area_of_joint(complex, 0), 12);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return b.excavation == 0U; }), 8);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return b.role == Role::fixed; }), 16);
  // On the roof of the excavation a joint has rock on one side alone, beside it on both.
  input.joints.emplace_back(rectangle(2, 3, {0, 0}, {4, 4}));
  EXPECT_DOUBLE_EQ(area_of_joint(with_network(input), 1), 12);
}

TEST(JointNetworkTest, WhereAnExcavationMeetsASideItCounts) {
  // A joint that rises from the edge in which the roof of an opening meets the west side.
  const auto complex =
      with_network(scene(cube(), {joint({{0, 0, 3}, {0, 4, 3}, {1, 4, 4}, {1, 0, 4}})}, {box({-1, 1, 1}, {2, 3, 3})}));
  check(complex);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return b.excavation == 0U; }), 2);
  EXPECT_DOUBLE_EQ(border_length(complex, [](const auto& b) { return !b.excavation && b.tag == 0U; }), 2);
}

TEST(JointNetworkTest, JointsOnOneAnotherAndOnOneLine) {
  const auto lying = with_network(scene(cube(), {rectangle(2, 2, {-1, -1}, {3, 5}), rectangle(2, 2, {1, -1}, {5, 5})}));
  check(lying);
  EXPECT_DOUBLE_EQ(area_of_joint(lying, 0), 12);
  EXPECT_DOUBLE_EQ(area_of_joint(lying, 1), 12);
  double both = 0;
  for (const auto& piece : lying.network()->pieces) both += piece.joints.size() == 2 ? piece.area.si() : 0;
  EXPECT_DOUBLE_EQ(both, 8);
  for (const char* name : {"deg-fan12", "deg-fan12r", "deg-vertex20r", "deg-coplanarr", "deg-touch", "deg-cavity",
                           "deg-ring", "deg-sliver10-1e-12", "deg-utm7", "rect-13"}) {
    SCOPED_TRACE(name);
    check(with_network(support::cut_input(support::workload_named(name).value())));
  }
}

// ---- The oracle: convex polygons in doubles
// --------------------------------------------------------------------------

using Polygon = std::vector<Vec3>;

/// What of a convex polygon lies where n . x <= d.
Polygon clipped(const Polygon& in, Vec3 n, double d) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 a = in[i], b = in[(i + 1) % in.size()];
    const double of_a = geometry::dot(n, a) - d, of_b = geometry::dot(n, b) - d;
    if (of_a <= 0) out.push_back(a);
    if ((of_a < 0 && of_b > 0) || (of_a > 0 && of_b < 0)) out.push_back(a + (of_a / (of_a - of_b)) * (b - a));
  }
  return out;
}
Polygon in_box(Polygon p, double side) {
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    p = clipped(clipped(p, axis, side), -axis, 0);
  }
  return p;
}
Vec3 area_vector(const Polygon& p) {
  Vec3 sum{};
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += 0.5 * geometry::cross(p[i] - p[0], p[i + 1] - p[0]);
  return sum;
}
/// The part of segment a b inside a convex polygon of its plane.
double length_inside(Vec3 a, Vec3 b, const Polygon& p) {
  const Vec3 up = area_vector(p);
  double lo = 0, hi = 1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 out = geometry::cross(p[(i + 1) % p.size()] - p[i], up);
    const double at_a = geometry::dot(out, a - p[i]), at_b = geometry::dot(out, b - p[i]);
    if (at_a > 0 && at_b > 0) return 0;
    if (at_a > 0) lo = std::max(lo, at_a / (at_a - at_b));
    if (at_b > 0) hi = std::min(hi, at_a / (at_a - at_b));
  }
  return hi > lo ? (hi - lo) * geometry::norm(b - a) : 0;
}
double length_of_meet(const Polygon& p, const Polygon& q) {
  const Vec3 n = geometry::normalized(area_vector(q));
  std::vector<Vec3> ends;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 a = p[i], b = p[(i + 1) % p.size()];
    const double of_a = geometry::dot(n, a - q[0]), of_b = geometry::dot(n, b - q[0]);
    if ((of_a < 0) != (of_b < 0)) ends.push_back(a + (of_a / (of_a - of_b)) * (b - a));
  }
  return ends.size() == 2 ? length_inside(ends[0], ends[1], q) : 0;
}

TEST(JointNetworkTest, DiscsAsTheClippingOfPolygonsHasThem) {
  const support::Workload workload = support::workload_named("disc-1000").value();
  const auto complex = with_network(support::cut_input(workload));
  check(complex);
  const auto& network = *complex.network();
  std::vector<Polygon> polygons;
  for (const auto& corners : workload.polygons) polygons.push_back(in_box(corners, 100));
  std::map<std::pair<std::size_t, std::size_t>, double> meets;
  double on_sides = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (polygons[i].size() < 3) continue;
    EXPECT_NEAR(area_of_joint(complex, i), geometry::norm(area_vector(polygons[i])), 1e-6) << i;
    for (std::size_t j = i + 1; j < polygons.size(); ++j) {
      if (polygons[j].size() < 3) continue;
      if (const double l = length_of_meet(polygons[i], polygons[j]); l > 1e-9) meets[{i, j}] = l;
    }
    for (std::size_t k = 0; k < polygons[i].size(); ++k) {
      const Vec3 a = polygons[i][k], b = polygons[i][(k + 1) % polygons[i].size()];
      const auto both_at = [&](double at) {
        const auto near = [&](double x, double y) { return std::abs(x - at) < 1e-9 && std::abs(y - at) < 1e-9; };
        return near(a.x, b.x) || near(a.y, b.y) || near(a.z, b.z);
      };
      if (both_at(0) || both_at(100)) on_sides += geometry::norm(b - a);
    }
  }
  EXPECT_NEAR(border_length(complex, [](const auto&) { return true; }), on_sides, 1e-6);
  EXPECT_GT(meets.size(), 300U);
  std::map<std::pair<std::size_t, std::size_t>, double> found;
  for (const auto& [s, pieces] : sides_of(network)) {
    std::set<std::size_t> joints;
    for (const std::uint32_t p : pieces) joints.insert(network.pieces[p].joints.front().index());
    if (joints.size() == 2) found[{*joints.begin(), *joints.rbegin()}] += length(complex, s);
    EXPECT_LE(joints.size(), 2U);
  }
  EXPECT_EQ(found.size(), meets.size());
  for (const auto& [pair, l] : meets) EXPECT_NEAR(found[pair], l, 1e-6) << pair.first << ' ' << pair.second;
}

}  // namespace
}  // namespace cleave::testing
