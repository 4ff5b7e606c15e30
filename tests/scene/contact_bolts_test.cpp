#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cleave/scene2d/contact.hpp"

// Bolts of scenes of contact.
namespace cleave::scene::contact_bolts_test {
namespace {

constexpr double g = 9.81;

std::string first_problem(const std::string& text) {
  const auto scene = parse_contact(text, "s.toml");
  return scene ? "" : describe(scene.error().front());
}

ContactResult ran(const std::string& text, const ContactRun& how = {}) {
  auto scene = parse_contact(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  if (!scene) return {};
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(*scene, 1, timer, progress, how);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return result ? *std::move(result) : ContactResult{};
}

/// Three blocks of 1 x 1 m under a roof; the lowest is what a mechanical bolt holds all of.
const std::string hanging =
    "[[body]]\nname = \"roof\"\nfixed = true\nrectangle = { corner = [-2, 3], width = 4, height = 2 }\n"
    "[[body]]\nname = \"block\"\ndensity = 2600\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n"
    "repeat = { count = 3, shift = [0, 1] }\n";
const std::string at_rest = "[contact]\nstatic = true\nstep = 0.05\n";
const std::string bolt = "[[bolt]]\nname = \"b\"\nhead = [0, 0]\ntoe = [0, 4.5]\nspacing = 2\n";

TEST(ContactBolts, EachKindHoldsWhatHangsOnIt) {
  const double weight = 2600 * g;
  // Of the whole anchor: from plate to anchor, all three blocks.
  const ContactResult end = ran(at_rest + bolt +
                                "kind = \"mechanical\"\nplate_capacity = 3e5\nanchor_capacity = 3e5\nanchorage = "
                                "0.5\ntendon_capacity = 2e5\n" +
                                hanging);
  ASSERT_EQ(end.bolts.size(), 1U);
  EXPECT_EQ(end.bolts[0].first, "block 1");
  EXPECT_EQ(end.bolts[0].second, "roof");
  EXPECT_NEAR(end.bolts[0].force.si() / (2 * 3 * weight), 1, 1e-6);
  EXPECT_NEAR(end.bolts[0].capacity.si(), 2e5, 1e-6);
  EXPECT_EQ(end.bolts[0].state, BoltState::holds);
  // E A / L of one bolt, per metre.
  const double stiffness = 200e9 * std::numbers::pi / 4 * 0.025 * 0.025 / 4 / 2;
  EXPECT_NEAR(-(end.bodies[1].centroid.y - end.bodies[1].start.y) * stiffness / (3 * weight), 1, 1e-4);
  // Gripped all along: a bar a joint, each carries what is below it.
  const ContactResult bar = ran(at_rest + bolt + "bond_strength = 1.5e5\ntendon_capacity = 2e5\n" + hanging);
  ASSERT_EQ(bar.bolts.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(bar.bolts[k].force.si() / (2 * (static_cast<double>(k) + 1) * weight), 1, 1e-6);
    const double above = static_cast<double>(k) + 1;
    EXPECT_NEAR(bar.bolts[k].capacity.si(), std::min(2e5, 1.5e5 * std::min(above, 4.5 - above)), 1e-3);
  }
  // A cable grips nothing behind its plate: what is there hangs on the plate.
  const ContactResult cable = ran(at_rest + bolt +
                                  "kind = \"cable\"\nfree_length = 3\nbond_strength = 2e5\nplate_capacity = "
                                  "2e5\ntendon_capacity = 2.5e5\n" +
                                  hanging);
  ASSERT_EQ(cable.bolts.size(), 1U);
  EXPECT_EQ(cable.bolts[0].first, "block 1");
  EXPECT_NEAR(cable.bolts[0].force.si() / (2 * 3 * weight), 1, 1e-6);
  EXPECT_NEAR(cable.bolts[0].capacity.si(), 2e5, 1e-3);
}

// A load that comes at once pulls with twice its weight, if steps are short enough to see it.
TEST(ContactBolts, StepsThatDampASwingAreSaid) {
  const auto hung = [](const std::string& contact) {
    return ran("[contact]\nduration = 0.1\nrigid = true\n" + contact +
               "[[body]]\nname = \"roof\"\nfixed = true\noutline = [[-3, 0], [3, 0], [3, 1], [-3, 1]]\n"
               "[[body]]\nname = \"b\"\ndensity = 2600\nrectangle = { corner = [-0.5, -1], width = 1, height = 1 }\n"
               "[[bolt]]\nhead = [0, -1]\ntoe = [0, 0.9]\nplate_capacity = 1e8\nbond_strength = 1e8\n"
               "tendon_capacity = 42000\n");
  };
  const auto said = [](const ContactResult& result) {
    return std::ranges::count_if(result.notes, [](const std::string& note) { return note.contains("swings on it"); });
  };
  const double weight = 2600 * g;
  const ContactResult coarse = hung("estimate = true\n"), fine = hung("step = 5e-5\nestimate = true\n");
  EXPECT_EQ(said(coarse), 1);
  EXPECT_LT(coarse.bolts[0].largest.si(), 1.3 * weight);
  EXPECT_FALSE(coarse.error);
  EXPECT_TRUE(coarse.no_estimate.contains("swings with a period of")) << coarse.no_estimate;
  EXPECT_EQ(said(fine), 0);
  EXPECT_EQ(said(hung("step = 2e-4\n")), 1);  // 1.4 % too little
  EXPECT_EQ(fine.bolts[0].state, BoltState::broken);
  // It had come to its capacity when it broke, somewhere in a step, and to no more.
  EXPECT_EQ(fine.bolts[0].largest, fine.bolts[0].capacity);
}

TEST(ContactBolts, TheyBreakYieldAndPressAsTheirNumbersSay) {
  const double weight = 2600 * g;
  const auto capacity = [](double n) { return "bond_strength = 1e8\ntendon_capacity = " + std::to_string(n) + "\n"; };
  const ContactResult holds = ran(at_rest + bolt + capacity(2 * 3 * weight * 1.02) + hanging);
  const ContactResult breaks = ran(at_rest + bolt + capacity(2 * 3 * weight * 0.98) + hanging);
  EXPECT_EQ(holds.bolts[2].state, BoltState::holds);
  EXPECT_TRUE(holds.converged);
  EXPECT_FALSE(breaks.converged);  // nothing holds it then
  EXPECT_EQ(breaks.bolts[2].state, BoltState::broken);
  ASSERT_TRUE(breaks.bolts[2].broken_at.has_value());
  // What lengthens at its capacity lets it down slowly: less weight, less pull, and what it takes is written down.
  const ContactResult yields = ran("[contact]\nduration = 0.4\nstep = 0.002\n" + bolt + capacity(2 * 3 * weight * 0.9) +
                                   "ductility = 1\nyoung = 9e14\ndiameter = 0.1\n" + hanging);
  EXPECT_EQ(yields.bolts[2].state, BoltState::yields);
  EXPECT_NEAR(yields.largest_displacement, 0.5 * 0.1 * g * 0.16, 0.01 * 0.5 * 0.1 * g * 0.16);
  const ContactHistory& last = yields.history.back();
  EXPECT_NEAR(last.bolts / (0.9 * 3 * weight * yields.bolts[2].lengthened.si()), 1, 1e-6);
  EXPECT_NEAR((last.kinetic + last.gravity + last.elastic + last.bolts) / -last.gravity, 0, 1e-3);
  // Bolted to the floor.
  const std::string floor =
      "[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-2, -1], width = 4, height = 1 }\n"
      "[[body]]\nname = \"block\"\ndensity = 2600\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n";
  const ContactResult pressed = ran(at_rest +
                                    "[[bolt]]\nhead = [0, 1]\ntoe = [0, -0.5]\nkind = \"mechanical\"\nplate_capacity = "
                                    "3e5\nanchor_capacity = 3e5\nanchorage = 0.25\ntendon_capacity = 2e5\npretension = "
                                    "1e5\n" +
                                    floor);
  EXPECT_NEAR(-pressed.bodies[0].force.y / (weight + 1e5), 1, 1e-4);
  // Later.
  const ContactResult late =
      ran("[contact]\nduration = 0.4\nstep = 0.003\n" + bolt + capacity(1e7) + "installed = 0.1\n" + hanging);
  EXPECT_GT(late.largest_displacement, 0.5 * g * 0.01);
  EXPECT_LT(late.largest_displacement, 0.5 * g * 0.01 + 0.02);
  const ContactResult never = ran("[contact]\nduration = 0.1\n" + bolt + capacity(1e7) + "installed = 0.2\n" + hanging);
  EXPECT_EQ(never.bolts[0].state, BoltState::absent);
}

TEST(ContactBolts, AnElasticRunHasThemToo) {
  const ContactResult result = ran("[rock]\nyoung = 1e9\npoisson = 0.25\n" + at_rest + "rigid = false\n" + bolt +
                                   "kind = \"mechanical\"\nplate_capacity = 3e5\nanchor_capacity = 3e5\nanchorage = "
                                   "0.5\ntendon_capacity = 2e5\n" +
                                   hanging);
  ASSERT_EQ(result.bolts.size(), 1U);
  EXPECT_TRUE(result.elastic);
  EXPECT_NEAR(result.bolts[0].force.si() / (2 * 3 * 2600 * g), 1, 1e-5);
}

TEST(ContactBolts, ARunThatWasStoppedKeepsThem) {
  const std::string text = "[contact]\nduration = 0.2\nstep = 0.002\nframes = 5\n" + bolt +
                           "bond_strength = 1e8\ntendon_capacity = 150000\nductility = 0.01\n" + hanging;
  const ContactResult whole = ran(text);
  EXPECT_EQ(whole.bolts[2].state, BoltState::broken);
  for (const int at : {1, 20, 60}) {
    const ContactResult half = ran(text, {.stop = [at, asked = 0]() mutable { return asked++ >= at; }});
    const ContactResult rest = ran(text, {.from = SavedRun{"half", half.state}});
    EXPECT_TRUE(rest.state == whole.state) << at;
    ASSERT_EQ(rest.bolts.size(), whole.bolts.size());
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(rest.bolts[k].largest, whole.bolts[k].largest);
      EXPECT_EQ(rest.bolts[k].broken_at, whole.bolts[k].broken_at);
    }
  }
}

TEST(ContactBolts, WhatIsWrongWithThemIsSaid) {
  const std::string good = "head = [0, 0]\ntoe = [0, 4.5]\ntendon_capacity = \"200 kN\"\n";
  const std::string grip = "bond_strength = 1e5\n";
  const std::vector<std::pair<std::string, std::string>> bad{
      {good, "bolt[1].bond_strength: is missing"},
      {"toe = [0, 4.5]\ntendon_capacity = 2e5\n" + grip, "bolt[1].head: is missing"},
      {"head = [0, 0]\ntoe = [0, 4.5]\n" + grip, "bolt[1].tendon_capacity: is missing"},
      {"head = [0, -3]\ntoe = [0, 4.5]\ntendon_capacity = 2e5\n" + grip, "bolt[1].head: lies in no body"},
      {"head = [0, 0]\ntoe = [0, 9]\ntendon_capacity = 2e5\n" + grip, "bolt[1].toe: lies in no body"},
      {"head = [0, 0]\ntoe = [0, 0.5]\ntendon_capacity = 2e5\n" + grip, "holds nothing together"},
      {good + grip + "anchorage = 1\n", "bolt[1].anchorage: has no meaning for kind = \"grouted\""},
      {good + "kind = \"mechanical\"\nanchor_capacity = 1e5\nanchorage = 1\n", "bolt[1].plate_capacity: is missing"},
      {good + "kind = \"mechanical\"\nanchor_capacity = 1e5\nplate_capacity = 1e5\nanchorage = 3\n",
       "longer than the bolt lies in the body at its toe"},
      {good + grip + "pretension = 3e5\n", "bolt[1].pretension: is more than its capacity of 100000 N"},
      {good + "kind = \"cable\"\nfree_length = 1.5\nbond_strength = 1e5\n", "with no capacity at all"},
      {good + "kind = \"cabel\"\n" + grip, "did you mean \"cable\""},
      {good + grip + "lenght = 3\n", "bolt[1].lenght"},
      {good + grip + "stretch = 1e-300\n", "bolt[1].stretch: is 1e-300; give a number from 0.001"},
      {good + grip + "diameter = 1e-200\n", "bolt[1].diameter: is 1e-200; give a number from 0.0001"},
  };
  for (const auto& [text, want] : bad) {
    const std::string got = first_problem(at_rest + "[[bolt]]\n" + text + hanging);
    EXPECT_NE(got.find(want), std::string::npos) << got << "\nwanted " << want;
  }
  EXPECT_NE(first_problem(at_rest + "[[bolt]]\ninstalled = 1\n" + good + grip + hanging).find("knows no time"),
            std::string::npos);
}

}  // namespace
}  // namespace cleave::scene::contact_bolts_test
