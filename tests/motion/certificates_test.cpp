#include <gtest/gtest.h>

#include <array>

#include "assemblies.hpp"
#include "cut_rock.hpp"

/// Motion against the certificates of statics: what certainly moves moves, what certainly stands stands.
namespace cleave::motion {
namespace {

using namespace shapes;

/// What is certain of it is what happens from rest; counts what was said.
void expect_agreement(const RandomAssembly& random, std::array<int, 3>& count) {
  const Certain certain = certified(random.statics);
  ++count.at(static_cast<std::size_t>(certain));
  if (certain == Certain::in_doubt) return;
  const auto moved = moved_from_rest(random);
  if (!moved) {
    ADD_FAILURE() << moved.error();
    return;
  }
  EXPECT_EQ(*moved > 1e-6, certain == Certain::moves) << *moved;
}

TEST(Certificates, WhatCertainlyMovesMovesAndWhatCertainlyStandsStands) {
  std::array<int, 3> count{};
  AssemblyMaker maker{1};
  for (int k = 0; k < 12; ++k) {
    SCOPED_TRACE(k);
    const RandomAssembly random = maker.make();
    expect_agreement(random, count);
  }
  EXPECT_GE(count[0], 3);
  EXPECT_GE(count[1], 2);
  EXPECT_LE(count[2], 6);
}

// Joints of any direction, faces that overlap in part, a friction for each joint; 2 to 3 bodies each.
TEST(Certificates, TwoHundredAssembliesOfCutRock) {
  std::array<int, 3> count{};
  for (std::uint64_t seed = 0; count[0] + count[1] < 200; ++seed) {
    SCOPED_TRACE(seed);
    const RandomAssembly random = CutRock{seed}.make(8);
    expect_agreement(random, count);
  }
  EXPECT_GE(count[0], 120);
  EXPECT_GE(count[1], 25);
  EXPECT_LE(count[2], 90);
}

}  // namespace
}  // namespace cleave::motion
