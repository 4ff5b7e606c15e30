#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/geometry/tunnel.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Joints with holes, joints that end on others, and the parts of joints that bound no block. Domain: a cube of side 4.

namespace cleave::testing {
namespace {

using Shapes = std::vector<Shape>;

geometry::Solid cube() { return box({0, 0, 0}, {4, 4, 4}); }
geometry::Polygon polygon(std::vector<Vec3> corners) { return geometry::Polygon::make(std::move(corners)).value(); }
geometry::Polygon square(double lo, double hi, double z) {
  return polygon({{lo, lo, z}, {hi, lo, z}, {hi, hi, z}, {lo, hi, z}});
}
topology::JointId id(std::size_t joint) { return topology::JointId{joint}; }

TEST(Holes, AHoleJoinsTheBlocks) {
  const topology::Joint level{{square(-1, 5, 2)}, {{square(1, 3, 2)}}};
  EXPECT_EQ(shapes(scene(cube(), {level})), (Shapes{{cuboid, 64}}));
  const topology::Joint plug{{square(1, 3, 2)}};
  EXPECT_EQ(shapes(scene(cube(), {level, plug})), (Shapes{{cuboid, 32}, {cuboid, 32}}));
  // A box over the hole: core above, its foot is the hole.
  auto input = scene(cube(), {level});
  for (const double x : {1.0, 3.0}) input.joints.emplace_back(rectangle(0, x, {1, 2}, {3, 3}));
  for (const double y : {1.0, 3.0}) input.joints.emplace_back(rectangle(1, y, {1, 2}, {3, 3}));
  input.joints.emplace_back(rectangle(2, 3, {1, 1}, {3, 3}));
  EXPECT_EQ(volumes(input), (std::vector<double>{28, 36}));
}

TEST(Holes, SeveralHolesOfAnyShape) {
  const topology::Joint level{{square(-1, 5, 2)},
                              {{square(0.25, 1, 2), square(3, 3.5, 2),
                                polygon({{1.5, 1.5, 2}, {2.5, 1.5, 2}, {2, 2, 2}, {2.5, 2.5, 2}, {1.5, 2.5, 2}})}}};
  auto input = scene(cube(), {level});
  EXPECT_EQ(shapes(input), (Shapes{{cuboid, 64}}));
  for (const auto& hole : level.holes[0]) input.joints.emplace_back(topology::Joint{{hole}});
  const auto audited = certified(input);
  EXPECT_EQ(audited.complex().blocks().size(), 2U);
  input.joints.erase(input.joints.begin() + 2);
  EXPECT_EQ(count_blocks(input), 1U) << "one hole stays open";
}

TEST(Holes, TurnedOutOfTheAxes) {
  // The same in a plane through no lattice direction; the hole is plugged by a polygon with the same corners.
  const Vec3 u = geometry::normalized(Vec3{0.7, 0.2, -0.3}),
             v = geometry::normalized(geometry::cross(u, {0.1, 0.9, 0.5}));
  const auto at = [&](double a, double b) { return Vec3{2.03, 1.97, 2.01} + a * u + b * v; };
  const auto ring = [&](double r, int n) {
    std::vector<Vec3> corners;
    for (int i = 0; i < n; ++i) {
      corners.push_back(at(r * std::cos(2 * std::numbers::pi * i / n), r * std::sin(2 * std::numbers::pi * i / n)));
    }
    return polygon(std::move(corners));
  };
  const topology::Joint level{{ring(9, 7)}, {{ring(1, 9)}}};
  EXPECT_EQ(count_blocks(scene(cube(), {level})), 1U);
  // A plug drawn in the same plane lies in another one by rounding; `snap` gives it the plane of the first.
  const auto plugged = [&](double radius) {
    auto input = scene(cube(), {level, topology::Joint{{ring(radius, 9)}}});
    input.snap = metres(1e-9);
    return count_blocks(input);
  };
  EXPECT_EQ(plugged(1), 2U);
  EXPECT_EQ(plugged(1.5), 2U);
  EXPECT_EQ(plugged(0.9), 1U);
}

/// Area of the contact in z = 2 by the joint it is of.
std::map<std::uint32_t, double> areas_at_2(const topology::BlockComplex& complex) {
  std::map<std::uint32_t, double> areas;
  for (const topology::Face& face : complex.faces()) {
    for (const topology::Patch patch : complex.patches(face)) {
      if (patch.joint && face.outward.z > 0.5) areas[patch.joint->value()] += patch.area.si();
    }
  }
  return areas;
}

TEST(Overlaps, AFaceIsOfTheJointThatGoesBefore) {
  // A level plane, a square of side 2 on it and one of side 1 within both, and a plane across all of them.
  auto input = scene(cube());
  input.joints.emplace_back(topology::PersistentJoint{{2, 2, 2}, {0, 0, 1}});
  input.joints.emplace_back(topology::Joint{{square(1, 3, 2)}});
  input.joints.emplace_back(topology::Joint{{square(1, 2, 2)}});
  input.joints.emplace_back(topology::PersistentJoint{{2.5, 2, 2}, {1, 0, 0}});
  using Areas = std::map<std::uint32_t, double>;
  const auto found = [&](std::vector<std::uint32_t> precedence) {
    input.precedence = std::move(precedence);
    const auto audited = certified(input);
    using Pairs = std::vector<std::pair<topology::JointId, topology::JointId>>;
    EXPECT_EQ(audited.complex().report().overlapping, (Pairs{{id(0), id(1)}, {id(0), id(2)}}));
    return areas_at_2(audited.complex());
  };
  EXPECT_EQ(found({}), (Areas{{0, 16}}));
  EXPECT_EQ(found({0, 0, 0, 0}), (Areas{{0, 16}}));
  EXPECT_EQ(found({1, 0, 2, 0}), (Areas{{0, 12}, {1, 4}}));
  EXPECT_EQ(found({2, 1, 0, 0}), (Areas{{0, 12}, {1, 3}, {2, 1}}));
  EXPECT_EQ(found({1, 1, 0, 0}), (Areas{{0, 15}, {2, 1}}));
  EXPECT_EQ(found({1}), (Areas{{0, 16}})) << "what no number is given for comes last";
}

TEST(Overlaps, JointsThatMeetInLinesDoNotOverlap) {
  auto input =
      scene(cube(), {topology::Joint{{square(-1, 5, 2)}, {{square(1, 3, 2)}}}, topology::Joint{{square(1, 3, 2)}}});
  input.joints.emplace_back(topology::PersistentJoint{{2.5, 2, 2}, {1, 0, 0}});
  EXPECT_TRUE(certified(input).complex().report().overlapping.empty());
}

TEST(Terminations, TheFarPartIsTakenAway) {
  // Level planes z = 2 and x = 1: the vertical one kept below only.
  auto input = scene(cube());
  input.joints.emplace_back(topology::PersistentJoint{{2, 2, 2}, {0, 0, 1}});
  input.joints.emplace_back(topology::PersistentJoint{{1, 2, 1}, {1, 0, 0}});
  EXPECT_EQ(count_blocks(input), 4U);
  input.terminations = {{id(1), id(0)}};
  EXPECT_EQ(volumes(input), (std::vector<double>{8, 24, 32}));
  input.joints[1] = topology::PersistentJoint{{1, 2, 3}, {1, 0, 0}};
  EXPECT_EQ(volumes(input), (std::vector<double>{8, 24, 32}));
  input.joints[1] = parallelogram({1, 2, 1.5}, {0, 9, 0}, {0, 0, 9});
  EXPECT_EQ(volumes(input), (std::vector<double>{8, 24, 32}));
}

TEST(Terminations, InclinedJointsAndTwoEnds) {
  auto input = scene(cube());
  const Vec3 n = geometry::normalized(Vec3{0.3, 0.2, 0.9});
  input.joints.emplace_back(topology::PersistentJoint{{2, 2, 3}, n});
  input.joints.emplace_back(topology::PersistentJoint{{2, 2, 1}, n});
  input.joints.emplace_back(parallelogram({2, 2, 2.1}, {0, 9, 0.4}, {0.3, 0, 9}));
  EXPECT_EQ(count_blocks(input), 6U);
  input.terminations = {{id(2), id(0)}, {id(2), id(1)}};
  EXPECT_EQ(count_blocks(input), 4U);
  // Blocks do not depend on the order of the joints.
  const auto whole = volumes(input);
  std::swap(input.joints[0], input.joints[2]);
  input.terminations = {{id(0), id(1)}, {id(0), id(2)}};
  const auto again = volumes(input);
  ASSERT_EQ(again.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(again[i], whole[i], 1e-9);
}

TEST(Terminations, OnAJointFarFromTheWindow) {
  // A level joint that ends on a vertical one which the window does not reach.
  auto input = scene(cube());
  input.joints.emplace_back(parallelogram({2, 2, 2}, {9, 0, 0}, {0, 9, 0}));
  input.joints.emplace_back(parallelogram({3, 2, 2}, {0, 9, 0}, {0, 0, 9}));
  input.terminations = {{id(0), id(1)}};
  input.window = topology::Window{{0, 0, 0}, {1, 4, 4}};
  EXPECT_EQ(volumes(input), (std::vector<double>{8, 8}));
}

TEST(Terminations, Refusals) {
  auto input = scene(cube());
  input.joints.emplace_back(topology::PersistentJoint{{2, 2, 2}, {0, 0, 1}});
  input.joints.emplace_back(topology::PersistentJoint{{1, 2, 2}, {1, 0, 0}});
  input.terminations = {{id(1), id(0)}};
  const auto undecided = topology::cut(input);
  ASSERT_FALSE(undecided.has_value());
  EXPECT_EQ(std::get<topology::TerminationUndecided>(undecided.error()).joint, id(1));
  input.joints[0] = topology::Joint{{square(-1, 5, 2), polygon({{-1, -1, 2}, {5, -1, 2}, {5, -1, 3}})}};
  input.joints[1] = topology::PersistentJoint{{1, 2, 1}, {1, 0, 0}};
  EXPECT_TRUE(std::holds_alternative<topology::TerminationUndecided>(topology::cut(input).error())) << "not flat";
}

double area_of(const topology::Dangling& dangling) { return dangling.area.si(); }

TEST(Dangling, EndsMembranesAndIsolatedJoints) {
  auto input = scene(cube(), {rectangle(2, 2, {-1, -1}, {3, 5})});  // stops 1 m short of x = 4
  input.keep_dangling = true;
  const auto one = certified(input).complex();
  ASSERT_TRUE(one.dangling().has_value());
  const auto& stub = *one.dangling();
  ASSERT_EQ(stub.pieces.size(), 1U);
  EXPECT_DOUBLE_EQ(area_of(stub), 12);
  EXPECT_EQ(stub.free_edges, 1U);
  EXPECT_DOUBLE_EQ(stub.free_edge_length.si(), 4);
  EXPECT_EQ(stub.isolated_joints, 0U);
  EXPECT_EQ(stub.pieces[0].loops[0].size(), 4U);

  input.joints.emplace_back(rectangle(0, 2, {-1, 2}, {5, 3}));  // stands on the first one and ends in the rock
  input.joints.emplace_back(rectangle(2, 1, {1, 1}, {2, 3}));   // touches nothing
  const auto three = certified(input).complex();
  const auto& all = *three.dangling();
  EXPECT_DOUBLE_EQ(area_of(all), 12 + 4 + 2);
  EXPECT_EQ(all.joints, 3U);
  EXPECT_EQ(all.isolated_joints, 1U);
  EXPECT_EQ(all.pieces.size(), 4U) << "the first one in two parts";
  EXPECT_EQ(all.free_edges, 1U + 1 + 4);
  EXPECT_EQ(three.blocks().size(), 1U);
}

TEST(Dangling, OvershootsOfSeparatingJoints) {
  auto input = scene(cube(), {rectangle(2, 2, {-1, -1}, {3, 5}), rectangle(0, 2, {-1, -1}, {5, 3})});
  input.keep_dangling = true;
  const auto complex = certified(input).complex();
  const auto& dangling = *complex.dangling();
  EXPECT_DOUBLE_EQ(area_of(dangling), 8);
  EXPECT_EQ(dangling.pieces.size(), 2U);
  for (const auto& piece : dangling.pieces) EXPECT_GT(complex.blocks()[piece.block].volume.si(), 40);
  EXPECT_EQ(canonical_hash(complex), [&] {
    input.keep_dangling = false;
    return hash_of(input);
  }());
}

TEST(Dangling, MembraneAndJointInACavity) {
  auto input = support::cut_input(support::workload_named("deg-ring").value());
  input.joints.emplace_back(rectangle(2, 4, {3, 3}, {5, 5}));
  input.keep_dangling = true;
  const auto complex = certified(input).complex();
  double membrane = 0;
  for (const auto& piece : complex.dangling()->pieces) {
    if (piece.joint == id(input.joints.size() - 1)) membrane += piece.area.si();
    EXPECT_FALSE(piece.isolated);
  }
  EXPECT_DOUBLE_EQ(membrane, 4);
}

class DanglingWorkloads : public ::testing::TestWithParam<const char*> {};
TEST_P(DanglingWorkloads, BlocksAreTheSameAndAreasAddUp) {
  auto input = support::cut_input(support::workload_named(GetParam()).value());
  input.excavations.push_back(
      geometry::make_tunnel(geometry::HorseshoeSection{metres(10), metres(10)}, {{40, -1, 30}, {40, 110, 30}}).value());
  const auto plain = certified(input).complex();
  input.keep_dangling = true;
  const auto kept = certified(input).complex();
  EXPECT_EQ(canonical_hash(kept), canonical_hash(plain));
  EXPECT_EQ(kept.blocks().size(), plain.blocks().size());
  // With a box of planes round the rock, cutting nothing new, the dangling area of the disc scene is that of the discs
  // inside: a piece never counts twice and never overlaps a face between blocks.
  double faces = 0, joints = 0;
  for (const auto& face : kept.faces()) {
    if (face.role == topology::Role::joint) faces += 0.5 * face.area.si();
  }
  for (const auto& entry : input.joints) {
    const auto* joint = std::get_if<topology::Joint>(&entry);
    const auto corners = joint->polygons[0].corners();
    Vec3 area{};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      area += 0.5 * geometry::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    }
    joints += geometry::norm(area);
  }
  EXPECT_LE(faces + area_of(*kept.dangling()), joints * (1 + 1e-9));
  EXPECT_GT(area_of(*kept.dangling()), 0);
}
INSTANTIATE_TEST_SUITE_P(Topology, DanglingWorkloads, ::testing::Values("rect-13", "disc-200", "disc-500"));

}  // namespace
}  // namespace cleave::testing
