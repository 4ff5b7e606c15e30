#include <fmt/format.h>

#include <string>
#include <string_view>

#include "cleave/realize/monte_carlo.hpp"
#include "run_scene.hpp"

// What a verdict leaves out, or is not of, is said; an ensemble says what its replay says.
namespace cleave::scene {
namespace {

using namespace test;

std::string across(std::string_view set, double x1, double z1, double x2, double z2) {
  return fmt::format(
      "[[joint]]\nset = \"{0}\"\npolygon = [[{1}, 1.9, {2}], [{3}, 1.9, {4}], [{3}, 8.1, {4}], [{1}, 8.1, {2}]]\n", set,
      x1, z1, x2, z2);
}
std::string walls(double x1, double z1, double x2, double z2) {
  std::string text;
  for (const double y : {2.0, 8.0}) {
    text += fmt::format(
        "[[joint]]\nset = \"W\"\npolygon = [[{1}, {0}, {2}], [{3}, {0}, {2}], [{3}, {0}, {4}], [{1}, {0}, {4}]]\n", y,
        x1, z1, x2, z2);
  }
  return text;
}

/// 1 x 6 x 4 m beside a crack in a wall: with 0.3 g outward it topples (0.3 > 1/4) and does not slide (0.3 < tan 40).
std::string calm_column(std::string_view rest) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [20, 10, 14] }\n" + across("B", 18.95, 10, 20.05, 10) +
         across("C", 19, 9.95, 19, 14.05) + walls(18.95, 9.9, 20.1, 15) +
         "[joints.B]\nfriction = 40\n[joints.C]\nfriction = 0\n[joints.W]\nfriction = 0\n[rock]\ndensity = 2700\n"
         "[stability]\nfree = [\"top\", \"east\"]\n" +
         std::string{rest};
}
std::string column(std::string_view stability, std::string_view rest = "") {
  return calm_column(fmt::format("seismic = [0.3, 0, 0]\n{}{}", stability, rest));
}
std::string bolt_at_its_head(double newtons) {
  return fmt::format(
      "[support]\n[[support.bolts]]\nat = [[20, 5, 13.5]]\ndirection = [-1, 0, 0]\nlength = 4\ntendon_capacity = {}\n"
      "plate_capacity = 1e6\nbond_strength = 1e6\nanchorage = 0.3\n",
      newtons);
}
constexpr std::string_view two = "[monte_carlo]\nrealizations = 2\n";

stochastic::Record record_of(const std::string& text) {
  const Scene scene = scene_of(text);
  return make_record(scene, shared_by_realizations(scene), 1);
}

TEST(VerdictNotes, EnsemblesCountWhatTurns) {
  const stochastic::Record flagged = record_of(column("", two));
  EXPECT_EQ(flagged.turning, 1U);
  EXPECT_EQ(flagged.all.count, 0U);
  const stochastic::Record decided = record_of(column("rotation = \"decide\"\n", two));
  EXPECT_EQ(decided.turning, 1U);
  EXPECT_EQ(decided.all.count, 1U);
  EXPECT_FALSE(record_of(column("rotation = \"off\"\n", two)).turning.has_value());
  const stochastic::Record under =
      record_of(calm_column("[[load]]\nname = \"quake\"\nseismic = [0.3, 0, 0]\n" + std::string{two}));
  ASSERT_EQ(under.cases.size(), 1U);
  EXPECT_EQ(under.turning, 0U);
  EXPECT_EQ(under.cases[0].turning, 1U);
  EXPECT_EQ(stochastic::record_of(stochastic::line_of(under)), under);
}

// The moment about the toe: 0.3 W 2 m - W 0.5 m = 0.1 W m, W = 635.7 kN, taken by a bolt at 3.5 m of 18.2 kN.
TEST(VerdictNotes, EnsemblesAskOfWhatTurnsWhatTheirReplayAsks) {
  for (const double capacity : {2e3, 100e3}) {
    const std::string text = column("rotation = \"decide\"\n", bolt_at_its_head(capacity));
    const RunResult run = run_of(text);
    const stochastic::Record record = record_of(text + std::string{two});
    ASSERT_TRUE(run.figures.support && record.support) << capacity;
    EXPECT_EQ(run.figures.support->passes(), capacity > 10e3);
    EXPECT_EQ(record.support->needing, 1U) << capacity;
    EXPECT_EQ(record.support->not_held, run.figures.support->passes() ? 0U : 1U) << capacity;
  }
}

TEST(VerdictNotes, WhatOnlyTurnsIsNotHeldWhereTranslationAloneIsAsked) {
  const RunResult run = run_of(column("rotation = \"decide\"\ngroups = \"off\"\n", bolt_at_its_head(2e3)));
  EXPECT_EQ(run.figures.key_blocks->count, 1U);
  ASSERT_TRUE(run.figures.support);
  EXPECT_FALSE(run.figures.support->passes());
  EXPECT_EQ(run.figures.support->turning, 1U);
  EXPECT_EQ(run.figures.support->turning_not_held, 1U);
  EXPECT_EQ(notes_with(run, "whether it holds it is not known, and it does not pass"), 1U);
  EXPECT_EQ(notes_with(run, "factors and net forces that are those of translation"), 1U);
  const stochastic::Record record =
      record_of(column("rotation = \"decide\"\ngroups = \"off\"\n", bolt_at_its_head(2e3) + std::string{two}));
  EXPECT_EQ(record.support->not_held, 1U);
}

/// A slab on 35 degrees under the crest of a slope at 60 degrees; its friction is `friction`.
std::string slab(double friction, double cohesion, std::string_view stability) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [40, 10, 30] }\n[[excavation]]\nname = \"cut\"\nkind = \"slope\"\n"
         "profile = { origin = [0, 0], direction = 90, points = [[20, 30], [31.547005383792516, 10]] }\n" +
         across("B", 15.95904239778555, 25.680689102744164, 26.969160832489962, 17.971321178182446) +
         across("C", 16, 25.60201028092661, 16, 30.05) + walls(15.95, 5, 31.9, 31) +
         fmt::format(
             "[joints.B]\nfriction = {}\ncohesion = {}\n[joints.C]\nfriction = 30\n[joints.W]\nfriction = 0\n"
             "[rock]\ndensity = 2700\n[stability]\nfree = [\"top\"]\n{}",
             friction, cohesion, stability);
}

TEST(VerdictNotes, BoltsOfASingleBlockAreItsOwn) {
  const auto bolted = [](std::string_view at) {
    return fmt::format(
        "[support]\n[[support.bolts]]\nat = [{}]\ndirection = [-1, 0, 0]\nlength = 10\ntendon_capacity = 2e6\n"
        "plate_capacity = 1e6\nbond_strength = 200e3\nanchorage = 1\n",
        at);
  };
  const std::string three = bolted(
      "[23.464101615137757, 3, 24], [23.464101615137757, 5, 24], "
      "[23.464101615137757, 7, 24]");
  const RunResult noted = run_of(slab(30, 0, three)), alone = run_of(slab(30, 0, "groups = \"off\"\n" + three));
  ASSERT_TRUE(noted.group_support);
  ASSERT_EQ(noted.support->bolts.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const stability::BoltResult &bolt = noted.support->bolts[k], &own = alone.support->bolts[k];
    EXPECT_EQ(bolt.status, stability::BoltStatus::redundant);
    EXPECT_EQ(bolt.status, own.status);
    EXPECT_NEAR(bolt.angle, 35, 1e-9);
    EXPECT_EQ(bolt.used, own.used);
    EXPECT_EQ(bolt.serves, own.serves);
  }
  EXPECT_EQ(noted.figures.support->bolts_redundant, 3U);
  EXPECT_EQ(noted.figures.support->bolts_of_groups, 0U);
}

TEST(VerdictNotes, EarthquakesThatHoldTheRockAreSaid) {
  constexpr std::string_view words = "with the earthquake of [stability] the lowest factor of safety is ";
  EXPECT_EQ(notes_with(run_of(slab(35, 15e3, "seismic = [-0.15, 0, 0]\n")), words), 1U);
  EXPECT_EQ(notes_with(run_of(slab(35, 15e3, "seismic = [0.15, 0, 0]\n")), words), 0U);
}

TEST(VerdictNotes, SurchargesThatPullAreSaid) {
  constexpr std::string_view words = "surcharge[1] pulls at the faces it acts on";
  const auto loaded = [](double traction) {
    return slab(35, 15e3, fmt::format("surcharge = [{{ on = \"all\", traction = [0, 0, {}] }}]\n", traction));
  };
  EXPECT_EQ(notes_with(run_of(loaded(20e3)), words), 1U);
  EXPECT_EQ(notes_with(run_of(loaded(-20e3)), words), 0U);
  EXPECT_EQ(notes_with(run_of(slab(35, 15e3,
                                   "[[load]]\nname = \"up\"\nsurcharge = [{ on = \"all\", traction = [0, 0, "
                                   "20e3] }]\n")),
                       words),
            1U);
}

/// A slab of the roof, 5 x 6 x 1 m, beside one of 6 or more that reaches the south side of the domain at y = 0.
/// `loads`: keys of [stability], and tables after it.
std::string roof_slabs(double from, const std::string& loads = "") {
  std::string text =
      "[domain]\nbox = { min = [0, 0, 0], max = [40, 20, 30] }\n[[excavation]]\nname = \"T\"\nkind = \"tunnel\"\n"
      "section = { shape = \"rectangle\", width = 6, height = 6 }\naxis = [[20, -1, 10], [20, 21, 10]]\n";
  const auto side = [&](double x1, double y1, double x2, double y2) {
    text += fmt::format(
        "[[joint]]\nset = \"R\"\npolygon = [[{0}, {1}, 12.97], [{2}, {3}, 12.97], [{2}, {3}, 14.03], [{0}, {1}, "
        "14.03]]\n",
        x1, y1, x2, y2);
  };
  for (const double first : {7.0, from}) {
    const double last = first == from ? 7 : 13;
    for (const double x : {17.5, 22.5}) side(x, first - 0.03, x, last + 0.03);
    text += fmt::format(
        "[[joint]]\nset = \"R\"\npolygon = [[17.47, {0}, 14], [22.53, {0}, 14], [22.53, {1}, 14], [17.47, {1}, 14]]\n",
        first - 0.03, last + 0.03);
  }
  for (const double y : {7.0, 13.0}) side(17.47, y, 22.53, y);
  if (from > 0) side(17.47, from, 22.53, from);
  return text + "[joints.R]\nfriction = 30\n[rock]\ndensity = 2700\n[stability]\n" + loads +
         "[support]\nshotcrete = { thickness = 0.07, strength = 1e6 }\n";
}
/// Takes the walls and the roof of the tunnel away.
constexpr const char* wider =
    "[[excavation]]\nname = \"wider\"\nkind = \"tunnel\"\nstage = 2\n"
    "section = { shape = \"rectangle\", width = 8, height = 12 }\naxis = [[20, -1, 10], [20, 21, 10]]\n";

TEST(VerdictNotes, ShotcreteHeldAtWhatOnlyTheBorderHoldsIsSaid) {
  constexpr std::string_view words =
      "shotcrete at the edges of blocks is held at 1 block that only a side of the domain";
  EXPECT_EQ(notes_with(run_of(roof_slabs(-1)), words), 1U);
  const RunResult inside = run_of(roof_slabs(1));
  EXPECT_EQ(notes_with(inside, words), 0U);
  EXPECT_FALSE(inside.figures.support->passes());
  // Under a load case alone: without it a pressure carries the roof.
  const std::string carried = "surcharge = [{ on = \"T\", pressure = 60e3 }]\n";
  EXPECT_EQ(notes_with(run_of(roof_slabs(-1, carried)), words), 0U);
  const RunResult under =
      run_of(roof_slabs(-1, carried + "[[load]]\nname = \"empty\"\nsurcharge = [{ on = \"T\", pressure = -60e3 }]\n"));
  EXPECT_EQ(notes_with(under, "load case empty: shotcrete at the edges of blocks is held at 1 block"), 1U);
  EXPECT_EQ(notes_with(under, words), 1U);
  // And after a stage that leaves nothing of it.
  const RunResult staged = run_of(roof_slabs(-1, wider));
  EXPECT_EQ(notes_with(staged, "after stage 1: shotcrete at the edges of blocks is held at 1 block"), 1U);
  EXPECT_EQ(notes_with(staged, words), 1U);
}

TEST(VerdictNotes, SurchargesThatPullInAStageAreSaid) {
  const auto loaded = [](double pressure) {
    return roof_slabs(-1, fmt::format("surcharge = [{{ on = \"T\", pressure = {} }}]\n", pressure) + wider);
  };
  constexpr std::string_view words = "after stage 1: surcharge[1] pulls at the faces it acts on";
  EXPECT_EQ(notes_with(run_of(loaded(-5e3)), words), 1U);
  EXPECT_EQ(notes_with(run_of(loaded(5e3)), words), 0U);
}

/// An active and a passive wedge of a trough, one on each side of a vertical joint.
std::string trough(std::string_view load) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [40, 10, 18] }\n" +
         across("B", 10.427669037090372, 18.032139380484328, 20.03830222215595, 9.967860619515672) +
         across("B", 19.96169777784405, 9.967860619515672, 29.57233096290963, 18.032139380484328) +
         across("J", 20, 9.95, 20, 18.05) + walls(10.41597125924632, 9.9, 29.58402874075368, 19) +
         "[joints.B]\nfriction = 8\n[joints.J]\nfriction = 0\n[joints.W]\nfriction = 0\n[rock]\ndensity = 2700\n"
         "[stability]\nfree = [\"top\"]\n" +
         std::string{load};
}

TEST(VerdictNotes, ALoadThatMovesAGroupChangesSomething) {
  const RunResult run = run_of(trough(
      "[[load]]\nname = \"s\"\nsurcharge = [{ on = \"all\", within = { min = [0, 0, 17.9], max = [20, 10, 18.1] }, "
      "traction = [0, 0, -105948] }]\n"));
  EXPECT_EQ(notes_with(run, "load case s: 1 key group"), 1U);
  EXPECT_EQ(notes_with(run, "load case s changes the factor of safety of no block"), 0U);
}

// A roof slab falls either way; under 1 g more, downward, twice the force is needed.
TEST(VerdictNotes, OfCasesThatMoveTheSameTheOneThatNeedsMoreGoverns) {
  std::string text = roof_slabs(1);
  text.resize(text.find("[support]"));
  const RunResult run = run_of(text + "[[load]]\nname = \"surge\"\nseismic = [0, 0, -1]\n");
  EXPECT_EQ(run.figures.governing_case, "surge");
}

/// Two blocks on a broken surface, parted by a vertical joint, of which the upper pushes the lower one out.
std::string broken_slide(std::string_view rest) {
  return "[domain]\nbox = { min = [-10, 0, 0], max = [35, 10, 45] }\n[[excavation]]\nname = \"cut\"\nkind = \"slope\"\n"
         "profile = { origin = [0, 0], direction = 90, points = [[18, 21.220518757182376], [33.6, 6.633844372845287]] "
         "}\n" +
         across("B", 9.967860619515672, 21.258820979338324, 18.032139380484328, 11.648187794272749) +
         across("B", 17.95048659656292, 11.6934486714767, 30.04951340343708, 9.993041344951997) +
         across("J", 18, 11.636490016428697, 18, 21.270518757182376) + walls(9, 5, 31, 45) +
         "[joints.B]\nfriction = 28\n[joints.J]\nfriction = 20\n[joints.W]\nfriction = 0\n[rock]\ndensity = 2700\n"
         "[stability]\nfree = [\"top\"]\nseismic = [0.15, 0, 0]\n" +
         std::string{rest};
}

TEST(VerdictNotes, MicroBlocksThatChangeNoFactorAreNotSaidToHold) {
  const RunResult run = run_of(broken_slide(""));
  ASSERT_EQ(run.figures.groups->count, 1U);
  EXPECT_EQ(notes_with(run, "a micro-block"), 1U);  // that it is there
  EXPECT_EQ(notes_with(run, "leans on"), 0U);
}

TEST(VerdictNotes, GroupsThatDecideCountInStagesAndOrders) {
  const RunResult run =
      run_of(broken_slide("groups = \"decide\"\n[[excavation]]\nname = \"later\"\nkind = \"polyhedron\"\nstage = 2\n"
                          "box = { min = [-10, 0, 0], max = [-8, 10, 2] }\n"));
  EXPECT_EQ(run.figures.key_blocks->count, 2U);
  ASSERT_TRUE(run.sequence);
  ASSERT_EQ(run.sequence->stages.size(), 2U);
  EXPECT_EQ(run.sequence->stages[0].key_blocks.count, 2U);
  EXPECT_EQ(run.sequence->orders[0].key_blocks, 2U);
  EXPECT_NEAR(run.sequence->orders[0].key_volume.si(), run.figures.key_blocks->volume_m3, 1e-6);
}

TEST(VerdictNotes, BlocksOfAGroupDoNotLieBehindOthers) {
  const RunResult run = run_of(broken_slide("groups = \"decide\"\n" + bolt_at_its_head(1)));
  EXPECT_EQ(run.figures.support->blocks, 0U);
  EXPECT_EQ(run.figures.support->key_blocks_behind, 0U);
}

TEST(VerdictNotes, SizesOfANormalLawThatLiesBelowZeroAreNoted) {
  const auto sized = [](std::string_view law) {
    return notes_of(scene_of(
        fmt::format("[domain]\nbox = {{ min = [0, 0, 0], max = [20, 20, 20] }}\n[[joint_set]]\n"
                    "orientation = {{ dip = 60, dip_direction = 90 }}\nsize = {{ {} }}\nintensity = {{ count = 3 }}\n",
                    law)));
  };
  const auto wide = sized("distribution = \"normal\", mean = 1, std = 30");
  ASSERT_EQ(wide.size(), 1U);
  EXPECT_TRUE(wide[0].contains("48.7 % of it lies below 0 and is not drawn")) << wide[0];
  EXPECT_TRUE(sized("distribution = \"normal\", mean = 10, std = 3").empty());
}

TEST(VerdictNotes, UnitsMayHaveRaisedFigures) {
  EXPECT_TRUE(parse_text(with_box("[rock]\ndensity = \"2700 kg/m\u00b3\"\n")).has_value());
}

TEST(VerdictNotes, NoThicknessIsMeantInKilometres) {
  const auto notes = notes_of(scene_of(with_box(
      "[stability]\nfree = [\"top\"]\n[support]\nshotcrete = { thickness = 0.001, strength = 1e6, on = \"all\" "
      "}\n")));
  ASSERT_FALSE(notes.empty());
  for (const std::string& note : notes) EXPECT_FALSE(note.contains("km")) << note;
}

}  // namespace
}  // namespace cleave::scene
