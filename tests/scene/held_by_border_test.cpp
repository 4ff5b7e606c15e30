#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/realize/places.hpp"
#include "cleave/realize/run.hpp"
#include "run_notes.hpp"
#include "run_scene.hpp"

// What must not pass in silence: blocks that only the border of the domain holds, and openings that miss the rock.

namespace cleave::scene::test::held_by_border_test {
namespace {

/// A slice of a slope: its east side is free, a joint dips out of it through the box from side to side.
std::string slice(double dip) {
  return with_box("[[joint]]\nplane = { through = [8, 4, 1], dip = " + std::to_string(dip) +
                  ", dip_direction = 90 }\n[joints.default]\nfriction = 30\n"
                  "[stability]\nfree = [\"top\", \"east\"]\n");
}

TEST(HeldByTheBorder, ASliceOfASlopeThatIsHeldByItsOwnSidesIsTold) {
  const RunResult result = run_of(slice(40));
  const KeyBlockFigures& key = *result.figures.key_blocks;
  EXPECT_EQ(key.count, 0U);
  ASSERT_TRUE(key.domain_held.has_value());
  EXPECT_EQ(key.domain_held->count, 1U);
  // Above the joint: the box less the prism below, which reaches the top where 1 + x' tan 40 = 6.
  const double tangent = 0.83909963117728, run = 5 / tangent;
  const double below = 8 * (1 * 8 + run * 5 / 2 + (8 - run) * 5);
  EXPECT_NEAR(key.domain_held->volume.si(), 384 - below, 1e-6);
  EXPECT_NEAR(key.domain_held->share, (8 * 5 + 8 * run) / (8 * 6 + 8 * 8), 1e-9);
  // Free: all of the east side above 1 m, and of the top what lies above the joint.
  EXPECT_EQ(
      notes_with(result, fmt::format("1 block at free faces ({:.4g} m3, {:.3g} % of the free area) is held only by",
                                     384 - below, 100 * (8 * 5 + 8 * run) / (8 * 6 + 8 * 8))),
      1U);
  // How it would go, were its sides smooth.
  ASSERT_EQ(result.domain_held->alone.size(), 1U);
  const stability::DomainHeld::Alone& alone = result.domain_held->alone[0];
  const double dip = 40 * std::numbers::pi / 180, friction = std::tan(std::numbers::pi / 6);
  EXPECT_EQ(alone.block, result.domain_held->blocks[0]);
  EXPECT_EQ(alone.mode, stability::Mode::sliding);
  EXPECT_NEAR(alone.factor_of_safety, friction / tangent, 1e-9);
  const double weight = 2700 * 9.81 * (384 - below);
  EXPECT_NEAR(alone.net.si() / (weight * (std::sin(dip) - std::cos(dip) * friction)), 1, 1e-6);
  EXPECT_NEAR(alone.direction.z, -std::sin(dip), 1e-9);
}

TEST(HeldByTheBorder, WhatFrictionHoldsIsNotTold) { EXPECT_EQ(notes_with(run_of(slice(20)), "held only by"), 0U); }

TEST(HeldByTheBorder, RockBelowHoldsWhatStandsOnIt) {
  // The column in front of a vertical joint stands on the bottom of the domain; an earthquake moves nothing there.
  const std::string column = with_box(
      "[[joint]]\nplane = { through = [6, 4, 1], dip = 90, dip_direction = 90 }\n[joints.default]\nfriction = 30\n"
      "[stability]\nfree = [\"top\", \"east\"]\nseismic = [0.3, 0, 0]\n");
  EXPECT_EQ(notes_with(run_of(column), "held only by"), 0U);
}

TEST(HeldByTheBorder, BlocksBesideWhatHasLeftHaveNoShareOfTheFreeFaces) {
  // A slab on a joint that dips out of the east side, between two walls and a cap, cut by a crack: its front leaves,
  // its rear part reaches the west side of the domain.
  const auto quad = [](const std::string& corners) { return "[[joint]]\npolygon = [" + corners + "]\n"; };
  const RunResult result = run_of(with_box(quad("[0, 1.9, 5.8], [8, 1.9, 0.2], [8, 6.1, 0.2], [0, 6.1, 5.8]") +
                                           quad("[0, 2, 0.1], [8, 2, 0.1], [8, 2, 5.95], [0, 2, 5.95]") +
                                           quad("[0, 6, 0.1], [8, 6, 0.1], [8, 6, 5.95], [0, 6, 5.95]") +
                                           quad("[0, 1.9, 5.9], [8, 1.9, 5.9], [8, 6.1, 5.9], [0, 6.1, 5.9]") +
                                           quad("[5, 1.9, 0.1], [5, 6.1, 0.1], [5, 6.1, 5.95], [5, 1.9, 5.95]") +
                                           "[joints.default]\nfriction = 30\n[stability]\nfree = [\"east\"]\n"));
  EXPECT_EQ(result.figures.key_blocks->count, 1U);
  const double rear = 4 * 5 * 0.5 * (0.1 + 3.6);
  EXPECT_EQ(notes_with(result, fmt::format("1 block ({:.4g} m3) beside a block that has left is held only by", rear)),
            1U);
  EXPECT_EQ(notes_with(result, "0 %"), 0U);
}

TEST(HeldByTheBorder, BarredBlocksAreToldWhyNobodyAsked) {
  const std::vector<stability::Barred> barred{{.block = topology::BlockId{7}, .factor_of_safety = 0.5}};
  std::vector<std::string> notes;
  add_barred_note(barred, false, notes);
  add_barred_note(barred, true, notes);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_TRUE(notes[0].ends_with("whether they are pushed out was not asked: see `groups`")) << notes[0];
  EXPECT_TRUE(notes[1].ends_with("was not asked: too many blocks are near free faces to be judged together"))
      << notes[1];
}

TEST(HeldByTheBorder, CohesionLeftOutNamesTheKeyThatCountsIt) {
  // A block between two vertical walls with cohesion slides out on its base.
  const std::string text =
      slice(40) + "cohesion_on_parallel_faces = false\n[joints.walls]\nfriction = 30\ncohesion = 1e3\n";
  const auto wall = [](const char* y) {
    return std::string{"[[joint]]\nset = \"walls\"\nplane = { through = [0, "} + y +
           ", 0], dip = 90, dip_direction = 0 }\n";
  };
  const RunResult result = run_of(text + wall("2") + wall("6"));
  EXPECT_EQ(notes_with(result, "it is not counted; cohesion_on_parallel_faces = true counts it"), 1U);
}

TEST(HeldByTheBorder, ABlockInsideIsAKeyBlockAsBefore) {
  // Two vertical joints free the slice of the domain's sides: the block between them leaves, two beside it stay.
  const RunResult result =
      run_of(slice(40) + "[[joint]]\nplane = { through = [0, 2, 0], dip = 90, dip_direction = 0 }\n" +
             "[[joint]]\nplane = { through = [0, 6, 0], dip = 90, dip_direction = 0 }\n");
  EXPECT_EQ(result.figures.key_blocks->count, 1U);
  EXPECT_EQ(notes_with(result, "2 blocks at free faces"), 1U);
}

std::string opening(std::string_view name, std::string_view min, std::string_view max) {
  return "[[excavation]]\nname = \"" + std::string{name} +
         "\"\nkind = \"polyhedron\"\nbox = { min = " + std::string{min} + ", max = " + std::string{max} + " }\n";
}

TEST(Openings, TheVolumeOfEachIsSaid) {
  // Two thirds of the first lie outside; the second shares 1 x 2 x 2 with it; the third has nothing left to take.
  const RunResult result =
      run_of(with_box(opening("out", "[6, 2, 2]", "[12, 4, 4]") + opening("shared", "[4, 2, 2]", "[7, 4, 4]") +
                      opening("late", "[5, 2.5, 2.5]", "[6.5, 3.5, 3.5]")));
  const auto& rows = result.figures.input.excavations;
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].name, "out");
  EXPECT_NEAR(rows[0].volume.si(), 8, 1e-9);
  EXPECT_NEAR(*rows[0].outside_share, 2.0 / 3, 1e-9);
  EXPECT_NEAR(rows[1].volume.si(), 8, 1e-9);
  EXPECT_NEAR(*rows[1].outside_share, 0, 1e-9);
  EXPECT_EQ(rows[2].volume.si(), 0);
  EXPECT_EQ(notes_with(result, "66.7 % of it lies outside the domain"), 1U);
  EXPECT_EQ(notes_with(result, "late: removes no rock"), 1U);
  EXPECT_EQ(notes_with(result, "outside the domain"), 1U);
}

TEST(Openings, WhatRemovesRockNeverLiesOutsideByAHundredPercent) {
  const RunResult result = run_of(with_box(opening("in millimetres", "[4, -1, -1]", "[4000, 4000, 4000]")));
  EXPECT_EQ(notes_with(result, "100 %"), 0U);
  EXPECT_EQ(notes_with(result, "in millimetres: all but 3e-07 % of it lies outside the domain; it removes 192 m3"), 1U);
}

TEST(Openings, OneNoteSpeaksOfAllThatLieOutside) {
  const RunResult result =
      run_of(with_box(opening("a third", "[6, 2, 2]", "[9, 4, 4]") + opening("two thirds", "[6, 5, 2]", "[12, 7, 4]")));
  EXPECT_EQ(notes_with(result, "outside the domain"), 1U);
  EXPECT_EQ(notes_with(result,
                       "2 openings lie partly outside the domain, up to 66.7 % of one (two thirds); they remove "
                       "16 m3 of rock"),
            1U);
}

TEST(Openings, OfARunThatCutsOnlyNearFreeFacesTheyAreWhole) {
  const RunResult result = run_of(with_box(opening("room", "[3, 3, 2]", "[5, 5, 4]") +
                                           "[[joint]]\nplane = { through = [4, 4, 3], dip = 30, dip_direction = 0 }\n"
                                           "[stability]\n[output]\nblocks = \"key\"\n"));
  ASSERT_EQ(result.figures.input.excavations.size(), 1U);
  EXPECT_NEAR(result.figures.input.excavations[0].volume.si(), 8, 1e-9);
}

TEST(Openings, OneThatOnlyTheCutterFindsOutsideIsRefused) {
  // In the corner of an L no plane of a face parts the two.
  const Files files{{"ell.obj",
                     "v 0 0 0\nv 8 0 0\nv 8 4 0\nv 4 4 0\nv 4 8 0\nv 0 8 0\nv 0 0 6\nv 8 0 6\nv 8 4 6\nv 4 4 6\n"
                     "v 4 8 6\nv 0 8 6\nf 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\n"
                     "f 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n"}};
  const auto with = [&](std::string_view min) {
    return try_run("[domain]\nmesh = \"ell.obj\"\n" + opening("beside", min, "[7, 7, 4]"), files);
  };
  ASSERT_TRUE(with("[3, 5, 2]").has_value());
  const auto refused = with("[5, 5, 2]");
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(describe(refused.error().front()).find("removes no rock"), std::string::npos);
  // `check` says the same without cutting along joints.
  const auto told =
      refusals(scene_of("[domain]\nmesh = \"ell.obj\"\n" + opening("beside", "[5, 5, 2]", "[7, 7, 4]"), files));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(describe(told.front()), describe(refused.error().front()));
}

// Ends that go on a little make sure that a tunnel comes out: no note. One that goes on for more than its width, or
// comes out beside its ends, may be misplaced.
TEST(Openings, EndsThatComeOutAreMeantTo) {
  const auto tunnel = [](std::string_view axis) {
    return run_of(
        with_box(fmt::format("[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\n"
                             "section = {{ shape = \"d_shape\", width = 2, wall = 1 }}\naxis = {}\n",
                             axis)));
  };
  for (const std::string_view axis : {"[[4, -1, 3], [4, 9.5, 3]]", "[[-1, 4, 3], [4, 4, 3], [4, -1, 3]]"}) {
    const RunResult meant = tunnel(axis);
    EXPECT_EQ(notes_with(meant, "outside the domain"), 0U) << axis;
    EXPECT_GT(*meant.figures.input.excavations[0].outside_share, 0) << axis;
  }
  for (const std::string_view axis : {"[[4, -3, 3], [4, 9, 3]]", "[[4, -1, 3], [4, 11, 3]]",
                                      "[[0.5, -1, 3], [0.5, 9, 3]]", "[[4, 0, 5.8], [4, 8, 5.8]]"}) {
    EXPECT_EQ(notes_with(tunnel(axis), "of it lies outside the domain"), 1U) << axis;
  }
}

TEST(Openings, OfStagesTheyAreThoseOfTheWholeWork) {
  const RunResult result =
      run_of(with_box("[[excavation]]\nname = \"early\"\nstage = 1\nkind = \"polyhedron\"\n"
                      "box = { min = [3, 3, 2], max = [5, 5, 4] }\n"
                      "[[excavation]]\nname = \"late\"\nstage = 2\nkind = \"polyhedron\"\n"
                      "box = { min = [4, 3, 2], max = [7, 5, 4] }\n"
                      "[[joint]]\nplane = { through = [4, 4, 3], dip = 30, dip_direction = 0 }\n"));
  const auto& rows = result.figures.input.excavations;
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[0].volume.si(), 8, 1e-9);
  EXPECT_NEAR(rows[1].volume.si(), 8, 1e-9);
  EXPECT_EQ(notes_with(result, "outside the domain"), 0U);
}

TEST(Openings, ASlopeIsMadeToReachBeyondTheDomain) {
  const RunResult result =
      run_of(with_box("[[excavation]]\nname = \"cut\"\nkind = \"slope\"\nplane = { through = [8, 0, 0], dip = 45, "
                      "dip_direction = 90 }\n"));
  const auto& rows = result.figures.input.excavations;
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_NEAR(rows[0].volume.si(), 6 * 6 / 2 * 8, 1e-9);
  EXPECT_FALSE(rows[0].outside_share.has_value());
  EXPECT_EQ(notes_with(result, "outside the domain"), 0U);
}

TEST(Openings, WhatARunRefusesIsFoundByTheCheck) {
  const std::string room = with_box(opening("room", "[3, 3, 2]", "[5, 5, 4]") +
                                    "[[joint]]\nplane = { through = [4, 4, 3], "
                                    "dip = 30, dip_direction = 0 }\n");
  EXPECT_TRUE(refusals(scene_of(room)).empty());
  const std::string off = room + "[stability]\npoint = [{ at = [4, 4, 5], force = [0, 0, 1000] }]\n";
  const auto ran = try_run(off);
  ASSERT_FALSE(ran.has_value());
  const auto told = refusals(scene_of(off));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(describe(told.front()), describe(ran.error().front()));
  // A snap that closes an opening up is told of before anything is cut.
  const auto coarse = refusals(scene_of("snap = 5\n" + room));
  ASSERT_EQ(coarse.size(), 1U);
  EXPECT_TRUE(coarse[0].remedy.contains("snap = 5")) << describe(coarse[0]);
  const auto swallowed = refusals(scene_of(with_box(opening("all", "[-1, -1, -1]", "[9, 9, 9]"))));
  ASSERT_EQ(swallowed.size(), 1U);
}

// Rock without the set, and no word of it, is what a slip in its intensity gives.
TEST(EmptySets, AreSaid) {
  const auto with = [](const std::string& name, const std::string& intensity) {
    return "[[joint_set]]\nname = \"" + name +
           "\"\norientation = { dip = 40, dip_direction = 30 }\nsize = 2\nintensity = { " + intensity + " }\n";
  };
  const RunResult result = run_of(with_box(with("A", "spacing = 9e4") + with("B", "p32 = 1")));
  EXPECT_EQ(notes_with(result, "no joint was drawn of the set A (line"), 1U);
  EXPECT_EQ(notes_with(result, "no joint was drawn"), 1U);
}

TEST(CoarseSnap, TheNoteNamesTheJoint) {
  const RunResult result =
      run_of("snap = 0.01\n" +
             with_box("[[joint]]\nname = \"chip\"\npolygon = [[4, 1, 1], [4, 1.004, 1], [4, 7, 5], [4, 1, 5]]\n"));
  EXPECT_EQ(notes_with(result, "snap is too coarse for a polygon: the shortest side, of joint chip ("), 1U);
}

/// A slab over a plane that dips 40 degrees out of a wall, held by a crumb of 4 l at its toe that hangs on rock beside.
std::string slab_behind_crumb(std::string_view more) {
  return fmt::format(
      "[domain]\nbox = {{ min = [0, -1, 0], max = [11, 4, 7] }}\n"
      "[[excavation]]\nname = \"cut\"\nkind = \"polyhedron\"\nbox = {{ min = [0, -1, 2], max = [5, 4, 7] }}\n"
      "[[joint]]\nplane = {{ through = [5, 0, 2.5], dip = 40, dip_direction = 270 }}\n"
      "[[joint]]\npolygon = [[4.9, 0, 2], [11, 0, 2], [11, 0, 8], [4.9, 0, 8], [4.9, 0, 2.6], [5.05, 0, 2.6], "
      "[5.05, 0, 2.5], [4.9, 0, 2.5]]\n"
      "[[joint]]\npolygon = [[5.05, -2, 2.5], [5.05, 0.1, 2.5], [5.05, 0.1, 2.6], [5.05, -2, 2.6]]\n"
      "[[joint]]\npolygon = [[4.9, 0.1, 2.5], [5.05, 0.1, 2.5], [5.05, 0.1, 2.6], [4.9, 0.1, 2.6]]\n"
      "[[joint]]\npolygon = [[4.9, -2, 2.6], [5.05, -2, 2.6], [5.05, 0.1, 2.6], [4.9, 0.1, 2.6]]\n"
      "[joints.default]\nfriction = 20\n[rock]\ndensity = 2700\n[stability]\nfree = [\"top\", \"north\"]\n{}",
      more);
}

TEST(Crumbs, WhatOnlyTheyHoldIsSaid) {
  const RunResult held = run_of(slab_behind_crumb("groups = \"off\"\n[micro_blocks]\nvolume = 0.01\n"));
  EXPECT_EQ(held.figures.key_blocks->count, 0U);
  EXPECT_EQ(notes_with(held,
                       "1 block (48.27 m3) stays only because of a micro-block (0.00435 m3 in all): without it "
                       "the least factor of safety is 0.434 (block "),
            1U);
  // Judged with all around it the slab turns about the crumb, which lifts its factor.
  const RunResult group = run_of(slab_behind_crumb("[micro_blocks]\nvolume = 0.01\n"));
  EXPECT_EQ(notes_with(group,
                       "1 key group leans on a micro-block (0.00435 m3 in all): what it holds is in the factor "
                       "of 0.826; without it a block of the group has 0.434 by itself;"),
            1U);
  const RunResult without = run_of(slab_behind_crumb("[micro_blocks]\nvolume = 0.01\npolicy = \"exclude\"\n"));
  EXPECT_EQ(without.figures.key_blocks->count, 1U);
  EXPECT_EQ(notes_with(without, "only because of a micro-block"), 0U);
  EXPECT_EQ(notes_with(run_of(slab_behind_crumb("[micro_blocks]\nvolume = 0.001\n")), "micro-block"), 0U);
  EXPECT_EQ(notes_with(run_of(slab_behind_crumb("[micro_blocks]\nvolume = 0.01\npolicy = \"keep\"\n")), "micro-block"),
            0U);
}

TEST(Crumbs, WhatTheyHoldUnderALoadOrInAnEarlierStageIsSaid) {
  const std::string alone = "groups = \"off\"\n[micro_blocks]\nvolume = 0.01\n";
  const auto at_friction = [&](const char* friction, const std::string& more) {
    std::string text = slab_behind_crumb(alone + more);
    return text.replace(text.find("friction = 20"), 13, std::string{"friction = "} + friction);
  };
  const std::string quake = "[[load]]\nname = \"quake\"\nseismic = [-0.5, 0, 0]\n";
  const std::string said =
      "1 block (48.27 m3) stays only because of a micro-block (0.00435 m3 in all): without it the "
      "least factor of safety is ";
  const RunResult pushed = run_of(at_friction("50", quake));
  EXPECT_EQ(notes_with(pushed, "load case quake: " + said + "0.517 (block "), 1U);
  EXPECT_EQ(notes_with(pushed, said), 1U) << "without the load it stays by itself";
  // Once where it leans on it without the load as well.
  const RunResult both = run_of(at_friction("20", quake));
  EXPECT_EQ(notes_with(both, said + "0.434"), 1U);
  EXPECT_EQ(notes_with(both, "load case quake: " + said), 0U);
  // The slab and its crumb are dug away by a second stage.
  const RunResult staged = run_of(at_friction("20",
                                              "[[excavation]]\nname = \"late\"\nstage = 2\nkind = \"polyhedron\"\n"
                                              "box = { min = [4.9, -1, 2.4], max = [11, 4, 7] }\n"));
  EXPECT_EQ(notes_with(staged, "after stage 1: " + said + "0.434 (block "), 1U);
  EXPECT_EQ(notes_with(staged, said), 1U);
}

TEST(Crumbs, WhatReachesItsTargetOnlyByThemIsSaid) {
  const auto supported = [](const char* length, const char* capacity, const std::string& more = {}) {
    return run_of(slab_behind_crumb(
        std::string{"groups = \"off\"\n[micro_blocks]\nvolume = 0.01\n"} + more + "[support]\n[[support.bolts]]\n" +
        "at = [[5, 1, 6], [5, 2, 6], [5, 3, 6], [5, 1, 4], [5, 2, 4], [5, 3, 4]]\ndirection = [1, 0, 0]\nlength = " +
        length + "\nanchorage = 0.5\ntendon_capacity = " + capacity + "\nbond_strength = 1e6\n"));
  };
  const std::string said =
      "the required factor of safety with the support only because of a micro-block (0.00435 m3 "
      "in all): without it the least is ";
  // Bolts that end in the slab hold nothing: it has 0.434 of its own.
  const RunResult bare = supported("1", "1e6");
  EXPECT_TRUE(bare.support->passes());
  EXPECT_EQ(notes_with(bare, "1 block (48.27 m3) reaches " + said + "0.434 of 1.3 (block "), 1U);
  EXPECT_EQ(notes_with(supported("6", "1e6"), said), 0U) << "bolts hold it without the crumb";
  const RunResult quake = supported("6", "1.5e5", "[[load]]\nname = \"quake\"\nseismic = [-0.5, 0, 0]\n");
  EXPECT_EQ(notes_with(quake, "load case quake: 1 block (48.27 m3) reaches " + said), 1U);
  EXPECT_EQ(notes_with(quake, said), 1U);
  EXPECT_EQ(notes_with(supported("1", "1e6", "policy = \"keep\"\n"), "micro-block"), 0U);
}

TEST(NearMisses, TheNoteNamesTheJoints) {
  const RunResult result =
      run_of(with_box("[[joint]]\nname = \"crown\"\npolygon = [[4, 1, 1], [4, 7, 1], [4, 7, 5], [4, 1, 5]]\n"
                      "[[joint]]\npolygon = [[3.999999, 2, 2], [3.999999, 6, 2], [2, 6, 2], [2, 2, 2]]\n"));
  EXPECT_EQ(notes_with(result, "(joint crown (s.toml:5) and joint 1 (s.toml:7))"), 1U) << result.notes.front();
}

TEST(PressureDiagram, PercentilesAreOfAreaNotOfBlocks) {
  const auto at = [](std::string_view place, double area, double pressure) {
    return PressureAt{place, square_metres(area), pascals(pressure)};
  };
  // A sliver needs a thousand times the pressure of what lies beside it.
  const auto rows = pressure_diagram({at("roof", 0.01, 1e6), at("roof", 9.99, 1e3), at("floor", 4, 0),
                                      at("floor", 0, 5e5), at("left wall", 6, 2e3), at("left wall", 4, 3e3)});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].place, "roof");
  EXPECT_DOUBLE_EQ(rows[0].area.si(), 10);
  EXPECT_EQ(rows[0].p95.si(), 1e3);
  EXPECT_EQ(rows[0].largest.si(), 1e6);
  EXPECT_EQ(rows[1].place, "left wall");
  EXPECT_EQ(rows[1].p50.si(), 2e3);
  EXPECT_EQ(rows[1].p90.si(), 3e3);
  EXPECT_EQ(rows[2].largest.si(), 0);
}

// Nothing loads the walls: they have a row all the same, with their area.
TEST(PressureDiagram, HasARowForPartsThatNothingLoads) {
  const auto at = [](std::string_view place, double area, double pressure) {
    return PressureAt{place, square_metres(area), pascals(pressure)};
  };
  const std::vector<PressureAt> walls{at("roof", 30, 0), at("left wall", 20, 0), at("left wall", 5, 0)};
  const auto rows = pressure_diagram({at("roof", 2, 1e3)}, walls);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].place, "roof");
  EXPECT_EQ(rows[0].area.si(), 2);
  EXPECT_EQ(rows[0].opening_area.si(), 30);
  EXPECT_EQ(rows[0].p50.si(), 1e3);
  EXPECT_EQ(rows[1].place, "left wall");
  EXPECT_EQ(rows[1].area.si(), 0);
  EXPECT_EQ(rows[1].opening_area.si(), 25);
  EXPECT_EQ(rows[1].p95.si(), 0);
  EXPECT_EQ(rows[1].largest.si(), 0);
}

TEST(PressureDiagram, HasARowForEveryPlaceThatABlockCanBeAt) {
  std::vector<PressureAt> blocks;
  for (const std::string_view place : all_locations()) blocks.push_back({place, square_metres(1), pascals(5)});
  EXPECT_EQ(pressure_diagram(blocks).size(), all_locations().size());
  for (const std::string_view place : {"slope", "bench", "crest", "ground", "face", "east wall", "left wall"}) {
    const auto rows = pressure_diagram({{place, square_metres(2), pascals(7)}});
    ASSERT_EQ(rows.size(), 1U) << place;
    EXPECT_EQ(rows[0].place, place);
  }
}

TEST(Places, ShaftsHaveTheirWallsByTheCompass) {
  using geometry::Vec3;
  const auto along = [](Vec3 axis, Vec3 up) { return geometry::section_frames({Vec3{}, axis}, up).front(); };
  // Along a tunnel to the north, east lies to the right; to the south, to the left.
  const auto north = along({0, 3, 0}, {0, 0, 1}), south = along({0, -3, 0}, {0, 0, 1});
  EXPECT_EQ(location_of(north, {2, 0, 1}), "right wall");
  EXPECT_EQ(location_of(south, {2, 0, 1}), "left wall");
  EXPECT_EQ(location_of(north, {0, 0, -1}), "floor");
  EXPECT_EQ(position_of(north, {-1, 0, 1}), "upper left");
  EXPECT_DOUBLE_EQ(clock_of(north, {1, 0, 0}), 3);
  const auto plunging = [&](double degrees) {
    const double plunge = degrees * std::numbers::pi / 180;
    return along({0, std::cos(plunge), -std::sin(plunge)}, {0, 0, 1});
  };
  EXPECT_FALSE(at_shaft(plunging(69)));  // a decline yet
  EXPECT_EQ(location_of(plunging(69), plunging(69).up), "roof");
  // Whichever way is called up, and whether it goes up or down.
  for (const auto& shaft : {plunging(71), along({0, 0, -1}, {1, 0, 0}), along({0, 0, 2}, {0, 1, 0})}) {
    EXPECT_TRUE(at_shaft(shaft));
    EXPECT_EQ(location_of(shaft, {0.2, 1, 0}), "north wall");
    // True north along x, then along -x.
    EXPECT_EQ(location_of(shaft, {1, 0.2, 0}, geometry::North::degrees(90)), "north wall");
    EXPECT_EQ(location_of(shaft, {0.2, 1, 0}, geometry::North::degrees(-90)), "east wall");
    EXPECT_EQ(position_of(shaft, {1, 1, 0}, geometry::North::degrees(45)), "north");
    EXPECT_EQ(location_of(shaft, {1, 0.2, 0}), "east wall");
    EXPECT_EQ(location_of(shaft, {0.2, -1, 0}), "south wall");
    EXPECT_EQ(location_of(shaft, {-1, 0.2, 0}), "west wall");
    EXPECT_EQ(position_of(shaft, {-1, -1, 0}), "southwest");
    EXPECT_EQ(position_of(shaft, {1, 0, 0}), "east");
  }
}

}  // namespace
}  // namespace cleave::scene::test::held_by_border_test
