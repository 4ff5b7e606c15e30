// Slips that would change a verdict without a word: what is stated twice, what nothing reads, what is counted in per
// cent. Each is refused, or noted.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/scene2d/contact.hpp"
#include "run_scene.hpp"

namespace cleave::scene::test::silent_slips_test {
namespace {

/// A wedge between two joints at the top of a slope.
std::string wedge(const std::string& more, const std::string& third = "") {
  return "[domain]\ncorners = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0], [0, 0, 10], [16.360298, 0, 10], "
         "[0, 20, 10], [16.360298, 20, 10]]\n"
         "[[joint]]\nplane = { through = [19.5, 10, 1], dip = 60, dip_direction = 45 }\nset = \"north-east\"\n"
         "[[joint]]\nplane = { through = [19.5, 10, 1], dip = 60, dip_direction = 135 }\n" +
         third + "[rock]\ndensity = 2700\n[joints.default]\nfriction = 50\n" + more;
}
const std::string second = "set = \"south-east\"\n";
const std::string free_faces = "[stability]\nfree = [\"top\", \"east\"]\n";

TEST(SilentSlips, DefaultOfPressuresIsThatOfSetsNotNamed) {
  const auto counted = [](const std::string& water, const std::string& third) {
    return run_of(wedge(free_faces + "groups = \"off\"\nwater = { pressures = { " + water + " } }\n", third))
        .figures.key_blocks->count;
  };
  const std::string both = "north-east = \"50 kPa\", south-east = \"50 kPa\"";
  EXPECT_EQ(counted("north-east = 0", second), 0U);
  EXPECT_EQ(counted(both, second), 1U);
  EXPECT_EQ(counted("default = \"50 kPa\"", second), 1U);
  EXPECT_EQ(counted("default = \"50 kPa\"", ""), 1U) << "a joint of no set, and one that has a set";
  const auto pressures = [](const std::string& text) {
    const Scene scene = scene_of(text);
    std::vector<std::vector<std::optional<double>>> of{scene.stability->loads.actions.spec().joint_pressure};
    for (const LoadCase& load : scene.stability->cases) of.push_back(load.loads.actions.spec().joint_pressure);
    return of;
  };
  using Of = std::vector<std::vector<std::optional<double>>>;
  // Sets: of no name, north-east, south-east.
  EXPECT_EQ(pressures(wedge(free_faces + "water = { pressures = { default = 50e3, north-east = 1e3 } }\n", second)),
            (Of{{50e3, 1e3, 50e3}}));
  EXPECT_EQ(pressures(wedge(free_faces + "water = { pressures = { north-east = 1e3 } }\n"
                                         "[[load]]\nname = \"wet\"\nwater = { pressures = { default = 50e3 } }\n",
                            second)),
            (Of{{std::nullopt, 1e3, std::nullopt}, {50e3, 50e3, 50e3}}));
}

std::vector<std::string> notes_of(const Scene& scene) {
  std::vector<std::string> notes;
  for (const Problem& note : scene.notes) notes.push_back(describe(note));
  return notes;
}

bool has(const std::vector<std::string>& lines, std::string_view part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.contains(part); });
}

const std::string set_a =
    "[[joint_set]]\nname = \"A\"\norientation = { dip = 50, dip_direction = 60 }\nsize = 2\nintensity = { count = 4 "
    "}\n";

TEST(SilentSlips, TwoJointSetsOfOneNameAreRefused) {
  EXPECT_EQ(
      error_of(with_box(set_a + set_a)),
      "s.toml:9: joint_set[2].name: \"A\" is the name of another joint set, s.toml:4; give each set a name of its "
      "own");
  EXPECT_EQ(
      error_of("include = [\"n.toml\", \"e.toml\"]\n" + with_box(""), {{"n.toml", set_a}, {"e.toml", "\n" + set_a}}),
      "e.toml:3: joint_set[2].name: \"A\" is the name of another joint set, n.toml:2; give each set a name of its "
      "own");
  EXPECT_EQ(
      error_of("include = \"n.toml\"\n" + with_box(set_a), {{"n.toml", set_a}}),
      "n.toml:2: joint_set[2].name: \"A\" is the name of another joint set, s.toml:5; give each set a name of its "
      "own");
  // A set may have joints that are given beside those that are drawn.
  EXPECT_TRUE(
      notes_of(scene_of(with_box(
                   set_a + "[[joint]]\nplane = { through = [4, 4, 3], dip = 5, dip_direction = 0 }\nset = \"A\"\n")))
          .empty());
}

TEST(SilentSlips, AFileIncludedTwiceIsRefused) {
  const std::string joint = "[[joint]]\nplane = { through = [4, 4, 3], dip = 5, dip_direction = 0 }\n";
  EXPECT_EQ(error_of("include = [\"n.toml\", \"n.toml\"]\n" + with_box(""), {{"n.toml", joint}}),
            "s.toml:1: include: names n.toml twice: each of its joints would be there twice; name it once");
  EXPECT_EQ(error_of("include = [\"n.toml\", \"./n.toml\"]\n" + with_box(""), {{"n.toml", joint}, {"./n.toml", joint}}),
            "s.toml:1: include: n.toml and ./n.toml hold the same; name it once");
}

TEST(SilentSlips, StrengthsInTwoIncludedFilesAreRefused) {
  const Files files{{"a.toml", "[joints.default]\nfriction = 20\n"}, {"b.toml", "\n[joints.default]\nfriction = 50\n"}};
  const std::string rest = with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 5, dip_direction = 0 }\n");
  EXPECT_EQ(
      error_of("include = [\"a.toml\", \"b.toml\"]\n" + rest, files),
      "b.toml:2: joints.default: stands in a.toml:1 as well; keep one of them, or state it in the scene, which goes "
      "before both");
  const Scene own =
      scene_of("include = [\"a.toml\", \"b.toml\"]\n" + rest + "[joints.default]\nfriction = 30\n", files);
  EXPECT_EQ(own.sets[own.joints.front().set].properties.friction.mean, 30);
  const auto notes = notes_of(own);
  EXPECT_TRUE(has(notes, "a.toml:1: joints.default: is not used: s.toml:6 states it too; the scene goes before"))
      << notes[0];
  EXPECT_TRUE(has(notes, "b.toml:2: joints.default: is not used: s.toml:6 states it too; the scene goes before"));
  EXPECT_TRUE(error_of("include = \"c.toml\"\n" + rest, {{"c.toml", "[joint]\nset = \"A\"\n"}})
                  .starts_with("c.toml:1: joint: is a table, and in s.toml it is an array; write [[joint]]"));
}

const std::string tunnel =
    "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", radius = 1 }\n"
    "axis = [[4, 0, 3], [4, 8, 3]]\n";
std::string set_of(const std::string& name, int direction) {
  return "[[joint_set]]\n" + name + "orientation = { dip = 50, dip_direction = " + std::to_string(direction) +
         " }\nsize = 2\nintensity = { count = 4 }\n";
}

TEST(SilentSlips, LargestKeyBlocksNeedThreeSets) {
  const std::string a = set_of("name = \"A\"\n", 60), b = set_of("name = \"B\"\n", 180);
  const auto with = [](const std::string& sets) {
    return "[stability]\nmaximum_blocks = { tunnel = \"t\"" + sets + " }\n" + tunnel;
  };
  EXPECT_EQ(
      error_of(with_box(with("") + a + b)),
      "s.toml:4: stability.maximum_blocks: has 2 of the three joint sets that make a block at a tunnel; add joints "
      "of other sets, or remove it");
  EXPECT_EQ(
      error_of(with_box(with(", sets = [\"A\", \"A\", \"B\"]") + a + b)),
      "s.toml:4: stability.maximum_blocks: has 2 of the three joint sets that make a block at a tunnel; name three "
      "sets, each once");
  EXPECT_TRUE(has(errors_of(with_box(with(", sets = [\"A\", \"B\", \"default\"]") + a + b)),
                  "names the set \"default\", and no joint belongs to it; name another"));
  EXPECT_TRUE(has(errors_of(with_box(with("") + a + b + set_of("", 300) + set_of("", 0))),
                  "takes the joint sets without a name as one, with the orientation of the first; give each a name"));
  EXPECT_TRUE(parse_text(with_box(with("") + a + b + set_of("", 300))).has_value());
}

TEST(SilentSlips, AHalfWidthInPerCentIsRefused) {
  const auto stop = [](const std::string& width) {
    return with_box(set_a + tunnel + "[stability]\n[monte_carlo]\nstop = { relative_half_width = " + width +
                    ", max = 200 }\n");
  };
  EXPECT_EQ(error_of(stop("10")),
            "s.toml:15: monte_carlo.stop.relative_half_width: is 10, which is 10 times the mean; for 10 % of the mean "
            "write 0.1");
  EXPECT_TRUE(error_of(stop("2.5")).contains("for 2.5 % of the mean write 0.025"));
  EXPECT_TRUE(error_of(stop("1000")).contains("relative_half_width: is 1000; give a number "));
  EXPECT_TRUE(parse_text(stop("1")).has_value());
}

TEST(SilentSlips, LimitsOfMicroBlocksFarFromCrumbsAreNoted) {
  const auto notes = [](const std::string& limit) {
    return notes_of(scene_of(wedge(free_faces + "[micro_blocks]\n" + limit + "\n", second)));
  };
  EXPECT_TRUE(has(notes("thickness = 5"),
                  "micro_blocks.thickness: is 5 m, which is far from usual (1e-09 to 0.5); if it is meant in "));
  EXPECT_TRUE(has(notes("volume = 1000"), "micro_blocks.volume: is 1000 m3, which is far from usual"));
  EXPECT_TRUE(notes("thickness = 0.1\nvolume = 1").empty());
}

TEST(SilentSlips, MicroBlocksLeftOutThatWouldMoveAreSaid) {
  const auto run = [](const std::string& friction, const std::string& more) {
    return run_of(wedge(free_faces + "groups = \"off\"\n[joints.south-east]\nfriction = " + friction +
                            "\n[joints.north-east]\nfriction = " + friction +
                            "\n[micro_blocks]\npolicy = \"exclude\"\nthickness = 5\n" + more,
                        second));
  };
  const RunResult moving = run("30", "");
  EXPECT_EQ(moving.figures.key_blocks->count, 0U);
  EXPECT_EQ(
      notes_with(moving,
                 "1 block (54.92 m3) left out by [micro_blocks] would move, and is in no count of key blocks: the "
                 "least factor of safety is 0.596 (block "),
      1U)
      << moving.notes.back();
  EXPECT_EQ(notes_with(moving, "left out by"), 1U);
  EXPECT_EQ(notes_with(run("60", ""), "left out by"), 0U);
  const RunResult shaken = run("60", "[[load]]\nname = \"quake\"\nseismic = [1, 0, 0]\n");
  EXPECT_EQ(notes_with(shaken, "load case quake: 1 block (54.92 m3) left out by [micro_blocks] would move"), 1U);
}

TEST(SilentSlips, TwoExcavationsOfOneNameAreRefused) {
  const std::string other =
      "[[excavation]]\nname = \"t\"\nkind = \"polyhedron\"\nbox = { min = [6, 1, 1], max = [7, 2, 2] }\n";
  EXPECT_EQ(error_of(with_box(tunnel + other)),
            "s.toml:9: excavation[2].name: \"t\" is the name of another excavation, in line 4; give each a name of its "
            "own");
  EXPECT_TRUE(error_of(with_box("[[excavation]]\nname = \"excavation[2]\"" + other.substr(other.find("\nkind")) +
                                "[[excavation]]" + other.substr(other.find("\nkind"))))
                  .contains("excavation[2].name: \"excavation[2]\" is the name of another excavation, in line 4"));
}

TEST(SilentSlips, SectionsDrawnAboutAnotherPointThanTheirMiddleAreNoted) {
  const auto notes = [](const std::string& corners) {
    return notes_of(scene_of(with_box("[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"polygon\", corners = " +
                                      corners + " }\naxis = [[4, 0, 3], [4, 8, 3]]\n")));
  };
  const std::string_view said = "excavation[1].section.corners: lie about";
  EXPECT_TRUE(
      has(notes("[[-1, 0], [1, 0], [1, 2], [-1, 2]]"),
          "excavation[1].section.corners: lie about (0, 1), where the axis goes through them: not through their (0, "
          "0); to have (0, 0) on the axis as it is now, move the axis by 0 m to the right and 1 m up"));
  EXPECT_FALSE(has(notes("[[-1, -1], [1, -1], [1, 1], [-1, 1]]"), said));
  EXPECT_FALSE(has(notes("[[-1, -0.99], [1, -0.99], [1, 1.01], [-1, 1.01]]"), said));
}

TEST(SilentSlips, LawsCutFarFromTheirMeanAreNoted) {
  const auto notes = [](const std::string& law) {
    return notes_of(scene_of(wedge(
        "[joints.north-east]\nfriction = { distribution = \"normal\", mean = 30, std = 5, " + law + " }\n" + free_faces,
        second)));
  };
  EXPECT_TRUE(
      has(notes("min = 40, max = 50"),
          "joints.north-east.friction.mean: is 30, outside of min..max: no more than a tail of the law is drawn; "
          "mean and std are those of the law before it is cut"));
  EXPECT_TRUE(notes("min = 20, max = 40").empty());
}

TEST(SilentSlips, WaterAndGravityOfBodiesAreLookedAt) {
  const auto notes = [](const std::string& water, const std::string& gravity) {
    const std::string joint = water.contains("[joints.block]") ? "joint = \"block\"\n" : "";
    const auto scene = parse_contact(
        "[rock]\ndensity = 2600\n[contact]\nstatic = true\n" + gravity + "[joints.default]\nfriction = 30\n" + water +
            "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
            "[[body]]\nname = \"block\"\n" +
            joint + "rectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n",
        "s.toml");
    std::vector<std::string> said;
    EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
    if (!scene) return said;
    for (const Problem& note : scene->notes) said.push_back(describe(note));
    return said;
  };
  EXPECT_TRUE(
      has(notes("water_table = 500\n", ""),
          "joints.default.water_table: is 500, above all bodies (up to 1): they stand under water; it is a level "
          "in the coordinates of the scene, not a depth or a level above the sea"));
  EXPECT_TRUE(has(notes("water_table = -2\n", ""), "is -2, below all bodies (from -1 on), so that nothing is wet"));
  EXPECT_TRUE(has(notes("[joints.block]\nwater_table = 3\n", ""), "joints.block.water_table: is 3, above all bodies"));
  EXPECT_FALSE(has(notes("water_table = 0.5\n[joints.block]\nfriction = 20\n", ""), "water_table"));
  EXPECT_TRUE(has(notes("", "gravity = [0, 9.81]\n"), "contact.gravity: points upwards, as y does"));
  EXPECT_FALSE(has(notes("", "gravity = [1, -9.81]\n"), "gravity"));
}

// One mistake, one message: what names an opening that could not be read is no mistake of its own.
TEST(SilentSlips, AWrongExcavationIsTheOnlyError) {
  const std::string wrong =
      "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", radius = 1 }\naxis = [[4, 0, "
      "3]]\n";
  const std::string users =
      "[field_stress]\ntunnel = \"t\"\nstress = [-1e6, -1e6, -1e6, 0, 0, 0]\n[rock]\ndensity = 2700\npoisson = 0.25\n"
      "[stability]\nsurcharge = [{ on = \"t\", pressure = 10e3 }]\nmaximum_blocks = { tunnel = \"t\" }\n"
      "[support]\nshotcrete = { thickness = 0.1, strength = 1e6 }\n[[support.bolts]]\ntunnel = \"t\"\nspacing = [2, "
      "2]\n"
      "length = 3\ntendon_capacity = 200e3\nbond_strength = 200e3\nanchorage = 0.5\n"
      "[monte_carlo]\nstop = { relative_half_width = 0.1, max = 200 }\n";
  EXPECT_TRUE(error_of(with_box(wrong + users)).starts_with("s.toml:7: excavation[1].axis: "));
  EXPECT_TRUE(error_of(with_box("[[excavation]]\nname = \"t\"\nkind = \"tunel\"\n" + users))
                  .starts_with("s.toml:5: excavation[1].kind: "));
  EXPECT_TRUE(has(errors_of(with_box(users)), "\"t\" is neither an excavation"));
}

}  // namespace
}  // namespace cleave::scene::test::silent_slips_test
