// On which free faces sprayed concrete and a pressure hold a block.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/support.hpp"
#include "statics.hpp"

namespace cleave::stability::sprayed_faces_test {
namespace {

using geometry::Vec3;
using statics::audited;
using statics::strength;
using topology::BlockId;

constexpr std::uint32_t bottom = 4, top = 5;  // tags of a box

topology::Joint polygon(std::vector<Vec3> corners) {
  return topology::Joint{{geometry::Polygon::make(std::move(corners)).value()}};
}

topology::Joint level(double z) { return polygon({{4, 4, z}, {6, 4, z}, {6, 6, z}, {4, 6, z}}); }

/// A plug of 1 x 1 m from the roof of an opening (z = 5) to the ground above it (z = 7), cut at `levels` besides.
topology::CutInput plug(const std::vector<double>& levels = {}) {
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {10, 10, 7}).value(),
                           .joints = {},
                           .excavations = {geometry::make_box({2, -1, 2}, {8, 11, 5}).value()},
                           .free_domain_tags = {top}};
  const double low = 4.5, high = 5.5;
  for (const double s : {low, high}) {
    input.joints.push_back(polygon({{s, low, 4}, {s, high, 4}, {s, high, 8}, {s, low, 8}}));
    input.joints.push_back(polygon({{low, s, 4}, {high, s, 4}, {high, s, 8}, {low, s, 8}}));
  }
  for (const double z : levels) input.joints.push_back(level(z));
  return input;
}

/// What 1 m of the layer holds, N.
Shotcrete layer(double per_metre, std::vector<FreeSurface> on = {}) {
  return {.thickness = metres(0.1), .shear_strength = pascals(per_metre / 0.1), .on = std::move(on)};
}

struct Found {
  SupportedBlock block;
  bool groups_held;
};

/// The one block that needs support, and whether the check of groups holds it too.
Found found(const topology::AuditedComplex& complex, const Settings& settings, const Shotcrete& shotcrete) {
  const SupportPlan plan{.shotcrete = shotcrete, .target_falling = 1.5, .target_sliding = 1.5};
  const SupportResult alone = check_support(complex, settings, analyse(complex, settings), plan);
  const GroupSupport groups = check_groups(complex, settings, plan, alone, {20'000, 0});
  EXPECT_EQ(groups.below.groups.size(), 1U);
  EXPECT_EQ(alone.blocks.size(), 1U);
  return {alone.blocks.at(0), groups.left.groups.empty()};
}

void expect_factor(const Found& found, double factor) {
  EXPECT_NEAR(found.block.factor_with_shotcrete.value(), factor, 1e-9);
  EXPECT_NEAR(found.block.factor_with_support.value(), factor, 1e-5);
  EXPECT_EQ(found.block.held != Held::not_held, factor >= 1.5);
  EXPECT_EQ(found.groups_held, factor >= 1.5);
  EXPECT_EQ(found.block.needed_thickness.has_value(), factor > 0);
}

// 2 N of plug on 4 m of edge in the roof. The ground above is not sprayed, and the plug moves away from it: 4 m there
// hold nothing, whatever is sprayed.
TEST(SprayedFaces, ThePlugHangsOnTheRoofAlone) {
  const auto complex = audited(plug());
  const Settings settings = statics::settings({strength(30)});
  for (const double factor : {0.9, 1.2, 1.8}) {
    SCOPED_TRACE(factor);
    const double per_metre = factor * 2 / 4;
    expect_factor(found(complex, settings, layer(per_metre)), factor);
    expect_factor(found(complex, settings, layer(per_metre, {AnyFreeFace{}})), factor);
    expect_factor(found(complex, settings, layer(per_metre, {ExcavationWall{0}})), factor);
    expect_factor(found(complex, settings, layer(per_metre, {DomainSide{top}, ExcavationWall{0}})), factor);
    expect_factor(found(complex, settings, layer(per_metre, {DomainSide{top}})), 0);
    expect_factor(found(complex, settings, layer(per_metre, {ExcavationWall{1}})), 0);
  }
}

// A pressure acts on the roof alone: on both faces it would cancel.
TEST(SprayedFaces, APressureActsWhereTheBlockComesOut) {
  const auto complex = audited(plug());
  const Settings settings = statics::settings({strength(30)});
  EXPECT_NEAR(found(complex, settings, layer(1)).block.required_pressure, 1.5 * 2, 1e-9);
}

// A slab of 6.4 m3 that slides into a cutting of two steps; its face on the ground above is larger than those in the
// walls. Bolts from the ground would push it out: they go into the walls, 1.5 to 1 as these have area, and not into the
// berm between them.
TEST(SpotBoltPlaces, OnWallsOfExcavationsByTheirArea) {
  const double dip = 40 * std::numbers::pi / 180;
  topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {14, 2, 8}).value(),
                           .joints = {},
                           .excavations = {geometry::make_box({-1, -1, 5}, {5, 3, 7}).value(),
                                           geometry::make_box({-1, -1, 7}, {5.5, 3, 9}).value()},
                           .free_domain_tags = {2, 3, top}};
  input.joints.emplace_back(topology::PersistentJoint{{5, 0, 5.5}, {-std::sin(dip), 0, std::cos(dip)}});
  const auto complex = audited(input);
  const Settings settings = statics::settings({strength(39)});
  SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.5};
  plan.spot = SpotBolts{.type = {.tendon = newtons(0.4),
                                 .plate = newtons(9),
                                 .anchorage = metres(0.1),
                                 .kind = GroutedBar{.bond = newtons_per_metre(9)}},
                        .length = metres(6)};
  const SupportResult result = check_support(complex, settings, analyse(complex, settings), plan);
  ASSERT_EQ(result.blocks.size(), 1U);
  EXPECT_TRUE(result.passes());
  ASSERT_GE(result.bolts.size(), 5U);
  std::vector<double> walls;
  for (std::size_t k = 0; k < 5; ++k) walls.push_back(result.bolts[k].bolt.collar.x);
  EXPECT_EQ(walls, (std::vector<double>{5, 5.5, 5, 5, 5.5}));
  for (const BoltResult& bolt : result.bolts) EXPECT_EQ(bolt.status, BoltStatus::holds);
}

// A free side of the domain is no wall of an excavation: sprayed where it is named.
TEST(SprayedFaces, FreeSidesAreSprayedWhereTheyAreNamed) {
  topology::CutInput input = plug({6.5});
  input.excavations.clear();
  input.domain = geometry::make_box({0, 0, 5}, {10, 10, 10}).value();
  input.free_domain_tags = {bottom};
  const auto complex = audited(input);
  const Settings settings = statics::settings({strength(30)});
  const double weight = 1.5, per_metre = 1.8 * weight / 4;
  expect_factor(found(complex, settings, layer(per_metre)), 0);
  expect_factor(found(complex, settings, layer(per_metre, {DomainSide{top}})), 0);
  expect_factor(found(complex, settings, layer(per_metre, {DomainSide{bottom}})), 1.8);
  expect_factor(found(complex, settings, layer(per_metre, {AnyFreeFace{}})), 1.8);
}

// Plates that were scaled off one behind the other lay the plug bare: it is sprayed where they would have been.
TEST(SprayedFaces, WhatScalingLaidBareIsSprayedAsWhatWasInFront) {
  const auto complex = audited(plug({5.1, 5.2, 6.8, 6.9}));
  Settings settings = statics::settings({strength(30)});
  for (const BlockId id : complex.complex().blocks().ids()) {
    if (complex.complex().blocks()[id].volume.si() < 1) settings.left_out.push_back(id);
  }
  ASSERT_EQ(settings.left_out.size(), 4U);
  const double weight = 1.6, per_metre = 1.8 * weight / 4;
  expect_factor(found(complex, settings, layer(per_metre)), 1.8);
  expect_factor(found(complex, settings, layer(per_metre, {AnyFreeFace{}})), 1.8);
  expect_factor(found(complex, settings, layer(per_metre, {DomainSide{top}})), 0);
  EXPECT_NEAR(found(complex, settings, layer(1)).block.required_pressure, 1.5 * weight, 1e-9);
}

/// A block of 1 x 1 x 2 m in a roof, cut at `levels`, with `more` joints.
topology::CutInput roof_block(const std::vector<double>& levels, const std::vector<topology::Joint>& more = {}) {
  topology::CutInput input = plug(levels);
  input.domain = geometry::make_box({0, 0, 0}, {10, 10, 12}).value();
  input.free_domain_tags = {};
  input.joints.push_back(level(7));
  input.joints.insert(input.joints.end(), more.begin(), more.end());
  return input;
}

/// The block that receives most, support being asked for up to `most_pressure`.
SupportedBlock receiver(const topology::CutInput& input, double most_pressure) {
  const auto complex = audited(input);
  const Settings settings = statics::settings({strength(30)});
  const SupportPlan plan{.target_falling = 1.5, .target_sliding = 1.5, .most_pressure = pascals(most_pressure)};
  const SupportResult result = check_support(complex, settings, analyse(complex, settings), plan);
  EXPECT_EQ(result.blocks.size(), 1U);
  return result.blocks.at(0);
}

// A crumb of 0.1 x 1 x 0.1 m keeps a block of 1.99 m3 in the roof. The pressure of a lining is on both: what holds the
// block, on its 0.9 m2, leaves the crumb alone with its own weight.
TEST(FacePressures, ABlockPassesNothingOnAtThePressureItNeedsItself) {
  const topology::CutInput input =
      roof_block({}, {polygon({{5.4, 4.4, 4}, {5.4, 5.6, 4}, {5.4, 5.6, 5.15}, {5.4, 4.4, 5.15}}),
                      polygon({{5.35, 4.4, 5.1}, {5.6, 4.4, 5.1}, {5.6, 5.6, 5.1}, {5.35, 5.6, 5.1}})});
  const double crumb = 1.5 * 0.01 / 0.1, block = 1.5 * 1.99 / 0.9, all = 1.5 * 2 / 0.1;
  for (const double most : {1.0, 10.0, 100.0}) {
    SCOPED_TRACE(most);
    const SupportedBlock found = receiver(input, most);
    EXPECT_NEAR(found.received, 1.99, 1e-9);
    EXPECT_NEAR(found.required_pressure, all, 1e-6);
    EXPECT_NEAR(found.own_pressure, crumb, 1e-6);
    EXPECT_NEAR(found.lining_pressure, most > block ? block : crumb, 1e-6);
    EXPECT_EQ(found.passed_on, all > most);
  }
}

// A block without a face of its own is held through the one in front, whatever the pressure.
TEST(FacePressures, WhatHasNoFacePassesEverythingOn) {
  const SupportedBlock found = receiver(roof_block({5.1}), 100);
  EXPECT_NEAR(found.required_pressure, 1.5 * 2, 1e-6);
  EXPECT_NEAR(found.own_pressure, 1.5 * 0.1, 1e-6);
  EXPECT_NEAR(found.lining_pressure, 1.5 * 2, 1e-6);
}

}  // namespace
}  // namespace cleave::stability::sprayed_faces_test
