// Removability and motion against an oracle that shares nothing with the module: non-negative least squares in long
// double (Lawson and Hanson 1974), on blocks of random rock, and on hundreds of planes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "oracles.hpp"

namespace cleave::stability::mode_oracle_test {
namespace {

using geometry::Vec3;

namespace oracle = stability_oracle::least_squares;

struct Tally {
  std::size_t blocks = 0, concave = 0, moving = 0, wedges = 0, tapered = 0, ties = 0, wrong = 0, close = 0;
};

void compare(const std::vector<Direction>& rows, const std::vector<oracle::V>& normals, Vec3 force, bool broken,
             Tally& tally) {
  const Cone cone{rows};
  const bool free = cone.dimension() > 0;
  const Motion motion = project(cone, Resultant::along(force, newtons(geometry::norm(force))));
  const oracle::V r{force.x, force.y, force.z};
  const oracle::Left left = oracle::residual(normals, r, broken);
  const auto s = geometry::norm(motion.s);
  const double off =
      std::hypot(motion.s.x - static_cast<double>(left.s[0]), motion.s.y - static_cast<double>(left.s[1]),
                 motion.s.z - static_cast<double>(left.s[2]));
  ++tally.blocks;
  tally.tapered += free ? 0U : 1U;
  tally.moving += s > 0 ? 1U : 0U;
  tally.ties += motion.tie ? 1U : 0U;
  tally.wedges += motion.kind == MotionKind::two_planes ? 1U : 0U;
  bool wrong = off > 1e-9 * geometry::norm(force);
  const std::size_t pressing = motion.kind == MotionKind::two_planes ? 2 : motion.kind == MotionKind::one_plane ? 1 : 0;
  if (s > 1e-9 && pressing != left.pressing) {
    // The same s by fewer faces: modes that coincide.
    ++tally.close;
    wrong = wrong || motion.touching.size() <= pressing;
  }
  if (!broken) wrong = wrong || free != oracle::removable(normals);
  if (free == false) wrong = wrong || s != 0;
  tally.wrong += wrong ? 1U : 0U;
}

Tally random_rock(std::uint64_t scenes, bool broken) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    Rng rng{{.seed = seed, .realization = 0, .purpose = 11, .index = 0}};
    const auto vec = [&](double low, double high) {
      return Vec3{low + (high - low) * rng.uniform(), low + (high - low) * rng.uniform(),
                  low + (high - low) * rng.uniform()};
    };
    topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {10, 10, 10}).value(),
                             .joints = {},
                             .excavations = {geometry::make_box({3, -1, 4}, {6, 11, 7}).value()},
                             .free_domain_tags = {5}};
    for (int i = 0; i < 6; ++i) {
      input.joints.emplace_back(topology::PersistentJoint{vec(1, 9), geometry::normalized(vec(-1, 1))});
    }
    for (int i = 0; i < 12; ++i) {
      const Vec3 c = vec(0, 10), n = geometry::normalized(vec(-1, 1));
      const Vec3 u = geometry::normalized(cross(n, {0.3, 0.5, 0.7})), v = cross(n, u);
      input.joints.emplace_back(topology::Joint{
          {geometry::Polygon::make({c + 4 * u + 4 * v, c - 4 * u + 4 * v, c - 4 * u - 4 * v, c + 4 * u - 4 * v})
               .value()}});
    }
    const auto complex = topology::cut(input);
    EXPECT_TRUE(complex.has_value());
    for (const auto& block : complex->blocks()) {
      std::vector<Direction> rows;
      std::vector<oracle::V> normals;
      for (const topology::FaceId id : block.faces) {
        // Any face may be open: blocks inside the rock are tried too.
        const auto& face = complex->faces()[id];
        if (rng.uniform() < 0.35) continue;
        const Direction n = Direction::normal_of(complex->planes()[face.plane]);
        rows.push_back(face.block_on_positive_side ? n : n.opposite());
        normals.push_back({-face.outward.x, -face.outward.y, -face.outward.z});
      }
      if (rows.empty()) continue;
      tally.concave += block.convex ? 0U : 1U;
      compare(rows, normals, rng.uniform() < 0.5 ? Vec3{0, 0, -1} : geometry::normalized(vec(-1, 1)), broken, tally);
    }
  }
  return tally;
}

TEST(ModeOracleTest, AgreesOnThousandsOfBlocksOfRandomRock) {
  const Tally tally = random_rock(60, false);
  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_GT(tally.blocks, 3000U);
  EXPECT_GT(tally.concave, 100U);
  EXPECT_GT(tally.moving, 500U);
  EXPECT_GT(tally.wedges, 100U);
  EXPECT_GT(tally.tapered, 100U);
  RecordProperty("blocks", static_cast<int>(tally.blocks));
}

TEST(ModeOracleTest, NoticesAPlantedBug) { EXPECT_GT(random_rock(10, true).wrong, 20U); }

// Hundreds of faces: tangent planes of a cap, so that K is a narrow cone, with antiparallel and repeated ones among
// them.
TEST(ModeOracleTest, AgreesWithHundredsOfFaces) {
  Tally tally;
  Rng rng{{.seed = 5, .realization = 0, .purpose = 12, .index = 0}};
  for (int round = 0; round < 12; ++round) {
    std::vector<Direction> rows;
    std::vector<oracle::V> normals;
    const double opening = 0.2 + 0.1 * round;
    for (int i = 0; i < 240; ++i) {
      const double a = 6.283185307179586 * rng.uniform(), t = opening + (1.4 - opening) * rng.uniform();
      const Vec3 n{std::cos(a) * std::cos(t), std::sin(a) * std::cos(t), -std::sin(t)};
      const Direction d = handmade::direction(n);
      rows.push_back(d);
      normals.push_back({d.unit().x, d.unit().y, d.unit().z});
      if (i % 40 == 0) {
        rows.push_back(d);
        normals.push_back(normals.back());
      }
    }
    compare(rows, normals, geometry::normalized({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5}), false,
            tally);
    compare(rows, normals, {0, 0, -1}, false, tally);
  }
  EXPECT_EQ(tally.wrong, 0U);
}

// Nearly parallel planes, a resultant along an edge, in a plane, zero, tiny and huge: finite, and the stated answer.
TEST(ModeExtremesTest, NearlyParallelPlanes) {
  for (const double angle : {1e-9, 1e-7, 1e-5}) {
    const Vec3 n1 = handmade::upward(50, 90);
    const Vec3 tilted = geometry::normalized(n1 + angle * Vec3{0, 1, 0});
    const std::vector<Direction> rows{handmade::direction(n1), handmade::direction(tilted)};
    const Motion m = project(Cone{rows}, Resultant::along({0, 0, -1}, newtons(1)));
    ASSERT_TRUE(m.kind == MotionKind::one_plane || m.kind == MotionKind::two_planes);
    EXPECT_TRUE(geometry::is_finite(m.s));
    EXPECT_NEAR(geometry::norm(m.s), std::sin(handmade::radians(50)), 1e-6);
    EXPECT_NEAR(m.reactions[0] + m.reactions[1], std::cos(handmade::radians(50)), 1e-5);
  }
}

TEST(ModeExtremesTest, ResultantAlongAnEdgeInAPlaneAndZero) {
  const std::vector<Direction> rows{handmade::direction({1, 0, 1}), handmade::direction({-1, 0, 1})};
  const Cone cone{rows};
  const Motion along = project(cone, Resultant::along({0, 1, 0}, newtons(5)));  // the edge of both
  EXPECT_EQ(along.kind, MotionKind::free);
  EXPECT_EQ(along.touching.size(), 2U);
  EXPECT_FALSE(along.tie);
  const Motion pressed = project(cone, Resultant::along({0, 0, -1}, newtons(5)));
  EXPECT_EQ(pressed.kind, MotionKind::held);
  const Motion into = project(cone, Resultant::along({-1, 0, -1}, newtons(5)));  // straight into the first
  EXPECT_EQ(into.kind, MotionKind::held);
  EXPECT_EQ(project(cone, Resultant{}).kind, MotionKind::none);
  Resultant cancelled = Resultant::along({0, 0, -1}, newtons(1e9));
  cancelled.add({0, 0, 1e9}, 1e9);
  EXPECT_EQ(project(cone, cancelled).kind, MotionKind::none);
  for (const double size : {1e-100, 1e-9, 1e15, 1e100}) {
    const Motion m = project(cone, Resultant::along({0, 3, -1}, newtons(size)));
    EXPECT_TRUE(geometry::is_finite(m.s));
    EXPECT_EQ(m.kind, MotionKind::two_planes);
  }
}

}  // namespace
}  // namespace cleave::stability::mode_oracle_test
