#include <gtest/gtest.h>

#include "complexes.hpp"
#include "workloads.hpp"

// Small scenes with known vertices, edges, faces, loops, shells, genus and volume of every block. Domain: a cube of
// side 4.

namespace cleave::testing::scenes_test {
namespace {

using Shapes = std::vector<Shape>;

geometry::Solid cube() { return box({0, 0, 0}, {4, 4, 4}); }
topology::CutInput joints(std::initializer_list<topology::Joint> list) { return scene(cube(), list); }
topology::CutInput excavated(std::vector<geometry::Solid> solids) { return scene(cube(), {}, std::move(solids)); }

/// z = 2 from x = a to b, and beyond the domain in y.
topology::Joint level(double a, double b) { return rectangle(2, 2, {a, -1}, {b, 5}); }
/// x = 2 from z = a to b, and beyond the domain in y.
topology::Joint upright(double a, double b) { return rectangle(0, 2, {-1, a}, {5, b}); }

TEST(Scenes, NothingCutsTheBox) {
  const Shapes whole{{cuboid, 64}};
  EXPECT_EQ(shapes(joints({})), whole);
  EXPECT_EQ(shapes(joints({level(-1, 3)})), whole) << "stops short of one side";
  EXPECT_EQ(shapes(joints({level(-1, 1.5), upright(-1, 2)})), whole) << "L with a gap";
  EXPECT_EQ(shapes(joints({level(-1, 1.75), level(2.25, 5)})), whole) << "two coplanar joints with a gap";
  EXPECT_EQ(shapes(joints({rectangle(2, 0, {-1, -1}, {5, 5})})), whole) << "in the bottom of the domain";
  EXPECT_EQ(shapes(joints({rectangle(2, 2, {1, 1}, {3, 3})})), whole) << "in the middle of the rock";
}

TEST(Scenes, OneFullJoint) {
  const Shapes halves{{cuboid, 32}, {cuboid, 32}};
  EXPECT_EQ(shapes(joints({level(-1, 5)})), halves);
  EXPECT_EQ(shapes(joints({level(0, 4), rectangle(2, 2, {0, 0}, {4, 4})})), halves) << "ends exactly on the sides";
  EXPECT_EQ(shapes(joints({level(-1, 2), level(2, 5)})), halves) << "side by side";
  EXPECT_EQ(shapes(joints({level(-1, 3), level(1, 5)})), halves) << "overlapping";
}

TEST(Scenes, TwoHalfJointsInAnL) {
  const Shapes corner{{cuboid, 16}, {{12, 18, 8, 8, 1, 0}, 48}};
  EXPECT_EQ(shapes(joints({level(-1, 2), upright(-1, 2)})), corner);
  EXPECT_EQ(shapes(joints({level(-1, 3), upright(-1, 2)})), corner) << "the level one goes on";
  EXPECT_EQ(shapes(joints({level(-1, 2), upright(-1, 3)})), corner) << "the vertical one goes on";
  EXPECT_EQ(shapes(joints({level(-1, 3), upright(-1, 3)})), corner) << "both go on";
}

TEST(Scenes, TheConcaveBlockOfAnLIsConcave) {
  const auto audited = certified(joints({level(-1, 2), upright(-1, 2)}));
  for (const topology::Block& block : audited.complex().blocks()) EXPECT_EQ(block.convex, block.counts.vertices == 8);
}

TEST(Scenes, TAndThreeFullJoints) {
  EXPECT_EQ(shapes(joints({level(-1, 5), upright(2, 5)})), (Shapes{{cuboid, 16}, {cuboid, 16}, {cuboid, 32}}));
  EXPECT_EQ(shapes(joints({level(-1, 5), upright(-1, 5), rectangle(1, 2, {-1, -1}, {5, 5})})), Shapes(8, {cuboid, 8}));
}

TEST(Scenes, ClosedBoxesOfJoints) {
  constexpr std::array<unsigned, 6> shell{16, 24, 12, 12, 2, 0};
  auto one = joints({});
  add_closed_box(one, {1, 1, 1}, {3, 3, 3});
  EXPECT_EQ(shapes(one), (Shapes{{cuboid, 8}, {shell, 56}}));
  auto nested = one;
  add_closed_box(nested, {0.5, 0.5, 0.5}, {3.5, 3.5, 3.5});
  EXPECT_EQ(shapes(nested), (Shapes{{cuboid, 8}, {shell, 19}, {shell, 37}}));
  auto two = joints({});
  add_closed_box(two, {0.5, 0.5, 0.5}, {1.5, 1.5, 1.5});
  add_closed_box(two, {2, 2, 2}, {3.5, 3.5, 3.5});
  EXPECT_EQ(shapes(two), (Shapes{{cuboid, 1}, {cuboid, 3.375}, {{24, 36, 18, 18, 3, 0}, 59.625}}));
}

TEST(Scenes, ACavityIsTheSecondShell) {
  auto input = joints({});
  add_closed_box(input, {1, 1, 1}, {3, 3, 3});
  const auto audited = certified(input);
  for (const topology::Block& block : audited.complex().blocks()) {
    for (const topology::FaceId f : block.faces) {
      const topology::Face& face = audited.complex().faces()[f];
      const bool outer = face.role == topology::Role::fixed;
      EXPECT_EQ(face.shell, outer || block.counts.shells == 1 ? 0U : 1U);
    }
    EXPECT_EQ(block.convex, block.counts.shells == 1);
  }
}

TEST(Scenes, RingOfJoints) {
  const Shapes ring{{{16, 24, 10, 12, 1, 1}, 42}, {{24, 36, 16, 18, 2, 1}, 470}};
  auto input = support::cut_input(support::workload_named("deg-ring").value());
  EXPECT_EQ(shapes(input), ring);
  input.joints.emplace_back(rectangle(2, 4, {3, 3}, {5, 5}));
  EXPECT_EQ(shapes(input), ring) << "a membrane over the hole separates nothing";
  EXPECT_EQ(certified(input).complex().report().dangling.size(), 1U);
}

TEST(Scenes, BoxesThatTouchAlongAnEdgeAndAtAVertex) {
  const auto found = shapes(support::cut_input(support::workload_named("deg-cavity").value()));
  ASSERT_EQ(found.size(), 6U);
  EXPECT_EQ((Shapes{found.begin(), found.begin() + 4}),
            (Shapes{{cuboid, 0.125}, {cuboid, 1}, {cuboid, 1}, {cuboid, 1}}));
  EXPECT_EQ(found[4], (Shape{{16, 24, 12, 12, 2, 0}, 26}));
  EXPECT_NEAR(found[5].volume, 512 - 27 - 2.125, 1e-9);
}

TEST(Excavations, ShaftsAndCavern) {
  EXPECT_EQ(shapes(excavated({box({1, 1, -1}, {3, 3, 5})})), (Shapes{{{16, 24, 10, 12, 1, 1}, 48}})) << "through";
  EXPECT_EQ(shapes(excavated({box({1, 1, 2}, {3, 3, 5})})), (Shapes{{{16, 24, 11, 12, 1, 0}, 56}})) << "blind";
  EXPECT_EQ(shapes(excavated({box({1, 1, 1}, {3, 3, 3})})), (Shapes{{{16, 24, 12, 12, 2, 0}, 56}})) << "cavern";
}

TEST(Excavations, TunnelsThatMeet) {
  const auto along_x = [](double z) { return box({-1, 1.5, z - 0.5}, {5, 2.5, z + 0.5}); };
  const auto along_y = [](double from, double z) { return box({1.5, from, z - 0.5}, {2.5, 5, z + 0.5}); };
  EXPECT_EQ(shapes(excavated({along_x(2), along_y(-1, 2)})), (Shapes{{{32, 48, 16, 20, 1, 3}, 57}})) << "cross";
  EXPECT_EQ(shapes(excavated({along_x(2), along_y(2, 2)})), (Shapes{{{24, 36, 13, 16, 1, 2}, 58.5}})) << "T";
  EXPECT_EQ(shapes(excavated({along_x(2), along_y(2.5, 2)})), (Shapes{{{24, 36, 13, 16, 1, 2}, 58.5}}))
      << "T, wall to wall";
  EXPECT_EQ(shapes(excavated({along_x(1), along_y(-1, 3)})), (Shapes{{{24, 36, 14, 18, 1, 2}, 56}})) << "two levels";
}

TEST(Excavations, TrenchAndShaftsThatTouch) {
  EXPECT_EQ(shapes(excavated({box({-1, 1.5, -1}, {5, 2.5, 1})})), (Shapes{{{16, 24, 10, 10, 1, 0}, 60}}));
  EXPECT_EQ(shapes(excavated({box({1, 1, -1}, {2, 2, 5}), box({2, 2, -1}, {3, 3, 5})})),
            (Shapes{{{24, 36, 14, 16, 1, 1}, 56}}))
      << "two shafts that touch along a vertical edge";
}

TEST(Excavations, GenusIsTheNumberOfSeparateTunnels) {
  std::vector<geometry::Solid> tunnels;
  for (const double x : {0.5, 1.5, 2.5}) tunnels.push_back(box({x, -1, 1}, {x + 0.5, 5, 2}));
  const auto found = shapes(excavated(tunnels));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].counts.at(5), 3U);
  EXPECT_DOUBLE_EQ(found[0].volume, 64 - 3 * 0.5 * 4);
}

TEST(Excavations, MakeFreeFacesAndWinOverJoints) {
  // The joint runs along the tunnel's floor: where the tunnel is, air counts.
  auto input = scene(cube(), {rectangle(2, 1, {-1, -1}, {5, 5})}, {box({1, -1, 1}, {3, 5, 3})});
  input.free_domain_tags = {5};  // top
  const auto audited = certified(input);
  ASSERT_EQ(audited.complex().blocks().size(), 2U);
  double free = 0, fixed = 0, joint_area = 0;
  for (const topology::Face& face : audited.complex().faces()) {
    switch (face.role) {
      case topology::Role::free:
        free += face.area.si();
        EXPECT_NE(face.excavation.has_value(), face.tag == 5U && face.outward.z > 0.5);
        EXPECT_TRUE(audited.complex().patches(face).empty() || !audited.complex().patches(face)[0].neighbour);
        break;
      case topology::Role::fixed: fixed += face.area.si(); break;
      case topology::Role::joint: joint_area += face.area.si(); break;
      case topology::Role::window: FAIL() << "no window was asked for";
    }
  }
  EXPECT_DOUBLE_EQ(free, 4 * (2 + 2 + 2 + 2) + 16);  // the tunnel's four sides and the top
  EXPECT_DOUBLE_EQ(fixed, 5 * 16 - 2 * 4);           // five sides less the portals
  EXPECT_DOUBLE_EQ(joint_area, 2 * (16 - 8));        // both sides of what is left of the joint
}

TEST(Excavations, EqualOnesAreOne) {
  const auto shaft = box({1, 1, -1}, {3, 3, 5});
  EXPECT_EQ(shapes(excavated({shaft, shaft})), (Shapes{{{16, 24, 10, 12, 1, 1}, 48}}));
  EXPECT_EQ(shapes(excavated({shaft, box({1, 1, 1}, {2, 3, 2})})), (Shapes{{{16, 24, 10, 12, 1, 1}, 48}}))
      << "one in another";
}

TEST(Excavations, MayCutTheRockApart) {
  EXPECT_EQ(shapes(excavated({box({-1, 1, -1}, {5, 3, 5})})), (Shapes{{cuboid, 16}, {cuboid, 16}}));
}

}  // namespace
}  // namespace cleave::testing::scenes_test
