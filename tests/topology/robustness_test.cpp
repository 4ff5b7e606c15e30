#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "cleave/geometry/terrain.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Degenerate scenes at other places and sizes, many planes through a point, slivers by the thousand, large meshes, and
// joints that share edges with openings and the ground.

namespace cleave::testing {
namespace {

struct Change {
  const char* name;
  double scale;
  double shift;
};
std::ostream& operator<<(std::ostream& out, const Change& c) { return out << c.name; }

topology::CutInput changed(const char* workload, const Change& change) {
  support::Workload scene = support::workload_named(workload).value();
  const auto move = [&](Vec3& p) { p = change.scale * p + Vec3{change.shift, change.shift, change.shift}; };
  for (Vec3& p : scene.corners) move(p);
  for (auto& polygon : scene.polygons) {
    for (Vec3& p : polygon) move(p);
  }
  return support::cut_input(scene);
}

std::ptrdiff_t thick(const topology::CutInput& input) {
  const auto audited = certified(input);
  EXPECT_TRUE(audited.certificate().passed);
  return std::ranges::count_if(audited.complex().blocks(), [](const topology::Block& b) { return !b.sliver; });
}

class Elsewhere : public ::testing::TestWithParam<Change> {};

// Rounding may part what met in a point, or join it: that makes or unmakes slivers only.
TEST_P(Elsewhere, TheSameBlocksButForSlivers) {
  for (const char* name :
       {"deg-cavity", "deg-coplanar", "deg-coplanarr", "deg-fan12", "deg-fan12r", "deg-ring", "deg-touch", "deg-utm6",
        "deg-utm7", "deg-vertex20", "deg-vertex20r", "deg-vertex8", "deg-vertex8r"}) {
    EXPECT_EQ(thick(changed(name, GetParam())), thick(changed(name, {"", 1, 0}))) << name;
  }
}
// Tilts of 1e-6 and less: how many of these slivers are left is decided by the last bits of the moved coordinates, but
// whatever they are, the block system is whole.
TEST_P(Elsewhere, SliversAreCertified) {
  for (const char* name : {"deg-sliver10-1e-06", "deg-sliver10-1e-09", "deg-sliver10-1e-12"}) {
    const auto audited = certified(changed(name, GetParam()));
    EXPECT_TRUE(audited.certificate().passed) << name;
    EXPECT_LE(audited.certificate().volume_relative_error, 1e-9) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Robustness, Elsewhere,
                         ::testing::Values(Change{"far", 1, 1e7}, Change{"small", 1e-3, 0}, Change{"large", 1e3, 0},
                                           Change{"smallAndFar", 1e-3, 1e7}, Change{"largeAndFar", 1e3, 1e7}),
                         [](const auto& change) { return std::string{change.param.name}; });

// m planes in general directions through one point of the domain: m^2 - m + 2 blocks.
TEST(Robustness, FiftyPlanesThroughOnePoint) {
  const auto workload = support::common_vertex(50);
  EXPECT_EQ(count_blocks(support::cut_input(workload)), 50U * 50 - 50 + 2);
}

TEST(SharedEdges, JointsFromEveryEdgeOfATunnel) {
  // One joint from each edge of a circular tunnel (32 sides) straight outwards: as many blocks as edges.
  const auto tunnel = geometry::make_tunnel(geometry::CircleSection{metres(6)}, {{10, 0, 10}, {10, 20, 10}}).value();
  auto input = scene(box({0, 0, 0}, {20, 20, 20}), {}, {tunnel});
  std::set<std::pair<double, double>> edges;
  for (const Vec3& v : tunnel.vertices()) edges.insert({v.x, v.z});
  for (const auto& [x, z] : edges) {
    const Vec3 out{10 + 8 * (x - 10), 0, 10 + 8 * (z - 10)};
    input.joints.emplace_back(joint({{x, 0, z}, {x, 20, z}, {out.x, 20, out.z}, {out.x, 0, out.z}}));
  }
  ASSERT_EQ(edges.size(), 32U);
  EXPECT_EQ(count_blocks(input), 32U);
}

TEST(SharedEdges, JointsFromTheEdgesOfABoxTunnelToThoseOfTheDomain) {
  auto input = scene(box({0, 0, 0}, {4, 4, 4}), {}, {box({1, 0, 1}, {3, 4, 3})});
  for (const double x : {0.0, 4.0}) {
    for (const double z : {0.0, 4.0}) {
      const double a = x == 0 ? 1 : 3, b = z == 0 ? 1 : 3;
      input.joints.emplace_back(joint({{x, 0, z}, {x, 4, z}, {a, 4, b}, {a, 0, b}}));
    }
  }
  EXPECT_EQ(volumes(input), (std::vector<double>{12, 12, 12, 12}));
}

TEST(SharedEdges, JointsThroughAllEdgesAndVerticesOfTheGround) {
  // 4 x 4 cells; vertical planes along rows, columns and the cells' diagonals: one column of rock a triangle.
  const std::vector<double> values{3, 4, 5, 4, 3, 2, 6, 1, 5, 4, 3, 3, 3, 7, 2, 5, 4, 6, 2, 1, 4, 4, 5, 3, 2};
  const auto ground =
      geometry::ground_of({.columns = 5, .rows = 5, .x = 0, .y = 0, .step_x = 1, .step_y = 1, .values = values});
  auto input = scene(geometry::close_ground(ground, -1).value());
  for (int k = 1; k < 4; ++k) {
    input.joints.emplace_back(topology::PersistentJoint{{1.0 * k, 0, 0}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0, 1.0 * k, 0}, {0, 1, 0}});
  }
  for (int k = -3; k <= 3; ++k) {
    input.joints.emplace_back(joint({{-1.0 + k, -1, -2}, {6.0 + k, 6, -2}, {6.0 + k, 6, 9}, {-1.0 + k, -1, 9}}));
  }
  const auto audited = certified(input);
  EXPECT_EQ(audited.complex().blocks().size(), 32U);
  double volume = 0;
  for (const auto& [a, b, c] : ground.triangles) {
    volume += 0.5 * ((ground.vertices[a].z + ground.vertices[b].z + ground.vertices[c].z) / 3 + 1);
  }
  EXPECT_NEAR(audited.certificate().volume.si(), volume, 1e-9);
}

TEST(LargeCoordinates, RefusalsNameTheLattice) {
  // A joint of 2 nm in a scene of 1,000 km: its corners fall together on the lattice, and the message names it.
  auto input = scene(box({0, 0, 0}, {1e6, 1e6, 1e6}));
  input.joints.emplace_back(joint({{0.5, 0.5, 0.5}, {0.5 + 2e-9, 0.5, 0.5}, {0.5, 0.5 + 2e-9, 0.5}}));
  const auto complex = topology::cut(input);
  ASSERT_FALSE(complex.has_value());
  EXPECT_NE(describe(complex.error()).find("the lattice of 7.45"), std::string::npos) << describe(complex.error());
}

}  // namespace
}  // namespace cleave::testing
