/// Key blocks on demand under every load: those of the whole scene. What a load does to the part of a block that was
/// not cut is not known, so each kind of load could hide a block that moves.

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "near_scenes.hpp"
#include "trials.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using near_scenes::Met;
using near_scenes::network;
using near_scenes::weak_rock;

// Boxes of 40 m with a tunnel at 18 to 22 m across and up: see near_scenes.hpp.
template <class Change>
Met over_random_rock(int most, Change change, double size = 18) {
  Met met;
  const int scenes = testing::trials(most, 4);
  for (int trial = 0; trial < scenes; ++trial) {
    const auto seed = static_cast<std::uint64_t>(100 + trial);
    const auto input =
        network(seed, 60 + 15 * static_cast<std::size_t>(trial % 4), trial % 3 == 0 ? 30 : size, trial % 4 < 2);
    Settings settings = weak_rock();
    change(settings, trial, input);
    near_scenes::expect_same(input, settings, "seed " + std::to_string(seed), met);
  }
  EXPECT_GT(met.found, 0U);
  return met;
}

Actions actions(ActionSpec spec) { return Actions::make(std::move(spec)).value(); }

TEST(NearLoadsTest, WaterTableAnywhere) {
  const Met met = over_random_rock(16, [](Settings& s, int trial, const auto&) {
    const double level = 12 + 4 * (trial % 4);  // below the tunnel, in it, above it
    s.actions = actions({.water = WaterTable{.level = level, .on_free_faces = trial % 8 >= 4}});
  });
  EXPECT_GT(met.windows, 0U);
}

TEST(NearLoadsTest, WaterTableFarBelowCostsNoMoreThanNone) {
  Met dry = over_random_rock(8, [](Settings&, int, const auto&) {});
  Met wet = over_random_rock(
      8, [](Settings& s, int, const auto&) { s.actions = actions({.water = WaterTable{.level = 6}}); });
  EXPECT_EQ(dry.windows, wet.windows);
  EXPECT_GT(wet.windows, 0U);
}

TEST(NearLoadsTest, PressuresInJoints) {
  over_random_rock(12, [](Settings& s, int trial, const topology::CutInput& input) {
    ActionSpec spec;
    spec.joint_pressure.resize(input.joints.size());
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
      if (j % 3 == static_cast<std::size_t>(trial) % 3) spec.joint_pressure[j] = 20e3;
    }
    if (trial % 2 == 0) spec.water = WaterTable{.level = 22};
    s.actions = actions(std::move(spec));
  });
}

TEST(NearLoadsTest, SurchargesAndSupportPressure) {
  const Met met = over_random_rock(12, [](Settings& s, int trial, const auto&) {
    ActionSpec spec;
    if (trial % 2 == 0) {
      spec.surcharges.push_back({.within = Box{{17, 15, 17}, {23, 25, 18.5}}, .traction = {0, 0, -50e3}});  // floor
    } else {
      spec.surcharges.push_back({.on = ExcavationWall{0}, .pressure = pascals(trial % 4 == 1 ? 30e3 : -30e3)});
    }
    s.actions = actions(std::move(spec));
  });
  EXPECT_GT(met.windows, 0U);
}

TEST(NearLoadsTest, PointAndLineForces) {
  const Met met = over_random_rock(12, [](Settings& s, int trial, const auto&) {
    ActionSpec spec;
    spec.points.push_back({.at = {20, 20, 18}, .force = {0, 0, 2e6}});  // an anchor that pulls the floor up
    spec.points.push_back({.at = {18, 20, 20}, .force = {1e6, 0, 0}});
    if (trial % 2 == 0) spec.lines.push_back({.from = {19, 14, 22}, .to = {19, 26, 22}, .per_metre = {0, 0, -2e5}});
    s.actions = actions(std::move(spec));
  });
  EXPECT_GT(met.windows, 0U);
}

TEST(NearLoadsTest, StrengthOfAnyKindAndQuakes) {
  const Met met = over_random_rock(12, [](Settings& s, int trial, const topology::CutInput& input) {
    for (std::uint32_t j = 0; j < input.joints.size(); ++j) {
      const auto friction = FrictionAngle::degrees(20 + 3 * (j % 5));
      s.strengths.set(topology::JointId{j}, j % 2 == 0
                                                ? JointStrength::barton_bandis(friction, 8, pascals(50e6)).value()
                                                : JointStrength::make(friction, pascals(5e3), pascals(1e3)).value());
    }
    s.loads = Loads::make({0, 0, -9.81}, {0.15 * (trial % 3), 0.05, 0}).value();
    if (trial % 2 == 0) s.partial = PartialFactors::make(1.25, 1.6, 1.1).value();
  });
  EXPECT_GT(met.windows, 0U);
}

TEST(NearLoadsTest, EverythingAtOnce) {
  over_random_rock(12, [](Settings& s, int trial, const auto&) {
    ActionSpec spec{.water = WaterTable{.level = 16.0 + 3.0 * (trial % 3)}};
    spec.surcharges.push_back({.traction = {0, 5e3, -20e3}});
    spec.points.push_back({.at = {20, 20, 22}, .force = {0, 0, -1e5}});
    s.actions = actions(std::move(spec));
    s.loads = Loads::make({0, 0, -9.81}, {0, 0.1, 0}).value();
    s.strict = trial % 4 == 3;
  });
}

TEST(NearLoadsTest, RotationThatDecides) {
  over_random_rock(6, [](Settings& s, int, const auto&) { s.rotation = RotationCheck::decide; });
}

// Blocks below a target are counted: none of them may hide behind the window.
TEST(NearLoadsTest, BlocksBelowATargetAreListed) {
  std::size_t met = 0;
  for (int trial = 0; trial < testing::trials(8, 4); ++trial) {
    const auto input = network(static_cast<std::uint64_t>(200 + trial), 200, 18, true);
    Settings settings = weak_rock();
    settings.strengths = StrengthTable{statics::strength(40)};
    settings.least_factor = 4;
    const auto below = [](const Analysis& analysis) {
      std::size_t n = 0;
      for (const Judgement& j : analysis.judgements) n += moves(j.mode) && j.factor_of_safety < 4 ? 1U : 0U;
      return n;
    };
    const auto whole = topology::audit(topology::cut(input).value());
    StageTimer timer;
    const auto near = analyse_near_field(input, settings, {}, timer);
    ASSERT_TRUE(whole && near);
    const Analysis expected = analyse(*whole, settings);
    EXPECT_EQ(below(expected), below(near->analysis)) << trial;
    met += below(expected) - near_scenes::leaving(expected).size();
  }
  EXPECT_GT(met, 0U);
}

}  // namespace
}  // namespace cleave::stability
