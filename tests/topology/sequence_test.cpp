#include "cleave/topology/sequence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "cleave/geometry/tunnel.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Blocks of each state of the work against cutting with the excavations done so far.

namespace cleave::testing {
namespace {

using topology::BlockId;
using topology::CellId;
using topology::SequentialCut;
using topology::WorkState;

/// Rectangles in a box of 80 x 80 x 60 m and a tunnel of four parts: crown left and right, bench left and right.
topology::CutInput four_faces() {
  auto input = support::cut_input(support::workload_named("rect-13").value());
  for (const double z : {30.0, 25.0}) {
    for (const double x : {35.0, 40.0}) input.excavations.push_back(box({x, 0, z}, {x + 5, 80, z + 5}));
  }
  return input;
}

topology::BlockComplex blocks(const SequentialCut& sequence, const WorkState& state) {
  auto made = sequence.blocks(state).value();
  return topology::audit(std::move(made.complex)).value().complex();
}

TEST(SequentialCut, EachStateHasTheBlocksOfItsOwnCut) {
  const auto input = four_faces();
  const auto sequence = SequentialCut::make(input).value();
  for (std::size_t done = 0; done <= 4; ++done) {
    WorkState state{.excavated = std::vector<std::uint8_t>(4, 0)};
    auto alone = input;
    alone.excavations.clear();
    for (std::size_t e = 0; e < done; ++e) {
      state.excavated[e] = 1;
      alone.excavations.push_back(input.excavations[e]);
    }
    const auto complex = blocks(sequence, state);
    EXPECT_EQ(canonical_hash(complex), hash_of(alone)) << done << " faces out";
    EXPECT_NEAR(complex.rock_volume().si(), 80.0 * 80 * 60 - 2000.0 * static_cast<double>(done), 1e-6);
  }
}

TEST(SequentialCut, ASurfaceOfALaterStagePartsNothing) {
  // A closed box of excavation inside the rock: before it is out the domain is one block.
  auto input = scene(box({0, 0, 0}, {4, 4, 4}), {}, {box({1, 1, 1}, {3, 3, 3}), box({2, 2, 2}, {3.5, 3.5, 3.5})});
  const auto sequence = SequentialCut::make(input).value();
  EXPECT_EQ(shapes(blocks(sequence, {.excavated = {0, 0}})), (std::vector<Shape>{{cuboid, 64}}));
  EXPECT_EQ(shapes(blocks(sequence, {.excavated = {1, 0}})), (std::vector<Shape>{{{16, 24, 12, 12, 2, 0}, 56}}));
  EXPECT_NEAR(blocks(sequence, {.excavated = {1, 1}}).rock_volume().si(), 64 - 8 - 3.375 + 1, 1e-12);
  // Where a joint lies on the later surface it parts the rock before.
  add_closed_box(input, {1, 1, 1}, {3, 3, 3});
  const auto jointed = SequentialCut::make(input).value();
  EXPECT_EQ(blocks(jointed, {.excavated = {0, 0}}).blocks().size(), 2U);
  EXPECT_EQ(blocks(jointed, {.excavated = {1, 0}}).blocks().size(), 1U);
}

TEST(SequentialCut, WhatFallsLeavesRoomWithFreeFaces) {
  const auto sequence = SequentialCut::make(four_faces()).value();
  const WorkState before{.excavated = {1, 1, 0, 0}};
  const auto whole = sequence.blocks(before).value();
  const auto& all = whole.complex.blocks();
  const auto found = std::ranges::find_if(all, [](const topology::Block& b) { return b.free && !b.fixed; });
  ASSERT_NE(found, all.end());
  const BlockId fallen{static_cast<std::size_t>(found - all.begin())};
  std::set<BlockId> neighbours;
  for (const topology::FaceId f : found->faces) {
    for (const topology::Patch& patch : whole.complex.patches(whole.complex.faces()[f])) {
      if (patch.neighbour) neighbours.insert(*patch.neighbour);
    }
  }
  WorkState after = before;
  for (std::size_t c = 0; c < sequence.cells(); ++c) {
    if (whole.block_of_cell[c] == fallen) after.fallen.emplace_back(c);
  }
  ASSERT_FALSE(after.fallen.empty());
  const auto rest = sequence.blocks(after).value();
  const auto audited = topology::audit(rest.complex).value();
  EXPECT_EQ(rest.complex.blocks().size(), all.size() - 1);
  EXPECT_NEAR(rest.complex.rock_volume().si(), whole.complex.rock_volume().si() - found->volume.si(), 1e-6);
  for (const BlockId neighbour : neighbours) {
    for (std::size_t c = 0; c < sequence.cells(); ++c) {
      if (whole.block_of_cell[c] != neighbour) continue;
      EXPECT_TRUE(rest.complex.blocks()[rest.block_of_cell[c].value()].free);
    }
  }
}

TEST(SequentialCut, ABlockOfALaterStateIsPartOfOneEarlierBlock) {
  const auto sequence = SequentialCut::make(four_faces()).value();
  const auto early = sequence.blocks({.excavated = {1, 0, 0, 0}}).value();
  const auto late = sequence.blocks({.excavated = {1, 1, 1, 1}}).value();
  std::vector<std::set<BlockId>> parents(late.complex.blocks().size(), std::set<BlockId>{});
  for (std::size_t c = 0; c < sequence.cells(); ++c) {
    if (late.block_of_cell[c]) parents[late.block_of_cell[c]->index()].insert(early.block_of_cell[c].value());
  }
  for (std::size_t b = 0; b < parents.size(); ++b) {
    ASSERT_EQ(parents[b].size(), 1U);
    EXPECT_LE(late.complex.blocks()[BlockId{b}].volume.si(),
              early.complex.blocks()[*parents[b].begin()].volume.si() * (1 + 1e-12));
  }
}

TEST(SequentialCut, NoRockLeftIsAnError) {
  const auto input = scene(box({0, 0, 0}, {4, 4, 4}), {}, {box({-1, -1, -1}, {5, 5, 2}), box({-1, -1, 1}, {5, 5, 5})});
  const auto sequence = SequentialCut::make(input).value();
  EXPECT_TRUE(sequence.blocks({.excavated = {1, 0}}).has_value());
  EXPECT_TRUE(std::holds_alternative<topology::DomainSwallowed>(sequence.blocks({.excavated = {1, 1}}).error()));
}

}  // namespace
}  // namespace cleave::testing
