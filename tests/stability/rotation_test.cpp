// Toppling and twisting of a single block: the block on an incline (Ashby 1971; Goodman and Bray 1976), and a beam
// pushed at its end.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::stability::rotation_test {
namespace {

using geometry::Vec3;
using handmade::radians;
using statics::strength;

struct Incline {
  double dip = 40, length = 1, width = 1, height = 1;
  JointStrength joint = strength(50);
  ActionSpec loads = {};
  RotationCheck check = RotationCheck::flag;
  Vec3 seismic = {};

  [[nodiscard]] Analysis run() const {
    const double a = radians(dip);
    const Vec3 d{std::cos(a), 0, -std::sin(a)}, y{0, 1, 0}, n{std::sin(a), 0, std::cos(a)};
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] =
          ((i & 1U) != 0 ? length : 0) * d + ((i & 2U) != 0 ? width : 0) * y + ((i & 4U) != 0 ? height : -1.0) * n;
    }
    topology::CutInput input{.domain = geometry::make_hexahedron(corners).value(),
                             .joints = {},
                             .excavations = {},
                             .free_domain_tags = {0, 1, 2, 3, 5}};
    input.joints.emplace_back(topology::PersistentJoint{{}, n});
    const auto complex = topology::audit(topology::cut(input).value());
    Settings with = statics::settings({joint}, seismic);
    with.actions = Actions::make(loads).value();
    with.rotation = check;
    return analyse(*complex, with);
  }
};

const Judgement& only(const Analysis& a) {
  EXPECT_EQ(a.judgements.size(), 1U);
  return a.judgements.at(0);
}

// Base over height against the tangent of the dip decides; friction and cohesion of the base do not.
TEST(RotationTest, ColumnsToppleWhenTheirBaseIsTooShort) {
  for (const double dip : {20.0, 40.0, 48.0}) {
    for (const double ratio : {0.5, 0.9, 0.99, 1.01, 1.1, 2.0}) {  // (base / height) / tan(dip)
      for (const double cohesion : {0.0, 100.0}) {
        Incline scene{.dip = dip, .length = 1, .width = 0.7, .height = 1 / (ratio * std::tan(radians(dip)))};
        scene.joint = strength(50, cohesion);
        const Analysis a = scene.run();
        const Judgement& j = only(a);
        EXPECT_EQ(j.mode, Mode::sliding);
        EXPECT_FALSE(j.key);
        ASSERT_TRUE(j.rotation.has_value());
        EXPECT_EQ(j.rotation->turns, ratio < 1) << dip << ' ' << ratio << ' ' << cohesion;
        if (ratio < 1) {
          EXPECT_NEAR(j.rotation->axis.y, 1, 1e-6);  // over its toe, down the dip
          EXPECT_GT(j.rotation->lack, 0);
        } else {
          EXPECT_EQ(j.rotation->lack, 0);
        }
        EXPECT_TRUE(a.batches.empty());
      }
    }
  }
}

TEST(RotationTest, WhatSlidesIsNotAsked) {
  Incline scene{.height = 3};
  scene.joint = strength(30);
  const Analysis a = scene.run();
  EXPECT_TRUE(only(a).key);
  EXPECT_FALSE(only(a).rotation.has_value());
}

TEST(RotationTest, DecidesOnlyWhereAsked) {
  Incline scene{.height = 3};
  scene.check = RotationCheck::decide;
  const Analysis decided = scene.run();
  EXPECT_TRUE(only(decided).key);
  EXPECT_EQ(only(decided).batch, 1U);
  ASSERT_TRUE(only(decided).transferred.has_value());
  EXPECT_TRUE(only(decided).transferred->key);
  EXPECT_EQ(only(decided).transferred->passed.si(), 0);
  scene.check = RotationCheck::off;
  const Analysis off = scene.run();
  EXPECT_FALSE(only(off).key);
  EXPECT_FALSE(only(off).rotation.has_value());
}

// On a level base weight alone moves nothing; a push of k W at the centroid topples the block when k > base / height.
TEST(RotationTest, QuakeOnALevelBase) {
  for (const double push : {0.4, 0.49, 0.51, 0.6}) {
    Incline scene{.dip = 0, .length = 1, .width = 5, .height = 2};
    scene.seismic = {push, 0, 0};
    const Analysis a = scene.run();
    ASSERT_TRUE(only(a).rotation.has_value());
    EXPECT_FALSE(only(a).key);
    EXPECT_EQ(only(a).rotation->turns, push > 0.5) << push;
  }
}

// A beam 20 m long and 1 cm wide, pushed across at its end: the end's half of the weight has to hold it by friction.
TEST(RotationTest, BeamTwistsOnItsBase) {
  const double weight = 20 * 1e-2 * 1e-2, most = 0.5 * weight * std::tan(radians(30));
  for (const double share : {0.8, 0.95, 1.05, 1.5}) {
    Incline scene{.dip = 0, .length = 20, .width = 1e-2, .height = 1e-2};
    scene.joint = strength(30);
    // Down by as much as keeps the push from tipping the beam over its edge: none is needed, the push is at the base.
    scene.loads.points = {{.at = {20, 5e-3, 1e-9}, .force = {0, share * most, 0}}};
    const Analysis a = scene.run();
    ASSERT_TRUE(only(a).rotation.has_value());
    EXPECT_FALSE(only(a).key);  // as a whole it would slide at twice `most`
    EXPECT_EQ(only(a).rotation->turns, share > 1) << share;
    if (share > 1) {
      EXPECT_GT(std::abs(only(a).rotation->axis.z), 0.8);
    }
  }
}

}  // namespace
}  // namespace cleave::stability::rotation_test
