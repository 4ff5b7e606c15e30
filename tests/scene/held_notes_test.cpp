#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// What stays, or reaches its target, only by what may not be there: told in every state that is judged, at every
// target that is asked.

namespace cleave::scene::test::held_notes_test {
namespace {

double tan_of(double degrees) { return std::tan(degrees * std::numbers::pi / 180); }

std::string quad(const std::string& set, const std::string& corners) {
  return "[[joint]]\nset = \"" + set + "\"\npolygon = [" + corners + "]\n";
}

/// A slope of 60 degrees; in it a slab of 477.6 m3 on a joint that dips 35 degrees out of it, before a crack.
/// `walls`: how much the second end of each lies inside of the first, m over 15.95 m; none: sides of the domain.
std::string slab(double friction, const std::string& rest, std::optional<double> walls = {}, bool inside = false) {
  const std::string from = walls ? "1.9" : "-1", to = walls ? "8.1" : "11";
  std::string text =
      "[domain]\nbox = { min = [0, 0, 0], max = [40, 10, 30] }\n"
      "[[excavation]]\nname = \"cut\"\nkind = \"slope\"\nprofile = { origin = [0, 0], direction = 90, "
      "points = [[20, 30], [31.547005383792516, 10]] }\n";
  text += quad("B", fmt::format("[15.95904239778555, {0}, 25.680689102744164], [26.969160832489962, {0}, "
                                "17.971321178182446], [26.969160832489962, {1}, 17.971321178182446], "
                                "[15.95904239778555, {1}, 25.680689102744164]",
                                from, to));
  text += quad("C", fmt::format("[16, {0}, 25.60201028092661], [16, {0}, 30.05], [16, {1}, 30.05], [16, {1}, "
                                "25.60201028092661]",
                                from, to));
  if (walls) {
    text += "[joints.W]\nfriction = 0\n";
    for (const double side : {2.0, 8.0}) {
      const double far = side < 5 ? side + *walls : side - *walls;
      text += quad("W", fmt::format("[15.95, {0}, 5], [31.9, {1}, 5], [31.9, {1}, 31], [15.95, {0}, 31]", side, far));
    }
  }
  if (inside) {
    for (const double x : {20.0, 21.0}) {
      text +=
          quad("I", fmt::format("[{0}, 3.98, 25.98], [{0}, 5.02, 25.98], [{0}, 5.02, 27.02], [{0}, 3.98, 27.02]", x));
      text += quad(
          "I",
          fmt::format("[19.98, {0}, 25.98], [21.02, {0}, 25.98], [21.02, {0}, 27.02], [19.98, {0}, 27.02]", x - 16));
      text += quad(
          "I", fmt::format("[19.98, 3.98, {0}], [21.02, 3.98, {0}], [21.02, 5.02, {0}], [19.98, 5.02, {0}]", x + 6));
    }
  }
  return text + fmt::format(
                    "[joints.default]\nfriction = 30\n[joints.B]\nfriction = {}\n"
                    "[rock]\ndensity = 2700\n[stability]\nfree = [\"top\"]\n{}",
                    friction, rest);
}

constexpr const char* shotcrete = "[support]\nshotcrete = { thickness = 0.01, strength = 1e5 }\n";
/// Takes the slab away.
constexpr const char* later =
    "[[excavation]]\nname = \"later\"\nkind = \"slope\"\nstage = 2\n"
    "profile = { origin = [0, 0], direction = 90, points = [[5, 30], [6, 12], [40, 11.9]] }\n";

TEST(HeldNotes, ASupportDoesNotPassInSilenceWhereSidesOfTheDomainReachTheTarget) {
  const RunResult result = run_of(slab(40, shotcrete));
  const NotAsked& rest = result.figures.support->not_asked;
  EXPECT_EQ(rest.count, 1U);
  EXPECT_NEAR(rest.volume.si(), 477.6, 0.1);
  EXPECT_NEAR(rest.lowest_factor_of_safety, tan_of(40) / tan_of(35), 1e-6);
  EXPECT_EQ(notes_with(result,
                       "1 block (477.6 m3) at free faces reaches the target of 1.3 for sliding only because of "
                       "sides of the domain that are not free: without those the least factor of safety is "
                       "1.198"),
            1U);
  EXPECT_EQ(run_of(slab(45, shotcrete)).figures.support->not_asked.count, 0U);
  // Below 1 it is told of as before, and counts here as well.
  const RunResult moving = run_of(slab(30, shotcrete));
  EXPECT_EQ(moving.figures.support->not_asked.count, 1U);
  EXPECT_EQ(notes_with(moving, "is held only by a side of the domain"), 1U);
  EXPECT_EQ(notes_with(moving, "reaches the target"), 0U);
}

TEST(HeldNotes, NorUnderALoad) {
  const std::string quake = "[[load]]\nname = \"quake\"\nseismic = [0.1, 0, 0]\n";
  const RunResult result = run_of(slab(45, shotcrete + quake));
  EXPECT_EQ(notes_with(result, "load case quake: 1 block (477.6 m3) at free faces reaches the target of 1.3"), 1U);
  EXPECT_EQ(notes_with(result, "reaches the target"), 1U);
  EXPECT_EQ(result.figures.support->not_asked.count, 1U);
}

TEST(HeldNotes, NorWhereASlightTaperReachesIt) {
  const RunResult result = run_of(slab(40, shotcrete, 0.004));
  EXPECT_EQ(result.figures.support->not_asked.count, 1U);
  EXPECT_NEAR(result.figures.support->not_asked.lowest_factor_of_safety, tan_of(40) / tan_of(35), 1e-3);
  EXPECT_EQ(notes_with(result, "reaches the target of 1.3 for sliding only because of a taper of its joints"), 1U);
  EXPECT_EQ(run_of(slab(30, shotcrete, 0.004)).figures.support->not_asked.count, 1U);
  // Between parallel walls it is below its target in its own right, as all else says.
  const RunResult straight = run_of(slab(40, "target = { sliding = 1.3 }\n", 0.0));
  EXPECT_EQ(notes_with(straight, "reaches the target"), 0U);
}

// At strengths over the target, as the replay of the realization does.
TEST(HeldNotes, EnsemblesCountWhatReachesATargetByWhatMayNotBeThere) {
  const auto expect_same = [](const std::optional<stochastic::StayingAtTarget>& counted,
                              const std::optional<HeldAtTarget>& replayed) {
    ASSERT_TRUE(counted && replayed);
    EXPECT_EQ(counted->border.count, replayed->border.count);
    EXPECT_EQ(counted->border.volume.si(), replayed->border.volume.si());
    EXPECT_EQ(counted->tapered.count, replayed->tapered.count);
    EXPECT_EQ(counted->tapered.volume.si(), replayed->tapered.volume.si());
  };
  const std::string quake = "[[load]]\nname = \"quake\"\nseismic = [0.1, 0, 0]\n";
  const std::string ensemble = "[monte_carlo]\nrealizations = 2\n", decide = "groups = \"decide\"\n";
  // By sides of the domain, by a taper; 40 degrees miss 1.3 in the base case, 45 under the load alone.
  for (const std::optional<double> walls : {std::optional<double>{}, std::optional{0.004}}) {
    for (const double friction : {40.0, 45.0}) {
      for (const std::string& how : {"target = { sliding = 1.3 }\n" + decide, std::string{shotcrete}}) {
        const Scene scene = scene_of(slab(friction, how + quake + ensemble, walls));
        const stochastic::Record record = make_record(scene, shared_by_realizations(scene), 1);
        StageTimer timer;
        Progress progress{ProgressStyle::quiet};
        const auto replay = run(scene, {.realization = 1}, timer, progress);
        ASSERT_TRUE(replay.has_value());
        expect_same(record.at_target, replay->figures.key_blocks->held_at_target);
        ASSERT_EQ(record.cases.size(), 1U);
        expect_same(record.cases[0].at_target, replay->figures.load_cases.at(0).figures.held_at_target);
        const stochastic::Staying& base = walls ? record.at_target->tapered : record.at_target->border;
        EXPECT_EQ(base.count, friction < 45 ? 1U : 0U);
        EXPECT_NEAR(base.volume.si(), friction < 45 ? (walls ? 286.0 : 477.6) : 0, 1);
        const auto& shaken = *record.cases[0].at_target;
        EXPECT_EQ((walls ? shaken.tapered : shaken.border).count, 1U);
        // At strengths as they are nothing of it shows.
        EXPECT_EQ(record.border->count + record.tapered->count, 0U);
      }
    }
  }
  const Scene none = scene_of(slab(40, ensemble));
  EXPECT_FALSE(make_record(none, shared_by_realizations(none), 0).at_target.has_value());
}

TEST(HeldNotes, SidesOfTheDomainAreToldOfAfterStages) {
  const RunResult result = run_of(slab(30, later));
  EXPECT_EQ(notes_with(result, "after stage 1: 1 block (477.6 m3) at free faces is held only by sides of the domain"),
            1U);
  // When all is excavated the base case tells of it.
  const RunResult there = run_of(slab(30,
                                      "[[excavation]]\nname = \"far\"\nkind = \"polyhedron\"\nstage = 2\n"
                                      "box = { min = [1, 1, 1], max = [2, 2, 2] }\n"));
  EXPECT_EQ(notes_with(there, "held only by"), 1U);
  const RunResult supported = run_of(slab(30, std::string{later} + shotcrete));
  EXPECT_EQ(supported.figures.support->not_asked.count, 1U);
}

TEST(HeldNotes, WhatMissesATargetIsToldOfUnderLoadsAndAfterStages) {
  const std::string target = "target = { sliding = 1.3 }\n", quake = "[[load]]\nname = \"quake\"\nseismic = ";
  const RunResult stage = run_of(slab(40, target + later, 0.0));
  EXPECT_EQ(notes_with(stage, "after stage 1: 1 group of blocks (286."), 1U);
  const RunResult load = run_of(slab(45, target + quake + "[0.1, 0, 0]\n", 0.0));
  EXPECT_EQ(notes_with(load, "load case quake: 1 group of blocks"), 1U);
  ASSERT_TRUE(load.figures.load_cases.at(0).groups.has_value());
  EXPECT_EQ(load.figures.load_cases.at(0).groups->below_target, 1U);
  EXPECT_EQ(notes_with(load, "would move at strengths over the target"), 1U);
  // Without groups single blocks are told of, once.
  const std::string off = "groups = \"off\"\n";
  const RunResult alone = run_of(slab(40, off + target + quake + "[0.01, 0, 0]\n", 0.0));
  EXPECT_EQ(notes_with(alone,
                       "that does not move is below the target (falling 1.5, sliding 1.3): the least factor of "
                       "safety is 1.198"),
            1U);
  EXPECT_EQ(notes_with(alone, "is below the target"), 1U);
  EXPECT_EQ(notes_with(run_of(slab(45, off + target, 0.0)), "below the target"), 0U);
  EXPECT_EQ(notes_with(run_of(slab(40, off + target + later, 0.0)), "after stage 1: 1 block ("), 1U);
}

/// A plate that stands on a flat joint behind a free face.
std::string plate(const std::string& rest) {
  return "[domain]\nbox = { min = [0, 0, 0], max = [20, 10, 14] }\n" +
         quad("B", "[18.95, 1.9, 10], [20.05, 1.9, 10], [20.05, 8.1, 10], [18.95, 8.1, 10]") +
         quad("C", "[19, 1.9, 9.95], [19, 1.9, 14.05], [19, 8.1, 14.05], [19, 8.1, 9.95]") +
         quad("C", "[18.95, 2, 9.9], [20.1, 2, 9.9], [20.1, 2, 15], [18.95, 2, 15]") +
         quad("C", "[18.95, 8, 9.9], [20.1, 8, 9.9], [20.1, 8, 15], [18.95, 8, 15]") +
         "[joints.B]\nfriction = 40\n[joints.C]\nfriction = 0\n[stability]\nfree = [\"top\", \"east\"]\n"
         "groups = \"off\"\n" +
         rest;
}

TEST(HeldNotes, TurningIsToldOfUnderLoadsAndAfterStages) {
  const RunResult load = run_of(plate("[[load]]\nname = \"quake\"\nseismic = [0.3, 0, 0]\n"));
  EXPECT_EQ(notes_with(load, "load case quake: 1 block (24 m3) would turn or topple though it cannot slide"), 1U);
  const std::string stages =
      "seismic = [0.3, 0, 0]\n[[excavation]]\nname = \"later\"\nkind = \"polyhedron\"\nstage = 2\n"
      "box = { min = [15, 0, 9], max = [20, 10, 14] }\n[[excavation]]\nname = \"first\"\nkind = \"polyhedron\"\n"
      "box = { min = [0, 0, 13.9], max = [1, 10, 14] }\n";
  EXPECT_EQ(notes_with(run_of(plate(stages)), "after stage 1: 1 block (24 m3) would turn or topple"), 1U);
  // What turns in the base case is not told of again.
  const RunResult both = run_of(plate("seismic = [0.3, 0, 0]\n[[load]]\nname = \"quake\"\nseismic = [0.35, 0, 0]\n"));
  EXPECT_EQ(notes_with(both, "would turn or topple"), 1U);
}

/// Two blocks of a slope behind one another, on joints of less dip in front: the one behind rests on the other.
std::string active_passive(const std::string& from, const std::string& to, std::optional<double> walls, double friction,
                           const std::string& rest) {
  std::string text =
      "[domain]\nbox = { min = [-10, 0, 0], max = [35, 10, 45] }\n[[excavation]]\nname = \"cut\"\nkind = "
      "\"slope\"\nprofile = { origin = [0, 0], direction = 90, points = [[22, 16.47341200010365], [32.4, "
      "8.057976399968904]] }\n";
  const auto strip = [&](const char* set, const char* a, const char* b) {
    text += quad(set, fmt::format("[{0}], [{1}], [{2}], [{3}]", fmt::format(fmt::runtime(a), from),
                                  fmt::format(fmt::runtime(b), from), fmt::format(fmt::runtime(b), to),
                                  fmt::format(fmt::runtime(a), to)));
  };
  strip("B", "11.956698729810778, {}, 16.49841200010365", "22.04330127018922, {}, 10.674909308207392");
  strip("B", "21.95019026509541, {}, 10.704267095344775", "30.04980973490459, {}, 9.995642212862617");
  strip("J", "22, {}, 10.649909308207391", "22, {}, 16.52341200010365");
  if (walls) {
    text += "[joints.W]\nfriction = 0\n";
    for (const double y : {2.0, 8.0}) {
      text += quad("W", fmt::format("[11, {0}, 5], [31, {1}, 5], [31, {1}, 45], [11, {0}, 45]", y,
                                    y < 5 ? y + *walls : y - *walls));
    }
  }
  return text + fmt::format(
                    "[joints.B]\nfriction = {}\n[joints.J]\nfriction = 20\n[stability]\n"
                    "free = [\"top\"]\n{}",
                    friction, rest);
}

TEST(HeldNotes, WhatLesserNeighboursBarIsToldOfUnderLoads) {
  const RunResult result = run_of(
      active_passive("1.9", "8.1", 0.0, 32, "groups = \"off\"\n[[load]]\nname = \"quake\"\nseismic = [0.4, 0, 0]\n"));
  EXPECT_EQ(notes_with(result, "only because of neighbours that are smaller or removable"), 1U);
  EXPECT_EQ(notes_with(result, "load case quake: 1 block ("), 1U);
}

TEST(HeldNotes, WhatLiesInsideABlockIsToldOfUnderLoads) {
  const RunResult result =
      run_of(slab(40, "groups = \"off\"\n[[load]]\nname = \"quake\"\nseismic = [0.2, 0, 0]\n", 0.0, true));
  EXPECT_EQ(notes_with(result, "stays only because of what lies wholly inside: as one body"), 1U);
  // And where the target is asked.
  EXPECT_EQ(notes_with(run_of(slab(40, shotcrete, 0.0, true)), "only because of what lies wholly inside"), 1U);
}

TEST(HeldNotes, ThatTwoBlocksMayBeHeldBySidesOfTheDomainIsSaidWithoutGroups) {
  const std::string_view unasked = "held by sides of the domain that are not free was not asked";
  EXPECT_EQ(notes_with(run_of(active_passive("-1", "11", {}, 15, "groups = \"off\"\n")), unasked), 1U);
  EXPECT_EQ(notes_with(run_of(active_passive("-1", "11", {}, 15, "")), unasked), 0U);
}

TEST(HeldNotes, GroupsThatASlightTaperHoldsAreToldOf) {
  const RunResult straight = run_of(active_passive("1.9", "8.1", 0.0, 15, ""));
  ASSERT_EQ(straight.key_groups->groups.size(), 1U);
  EXPECT_EQ(straight.key_groups->groups[0].blocks.size(), 2U);
  EXPECT_EQ(notes_with(straight, "between parallel ones"), 0U);
  const RunResult slight = run_of(active_passive("1.9", "8.1", 0.009, 15, ""));
  EXPECT_TRUE(slight.key_groups->groups.empty());
  EXPECT_EQ(
      notes_with(slight, fmt::format("between parallel ones they would move together, the least factor of safety is "
                                     "{:.2g}",
                                     straight.key_groups->groups[0].least_factor())),
      1U);
  EXPECT_EQ(notes_with(run_of(active_passive("1.9", "8.1", 0.1, 15, "")), "between parallel ones"), 0U);
  const RunResult supported = run_of(active_passive("1.9", "8.1", 0.009, 15, shotcrete));
  EXPECT_EQ(supported.figures.support->not_asked.count, 2U);
}

}  // namespace
}  // namespace cleave::scene::test::held_notes_test
