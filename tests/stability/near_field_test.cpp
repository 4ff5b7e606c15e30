/// Key blocks found without cutting more than their neighbourhood are those of the whole scene.

#include "cleave/stability/analyse.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "near_scenes.hpp"
#include "trials.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using near_scenes::leaving;
using near_scenes::network;
using near_scenes::weak_rock;

TEST(NearFieldTest, GivesTheKeyBlocksOfTheWholeScene) {
  near_scenes::Met met;
  const int scenes = testing::trials(12, 8);
  for (int trial = 0; trial < scenes; ++trial) {
    const auto seed = static_cast<std::uint64_t>(trial);
    const auto input = network(seed, 90 + 15 * seed, trial % 2 == 0 ? 30 : 18, trial % 4 < 2);
    near_scenes::expect_same(input, weak_rock(), "seed " + std::to_string(seed), met);
  }
  // The test must have met what it is about.
  EXPECT_GT(met.windows, 0U);
  EXPECT_GT(met.grown, 0U);
  EXPECT_GT(met.found, 10U);
}

void add_square(topology::CutInput& input, const std::array<Vec3, 4>& corners) {
  input.joints.emplace_back(topology::Joint{{geometry::Polygon::make({corners.begin(), corners.end()}).value()}});
}

/// A tunnel, and a block on its roof that reaches from z = 8 up to 29.
topology::CutInput tall_block() {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {40, 40, 40}).value()};
  input.excavations.push_back(geometry::make_box({18, -1, 4}, {22, 41, 8}).value());
  add_square(input, {{{19, 19, 7}, {19, 21, 7}, {19, 21, 30}, {19, 19, 30}}});
  add_square(input, {{{21, 19, 7}, {21, 21, 7}, {21, 21, 30}, {21, 19, 30}}});
  add_square(input, {{{19, 19, 7}, {21, 19, 7}, {21, 19, 30}, {19, 19, 30}}});
  add_square(input, {{{19, 21, 7}, {21, 21, 7}, {21, 21, 30}, {19, 21, 30}}});
  add_square(input, {{{18, 18, 29}, {22, 18, 29}, {22, 22, 29}, {18, 22, 29}}});
  return input;
}

// One block on the roof that reaches far up: a window that cuts through it must not call it stable, nor cut it short.
TEST(NearFieldTest, FollowsATallBlock) {
  topology::CutInput input = tall_block();
  const auto square = [&](const std::array<Vec3, 4>& corners) { add_square(input, corners); };
  // Sheets elsewhere, which make a small window look good enough.
  for (int i = 0; i < 40; ++i) {
    const double z = 10 + 0.7 * i;
    square({{{0.5, 0.5, z}, {16.5, 0.5, z}, {16.5, 39.5, z}, {0.5, 39.5, z}}});
  }
  StageTimer timer;
  const auto near = analyse_near_field(input, weak_rock(), {}, timer);
  ASSERT_TRUE(near.has_value());
  ASSERT_EQ(leaving(near->analysis).size(), 1U);
  EXPECT_NEAR(near->complex.complex().blocks()[leaving(near->analysis)[0]].volume.si(), 2 * 2 * 21, 1e-9);
  EXPECT_GT(near->rounds, 1U);
}

// A block that hangs over the tunnel from far above, and a joint in it that is bent and ends inside it. In a window
// that ends below, its two parts hold each other, by turns: each is above the other somewhere. They are one block.
TEST(NearFieldTest, PartsOfOneBlockDoNotHoldEachOther) {
  topology::CutInput input = tall_block();
  const auto square = [&](const std::array<Vec3, 4>& corners) { add_square(input, corners); };
  // The bent joint, through all of the block up to z = 28: a nose to the right at z = 9, vertical from z = 10.
  input.joints.emplace_back(topology::Joint{{
      geometry::Polygon::make({{19.8, 18.5, 7}, {19.8, 21.5, 7}, {20.4, 21.5, 9}, {20.4, 18.5, 9}}).value(),
      geometry::Polygon::make({{20.4, 18.5, 9}, {20.4, 21.5, 9}, {19.8, 21.5, 10}, {19.8, 18.5, 10}}).value(),
      geometry::Polygon::make({{19.8, 18.5, 10}, {19.8, 21.5, 10}, {19.8, 21.5, 28}, {19.8, 18.5, 28}}).value(),
  }});
  for (int i = 0; i < 40; ++i) {  // sheets elsewhere, which make a small window look good enough
    const double z = 10 + 0.7 * i;
    square({{{0.5, 0.5, z}, {16.5, 0.5, z}, {16.5, 39.5, z}, {0.5, 39.5, z}}});
  }
  const auto first = NearField::around_free_faces(input);
  ASSERT_TRUE(first.has_value());
  ASSERT_GT(first->window().max.z, 10.5);  // past the nose
  ASSERT_LT(first->window().max.z, 27);    // and the joint goes on
  near_scenes::Met met;
  near_scenes::expect_same(input, weak_rock(), "bent joint", met);
  EXPECT_EQ(met.found, 1U);
  EXPECT_EQ(met.grown, 1U);
}

TEST(NearFieldTest, IsNotUsedWithoutFreeFaces) {
  EXPECT_FALSE(NearField::around_free_faces({.domain = geometry::make_box({0, 0, 0}, {1, 1, 1}).value()}).has_value());
}

}  // namespace
}  // namespace cleave::stability
