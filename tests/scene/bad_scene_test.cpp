#include <gtest/gtest.h>

#include <ostream>

#include "parse_support.hpp"

// Every kind of wrong scene gets its file, line, key, what is wrong and what to do.
namespace cleave::scene::test {
namespace {

struct Bad {
  std::string_view name;
  std::string text;
  std::string_view message;  ///< the whole of it
  Files files = {};
};

void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class BadSceneTest : public testing::TestWithParam<Bad> {};

TEST_P(BadSceneTest, IsToldWithLineKeyAndRemedy) {
  EXPECT_EQ(error_of(GetParam().text, GetParam().files), GetParam().message);
}

std::string name_of_case(const testing::TestParamInfo<Bad>& bad) { return std::string{bad.param.name}; }

const std::string polygon = "[[joint]]\npolygon = ";
const std::string set = "[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nintensity = { count = 3 }\n";

INSTANTIATE_TEST_SUITE_P(
    Scene, BadSceneTest,
    testing::Values(
        Bad{"Empty", "",
            "s.toml:1: domain: the file is empty; start from a scene that cleave init prints: cleave init tunnel"},
        Bad{"OnlyAComment", "# nothing\n",
            "s.toml:1: domain: the file is empty; start from a scene that cleave init prints: cleave init tunnel"},
        Bad{"GravityOfNoTable", with_box("gravity = 9.81\n"),
            "s.toml:3: domain.gravity: unknown key; it belongs to [stability] (of bodies: [elastic] or [contact]); "
            "known here: box, corners, mesh, terrain"},
        Bad{"FrictionOfRock", with_box("[rock]\nfriction = 30\n"),
            "s.toml:4: rock.friction: unknown key; it belongs to [joints.NAME], or [joints.default]; known here: "
            "density, young, poisson"},
        Bad{"NotToml", "v 0 0 0\nf 1 2 3\n",
            "s.toml:1: TOML: Error while parsing key-value pair: expected '=', saw '0'; fix the syntax: see "
            "https://toml.io"},
        Bad{"Twice", with_box("seed = 1\n[domain]\n"),
            "s.toml:4: TOML: [domain] stands twice, in lines 1 and 4; put all its keys under one of them"},
        Bad{"SetsTwice", with_box("[joint_set]\ndip = 3\n[joint_set]\ndip = 4\n"),
            "s.toml:5: TOML: [joint_set] stands twice, in lines 3 and 5; write [[joint_set]], with double brackets, "
            "each time"},
        Bad{"JointThenJoints", with_box("[joint] # one\nset = \"A\"\n[[joint]]\nset = \"B\"\n"),
            "s.toml:5: TOML: [joint] stands twice, in lines 3 and 5; write [[joint]], with double brackets, each time"},
        Bad{"DecimalComma", "seed = 1\nsnap = 0,5 # m\n",
            "s.toml:2: TOML: the number has a decimal comma; write a point"},
        Bad{"InnerDecimalComma",
            with_box("[[joint]]\nplane = { through = [0, 5, 3], dip = 45,5, dip_direction = 90 }\n"),
            "s.toml:4: TOML: the number has a decimal comma; write a point"},
        Bad{"LastDecimalComma", with_box("[[joint]]\nplane = { dip = 45, dip_direction = -90,5 }\n"),
            "s.toml:4: TOML: the number has a decimal comma; write a point"},
        Bad{"NoDecimalComma", with_box("[[joint]]\nplane = { dip = 45, dip_direction : 90 }\n"),
            "s.toml:4: TOML: a key and its value are joined by =, not by a colon; write ="},
        Bad{"ThousandsOrDecimalComma", "snap = 2,700\n",
            "s.toml:1: TOML: the number has a comma; write 2700 where thousands are meant, a point where the comma is "
            "a "
            "decimal one"},
        Bad{"UnitWithoutQuotes", "[joints.A]\nfriction = 30 deg\n",
            "s.toml:2: TOML: a number with its unit stands in quotes; write \"30 deg\""},
        Bad{"DegreesWithoutQuotes", "[joints.A]\nfriction = 30\u00b0\n",
            "s.toml:2: TOML: a number with its unit stands in quotes; write \"30\u00b0\""},
        Bad{"UnitRightBehindTheNumber", "[rock]\nunit_weight = 26kN/m3 # of it\n",
            "s.toml:2: TOML: a number with its unit stands in quotes; write \"26kN/m3\""},
        Bad{"UnitInAnInlineTable", with_box("[[joint]]\nplane = { dip = 45 deg, dip_direction = 90 }\n"),
            "s.toml:4: TOML: a number with its unit stands in quotes; write \"45 deg\""},
        Bad{"LeadingZero", with_box("[[joint]]\nplane = { dip = 45, dip_direction = 045 }\n"),
            "s.toml:4: TOML: a number begins with no 0 before other digits; write 45"},
        Bad{"NoDigitBeforeThePoint", "snap = .5\n", "s.toml:1: TOML: a number begins with a digit; write 0.5"},
        Bad{"NoDigitBehindThePoint", "snap = -30.\n", "s.toml:1: TOML: a point stands between digits; write -30.0"},
        Bad{"ColonForEquals", "[joints.A]\nfriction: 30\n",
            "s.toml:2: TOML: a key and its value are joined by =, not by a colon; write friction = ..."},
        Bad{"CommentOfAnotherLanguage", "seed = 1 // the first\n",
            "s.toml:1: TOML: a comment begins with #, not with //; write #"},
        Bad{"Semicolon", "seed = 1;\n", "s.toml:1: TOML: a line has no semicolon at its end; leave it out"},
        Bad{"InlineTableOverTwoLines", with_box("[[joint]]\nplane = { through = [4, 4, 3],\n  dip = 20 }\n"),
            "s.toml:4: TOML: a table between { and } ends on the line on which it begins; write it on one line, or as "
            "a "
            "[table] of its own with one key a line"},
        Bad{"TrueInCapitals", "[rock]\nflag = True\n", "s.toml:2: TOML: true and false are written small; write true"},
        Bad{"Radius",
            with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 90 }\nshape = \"disc\"\nradius = 3\n"
                     "size = 6\nintensity = { count = 3 }\n"),
            "s.toml:6: joint_set[1].radius: unknown key; give size = 2 radius: the size of a disc is its diameter"},
        Bad{"SizesFromMoreToLess",
            with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 90 }\n"
                     "size = { distribution = \"uniform\", min = 9, max = 3 }\nintensity = { count = 3 }\n"),
            "s.toml:5: joint_set[1].size: min = 9 m is above max = 3 m; swap them"},
        Bad{"Backslashes", "include = \"C:\\sets\\a.toml\"\n",
            "s.toml:1: TOML: a backslash in double quotes begins a sign such as \\n; write paths with / or in single "
            "quotes"},
        Bad{"BackslashThatIsASign", with_box("[[joint]]\nfile = \"data\\new.csv\"\n"),
            "s.toml:4: TOML: a backslash in double quotes begins a sign such as \\n; write paths with / or in single "
            "quotes"},
        Bad{"AWorkbookOfJoints",
            with_box("[[joint]]\nfile = \"j.xlsx\"\n"),
            "s.toml:4: joint[1].file: the ending of \"j.xlsx\" is not known; export the sheet as CSV, and name that "
            "file",
            {{"j.xlsx", "PK\x03\x04rest"}}},
        Bad{"AWorkbookAsCsv",
            with_box("[[joint]]\nfile = \"j.csv\"\n"),
            "j.csv:1: file: is a workbook, not a table in text; export the sheet as CSV",
            {{"j.csv", "PK\x03\x04rest"}}},
        Bad{"ArcWithoutAWall",
            with_box("[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 2, "
                     "height = 2 }\naxis = [[4, 0, 3], [4, 8, 3]]\n[support]\n[[support.bolts]]\ntunnel = \"t\"\n"
                     "spacing = [1, 1]\narc = [10, 60]\nlength = 2\ntendon_capacity = 1e5\nbond_strength = 1e5\n"
                     "anchorage = 0.5\n"),
            "s.toml:12: support.bolts[1].arc: leaves no bolts: no wall of the section has its normal there, or rings "
            "begin beyond the tunnel's end; widen the arc, or lessen the offset"},
        Bad{"ProbabilityOfJointsThatEndAtNone",
            with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 90 }\nsize = 3\n"
                     "intensity = { count = 3 }\nprobability = 50\n"),
            "s.toml:7: joint_set[1].probability: has no meaning for the model \"baecher\"; remove it, or take another "
            "model"},
        Bad{"DipAndDirectionSwapped",
            with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 210, dip_direction = 45 }\n"),
            "s.toml:4: joint[1].plane.dip: is 210; give a number from 0 to 90 degrees, or swap dip and "
            "dip_direction"},
        Bad{"DipTooSteep", with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 210, dip_direction = 100 }\n"),
            "s.toml:4: joint[1].plane.dip: is 210; give a number from 0 to 90 degrees"},
        Bad{"QuotesOfAWordProcessor",
            "title = \xE2\x80\x9C"
            "A\xE2\x80\x9D\n",
            "s.toml:1: TOML: the quotes are those of a word processor; write straight ones (\")"},
        Bad{"NoQuotes", "nonplanar = triangulate\n", "s.toml:1: TOML: text stands in quotes; write \"triangulate\""},
        Bad{"Workbook", "PK\x03\x04rest",
            "s.toml:1: TOML: is a workbook or an archive (.xlsx, .zip), not a text; save the scene as plain text, "
            "tables "
            "as CSV"},
        Bad{"Utf16",
            std::string{"\xFF\xFE"
                        "s\0e\0",
                        6},
            "s.toml:1: TOML: is UTF-16 text; save it as UTF-8 (in Notepad: Save as, Encoding UTF-8)"},
        Bad{"SingleBrackets", with_box("[joint_set]\ndip = 3\n"),
            "s.toml:3: joint_set: is a table but must be a list of tables; write [[joint_set]], with double brackets"},
        Bad{"ASurvey", "[[orientations]]\nfile = \"a.csv\"\n",
            "s.toml:1: scene: is a survey file, not a scene; run cleave survey s.toml -o FOLDER"},
        Bad{"SetsAlone", "[[joint_set]]\nname = \"A\"\n[joints.A]\nfriction = 30\n",
            "s.toml:1: scene: has joint sets alone: it is a part of scenes, not one; write a scene with [domain] and "
            "include = [\"s.toml\"]"},
        Bad{"NoDomain", "seed = 3\n",
            "s.toml:1: domain: is missing; add [domain] with box = { min = [0, 0, 0], max = [80, 80, 60] }, corners, "
            "mesh or terrain"},
        Bad{"UnknownKey", "sead = 3\n" + std::string{box}, "s.toml:1: sead: unknown key; did you mean \"seed\"?"},
        Bad{"UnknownSection", with_box("[stabillity]\n"),
            "s.toml:3: stabillity: unknown key; did you mean \"stability\"?"},
        Bad{"UnknownInner", with_box("[stability]\nfree = [\"top\"]\ngravty = 9.81\n"),
            "s.toml:5: stability.gravty: unknown key; did you mean \"gravity\"?"},
        Bad{"LaterSection", with_box("[contact]\nsteps = 10\n"),
            "s.toml:3: contact: belongs to scenes in two dimensions, which hold [[body]] and none of [domain], joints; "
            "remove "
            "the section, or put the bodies into a scene of their own"},
        Bad{"MonteCarloWithoutLength", with_box("[monte_carlo]\nconfidence = 0.9\n"),
            "s.toml:3: monte_carlo: holds none of: realizations, stop; give exactly one of them"},
        Bad{"MonteCarloTwoLengths",
            with_box("[monte_carlo]\nrealizations = 5\nstop = { max = 9, relative_half_width = 1 }\n"),
            "s.toml:5: monte_carlo.stop: stands beside \"realizations\"; give exactly one of: realizations, stop"},
        Bad{"MonteCarloNoRealization", with_box("[monte_carlo]\nrealizations = 0\n"),
            "s.toml:4: monte_carlo.realizations: is 0; give a whole number from 1 to 100000000"},
        Bad{"MonteCarloUnknownQuantity",
            with_box("[stability]\nfree = [\"top\"]\n[monte_carlo]\nstop = { quantity = \"key_block_volum\", "
                     "relative_half_width = 0.1, max = 9 }\n"),
            "s.toml:6: monte_carlo.stop.quantity: \"key_block_volum\" is not known; did you mean "
            "\"key_block_volume_m3\"?"},
        Bad{"CohesionLawWithoutStd", with_box("[joints.default]\ncohesion = { distribution = \"normal\", mean = 5 }\n"),
            "s.toml:4: joints.default.cohesion.std: is missing; add std = a number from 0 to 1e+15 Pa"},
        Bad{"LaterBodies", with_box("[[body]]\nname = \"a\"\n"),
            "s.toml:3: body: belongs to scenes in two dimensions, which hold [[body]] and none of [domain], joints; "
            "remove "
            "the section, or put the bodies into a scene of their own"},
        Bad{"UnknownModel", with_box(set + "size = 5\nmodel = \"venetian\"\n"),
            "s.toml:7: joint_set[1].model: \"venetian\" is not known; did you mean \"veneziano\"? choose one of: "
            "baecher, "
            "enhanced_baecher, veneziano, dershowitz, mosaic, hierarchical, mit, orthogonal"},
        Bad{"KeyOfAnotherModel", with_box(set + "size = 5\nmodel = \"veneziano\"\nterminate_at = [\"B\"]\n"),
            "s.toml:8: joint_set[1].terminate_at: has no meaning for the model \"veneziano\"; remove it, or take "
            "another "
            "model"},
        Bad{"TerminatesAtNothing", with_box(set + "size = 5\nterminate_at = [\"B\"]\n"),
            "s.toml:7: joint_set[1].terminate_at: there are no joints of a set \"B\"; name other sets, of "
            "[[joint_set]] "
            "or [[joint]]"},
        Bad{"TerminatesAtItself", with_box(set + "name = \"A\"\nsize = 5\nterminate_at = [\"A\"]\n"),
            "s.toml:8: joint_set[1].terminate_at: \"A\" is this set itself; name other sets, of [[joint_set]] or "
            "[[joint]]"},
        Bad{"TerminatesInACircle",
            with_box(set + "name = \"A\"\nsize = 5\nterminate_at = [\"B\"]\n" + set +
                     "name = \"B\"\nsize = 5\nterminate_at = [\"A\"]\n"),
            "s.toml:8: joint_set[1].terminate_at: ends at sets that end at this one: nothing is older; leave one of "
            "them "
            "out"},
        Bad{"PersistentPolygons", with_box(set + "size = \"persistent\"\nmodel = \"veneziano\"\n"),
            "s.toml:6: joint_set[1].size: the model \"veneziano\" needs joints of a size; give shape and size, or the "
            "model \"baecher\" for persistent joints"},
        Bad{"WrongSchema", "schema = 2\n" + std::string{box},
            "s.toml:1: schema: is not a version that this program knows; write schema = 1"},
        Bad{"SeedIsText", "seed = \"x\"\n" + std::string{box},
            "s.toml:1: seed: is text but must be a whole number; give a whole number from 0 to 9223372036854775807"},
        Bad{"NegativeSnap", "snap = -1e-3\n" + std::string{box},
            "s.toml:1: snap: is -0.001; give a number from 0 to 1e+06 m"},
        Bad{"UnknownPolicy", "nonplanar = \"triangle\"\n" + std::string{box},
            "s.toml:1: nonplanar: \"triangle\" is not known; did you mean \"triangulate\"? choose one of: refuse, "
            "triangulate"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Domain, BadSceneTest,
    testing::Values(
        Bad{"ZeroVolume", "[domain]\nbox = { min = [0, 0, 5], max = [8, 8, 5] }\n",
            "s.toml:2: domain.box: has zero volume: min z = 5, max z = 5; make every number of min smaller than that "
            "of max"},
        Bad{"NegativeVolume", "[domain]\nbox = { min = [0, 9, 0], max = [8, 8, 5] }\n",
            "s.toml:2: domain.box: has negative volume: min y = 9, max y = 8; make every number of min smaller than "
            "that of max"},
        Bad{"NotANumber", "[domain]\nbox = { min = [0, nan, 0], max = [8, 8, 5] }\n",
            "s.toml:2: domain.box.min: is nan, which is not a number to work with; give a number from -1e+09 to 1e+09 "
            "m"},
        Bad{"Infinite", "[domain]\nbox = { min = [0, 0, 0], max = [8, inf, 5] }\n",
            "s.toml:2: domain.box.max: is inf, which is not a number to work with; give a number from -1e+09 to 1e+09 "
            "m"},
        Bad{"Enormous", "[domain]\nbox = { min = [0, 0, 0], max = [8, 1e300, 5] }\n",
            "s.toml:2: domain.box.max: is 1e+300; give a number from -1e+09 to 1e+09 m"},
        Bad{"TwoKinds", with_box("mesh = \"a.stl\"\n"),
            "s.toml:3: domain.mesh: stands beside \"box\"; give exactly one of: box, corners, mesh, terrain"},
        Bad{"NoKind", "[domain]\n",
            "s.toml:1: domain: holds none of: box, corners, mesh, terrain; give exactly one of them"},
        Bad{"SevenCorners", "[domain]\ncorners = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,1],[1,0,1],[0,1,1]]\n",
            "s.toml:2: domain.corners: has 7 points but must have 8; list the corners by the bits x, y, z of their "
            "number: [min, min, "
            "min], [max, min, min], [min, max, min], ..."},
        Bad{"MissingMesh", "[domain]\nmesh = \"pit.stl\"\n",
            "s.toml:2: domain.mesh: the file does not exist; check the name"},
        Bad{"MinMissing", "[domain]\nbox = { max = [1, 1, 1] }\n",
            "s.toml:2: domain.box.min: is missing; add min = [x, y, z]"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Strength, BadSceneTest,
    testing::Values(
        Bad{"NegativeFriction", with_box("[joints.default]\nfriction = -5\n"),
            "s.toml:4: joints.default.friction: is -5; give a number at least 0 and below 90 degrees"},
        Bad{"FrictionOf90", with_box("[joints.default]\nfriction = 90\n"),
            "s.toml:4: joints.default.friction: is 90; give a number at least 0 and below 90 degrees"},
        Bad{"FrictionWithUnitOfAnotherKind", with_box("[joints.default]\nfriction = \"30 kN\"\n"),
            "s.toml:4: joints.default.friction: is \"30 kN\", which is no number with a unit of degrees; write a bare "
            "number at least 0 and below 90 degrees, or a text with a unit such as \"35 deg\" (units: deg, degrees, °, "
            "rad, gon)"},
        Bad{"CountWithUnit", with_box("[stability]\nmax_batches = \"30 m\"\n"),
            "s.toml:4: stability.max_batches: is text but must be a whole number; give a whole number from 1 to "
            "1000000"},
        Bad{"RatioWithUnit", with_box("[stability]\nseismic = [\"1 m\", 0, 0]\n"),
            "s.toml:4: stability.seismic: is text but must be a number; write a bare number from -1000 to 1000, "
            "without "
            "quotes and unit"},
        Bad{"PropertiesOfNoJoint",
            with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\nset = \"bedding\"\n"
                     "[joints.beding]\nfriction = 12\n"),
            "s.toml:6: joints.beding: no joint belongs to this set; did you mean \"bedding\"?"},
        Bad{"OldAndNewName", with_box("[stability]\nstrict = true\nrequire_open_cone = true\n"),
            "s.toml:4: stability.strict: stands beside \"require_open_cone\", its new name; give one of them"},
        Bad{"FrictionLawWithoutMax",
            with_box("[joints.default]\nfriction = { distribution = \"uniform\", min = 20 }\n"),
            "s.toml:4: joints.default.friction.max: is missing; add min and max, in degrees"},
        Bad{"FrictionLimitsSwapped",
            with_box("[joints.default]\nfriction = { distribution = \"uniform\", min = 30, max = 20 }\n"),
            "s.toml:4: joints.default.friction.min: is 30, above max = 20; swap them"},
        Bad{"NegativeCohesion", with_box("[joints.default]\ncohesion = -1\n"),
            "s.toml:4: joints.default.cohesion: is -1; give a number from 0 to 1e+15 Pa"},
        Bad{"FrictionWithoutSet", with_box("[joints]\nfriction = 30\n"),
            "s.toml:4: joints.friction: is a whole number but must be a table of a joint set; put it under "
            "[joints.default]"},
        Bad{"DensityZero", with_box("[rock]\ndensity = 0\n"),
            "s.toml:4: rock.density: is 0; give a number above 0 and at most 100000 kg/m3"},
        Bad{"DensityNegative", with_box("[rock]\ndensity = -2700\n"),
            "s.toml:4: rock.density: is -2700; give a number above 0 and at most 100000 kg/m3"},
        Bad{"FreeFaceMisspelt", with_box("[stability]\nfree = [\"topp\"]\n"),
            "s.toml:4: stability.free: \"topp\" is no face of the domain; did you mean \"top\"? faces are: west, east, "
            "south, north, "
            "bottom, top"},
        Bad{"FreeIsText", with_box("[stability]\nfree = \"top\"\n"),
            "s.toml:4: stability.free: must be a list of texts; write [\"a\", \"b\"]"},
        Bad{"BatchesZero", with_box("[stability]\nmax_batches = 0\n"),
            "s.toml:4: stability.max_batches: is 0; give a whole number from 1 to 1000000"},
        Bad{"OutputIsText", with_box("[output]\nvtu = \"yes\"\n"),
            "s.toml:4: output.vtu: is text but must be true or false; write true or false, without quotes"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Joints, BadSceneTest,
    testing::Values(
        Bad{"DipOver90", with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 95, dip_direction = 0 }\n"),
            "s.toml:4: joint[1].plane.dip: is 95; give a number from 0 to 90 degrees, or swap dip and dip_direction"},
        Bad{"DirectionOf442", with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 45, dip_direction = 442 }\n"),
            "s.toml:4: joint[1].plane.dip_direction: is 442; give a number from 0 to 360 degrees"},
        Bad{"RadiusZero",
            with_box("[[joint]]\ndisc = { centre = [1, 1, 1], dip = 45, dip_direction = 0, radius = 0 }\n"),
            "s.toml:4: joint[1].disc.radius: is 0; give a number above 0 and at most 1e+09 m"},
        Bad{"NoShape", with_box("[[joint]]\nset = \"A\"\n"),
            "s.toml:3: joint[1]: holds none of: file, plane, disc, polygon; give exactly one of them"},
        Bad{"SingleBrackets", with_box("[joint]\nfile = \"a.obj\"\n"),
            "s.toml:3: joint: is a table but must be a list of tables; write [[joint]], with double brackets"},
        Bad{"MissingFile", with_box("[[joint]]\nfile = \"a.obj\"\n"),
            "s.toml:4: joint[1].file: the file does not exist; check the name"},
        Bad{"SecondJoint",
            with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 45, dip_direction = 0 }\n[[joint]]\nfile = 3\n"),
            "s.toml:6: joint[2].file: is a whole number but must be text; put it in double quotes"},
        Bad{"PointOfTwo", with_box(polygon + "[[0, 0, 0], [1, 0], [1, 1, 0]]\n"),
            "s.toml:4: joint[1].polygon[2]: has 2 entries but must have three; write [x, y, z]"},
        Bad{"SizeWithoutLaw", with_box(set + "size = { mean = 5 }\n"),
            "s.toml:6: joint_set[1].size.distribution: is missing; add distribution = \"constant\""},
        Bad{"SizeMissing", with_box(set),
            "s.toml:3: joint_set[1].size: is missing; add size = { distribution = \"normal\", mean = 100, std = 30, "
            "min = 1, max = 300 }, "
            "or \"persistent\""},
        Bad{"AspectOfDisc", with_box(set + "size = 5\nshape = \"disc\"\naspect = 2\n"),
            "s.toml:8: joint_set[1].aspect: has no meaning for a shape with one size; remove it, or use the shape "
            "rectangle or ellipse"},
        Bad{"KappaOfUniform",
            with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 30, distribution = \"uniform\", "
                     "dip_range = 5, "
                     "dip_direction_range = 5, kappa = 3 }\nintensity = { count = 3 }\nsize = 5\n"),
            "s.toml:4: joint_set[1].orientation.kappa: has no meaning for the distribution \"uniform\"; remove it, or "
            "set distribution "
            "= \"fisher\""},
        Bad{"TwoIntensities",
            with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nintensity = { count = 3, p32 = 1 "
                     "}\nsize = 5\n"),
            "s.toml:5: joint_set[1].intensity.p32: stands beside \"count\"; give exactly one of: count, p32, p30, p10, "
            "spacing"},
        Bad{"ShapeMisspelt", with_box(set + "size = 5\nshape = \"disk\"\n"),
            "s.toml:7: joint_set[1].shape: \"disk\" is not known; did you mean \"disc\"? choose one of: rectangle, "
            "square, disc, ellipse, "
            "polygon"},
        Bad{"PolygonOfTwoSides", with_box(set + "size = 5\nshape = \"polygon(2)\"\n"),
            "s.toml:7: joint_set[1].shape: \"polygon(2)\" is not known; write polygon(N), disc(N) or ellipse(N) with N "
            "from 3 to 256"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Excavations, BadSceneTest,
    testing::Values(
        Bad{"NoKind", with_box("[[excavation]]\nname = \"t\"\n"),
            "s.toml:3: excavation[1].kind: is missing; add kind = \"...\""},
        Bad{"KeyOfAnotherShape",
            with_box("[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2, width = 2 "
                     "}\naxis = [[4, 0, 3], "
                     "[4, 8, 3]]\n"),
            "s.toml:5: excavation[1].section.width: unknown key; known here: shape, segments, diameter, radius"},
        Bad{"NoAxis", with_box("[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2 }\n"),
            "s.toml:3: excavation[1].axis: is missing; add axis = [[x, y, z], [x, y, z]]"},
        Bad{"TunnelBesideTheRock",
            with_box("[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2 }\n"
                     "axis = [[40, 0, 3], [40, 8, 3]]\n"),
            "s.toml:3: excavation[1]: removes no rock: it lies wholly outside the domain; move it into the domain, or "
            "enlarge the domain"},
        Bad{"SlopeAboveTheRock",
            with_box(
                "[[excavation]]\nkind = \"slope\"\nplane = { through = [0, 0, 40], dip = 30, dip_direction = 90 }\n"),
            "s.toml:5: excavation[1].plane: lies above the whole domain and takes nothing out; check its point and "
            "dip"},
        Bad{"FaceOutOfRange",
            with_box("[[excavation]]\nkind = \"polyhedron\"\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, "
                     "1]]\nfaces = [[1, 3, 2], "
                     "[1, 2, 5]]\n"),
            "s.toml:6: excavation[1].faces: face 2 is not a list of three or more vertex numbers from 1 to 4; write "
            "faces = [[1, 2, 3], "
            "...]"}),
    name_of_case);

TEST(BadSceneTest, AllMistakesAreToldInTheOrderOfTheFile) {
  const auto lines = errors_of(
      "sead = 1\n[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 0] }\n[rock]\ndensity = 0\n[joints.A]\nfriction = -1\n"
      "cohesion = -2\n[stability]\nmax_batches = -1\n");
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_TRUE(lines[0].starts_with("s.toml:1: sead: ")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("s.toml:3: domain.box: ")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("s.toml:5: rock.density: ")) << lines[2];
  EXPECT_TRUE(lines[3].starts_with("s.toml:7: joints.A.friction: ")) << lines[3];
  EXPECT_TRUE(lines[4].starts_with("s.toml:8: joints.A.cohesion: ")) << lines[4];
  EXPECT_TRUE(lines[5].starts_with("s.toml:10: stability.max_batches: ")) << lines[5];
}

TEST(BadSceneTest, PolygonsAreRefusedForTheirOwnReasons) {
  const auto told = [](std::string_view corners) { return error_of(with_box(polygon + std::string{corners} + "\n")); };
  const std::vector<std::string> messages{
      told("[[0, 0, 0], [1, 0, 0]]"),                        // two points
      told("[[0, 0, 0], [1, 1, 1], [2, 2, 2]]"),             // on a line
      told("[[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]"),  // self-crossing
      told("[[1, 1, 1], [1, 1, 1], [1, 1, 1]]"),             // zero area
      told("[[0, 0, 0], [4, 0, 0], [4, 4, 1], [0, 4, 0]]"),  // not planar
  };
  for (const std::string& message : messages) {
    EXPECT_TRUE(message.starts_with("s.toml:4: joint[1].polygon: ")) << message;
    EXPECT_NE(message.find(';'), std::string::npos) << message;  // a remedy
  }
  EXPECT_NE(messages[4].find("triangulate"), std::string::npos) << messages[4];
}

TEST(BadSceneTest, ManyMistakesAreCountedNotPrinted) {
  std::string text{box};
  for (int i = 0; i < 1000; ++i) text += "[[joint]]\nset = 3\n";
  const auto lines = errors_of(text);
  ASSERT_EQ(lines.size(), 201U);
  EXPECT_NE(lines.back().find("1800 more errors are not shown"), std::string::npos) << lines.back();
}

// Whatever reads it, and however often.
TEST(BadSceneTest, AWrongValueIsToldOnce) {
  const auto errors = errors_of(with_box("[stability]\nfree = [\"top\"]\ntarget = { falling = 150, sliding = -1 }\n"));
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_TRUE(errors[0].contains("stability.target.falling: is 150")) << errors[0];
  EXPECT_TRUE(errors[1].contains("stability.target.sliding: is -1")) << errors[1];
}

TEST(BadSceneTest, KeysThatBoltsMissAreToldTogether) {
  const auto errors =
      errors_of(with_box("[stability]\n[[support.bolts]]\nat = [[4, 4, 6]]\ndirection = [0, 0, -1]\nlength = 2\n"
                         "tendon_capacity = 1e5\n"));
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_TRUE(errors[0].contains("support.bolts[1].anchorage: is missing")) << errors[0];
  EXPECT_TRUE(errors[1].contains("support.bolts[1].bond_strength: is missing")) << errors[1];
}

TEST(BadSceneTest, ControlCharactersAreRefused) {
  for (const std::string text : {"\"a\\u001b[31m\" = 1\n", "title = \"a\\u001b]0;b\\u0007\"\n",
                                 "title = \"a\\u009b31m\"\n", "title = \"a\\nkey blocks   0\"\n"}) {
    const std::string message = error_of("\n" + text + with_box(""));
    EXPECT_TRUE(message.contains("s.toml:2: TOML: a key or a text holds control characters")) << message;
    EXPECT_EQ(message.find('\x1b'), std::string::npos);
  }
  EXPECT_EQ(describe({"a\x1b[31m", 1, "k\xC2\x9B", "w", ""}), "a\\x1b[31m:1: k\\xc2\x9B: w");
}

}  // namespace
}  // namespace cleave::scene::test
