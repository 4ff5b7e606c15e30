#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Which joints hang together, what they connect, and what water can pass. Domain of the small scenes: 4 x 4 x 4 m.

namespace cleave::testing {
namespace {

using flow::Connectivity;
using topology::JointId;

struct Found {
  Connectivity of;
  flow::JointSurfaces surfaces;
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> joints() const {
    std::vector<std::vector<std::uint32_t>> out;
    for (const auto& cluster : of.clusters) {
      out.emplace_back();
      for (const JointId j : cluster.joints) out.back().push_back(j.value());
    }
    return out;
  }
  [[nodiscard]] std::set<std::uint32_t> backbone() const {
    std::set<std::uint32_t> out;
    for (const auto& part : of.parts) {
      if (part.backbone) out.insert(part.joint.value());
    }
    return out;
  }
};

Found found(topology::CutInput input) {
  input.keep_network = true;
  const auto complex = certified(input).complex();
  flow::JointSurfaces surfaces = flow::surfaces_of(*complex.network());
  Connectivity connectivity = flow::connectivity(complex, surfaces);
  return {std::move(connectivity), std::move(surfaces)};
}

geometry::Solid cube() { return box({0, 0, 0}, {4, 4, 4}); }
using Lists = std::vector<std::vector<std::uint32_t>>;

TEST(ConnectivityTest, ClustersTouchInLinesNotInPoints) {
  // 0 and 1 cross; 2 meets 1 in one corner alone; 3 is apart.
  const auto one = found(scene(cube(), {rectangle(2, 2, {0.5, 0.5}, {2, 2}), rectangle(0, 1, {0.5, 1}, {2, 3}),
                                        rectangle(0, 1, {2, 3}, {3, 3.5}), rectangle(1, 3.5, {3, 3}, {3.5, 3.5})}));
  EXPECT_EQ(one.joints(), (Lists{{0, 1}, {2}, {3}}));
  EXPECT_EQ(one.of.meetings, 1U);
  EXPECT_DOUBLE_EQ(one.of.meeting_length.si(), 1.5);
  EXPECT_DOUBLE_EQ(one.of.area.si(), 2.25 + 3 + 0.5 + 0.25);
  EXPECT_DOUBLE_EQ(one.of.clusters[0].area.si(), 5.25);
  EXPECT_TRUE(one.surfaces.surfaces.empty()) << "nothing reaches a side";
}

TEST(ConnectivityTest, ALineOfAnyLengthConnects) {
  // The second reaches 1e-12 m over the rim of the first, or ends 1e-12 m before it.
  for (const bool over : {true, false}) {
    const double from = over ? 2 - 1e-12 : 2 + 1e-12;
    const auto one = found(scene(cube(), {rectangle(2, 2, {0.5, 0.5}, {2, 2}), rectangle(0, 1, {from, 1}, {3, 3})}));
    EXPECT_EQ(one.joints().size(), over ? 1U : 2U);
  }
}

TEST(ConnectivityTest, WhatIsPassedOnTheWayToAnOpening) {
  // From the west side (0) over 1 to the chamber (excavation); 2 is a dead end on 1; 3 goes round by way of 1 alone, a
  // ring that leads back to where it left; 4 connects nothing.
  auto input = scene(
      cube(),
      {rectangle(2, 2, {-1, 1}, {1.5, 3}),  // level, x to 1.5
       rectangle(0, 1, {1, 1}, {3, 3}),     // upright at x = 1
       rectangle(2, 2.75, {1, 1.2}, {1.5, 1.6}), rectangle(2, 1.5, {0.5, 1}, {1.2, 3}),
       rectangle(2, 3.75, {0.5, 0.5}, {1, 1}), rectangle(2, 1.25, {0.8, 1.5}, {2.5, 2.5})},  // into the chamber from 1
      {box({2, 1, 1}, {3, 3, 2.2})});
  const auto one = found(input);
  EXPECT_EQ(one.joints().front(), (std::vector<std::uint32_t>{0, 1, 2, 3, 5}));
  EXPECT_EQ(one.backbone(), (std::set<std::uint32_t>{0, 1, 5}));
  // Without what leads into the chamber there is no way.
  input.joints.pop_back();
  EXPECT_TRUE(found(input).backbone().empty());
}

TEST(ConnectivityTest, SidesThatOneClusterConnects) {
  const auto one = found(scene(cube(), {rectangle(2, 2, {-1, 1}, {5, 3}), rectangle(1, 2, {1, 1}, {3, 5}),
                                        rectangle(2, 0.5, {-1, -1}, {0.5, 0.5})}));
  std::set<std::pair<std::uint32_t, std::uint32_t>> tags;
  for (const auto& [a, b] : one.of.percolates)
    tags.emplace(*one.surfaces.surfaces[a].tag, *one.surfaces.surfaces[b].tag);
  const std::set<std::pair<std::uint32_t, std::uint32_t>> expected{{0, 1}, {0, 2}, {0, 5}, {1, 5}};
  EXPECT_EQ(tags, expected) << "west-east and the top by the first two, west-south by the third";
}

TEST(ConnectivityTest, AnExcavationPartsAJoint) {
  const auto one = found(scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5})}, {box({1, -1, 1}, {3, 5, 3})}));
  EXPECT_EQ(one.of.parts.size(), 2U);
  EXPECT_EQ(one.of.clusters.size(), 2U);
  EXPECT_EQ(one.backbone(), (std::set<std::uint32_t>{0}));
}

/// The same by who meets whom, from the network's pieces alone, in another way: clusters by flooding, the backbone by
/// taking each part away in turn and asking whether the rest still reaches both ends from its two neighbours.
TEST(ConnectivityTest, FloodingFindsTheSame) {
  auto input = support::cut_input(support::workload_named("disc-1500").value());
  input.excavations.push_back(box({40, -1, 40}, {60, 101, 60}));
  input.keep_network = true;
  const auto complex = certified(input).complex();
  const auto& network = *complex.network();
  const auto surfaces = flow::surfaces_of(network);
  const auto connectivity = flow::connectivity(complex, surfaces);

  std::map<std::pair<topology::VertexId, topology::VertexId>, std::set<std::uint32_t>> at_side;
  for (std::uint32_t p = 0; p < network.pieces.size(); ++p) {
    for (std::uint32_t t = network.pieces[p].first_triangle;
         t < network.pieces[p].first_triangle + network.pieces[p].triangle_count; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        at_side[std::minmax(network.triangles[t][k], network.triangles[t][(k + 1) % 3])].insert(
            connectivity.part_of[p]);
      }
    }
  }
  const std::size_t parts = connectivity.parts.size(), fixed = parts, openings = parts + 1;
  std::vector<std::set<std::size_t>> next(parts + 2);
  const auto link = [&](std::size_t a, std::size_t b) {
    if (a == b) return;
    next[a].insert(b);
    next[b].insert(a);
  };
  for (const auto& [side, there] : at_side) {
    for (const auto a : there) {
      for (const auto b : there) link(a, b);
    }
  }
  const auto flood = [&](std::size_t from, std::size_t without) {
    std::vector<char> seen(parts + 3, 0);
    seen[from] = 1;
    std::vector<std::size_t> open{from};
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (const std::size_t to : next[at]) {
        if (to == without || seen[to] != 0) continue;
        seen[to] = 1;
        open.push_back(to);
      }
    }
    return seen;
  };
  for (std::size_t a = 0; a < parts; ++a) {
    const auto reached = flood(a, parts + 2);
    for (std::size_t b = 0; b < parts; ++b) {
      ASSERT_EQ((reached[b] != 0), connectivity.parts[a].cluster == connectivity.parts[b].cluster);
    }
    if (a > 40) break;
  }
  for (std::size_t b = 0; b < network.borders.size(); ++b) {
    const auto role = surfaces.surfaces[surfaces.of_border[b]].role;
    for (const auto part : at_side.at(std::minmax(network.borders[b].ends[0], network.borders[b].ends[1]))) {
      link(part, role == topology::Role::fixed ? fixed : openings);
    }
  }
  // On a path between the two ends: after taking any one other node away, still connected with one of the ends, and so
  // with two ways out that share no node (Menger).
  std::size_t on_it = 0;
  const auto from_fixed = flood(fixed, openings), from_openings = flood(openings, fixed);
  for (std::size_t a = 0; a < parts; ++a) {
    bool expected = from_fixed[a] != 0 && from_openings[a] != 0;
    for (std::size_t c = 0; c < parts && expected; ++c) {
      if (c == a) continue;
      const auto reached = flood(a, c);
      expected = reached[fixed] != 0 || reached[openings] != 0;
    }
    ASSERT_EQ(connectivity.parts[a].backbone, expected) << a;
    on_it += expected ? 1 : 0;
    if (on_it > 25 || a > 150) break;
  }
  EXPECT_GT(on_it, 5U);
}

}  // namespace
}  // namespace cleave::testing
