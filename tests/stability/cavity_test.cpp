// Blocks with cavities: air inside is rock that weighs nothing; blocks inside go where the block around them goes.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::stability::cavity_test {
namespace {

using geometry::Vec3;
using handmade::radians;
using statics::audited;
using statics::strength;

/// Six rectangles: a closed box of joints.
void add_box(topology::CutInput& input, Vec3 lo, Vec3 hi) {
  const auto corner = [&](unsigned i) {
    return Vec3{(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z};
  };
  constexpr std::array<std::array<unsigned, 4>, 6> sides{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& s : sides) {
    input.joints.emplace_back(
        topology::Joint{{geometry::Polygon::make({corner(s[0]), corner(s[1]), corner(s[2]), corner(s[3])}).value()}});
  }
}

/// A block of 4 x 4 x 3 m hangs in a roof between vertical joints.
topology::CutInput ceiling() {
  topology::CutInput input{.domain = geometry::make_box({-6, -6, 0}, {6, 6, 9}).value(),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {4}};
  for (const double s : {-2.0, 2.0}) {
    input.joints.emplace_back(topology::PersistentJoint{{s, 0, 0}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0, s, 0}, {0, 1, 0}});
  }
  input.joints.emplace_back(topology::PersistentJoint{{0, 0, 3}, {0, 0, 1}});
  return input;
}

/// The block in the middle of the roof.
topology::BlockId hanging(const topology::BlockComplex& complex) {
  for (const topology::BlockId id : complex.blocks().ids()) {
    const topology::Block& b = complex.blocks()[id];
    if (b.free && !b.fixed) return id;
  }
  ADD_FAILURE();
  return topology::BlockId{0U};
}

TEST(CavityTest, AirInsideWeighsNothing) {
  topology::CutInput input = ceiling();
  input.excavations.push_back(geometry::make_box({-1, -1, 1}, {1, 1, 2}).value());
  const auto complex = audited(input);
  const auto id = hanging(complex.complex());
  EXPECT_EQ(complex.complex().blocks()[id].counts.shells, 2U);
  const Analysis a = analyse(complex, statics::settings({strength(40)}));
  ASSERT_EQ(a.batches.size(), 1U);
  EXPECT_EQ(a.batches[0].blocks, std::vector{id});
  EXPECT_EQ(a.judgements.at(0).mode, Mode::falling);
  EXPECT_EQ(a.judgements.at(0).cone_dimension, 1);
  EXPECT_NEAR(a.judgements.at(0).net.si(), 4 * 4 * 3 - 2 * 2 * 1, 1e-9);
}

// One box, two boxes, a box in a box: what hangs is all of it.
TEST(CavityTest, BlocksInsideFallWithTheOneAround) {
  for (const unsigned boxes : {1U, 2U, 3U}) {
    topology::CutInput input = ceiling();
    add_box(input, {-1.5, -1, 0.5}, {-0.5, 1, 2.5});
    if (boxes == 2) add_box(input, {0.5, -1, 1}, {1, 1, 2});
    if (boxes == 3) add_box(input, {-1.25, -0.5, 1}, {-0.75, 0.5, 2});
    const auto complex = audited(input);
    const auto id = hanging(complex.complex());
    const Settings with = statics::settings({strength(40)});
    const Analysis a = analyse(complex, with);
    EXPECT_TRUE(a.batches.empty());  // one by one they hold each other
    const auto rows = held_from_within(complex, with, a);
    ASSERT_EQ(rows.size(), 1U) << boxes;
    EXPECT_EQ(rows[0].block, id);
    EXPECT_EQ(rows[0].inside.size(), boxes == 1 ? 1U : 2U);
    EXPECT_EQ(rows[0].mode, Mode::falling);
    EXPECT_EQ(rows[0].factor_of_safety, 0);
    EXPECT_NEAR(rows[0].net.si(), 48, 1e-9);
    EXPECT_LT(geometry::norm(rows[0].direction - Vec3{0, 0, -1}), 1e-12);
  }
}

// A box that reaches the roof is a block of its own: it falls first, and then nothing is inside.
TEST(CavityTest, ABlockWithAWayOutIsNotInside) {
  topology::CutInput input = ceiling();
  add_box(input, {-1, -1, -0.5}, {1, 1, 1});
  const auto complex = audited(input);
  const Settings with = statics::settings({strength(40)});
  const Analysis a = analyse(complex, with);
  EXPECT_EQ(a.batches.size(), 2U);
  EXPECT_TRUE(held_from_within(complex, with, a).empty());
  // Glued into its socket it stays, and bars the way of the block around it; but it is not inside.
  Settings glued = with;
  for (std::uint32_t joint = 5; joint < 11; ++joint)
    glued.strengths.set(topology::JointId{joint}, strength(40, 0, 1e3));
  const Analysis stuck = analyse(complex, glued);
  EXPECT_TRUE(stuck.batches.empty());
  EXPECT_TRUE(held_from_within(complex, glued, stuck).empty());
}

// Under every load there is, block and content together are what the same block is without the joints inside.
TEST(CavityTest, JointsInsideChangeNothing) {
  const double dip = 35;
  const Vec3 d{std::cos(radians(dip)), 0, -std::sin(radians(dip))},
      n{std::sin(radians(dip)), 0, std::cos(radians(dip))};
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = ((i & 1U) != 0 ? 12 : 0) * d + Vec3{0, (i & 2U) != 0 ? 8.0 : 0.0, 0} + ((i & 4U) != 0 ? 6 : -4) * n;
  }
  topology::CutInput solid{.domain = geometry::make_hexahedron(corners).value(),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {0, 1, 2, 3, 5}};
  solid.joints.emplace_back(topology::PersistentJoint{{}, n});
  topology::CutInput boxed = solid;
  const Vec3 middle = 6.0 * d + Vec3{0, 4, 0} + 3.0 * n;
  add_box(boxed, middle - Vec3{1, 2, 0.7}, middle + Vec3{1.3, 1, 0.9});
  const auto one = audited(solid), other = audited(boxed);
  ASSERT_EQ(other.complex().blocks().size(), one.complex().blocks().size() + 1);
  for (const double friction : {10.0, 30.0, 60.0}) {
    Settings with = statics::settings({strength(friction, 0.3)}, {0.05, 0.04, 0});
    ActionSpec loads;
    loads.water = WaterTable{.level = middle.z + 0.1, .unit_weight = newtons_per_cubic_metre(0.4)};
    loads.surcharges = {{.on = DomainSide{5}, .pressure = pascals(0.2)}};
    with.actions = Actions::make(std::move(loads)).value();
    const Analysis a = analyse(one, with);
    ASSERT_EQ(a.judgements.size(), 1U);
    const Analysis b = analyse(other, with);
    EXPECT_TRUE(b.judgements.empty());
    const auto rows = held_from_within(other, with, b);
    ASSERT_EQ(rows.size(), a.judgements[0].key ? 1U : 0U) << friction;
    if (rows.empty()) continue;
    EXPECT_EQ(rows[0].mode, a.judgements[0].mode);
    EXPECT_NEAR(rows[0].factor_of_safety, a.judgements[0].factor_of_safety, 1e-9);
    EXPECT_NEAR(rows[0].net.si(), a.judgements[0].net.si(), 1e-8);
    EXPECT_LT(geometry::norm(rows[0].direction - a.judgements[0].direction), 1e-9);
  }
}

}  // namespace
}  // namespace cleave::stability::cavity_test
