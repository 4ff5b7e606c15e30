#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/archive.hpp"
#include "contact_families.hpp"
#include "elastic_body.hpp"
#include "scenes.hpp"

// A run that is saved and gone on with is the run that was not.
namespace cleave::dbem::saved_test {
namespace {

using namespace scenes;
using support::elastic_body;

struct Case {
  std::vector<Body> bodies;
  Laws laws;
  WorldOptions options;
  [[nodiscard]] World made() const { return make(bodies, laws, options); }
};

/// What must be so where the run is saved, or the test shows nothing.
using Wanted = std::function<bool(const World&, const StepReport&)>;

/// Runs `steps` steps; from wherever `wanted` holds (`most` of those steps, spread out), another world goes on from
/// what was saved, and comes to the same bytes.
void saved_anywhere(const Case& setup, std::size_t steps, const Wanted& wanted, std::size_t most = 8) {
  World whole = setup.made();
  std::vector<std::string> saved;
  std::vector<std::size_t> at;
  for (std::size_t k = 1; k <= steps; ++k) {
    const auto report = whole.step();
    ASSERT_TRUE(report.has_value()) << describe(report.error());
    if (k == steps || !wanted(whole, *report)) continue;
    saved.push_back(whole.saved());
    at.push_back(k);
  }
  ASSERT_FALSE(saved.empty()) << "nothing to see where it was saved";
  const std::string end = whole.saved();
  for (std::size_t pick = 0; pick < std::min(most, saved.size()); ++pick) {
    const std::size_t q = pick * (saved.size() - 1) / std::max<std::size_t>(1, std::min(most, saved.size()) - 1);
    World other = setup.made();
    const auto restored = other.restore(saved[q]);
    ASSERT_TRUE(restored.has_value()) << describe(restored.error());
    EXPECT_TRUE(other.saved() == saved[q]);
    for (std::size_t b = 0; b < other.size(); ++b) EXPECT_EQ(other.body(b).name, whole.body(b).name);
    for (std::size_t k = at[q]; k < steps; ++k) ASSERT_TRUE(other.step().has_value());
    EXPECT_TRUE(other.saved() == end) << "saved after step " << at[q] << " of " << steps;
    for (std::size_t b = 0; b < other.size(); ++b) {
      EXPECT_EQ(other.outline(b), whole.outline(b));
      EXPECT_EQ(other.velocity(b), whole.velocity(b));
    }
    EXPECT_EQ(other.energy().lost, whole.energy().lost);
  }
}

const Wanted always = [](const World&, const StepReport&) { return true; };

TEST(SavedTest, AFallingArchAndStepsThatGrow) {
  saved_anywhere({arch(12, 0.1), law(0.7), {.step = 5e-3}}, 120, always);
  // Steps that grow count the calm ones before them.
  saved_anywhere({stack(3), law(0.5), {.step = 1e-4, .longest_step = 5e-3, .adaptive = true, .sleep = false}}, 40,
                 [](const World&, const StepReport& r) { return r.step > 1e-4; });
  // The error of position compares with the step before.
  std::vector<Body> bodies = slider(radians(30));
  bodies[1].forces.push_back({.at = {5.5, 3}, .force = {4e3, 0}, .factor = [](double t) { return std::sin(30 * t); }});
  saved_anywhere({bodies, law(0.2), {.step = 5e-2, .position_error = 1e-6}}, 60,
                 [](const World&, const StepReport& r) { return r.shortened > 0; });
}

TEST(SavedTest, ElasticDampedAndShaken) {
  Body below = elastic_body(rectangle(-0.5, 0, 1, 1), {.young = 1e8}, 2, 12);
  Body above = elastic_body(turned(rectangle(-0.4, 1.05, 0.8, 1), 0.02), {.young = 1e8}, 2, 12);
  below.modes->damping = 0.05;
  Case setup{{fixed("floor", rectangle(-5, -1, 10, 1)), below, above}, law(0.4), {.step = 1e-3}};
  saved_anywhere(setup, 150, always);
  setup.options.mass_damping = 3;
  setup.options.ground = [](double t) { return Vec2{4 * std::sin(40 * t), 0}; };
  saved_anywhere(setup, 150, always);
}

TEST(SavedTest, BrokenBondsSlipAndDilation) {
  Laws laws = law(std::tan(radians(35)));
  laws.otherwise.cohesion = 2e3;
  laws.otherwise.tension = 1e3;
  laws.otherwise.residual_cohesion = 1e3;
  laws.otherwise.residual_friction = std::tan(radians(30));
  Case setup{slider(radians(20)), laws, {.step = 2e-3}};
  setup.bodies[1].forces.push_back(
      {.at = {5.5, 0.4}, .force = {-9e3, 0}, .factor = [](double t) { return t < 0.05 || t > 0.2 ? 0.0 : 1.0; }});
  // Broken by slip, still closed; what is left holds it where friction alone would not.
  saved_anywhere(setup, 200, [](const World& w, const StepReport&) {
    return w.time() > 0.1 && std::ranges::none_of(w.contacts(), &Contact::bonded);
  });
  laws.otherwise.residual_friction = {};
  laws.otherwise.dilation = std::tan(radians(10));
  laws.otherwise.dilation_slip = metres(0.02);
  laws.otherwise.normal_stiffness = 1e8;
  laws.otherwise.shear_stiffness = 5e7;
  Case rough{{fixed("floor", rectangle(-20, -1, 40, 1)), block("block", rectangle(0, 0, 2, 1))}, laws, {.step = 2e-3}};
  rough.bodies[1].forces.push_back({.at = {1, 0.5}, .force = {1.2 * 2 * 2600 * g, 0}});
  saved_anywhere(rough, 150, [](const World& w, const StepReport&) { return w.displacement(1).x > 1e-3; });
}

TEST(SavedTest, SleepersAndWhatWakesThem) {
  std::vector<Body> bodies = stack(4);
  bodies.push_back(block("far", rectangle(3, 0, 1, 1)));
  bodies.push_back(block("late", rectangle(-0.3, 6, 0.6, 0.6)));
  const Case setup{bodies, law(0.5), {.step = 5e-3}};
  saved_anywhere(setup, 300, [](const World& w, const StepReport& r) { return w.asleep(2) && r.asleep >= 5; });
  saved_anywhere(setup, 300, [](const World& w, const StepReport&) { return w.time() > 0.1 && !w.asleep(2); });
}

// More slips that end within one step than steps may be ended one after the other: how many were is remembered.
TEST(SavedTest, SlipsThatEndOneAfterTheOther) {
  std::vector<Body> bodies{fixed("floor", rectangle(-1, -1, 40, 1))};
  for (int k = 0; k < 8; ++k) {
    bodies.push_back(block(fmt::format("b{}", k), rectangle(2.0 * k, 0, 1, 0.2)));
    bodies.back().velocity = {0.3 * g * (0.081 + 0.002 * k), 0};
  }
  const Case setup{bodies, law(0.3), {.step = 0.02, .sleep = false}};
  saved_anywhere(setup, 16, [](const World&, const StepReport& r) { return r.slip_ends > 0; }, 16);
  World world = setup.made();
  std::size_t in_a_row = 0, most = 0;
  for (int k = 0; k < 16; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value());
    in_a_row = report->slip_ends > 0 ? in_a_row + 1 : 0;
    most = std::max(most, in_a_row);
  }
  EXPECT_EQ(most, 4U);
  // The first ones stop where they should, v^2 / (2 mu g), to a ten thousandth of the step.
  for (std::size_t b = 1; b <= 4; ++b) {
    const double v = bodies[b].velocity.x;
    EXPECT_NEAR(world.displacement(b).x, v * v / (2 * 0.3 * g), 1e-8) << b;
  }
}

TEST(SavedTest, WhatBouncesAndRattles) {
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)),
                           block("a", turned(rectangle(-0.5, 0.3, 1, 0.4), 0.2)),
                           block("b", turned(rectangle(-0.4, 1.5, 0.7, 0.5), -0.4))};
  bodies[2].spin = 3;
  saved_anywhere({bodies, law(0.3, 0.6), {.step = 4e-3}}, 300, always, 12);
  saved_anywhere(
      {stack(5), law(0.4), {.gravity = {3, -9.81}, .step = 5e-3}}, 60,
      [](const World&, const StepReport& r) { return r.impact; }, 12);
}

TEST(SavedTest, FamiliesOfAwkwardContacts) {
  for (std::size_t family = 0; family < testing::contact_family_names.size(); ++family) {
    for (const std::uint64_t seed : {3U, 4U}) {
      const auto scene = testing::make_contact_scene(static_cast<testing::ContactFamily>(family), seed);
      const auto made = [&] { return World::make(scene.bodies, scene.laws, scene.options); };
      auto whole = made(), other = made();
      if (!whole) continue;
      for (std::size_t k = 0; k < 40; ++k) (void)whole->step();
      const std::string half = whole->saved();
      ASSERT_TRUE(other->restore(half).has_value()) << testing::contact_family_names[family];
      for (std::size_t k = 0; k < 40; ++k) {
        const auto first = whole->step(), then = other->step();
        ASSERT_EQ(first.has_value(), then.has_value());
        if (!first) break;
      }
      EXPECT_TRUE(whole->saved() == other->saved()) << testing::contact_family_names[family] << ' ' << seed;
    }
  }
}

TEST(SavedTest, DamagedTruncatedAndForeignBytesAreRefused) {
  const Case setup{stack(2), law(0.5), {.step = 5e-3}};
  World world = setup.made();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world.step().has_value());
  const std::string saved = world.saved();
  World other = setup.made();
  for (std::size_t size = 0; size < saved.size(); ++size) {
    ASSERT_FALSE(other.restore(saved.substr(0, size)).has_value()) << size;
  }
  for (std::size_t k = 0; k < saved.size(); ++k) {
    std::string wrong = saved;
    wrong[k] = static_cast<char>(wrong[k] ^ 0x10);
    ASSERT_FALSE(other.restore(wrong).has_value()) << k;
  }
  const auto refusal = [&](World of, const std::string& bytes) {
    const auto done = of.restore(bytes);
    return done ? std::string{"none"} : describe(done.error());
  };
  EXPECT_EQ(refusal(other, "schema = 1\n"), "is no saved world");
  EXPECT_EQ(refusal(other, ""), "is no saved world");
  EXPECT_EQ(refusal(other, sealed("cleave-world", 99, "x")), "was saved by another version");
  EXPECT_EQ(refusal(other, saved + " "), "is cut short or damaged");
  EXPECT_EQ(refusal(make(stack(3), law(0.5), setup.options), saved), "is of a world of other bodies, laws or gravity");
  EXPECT_EQ(refusal(make(stack(2), law(0.6), setup.options), saved), "is of a world of other bodies, laws or gravity");
  EXPECT_EQ(refusal(make(stack(2), law(0.5), {.gravity = {0, -1}}), saved),
            "is of a world of other bodies, laws or gravity");
  EXPECT_EQ(other.time(), 0);  // as it was
  // Steps of another length go on from it.
  World longer = make(stack(2), law(0.5), {.step = 1e-2});
  ASSERT_TRUE(longer.restore(saved).has_value());
  EXPECT_EQ(longer.step().value().step, 1e-2);
}

/// Whoever makes the sum right again can still not make a world that cannot be.
TEST(SavedTest, ForgedBytesAreRefusedOrAreAWorld) {
  const Case setup{arch(3, 0.3), law(0.5), {.step = 5e-3}};
  World world = setup.made();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world.step().has_value());
  const std::string saved = world.saved();
  const std::string whole{unsealed("cleave-world", 3, saved).value()};
  std::size_t refused = 0, taken = 0;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    for (const int bit : {0x01, 0x80}) {
      std::string bytes = whole;
      bytes[k] = static_cast<char>(bytes[k] ^ bit);
      World other = setup.made();
      const bool good = other.restore(sealed("cleave-world", 3, bytes)).has_value();
      (good ? taken : refused) += 1;
      if (!good) continue;
      World again = setup.made();  // the first step of the options is this world's own
      ASSERT_TRUE(again.restore(other.saved()).has_value());
      EXPECT_TRUE(again.saved() == other.saved()) << k;
    }
    const std::string shorter = whole.substr(0, k);
    EXPECT_FALSE(setup.made().restore(sealed("cleave-world", 3, shorter)).has_value());
  }
  EXPECT_GT(refused, 100U);
  EXPECT_GT(taken, 100U);
}

}  // namespace
}  // namespace cleave::dbem::saved_test
