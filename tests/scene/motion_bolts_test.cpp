#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Bolts of a scene that hold blocks in motion, against closed forms and against what the check of the support says.

namespace cleave::scene::test::motion_bolts_test {
namespace {

constexpr double g = 9.81;

bool says(const RunResult& result, const std::string& what) {
  return std::ranges::any_of(result.notes, [&](const std::string& note) { return note.find(what) != note.npos; });
}

/// A block of 2 x 2 x 1.5 m in a roof, its sides open downwards so that nothing but its bolts holds it.
constexpr double hung_weight = 2600 * g * 5.42;
std::string hung(const std::string& bolts, const std::string& motion, const std::string& more = {}) {
  const auto side = [](const std::string& axis, double s) {
    const auto corner = [&](double along, double z) {
      const std::string across = std::to_string(s * (1 - z / 15)), other = std::to_string(along);
      return "[" + (axis == "x" ? across + ", " + other : other + ", " + across) + ", " + std::to_string(z) + "]";
    };
    return "[[joint]]\npolygon = [" + corner(-1.2, -0.3) + ", " + corner(1.2, -0.3) + ", " + corner(1.2, 1.8) + ", " +
           corner(-1.2, 1.8) + "]\n";
  };
  return "[domain]\nbox = { min = [-4, -4, 0], max = [4, 4, 6] }\n" + side("x", -1) + side("x", 1) + side("y", -1) +
         side("y", 1) +
         "[[joint]]\npolygon = [[-1.2, -1.2, 1.5], [1.2, -1.2, 1.5], [1.2, 1.2, 1.5], [-1.2, 1.2, 1.5]]\n" + more +
         "[joints.default]\nfriction = 30\n[rock]\ndensity = 2600\n[stability]\nfree = [\"bottom\"]\ngroups = "
         "\"off\"\n[support]\n" +
         bolts + "[motion]\nerror = false\n" + motion;
}

/// Bolts of 3.5 m that hang from far above; `each`: N of tendon.
std::string bolts_at(const std::string& at, double each, const std::string& more = {}) {
  return "[[support.bolts]]\nat = [" + at +
         "]\ndirection = [0, 0, 1]\nlength = 3.5\ntendon_capacity = " + std::to_string(each) +
         "\nplate_capacity = 1e9\nbond_strength = 1e9\nanchorage = 0.3\n" + more;
}

double fall_of(const RunResult& result) {
  EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
  EXPECT_EQ(result.motion->blocks.size(), 1U);
  EXPECT_LT(result.motion->energy_error, 1e-9);
  EXPECT_LE(result.motion->overlap, 1e-6);
  return result.motion->blocks.at(0).fall.si();
}

TEST(MotionBolts, ABlockHangsExactlyWhereTheSumOfItsBoltsIsItsWeight) {
  for (const auto& [at, count] : {std::pair{"[0, 0, 0]", 1},
                                  {"[-0.5, -0.3, 0], [0.5, -0.3, 0], [0, 0.6, 0]", 3},
                                  {"[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]", 4}}) {
    const RunResult holds = run_of(hung(bolts_at(at, 1.001 * hung_weight / count), "duration = 0.3\n"));
    EXPECT_LT(fall_of(holds), 1e-6) << count;
    EXPECT_EQ(holds.motion->bolts.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(holds.motion->bolts_broken(), 0U);
    double sum = 0;
    for (const MotionBolt& bolt : holds.motion->bolts) {
      EXPECT_LE(bolt.largest.si(), 1.001 * hung_weight / count * (1 + 1e-9));
      sum += bolt.largest.si();
    }
    EXPECT_NEAR(sum / hung_weight, 1, 1e-3) << count;
    const RunResult falls = run_of(hung(bolts_at(at, 0.999 * hung_weight / count), "duration = 0.3\n"));
    EXPECT_EQ(falls.motion->bolts_broken(), static_cast<std::uint64_t>(count));
    EXPECT_EQ(falls.motion->blocks.at(0).bolts, static_cast<std::uint64_t>(count));
    EXPECT_EQ(falls.motion->blocks.at(0).bolts_broken, static_cast<std::uint64_t>(count));
    EXPECT_NEAR(falls.motion->largest_bolt_force().si() / (0.999 * hung_weight / count), 1, 1e-6);
    // All of them are gone after the first step, up to the first frame at 0.006 s: the rest is free fall.
    EXPECT_NEAR(fall_of(falls), 0.5 * g * 0.294 * 0.294, 1e-3) << count;
    EXPECT_TRUE(says(falls, "broke, the largest force is")) << count;
  }
}

TEST(MotionBolts, TheyYieldAtTheirCapacityUntilTheirDuctility) {
  const double each = 0.8 * hung_weight;
  const RunResult result =
      run_of(hung(bolts_at("[0, 0, 0]", each, "ductility = 0.05\n"), "duration = 0.3\nstep = 0.001\n"));
  // 0.2 g down to there, then g.
  const double there = std::sqrt(2 * 0.05 / (0.2 * g)), speed = 0.2 * g * there, left = 0.3 - there;
  EXPECT_NEAR(fall_of(result), 0.05 + speed * left + 0.5 * g * left * left, 2e-3);
  const MotionBolt& bolt = result.motion->bolts.at(0);
  ASSERT_TRUE(bolt.broken_at.has_value());
  EXPECT_NEAR(bolt.broken_at->si(), there, 2e-3);
  EXPECT_NEAR(bolt.largest.si() / each, 1, 1e-6);
  EXPECT_NEAR(bolt.lengthened.si(), 0.05, 1e-3);
  EXPECT_NEAR(result.motion->dissipated / (each * 0.05), 1, 0.02);
}

// What a bolt can carry is what holds it on both sides of the joint: 2 m behind, or plate and 1.5 m before.
TEST(MotionBolts, TheyHoldWhatPlateBondAndAnchorLet) {
  const auto bolt = [](double plate, double bond, const std::string& more = {}) {
    return "[[support.bolts]]\nat = [[0, 0, 0]]\ndirection = [0, 0, 1]\nlength = 3.5\ntendon_capacity = 1e9\n"
           "plate_capacity = " +
           std::to_string(plate) + "\nbond_strength = " + std::to_string(bond) + "\nanchorage = 0.3\n" + more;
  };
  const double w = hung_weight;
  for (const double share : {0.995, 1.005}) {
    EXPECT_EQ(fall_of(run_of(hung(bolt(1e9, share * w / 2), "duration = 0.15\n"))) > 1e-3, share < 1);
    EXPECT_EQ(fall_of(run_of(hung(bolt(0, share * w / 1.5), "duration = 0.15\n"))) > 1e-3, share < 1);
    EXPECT_EQ(fall_of(run_of(hung(bolt(0.2 * w, share * 0.8 * w / 1.5), "duration = 0.15\n"))) > 1e-3, share < 1);
  }
  // A bolt that ends in the block, one that is gripped too little behind it, and motion.support = false.
  for (const auto& [from, to] : {std::pair{"length = 3.5", "length = 1.4"},
                                 {"anchorage = 0.3", "anchorage = 2.1"},
                                 {"error = false", "error = false\nsupport = false"}}) {
    std::string text = hung(bolts_at("[0, 0, 0]", 10 * w), "duration = 0.15\n");
    text.replace(text.find(from), std::string{from}.size(), to);
    const RunResult result = run_of(text);
    EXPECT_NEAR(fall_of(result), 0.5 * g * 0.15 * 0.15, 1e-3) << to;
    EXPECT_TRUE(result.motion->bolts.empty()) << to;
    EXPECT_TRUE(says(result, std::string{to}.starts_with("error") ? "as motion.support says" : "no bolt ties")) << to;
  }
}

TEST(MotionBolts, WhatIsNotCarriedOverIsSaid) {
  const std::string more = "shear_capacity = 1e5\n[support.shotcrete]\nthickness = 0.1\nstrength = 1e6\non = \"all\"\n";
  const RunResult result = run_of(hung(bolts_at("[0, 0, 0]", 0.5 * hung_weight, more), "duration = 0.1\n"));
  EXPECT_GT(fall_of(result), 0.02);
  EXPECT_TRUE(says(result, "motion: blocks move without the shotcrete"));
  EXPECT_TRUE(says(result, "their shear_capacity is left out"));
  EXPECT_TRUE(result.motion->supported);
}

// A block that has left the domain is held where it is, and must hold nothing: a deep block is tied to a shallow one
// beside it, which leaves first.
TEST(MotionBolts, NothingHangsOnWhatHasLeft) {
  std::string text = hung(
      "[[support.bolts]]\nat = [[0.2, 0, 0]]\ndirection = [-1, 0, 0.8]\nlength = 0.9\n"
      "tendon_capacity = 1e9\nplate_capacity = 1e9\nbond_strength = 1e9\nanchorage = 0.2\n",
      "duration = 0.9\n");
  const std::string top = "[[-1.2, -1.2, 1.5], [1.2, -1.2, 1.5], [1.2, 1.2, 1.5], [-1.2, 1.2, 1.5]]\n";
  text.replace(text.find(top), top.size(),
               "[[0, -1.2, 1.5], [1.2, -1.2, 1.5], [1.2, 1.2, 1.5], [0, 1.2, 1.5]]\n"
               "[[joint]]\npolygon = [[-1.2, -1.2, 0.8], [0, -1.2, 0.8], [0, 1.2, 0.8], [-1.2, 1.2, 0.8]]\n"
               "[[joint]]\npolygon = [[0, -1.2, -0.3], [0, 1.2, -0.3], [0, 1.2, 1.8], [0, -1.2, 1.8]]\n");
  const RunResult result = run_of(text);
  ASSERT_EQ(result.motion->blocks.size(), 2U);
  EXPECT_TRUE(result.motion->converged) << result.motion->stopped_why;
  EXPECT_EQ(result.motion->bolts.size(), 1U);
  EXPECT_EQ(result.motion->bolts_broken(), 0U);
  for (const MotionBlock& block : result.motion->blocks) {
    EXPECT_TRUE(block.left);
    EXPECT_EQ(block.bolts, 1U);
    EXPECT_EQ(block.bolts_broken, 0U);
  }
}

/// A slab, or a wedge, on planes that come out of a slope that faces east, with bolts into the slope.
std::string on_a_slope(bool wedge, const std::string& direction, double tendon, const std::string& more) {
  std::string bolts;
  for (const auto& [x, y, z] : {std::tuple{12.5, 2.4, 9.0}, {12.5, 3.6, 9.0}, {12.0, 2.2, 10.0}, {12.0, 3.8, 10.0}}) {
    bolts +=
        (bolts.empty() ? "[" : ", [") + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + "]";
  }
  const std::string planes = wedge ? "[[joint]]\nplane = { through = [14, 3, 6], dip = 50, dip_direction = 130 }\n"
                                     "[[joint]]\nplane = { through = [14, 3, 6], dip = 50, dip_direction = 50 }\n"
                                   : "[[joint]]\nplane = { through = [14, 3, 6], dip = 40, dip_direction = 90 }\n"
                                     "[[joint]]\nplane = { through = [9, 3, 8], dip = 80, dip_direction = 270 }\n"
                                     "[[joint]]\nplane = { through = [12, 2, 6], dip = 89, dip_direction = 180 }\n"
                                     "[[joint]]\nplane = { through = [12, 4, 6], dip = 89, dip_direction = 0 }\n";
  return "[domain]\nbox = { min = [0, -5, 0], max = [30, 11, 12.5] }\n" + planes +
         "[joints.default]\nfriction = 20\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
         "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n"
         "[stability]\ngroups = \"off\"\n[support]\n[[support.bolts]]\nat = [" +
         bolts + "]\ndirection = " + direction + "\nlength = 12\ntendon_capacity = " + std::to_string(tendon) +
         "\nplate_capacity = 1e9\nbond_strength = 1e9\nanchorage = 0.3\n" + more;
}

// The factor of the check with bolts is 1 at some tendon; there motion begins.
TEST(MotionBolts, InclinedBoltsHoldWhereTheCheckSaysSo) {
  for (const bool wedge : {false, true}) {
    for (const std::string direction : {"[-1, 0, 0]", "[-1, 0.1, -0.3]", "[-1, 0, 0.1]"}) {
      const auto factor = [&](double tendon) {
        const RunResult result = run_of(on_a_slope(wedge, direction, tendon, ""));
        EXPECT_EQ(result.support->blocks.size(), 1U);
        return result.support->blocks.at(0).factor_with_support.value_or(0);
      };
      double low = 1e3, high = 1e7;
      ASSERT_LT(factor(low), 1);
      ASSERT_GT(factor(high), 1);
      while (high > 1.0005 * low) {
        const double middle = std::sqrt(low * high);
        (factor(middle) > 1 ? high : low) = middle;
      }
      for (const double share : {0.99, 1.01}) {
        const RunResult result =
            run_of(on_a_slope(wedge, direction, share * high, "[motion]\nduration = 0.2\nerror = false\n"));
        ASSERT_TRUE(result.motion->converged) << result.motion->stopped_why;
        ASSERT_GE(result.motion->blocks.size(), 1U);
        EXPECT_GE(result.motion->bolts.size(), 2U);
        EXPECT_EQ(result.motion->moved() > 0, share < 1) << wedge << direction << share;
        EXPECT_EQ(result.motion->bolts_broken() > 0, share < 1) << wedge << direction << share;
      }
    }
  }
}

// An angle law takes of the tension what the movement without bolts says.
TEST(MotionBolts, TheirAngleLawCounts) {
  const std::string direction = "[-1, 0, 0]", motion = "[motion]\nduration = 0.2\nerror = false\n";
  const auto slid = [&](double tendon, const std::string& law, const std::string& more) {
    return run_of(on_a_slope(false, direction, tendon, "angle = \"" + law + "\"\n" + more));
  };
  for (const std::string law : {"full", "cosine", "linear"}) {
    double low = 1e3, high = 1e7;
    while (high > 1.0005 * low) {
      const double middle = std::sqrt(low * high);
      const auto factor = slid(middle, law, "").support->blocks.at(0).factor_with_support;
      (factor.value_or(0) > 1 ? high : low) = middle;
    }
    for (const double share : {0.99, 1.01}) {
      EXPECT_EQ(slid(share * high, law, motion).motion->moved() > 0, share < 1) << law << share;
    }
  }
}

// Bolts that are put in after a stage hold nothing of what leaves in it.
TEST(MotionBolts, WhatIsPutInLaterHoldsNothingThatHasLeft) {
  std::string text =
      hung(bolts_at("[0, 0, 0]", 10 * hung_weight, "after_stage = STAGE\n"), "release = \"stage\"\nduration = 0.4\n");
  text.insert(
      text.find("[joints.default]"),
      "[[excavation]]\nname = \"first\"\nkind = \"polyhedron\"\nstage = 1\nbox = { min = [-4, -4, -1], max = [4, 4, "
      "0.2] }\n[[excavation]]\nname = \"then\"\nkind = \"polyhedron\"\nstage = 2\nbox = { min = [-4, -4, -1], max = "
      "[-3, 4, 0.4] }\n");
  text.replace(text.find("at = [[0, 0, 0]]"), 16, "at = [[0, 0, 0.2]]");
  for (const auto& [stage, moves] : {std::pair{"0", false}, {"1", true}, {"2", true}}) {
    std::string now = text;
    now.replace(now.find("STAGE"), 5, stage);
    const RunResult result = run_of(now);
    ASSERT_EQ(result.motion->blocks.size(), 1U);
    EXPECT_EQ(result.motion->moved() > 0, moves) << stage;
    EXPECT_EQ(says(result, "leave before it is put in"), moves) << stage;
  }
}

TEST(MotionBolts, ARunThatWasStoppedIsTheRunThatWasNot) {
  const std::string text =
      hung(bolts_at("[0.2, 0, 0], [-0.2, 0, 0]", 0.4 * hung_weight, "ductility = 0.02\n"), "duration = 0.3\n");
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto whole = run(scene, {.threads = 1}, timer, progress);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->motion->bolts_broken(), 2U);
  for (const std::uint64_t steps : {4U, 20U}) {
    const auto half = run(
        scene,
        {.threads = 1, .motion = {.stop = [steps, asked = std::uint64_t{0}]() mutable { return asked++ >= steps; }}},
        timer, progress);
    ASSERT_TRUE(half.has_value());
    const auto rest =
        run(scene, {.threads = 2, .motion = {.from = SavedRun{"half", half->motion->state}}}, timer, progress);
    ASSERT_TRUE(rest.has_value()) << describe(rest.error().front());
    EXPECT_EQ(rest->motion->state, whole->motion->state);
    EXPECT_EQ(rest->notes, whole->notes);
    for (std::size_t k = 0; k < 2; ++k) {
      const MotionBolt &a = rest->motion->bolts.at(k), &b = whole->motion->bolts.at(k);
      EXPECT_EQ(a.largest, b.largest);
      EXPECT_EQ(a.lengthened, b.lengthened);
      EXPECT_EQ(a.broken_at, b.broken_at);
    }
  }
}

}  // namespace
}  // namespace cleave::scene::test::motion_bolts_test
