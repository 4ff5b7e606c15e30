// Counts of block theory, and the largest block of a tunnel against the cutter.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using handmade::direction;
using handmade::upward;

// n planes in general position: n^2 - n + 2 pyramids with an interior, (n - 1)(n - 2)/2 of them removable at a plane;
// of all 2^n 1 falls, n slide on one plane, n(n - 1)/2 on two, (n - 1)(n - 2)/2 are safe without friction.
TEST(BlockTheoryTest, CountsOfGoodmanAndShi) {
  Rng rng{{.seed = 9, .realization = 0, .purpose = 31, .index = 0}};
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 3 + static_cast<std::size_t>(round) % 4;
    std::vector<Direction> planes;
    for (std::size_t i = 0; i < n; ++i)
      planes.push_back(direction(upward(5 + 80 * rng.uniform(), 360 * rng.uniform())));
    const std::vector<double> friction(n, 0.5);
    const Direction free = direction(upward(5 + 80 * rng.uniform(), 360 * rng.uniform()));
    std::size_t interior = 0, removable = 0;
    std::array<std::size_t, 6> modes{};
    for (const JointPyramid& p : joint_pyramids(planes, friction, {&free, 1}, {0, 0, -1})) {
      interior += p.dimension == 3 ? 1U : 0U;
      removable += p.removable() ? 1U : 0U;
      ++modes[static_cast<std::size_t>(p.mode)];
    }
    EXPECT_EQ(interior, n * n - n + 2);
    EXPECT_EQ(removable, (n - 1) * (n - 2) / 2);
    EXPECT_EQ(modes[static_cast<std::size_t>(Mode::falling)], 1U);
    EXPECT_EQ(modes[static_cast<std::size_t>(Mode::sliding)], n);
    EXPECT_EQ(modes[static_cast<std::size_t>(Mode::wedge)], n * (n - 1) / 2);
    EXPECT_EQ(modes[static_cast<std::size_t>(Mode::stable)], (n - 1) * (n - 2) / 2);
  }
}

// Joints 60/000, 60/120, 60/240 over a flat roof: only the pyramid below all three comes out, and it falls.
TEST(BlockTheoryTest, RoofPyramid) {
  const std::vector<Direction> planes{direction(upward(60, 0)), direction(upward(60, 120)), direction(upward(60, 240))};
  const std::vector<double> friction(3, 0.5);
  const Direction roof = direction({0, 0, -1});
  for (const JointPyramid& p : joint_pyramids(planes, friction, {&roof, 1}, {0, 0, -1})) {
    EXPECT_EQ(p.removable(), p.code == 7U) << p.code;
    if (p.code == 7U) {
      EXPECT_EQ(p.mode, Mode::falling);
    }
  }
}

// The largest block that the theory allows, cut out by the cutter from planes through its apex.
TEST(BlockTheoryTest, LargestBlockOfATunnelIsTheCuttersBlock) {
  const std::vector<Vec3> normals{upward(50, 80), upward(55, 200), upward(65, 310)};
  std::vector<Direction> planes;
  for (const Vec3 n : normals) planes.push_back(direction(n));
  const std::vector<std::array<double, 2>> outline{{-3, -3}, {3, -3}, {3, 1}, {1.5, 3}, {-1.5, 3}, {-3, 1}};
  const ConvexTunnel tunnel{.axis = {0, 1, 0}, .right = {1, 0, 0}, .up = {0, 0, 1}, .outline = outline};
  geometry::PolygonSection section;
  section.corners = outline;
  std::size_t found = 0;
  for (std::uint32_t code = 0; code < 8; ++code) {
    const auto largest = maximum_block(planes, code, tunnel);
    if (!largest || largest->volume < 1e-6) continue;
    // A hair nearer to the tunnel, so that edges that touch do not miss it by rounding.
    const Vec3 apex = (1 - 1e-6) * Vec3{largest->apex[0], 0, largest->apex[1]};
    topology::CutInput input{.domain = geometry::make_box({-60, -60, -60}, {60, 60, 60}).value(),
                             .joints = {},
                             .excavations = {geometry::make_tunnel(section, {{0, -70, 0}, {0, 70, 0}}).value()},
                             .free_domain_tags = {}};
    for (const Vec3 n : normals) input.joints.emplace_back(topology::PersistentJoint{apex, n});
    const auto complex = topology::cut(input);
    ASSERT_TRUE(complex.has_value());
    double closest = 1e9;
    for (const auto& block : complex->blocks()) {
      if (block.fixed) continue;
      closest = std::min(closest, std::abs(block.volume.si() / largest->volume - 1));
    }
    EXPECT_LT(closest, 1e-4) << code << ' ' << largest->volume;
    ++found;
  }
  EXPECT_GE(found, 4U);
}

}  // namespace
}  // namespace cleave::stability
