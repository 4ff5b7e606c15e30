#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cleave/realize/run.hpp"
#include "cleave/scene/plan.hpp"
#include "parse_support.hpp"

namespace cleave::scene::test {
namespace {

const topology::PersistentJoint& plane_of(const Scene& scene, std::size_t joint) {
  return std::get<topology::PersistentJoint>(scene.joints.at(joint).geometry);
}
std::span<const geometry::Polygon> polygons_of(const Scene& scene, std::size_t joint) {
  return std::get<topology::Joint>(scene.joints.at(joint).geometry).polygons;
}

TEST(SceneTest, SmallestSceneHasTheDefaultsOfTheContract) {
  const Scene scene = scene_of(box);
  EXPECT_EQ(scene.title, "s.toml");
  EXPECT_EQ(scene.seed, 1U);
  EXPECT_EQ(scene.snap, metres(0));
  EXPECT_DOUBLE_EQ(scene.domain.volume().si(), 384);
  EXPECT_TRUE(scene.joints.empty());
  EXPECT_FALSE(scene.stability.has_value());
  EXPECT_EQ(scene.rock.mass.density(), kilograms_per_cubic_metre(2700));
  EXPECT_TRUE(scene.output.vtu && scene.output.csv && scene.output.report);
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_EQ(describe(scene.notes[0]),
            "s.toml:1: joint: there are no joints; the rock stays one block unless excavations part it");
}

TEST(SceneTest, PlanesFollowDipAndDipDirection) {
  const Scene scene =
      scene_of(with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\nset = \"A\"\n"));
  const auto& plane = plane_of(scene, 0);
  EXPECT_EQ(plane.through, (geometry::Vec3{4, 4, 3}));
  EXPECT_NEAR(plane.normal.x, -std::sqrt(0.75), 1e-15);
  EXPECT_EQ(plane.normal.y, 0.0);
  EXPECT_NEAR(plane.normal.z, 0.5, 1e-15);
  EXPECT_EQ(scene.sets[scene.joints[0].set].name, "A");
  EXPECT_EQ(scene.joints[0].line, 4U);
}

TEST(SceneTest, NorthTurnsDipDirections) {
  const auto with_north = [](std::string_view north, std::string_view direction) {
    return scene_of("north = " + std::string{north} + "\n" +
                    with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = " +
                             std::string{direction} + " }\n"));
  };
  // True north 30 degrees clockwise of y: what dips to true north dips 30 degrees clockwise of y.
  EXPECT_EQ(plane_of(with_north("30", "0"), 0).normal, plane_of(with_north("0", "30"), 0).normal);
  EXPECT_EQ(plane_of(with_north("-40", "10"), 0).normal, plane_of(with_north("0", "330"), 0).normal);
  EXPECT_NE(plane_of(with_north("30", "0"), 0).normal, plane_of(with_north("0", "0"), 0).normal);
}

TEST(SceneTest, BentQuadsBecomeTrianglesOfOneJointWhenAsked) {
  const Scene scene = scene_of("nonplanar = \"triangulate\"\n" +
                               with_box("[[joint]]\npolygon = [[0, 0, 0], [4, 0, 0], [4, 4, 1], [0, 4, 0]]\n"));
  ASSERT_EQ(scene.joints.size(), 1U);
  EXPECT_EQ(polygons_of(scene, 0).size(), 2U);
}

TEST(SceneTest, DiscsAreLeftOutOnlyAsANoteWhenOutside) {
  const Scene scene =
      scene_of(with_box("[[joint]]\ndisc = { centre = [100, 4, 3], dip = 60, dip_direction = 270, radius = 2 }\n"
                        "[[joint]]\nplane = { through = [4, 4, 7], dip = 0, dip_direction = 0 }\n"
                        "[[joint]]\nplane = { through = [4, 4, 5], dip = 0, dip_direction = 0 }\n"));
  EXPECT_EQ(scene.joints.size(), 3U);
  ASSERT_EQ(scene.notes.size(), 2U);
  EXPECT_EQ(describe(scene.notes[0]),
            "s.toml:4: joint: lies wholly outside the domain; it cuts nothing and is left out");
  EXPECT_EQ(scene.notes[1].line, 6U);
}

TEST(SceneTest, EachFaceOfAnObjFileIsAJoint) {
  const Scene scene = scene_of(
      with_box("[[joint]]\nfile = \"a/j.obj\"\nset = \"A\"\n"),
      {{"a/j.obj", "# soup\nv 0 0 3\nv 8 0 3\nv 8 8 3\nv 0 8 3\nf 1 2 3 4\nv 1 0 0\nv 1 8 0\nv 1 8 6\nf 5 6 7\n"}});
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(polygons_of(scene, 0)[0].corners().size(), 4U);
  EXPECT_EQ(scene.joints[1].file, "a/j.obj");
  EXPECT_EQ(scene.joints[1].line, 10U);
  ASSERT_EQ(scene.files.size(), 1U);
  EXPECT_EQ(scene.files[0].name, "a/j.obj");
}

TEST(SceneTest, FacesOfAMeshWithoutAreaAreLeftOutAndSaid) {
  const std::string mesh = "v 0 0 3\nv 8 0 3\nv 8 8 3\nv 4 0 3\nf 1 2 3\nf 1 4 2\nf 1 2 4\n";
  for (const char* surface : {"", "surface = true\n"}) {
    const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.obj\"\n" + std::string{surface}), {{"j.obj", mesh}});
    EXPECT_EQ(scene.joints.size(), 1U);
    const auto said = std::ranges::find(scene.notes, "j.obj", &Problem::file);
    ASSERT_NE(said, scene.notes.end());
    EXPECT_EQ(describe(*said), "j.obj:6: f (face 2): 2 of 3 faces have no area and are left out, this is the first");
  }
  const std::string nothing =
      error_of(with_box("[[joint]]\nfile = \"j.obj\"\n"), {{"j.obj", "v 0 0 3\nv 8 0 3\nv 4 0 3\nf 1 2 3\n"}});
  EXPECT_TRUE(nothing.starts_with("j.obj:4: f (face 1): all corners lie on one line")) << nothing;
}

TEST(SceneTest, FacesThatAreNoPolygonsAreToldByTheirLine) {
  const std::string message = error_of(with_box("[[joint]]\nfile = \"j.obj\"\n"),
                                       {{"j.obj", "v 0 0 3\nv 8 0 3\nv 8 8 3\nv 0 8 4\nf 1 2 3\nf 1 2 3 4\n"}});
  EXPECT_TRUE(message.starts_with("j.obj:6: f (face 2): ")) << message;
  EXPECT_NE(message.find("triangulate"), std::string::npos) << message;
}

TEST(SceneTest, RowsOfATableBecomePlanesDiscsAndRectangles) {
  const std::string table =
      "dip,dip_direction,x,y,z,radius,set,friction,cohesion\n60,270,4,4,3,5,A,35,1000\n30,90,1,1,1,,B,,\n";
  const Scene scene =
      scene_of(with_box("[[joint]]\nfile = \"j.csv\"\n[joints.A]\nfriction = 20\n"), {{"j.csv", table}});
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(polygons_of(scene, 0)[0].corners().size(), 32U);
  EXPECT_EQ(scene.joints[0].own.friction, FrictionAngle::degrees(35));
  EXPECT_EQ(scene.joints[0].own.cohesion, pascals(1000));
  EXPECT_EQ(scene.sets[scene.joints[1].set].name, "B");
  EXPECT_NEAR(plane_of(scene, 1).normal.x, 0.5, 1e-15);
  EXPECT_EQ(scene.joints[1].line, 3U);
}

TEST(SceneTest, DirectionsBeyond360NeedAWord) {
  const Files files{{"j.csv", "dip,dip_direction,x,y,z\n45,442,1,1,1\n"}};
  const std::string message = error_of(with_box("[[joint]]\nfile = \"j.csv\"\n"), files);
  EXPECT_TRUE(message.starts_with("j.csv:2: ")) << message;
  EXPECT_NE(message.find("442"), std::string::npos) << message;
  const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.csv\"\nwrap = true\n"), files);
  const Scene same = scene_of(with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 45, dip_direction = 82 }\n"));
  EXPECT_EQ(plane_of(scene, 0).normal, plane_of(same, 0).normal);
}

// A compass 2.5 degrees west of true north reads that much less; over north it goes round.
TEST(SceneTest, DirectionsFromMagneticNorthAreTurned) {
  const Files files{{"j.csv", "dip,dip_direction,x,y,z\n45,79.5,1,1,1\n45,359,2,2,2\n"},
                    {"j.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}};
  const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.csv\"\ndeclination = 2.5\n"), files);
  const Scene same =
      scene_of(with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 45, dip_direction = 82 }\n"
                        "[[joint]]\nplane = { through = [2, 2, 2], dip = 45, dip_direction = 1.5 }\n"));
  EXPECT_EQ(plane_of(scene, 0).normal, plane_of(same, 0).normal);
  EXPECT_EQ(plane_of(scene, 1).normal, plane_of(same, 1).normal);
  const std::string wrong = error_of(with_box("[[joint]]\nfile = \"j.obj\"\ndeclination = 2.5\n"), files);
  EXPECT_NE(wrong.find("joint[1].declination: has a meaning for CSV files only"), std::string::npos) << wrong;
  const std::string plane =
      error_of(with_box("[[joint]]\nplane = { through = [1, 1, 1], dip = 45, dip_direction = 82 }\ndeclination = 2\n"));
  EXPECT_NE(plane.find("declination: has a meaning for files only"), std::string::npos) << plane;
}

TEST(SceneTest, MeshesMustBeClosedAndOutwards) {
  const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  EXPECT_NEAR(scene_of("[domain]\nmesh = \"d.obj\"\n", {{"d.obj", good}}).domain.volume().si(), 1.0 / 6, 1e-15);
  const std::string open = good.substr(0, good.rfind("f 1 4 3"));
  const std::string inside_out = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n";
  const std::string twice = good + "f 1 4 3\n";
  for (const std::string& mesh : {open, inside_out, twice}) {
    const std::string message = error_of("[domain]\nmesh = \"d.obj\"\n", {{"d.obj", mesh}});
    EXPECT_TRUE(message.starts_with("s.toml:2: domain.mesh: d.obj: ")) << message;
    EXPECT_NE(message.find(';'), std::string::npos) << message;
  }
}

TEST(SceneTest, ExportsAreNamesOfFormats) {
  const Scene scene = scene_of(with_box("[output]\nexports = [\"obj\", \"3dec\", \"obj\"]\n"));
  EXPECT_EQ(scene.output.exports, (std::vector<std::string>{"obj", "3dec"}));
  const std::string message = error_of(with_box("[output]\nexports = [\"lsdyn\"]\n"));
  EXPECT_TRUE(message.starts_with("s.toml:4: output.exports: \"lsdyn\" is not known; did you mean lsdyna?")) << message;
}

TEST(SceneTest, DrawingsHoldSurfacesAndPolygons) {
  // two 3DFACEs of one layer are one surface; a closed polyline is a joint of its own
  const std::string dxf =
      "0\nSECTION\n2\nENTITIES\n"
      "0\n3DFACE\n8\nFAULT\n10\n0\n20\n0\n30\n3\n11\n8\n21\n0\n31\n3\n12\n8\n22\n8\n32\n3\n"
      "0\n3DFACE\n8\nFAULT\n10\n0\n20\n0\n30\n3\n11\n8\n21\n8\n31\n3\n12\n0\n22\n8\n32\n4\n"
      "0\nLWPOLYLINE\n8\n0\n90\n3\n70\n1\n38\n1\n10\n0\n20\n0\n10\n8\n20\n0\n10\n0\n20\n8\n"
      "0\nENDSEC\n0\nEOF\n";
  const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.dxf\"\n"), {{"j.dxf", dxf}});
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(polygons_of(scene, 0).size(), 1U);
  EXPECT_EQ(scene.sets[scene.joints[0].set].name, "default");
  EXPECT_EQ(polygons_of(scene, 1).size(), 2U);
  EXPECT_EQ(scene.sets[scene.joints[1].set].name, "FAULT");
  EXPECT_EQ(scene.joints[1].line, 6U);
  const Scene named = scene_of(with_box("[[joint]]\nfile = \"j.dxf\"\nset = \"A\"\n"), {{"j.dxf", dxf}});
  EXPECT_EQ(named.sets[named.joints[1].set].name, "A");
  const std::string cut =
      error_of(with_box("[[joint]]\nfile = \"j.dxf\"\n"), {{"j.dxf", dxf.substr(0, dxf.size() / 2)}});
  EXPECT_TRUE(cut.starts_with("j.dxf:")) << cut;
}

TEST(SceneTest, ObjectsOfATSurfAreSurfaces) {
  const std::string object =
      "GOCAD TSurf 1\nHEADER {name:f1}\nTFACE\nVRTX 1 0 0 0\nVRTX 2 1 0 0\nVRTX 3 0 1 0\nVRTX 4 0 0 1\n"
      "TRGL 1 3 2\nTRGL 1 2 4\nTRGL 2 3 4\nTRGL 1 4 3\nEND\n";
  const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.ts\"\n"), {{"j.ts", object + object}});
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(polygons_of(scene, 1).size(), 4U);
  EXPECT_EQ(scene.sets[scene.joints[1].set].name, "f1");
  EXPECT_NEAR(scene_of("[domain]\nmesh = \"d.ts\"\n", {{"d.ts", object}}).domain.volume().si(), 1.0 / 6, 1e-15);
}

TEST(SceneTest, FracturesOfFracManAreJoints) {
  const std::string fab =
      "BEGIN FORMAT\nFormat = Ascii\nLength_Unit = Meter\nXAxis = East\nNo_Properties = 0\nEND FORMAT\n"
      "BEGIN SETS\nSet1 = \"steep\"\nEND SETS\n"
      "BEGIN FRACTURE\n1 4 1\n1 0 0 3\n2 8 0 3\n3 8 8 3\n4 0 8 3\n0 0 0 1\n"
      "2 4 1\n1 0 0 1\n2 8 0 1\n3 8 8 1\n4 0 8 9\n0 0 0 1\nEND FRACTURE\n";
  const std::string refused = error_of(with_box("[[joint]]\nfile = \"j.fab\"\n"), {{"j.fab", fab}});
  EXPECT_TRUE(refused.starts_with("j.fab:17: face 2: ")) << refused;
  const Scene scene =
      scene_of("nonplanar = \"triangulate\"\n" + with_box("[[joint]]\nfile = \"j.fab\"\n"), {{"j.fab", fab}});
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(scene.sets[scene.joints[0].set].name, "steep");
  EXPECT_EQ(polygons_of(scene, 1).size(), 2U);
}

TEST(SceneTest, UnknownEndingsAndTruncatedFilesAreRefused) {
  EXPECT_EQ(error_of("[domain]\nmesh = \"d.txt\"\n", {{"d.txt", "0\n"}}),
            "s.toml:2: domain.mesh: the ending of \"d.txt\" is not known; give a file that ends in .stl, .obj, .ply, "
            ".dxf or .ts");
  const std::string cut = error_of(with_box("[[joint]]\nfile = \"j.obj\"\n"), {{"j.obj", "v 0 0 3\nv 8 0 3\nv 8 8"}});
  EXPECT_TRUE(cut.starts_with("j.obj:3: ")) << cut;
  const std::string empty = error_of(with_box("[[joint]]\nfile = \"j.obj\"\n"), {{"j.obj", ""}});
  EXPECT_TRUE(empty.starts_with("j.obj:1: ")) << empty;
}

TEST(SceneTest, PropertiesFallBackToDefault) {
  const Scene scene =
      scene_of(with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\nset = \"A\"\n"
                        "[[joint]]\nplane = { through = [4, 4, 2], dip = 60, dip_direction = 270 }\nset = \"B\"\n"
                        "[joints.B]\nfriction = 12\n[joints.default]\nfriction = 40\ncohesion = 5e3\n"));
  const auto properties = [&](std::size_t joint) { return scene.sets[scene.joints[joint].set].properties; };
  EXPECT_EQ(properties(0).friction.mean, 40);
  EXPECT_EQ(properties(1).friction.mean, 12);
  EXPECT_EQ(properties(1).cohesion.quantile(0.3), pascals(5e3));
}

TEST(SceneTest, KindsOfBolts) {
  const auto with_spot = [](const std::string& keys) {
    return with_box("[stability]\nfree = [\"top\"]\n[support.spot]\nlength = 4\ntendon_capacity = 200e3\n" + keys);
  };
  const auto type = [&](const std::string& keys) { return scene_of(with_spot(keys)).support->plan.spot->type; };
  const auto bar = type("bond_strength = 3e5\nanchorage = 0.5\nshear_capacity = 1e5\nangle = \"cosine\"\n");
  EXPECT_EQ(std::get<stability::GroutedBar>(bar.kind).bond.si(), 3e5);
  EXPECT_EQ(std::get<stability::GroutedBar>(bar.kind).shear.si(), 1e5);
  EXPECT_EQ(bar.angle, stability::AngleLaw::cosine);
  const auto tube = type("kind = \"friction\"\nbond_strength = 4e4\nanchorage = 0.5\nshear_capacity = 7e4\n");
  EXPECT_EQ(std::get<stability::FrictionTube>(tube.kind).shear.si(), 7e4);
  const auto cable = type("kind = \"cable\"\nbond_strength = 2e5\nfree_length = 1.5\nanchorage = 1\n");
  EXPECT_EQ(std::get<stability::Cable>(cable.kind).free_length.si(), 1.5);
  const auto end = type("kind = \"mechanical\"\nanchor_capacity = 9e4\nplate_capacity = 1e5\nanchorage = 0.3\n");
  EXPECT_EQ(std::get<stability::MechanicalAnchor>(end.kind).capacity.si(), 9e4);

  const auto wrong = [&](const std::string& keys) { return error_of(with_spot(keys)); };
  EXPECT_NE(wrong("anchorage = 0.5\n").find("bond_strength: is missing"), std::string::npos);
  EXPECT_NE(wrong("kind = \"mechanical\"\nanchor_capacity = 9e4\nplate_capacity = 1e5\nanchorage = 0\n")
                .find("anchorage: is 0"),
            std::string::npos);
  EXPECT_NE(wrong("kind = \"mechanical\"\nanchor_capacity = 9e4\nanchorage = 0.3\n").find("plate_capacity: is 0"),
            std::string::npos);
  EXPECT_NE(wrong("kind = \"cable\"\nbond_strength = 2e5\nanchorage = 1\nshear_capacity = 1e5\n")
                .find("shear_capacity: has no meaning for bolts of kind \"cable\""),
            std::string::npos);
  EXPECT_NE(wrong("bond_strength = 2e5\nanchorage = 1\nfree_length = 1\n")
                .find("free_length: has no meaning for bolts of kind \"grouted\""),
            std::string::npos);
}

TEST(SceneTest, NumbersMayBeTextsWithAUnit) {
  const Scene scene = scene_of(with_box(
      "[[joint]]\nplane = { through = [4, \"400 cm\", 3], dip = \"60 deg\", dip_direction = 270 }\n"
      "[joints.default]\nfriction = { distribution = \"uniform\", min = \"20 deg\", max = 40 }\ncohesion = \"50 kPa\"\n"
      "tension = \"0.01 MPa\"\n[rock]\ndensity = \"26 kN/m3\"\n"
      "[stability]\nfree = [\"top\"]\nwater = { table = \"2m\", unit_weight = \"9.81 kN/m3\" }\n"
      "[support]\nshotcrete = { thickness = \"75 mm\", strength = \"2 MPa\", on = \"top\" }\n"
      "spot = { length = 3, tendon_capacity = \"200 kN\", bond_strength = \"300 kN/m\", anchorage = \"500 mm\" }\n"));
  const JointProperties& joint = scene.sets[SetId{std::size_t{0}}].properties;
  EXPECT_EQ(joint.cohesion.mean, 50e3);
  EXPECT_EQ(joint.tension.mean, 10e3);
  EXPECT_EQ(joint.friction.min, 20);
  EXPECT_DOUBLE_EQ(scene.rock.mass.density().si(), 26000 / 9.81);
  EXPECT_EQ(scene.stability->loads.actions.spec().water->unit_weight.si(), 9810);
  EXPECT_EQ(scene.support->plan.shotcrete->thickness.si(), 0.075);
  EXPECT_EQ(scene.support->plan.spot->type.tendon.si(), 200e3);
  EXPECT_EQ(scene.support->plan.spot->type.anchorage.si(), 0.5);
  EXPECT_TRUE(scene.notes.empty());
}

TEST(SceneTest, BareNumbersFarFromUsualOnesNameTheLikelyUnit) {
  const Scene scene =
      scene_of(with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\n"
                        "[joints.default]\nfriction = 0.6\ncohesion = 50\n[rock]\ndensity = 27\nyoung = 40\n"
                        "[stability]\nfree = [\"top\"]\nwater = { table = 2, unit_weight = 9.81 }\n"
                        "[support]\nshotcrete = { thickness = 75, strength = 2e6, on = \"all\" }\n"
                        "spot = { length = 3, tendon_capacity = 200, bond_strength = 300e3, anchorage = 0.5 }\n"));
  std::vector<std::string> meant;
  for (const Problem& note : scene.notes) meant.push_back(note.key + ": " + note.remedy);
  EXPECT_EQ(meant,
            (std::vector<std::string>{"joints.default.friction: if it is meant in rad, write \"0.6 rad\"",
                                      "joints.default.cohesion: if it is meant in kPa, write \"50 kPa\"",
                                      "rock.density: if it is meant in kN/m3, write \"27 kN/m3\"",
                                      "rock.young: if it is meant in GPa, write \"40 GPa\"",
                                      "stability.water.unit_weight: if it is meant in kN/m3, write \"9.81 kN/m3\"",
                                      "support.spot.tendon_capacity: if it is meant in kN, write \"200 kN\"",
                                      "support.shotcrete.thickness: if it is meant in mm, write \"75 mm\""}));
}

TEST(SceneTest, RowsWithTheirOwnStrengthAreNotToldThatNoneIsGiven) {
  const auto told = [](std::string table) {
    const Scene scene = scene_of(with_box("[[joint]]\nfile = \"j.csv\"\n[rock]\ndensity = 2700\n[stability]\nfree = "
                                          "[\"top\"]\n"),
                                 {{"j.csv", std::move(table)}});
    return std::ranges::count_if(scene.notes,
                                 [](const Problem& n) { return n.what.starts_with("no strength is given"); });
  };
  EXPECT_EQ(told("dip,dd,x,y,z,friction\n30,90,4,4,3,25\n"), 0);
  EXPECT_EQ(told("dip,dd,x,y,z,friction\n30,90,4,4,3,25\n30,90,4,4,2,\n"), 1);
  EXPECT_EQ(told("dip,dd,x,y,z\n30,90,4,4,3\n"), 1);
}

TEST(SceneTest, TheProjectIsReadAndChangesNothing) {
  const Scene scene =
      scene_of(with_box("[project]\nname = \"Adit 3\"\nauthor = \"A. Miner\"\ndate = \"2025-03-01\"\n"));
  EXPECT_EQ(scene.project.name, "Adit 3");
  EXPECT_EQ(scene.project.author, "A. Miner");
  EXPECT_EQ(scene.project.date, "2025-03-01");
  EXPECT_TRUE(scene.project.client.empty());
  EXPECT_TRUE(scene_of(box).project.empty());
}

TEST(SceneTest, OldNamesOfKeysAreReadWithANote) {
  const Scene scene = scene_of(with_box(
      "[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\n[joints.default]\nfriction = 30\n"
      "[rock]\ndensity = 2700\n[stability]\nfree = [\"top\"]\nstrict = true\n"));
  EXPECT_TRUE(scene.stability->strict);
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_EQ(describe(scene.notes[0]),
            "s.toml:11: stability.strict: is now called \"require_open_cone\"; write the new "
            "name: the old one goes with the next version");
}

TEST(SceneTest, FreeFacesAndGravity) {
  const Scene scene =
      scene_of(with_box("[stability]\nfree = [\"top\", \"west\", \"top\"]\ngravity = 9.8\nseismic = [0.1, 0, 0]\n"
                        "partial = { friction = 1.25 }\n"));
  EXPECT_EQ(scene.free_domain_tags, (std::vector<std::uint32_t>{5, 0}));
  ASSERT_TRUE(scene.stability.has_value());
  EXPECT_EQ(scene.stability->loads.body.gravity(), (geometry::Vec3{0, 0, -9.8}));
  EXPECT_EQ(scene.stability->partial.friction(), 1.25);
  EXPECT_EQ(scene.stability->partial.weight(), 1.0);
}

TEST(SceneTest, TunnelsHaveTheVolumeOfTheirSection) {
  const auto volume = [](std::string_view section) {
    const Scene scene = scene_of(with_box("[[excavation]]\nkind = \"tunnel\"\nsection = " + std::string{section} +
                                          "\naxis = [[4, 0, 3], [4, 8, 3]]\n"));
    return scene.excavations.at(0).solid.volume().si() / 8;
  };
  constexpr double pi = 3.14159265358979323846;
  EXPECT_NEAR(volume("{ shape = \"rectangle\", width = 2, height = 3 }"), 6, 1e-6);
  EXPECT_NEAR(volume("{ shape = \"circle\", diameter = 2 }"), pi, 1e-6);
  EXPECT_NEAR(volume("{ shape = \"circle\", radius = 1 }"), pi, 1e-6);
  EXPECT_NEAR(volume("{ shape = \"ellipse\", width = 2, height = 4 }"), 2 * pi, 1e-6);
  EXPECT_NEAR(volume("{ shape = \"trapezoid\", width = 4, top_width = 2, height = 3 }"), 9, 1e-6);
  // A half circle in chords is a little smaller: by (pi/n)^2/6 of its area for n segments.
  EXPECT_NEAR(volume("{ shape = \"horseshoe\", width = 2, height = 3, segments = 512 }"), 4 + pi / 2, 1e-4);
  EXPECT_NEAR(volume("{ shape = \"d_shape\", width = 2, wall = 2, segments = 512 }"), 4 + pi / 2, 1e-4);
  EXPECT_NEAR(volume("{ shape = \"d_shape\", width = 2, height = 3, segments = 512 }"), 4 + pi / 2, 1e-4);
  EXPECT_NEAR(volume("{ shape = \"arch\", width = 2, height = 3, rise = 1, segments = 512 }"), 4 + pi / 2, 1e-4);
  EXPECT_NEAR(volume("{ shape = \"polygon\", corners = [[0, 0], [2, 0], [0, 2]] }"), 2, 1e-6);
}

// Each of these once broke an assumption inside the TOML library (decision 11).
TEST(SceneTest, TextsThatAreAlmostTomlAreToldAsSuch) {
  for (const std::string_view text :
       {"\u00e9t\u00e9 = 1\n", "[do\u01e8main]\n", "a = [0,}\n", "a = [[0, 0], [\u00e9]]\n", "a = }\n"}) {
    const auto lines = errors_of(text);
    ASSERT_EQ(lines.size(), 1U) << text;
    EXPECT_TRUE(lines[0].starts_with("s.toml:1: TOML: ")) << lines[0];
  }
  EXPECT_EQ(scene_of("title = \"Stollen S\u00fcd\"\n" + std::string{box}).title, "Stollen S\u00fcd");
}

TEST(SceneTest, KeysWithoutLettersHaveAName) {
  EXPECT_TRUE(error_of("'' = ''\n" + std::string{box}).starts_with("s.toml:1: \"\": unknown key; "));
}

TEST(SceneTest, NestedValuesDoNotOverflowTheStack) {
  std::string text = "a = ";
  for (int i = 0; i < 100'000; ++i) text += "[";
  EXPECT_TRUE(errors_of(text).front().starts_with("s.toml:1: TOML: ")) << errors_of(text).front();
}

TEST(PlanTest, SaysWhatIsLeftOutAndWhy) {
  const Plan plan = make_plan(scene_of(box));
  std::vector<Step> listed{all_steps.begin(), all_steps.end()};
  std::erase(listed, Step::flow);  // nothing asks for it
  ASSERT_EQ(plan.steps.size(), listed.size());
  for (std::size_t i = 0; i < listed.size(); ++i) EXPECT_EQ(plan.steps[i].step, listed[i]);
  EXPECT_TRUE(plan.runs(Step::cut) && plan.runs(Step::audit) && plan.runs(Step::write) && plan.runs(Step::report));
  EXPECT_FALSE(plan.runs(Step::draw) || plan.runs(Step::stability) || plan.runs(Step::monte_carlo));
  const auto stability = std::ranges::find(plan.steps, Step::stability, &PlannedStep::step);
  EXPECT_EQ(stability->why, "no excavation and no free face");
}

TEST(PlanTest, FreeFacesOrExcavationsAskForStability) {
  EXPECT_TRUE(make_plan(scene_of(with_box("[stability]\nfree = [\"top\"]\n"))).runs(Step::stability));
  EXPECT_TRUE(make_plan(scene_of(with_box(
                            "[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [1, 1, 1], max = [2, 2, 2] }\n")))
                  .runs(Step::stability));
  EXPECT_FALSE(make_plan(scene_of(with_box("[stability]\ngravity = 9.81\n"))).runs(Step::stability));
}

const std::string random_sets = with_box(
    "[[joint_set]]\nname = \"A\"\norientation = { dip = 30, dip_direction = 30, distribution = \"fisher\", kappa = 20 "
    "}\n"
    "size = { distribution = \"exponential\", mean = 5, min = 1, max = 10 }\nintensity = { count = 40 }\n"
    "[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\nset = \"A\"\n"
    "[joints.A]\nfriction = { distribution = \"uniform\", min = 20, max = 30 }\n");

TEST(DrawTest, EachJointHasItsOwnFriction) {
  const auto drawn = sample(scene_of(random_sets));
  ASSERT_TRUE(drawn.has_value());
  ASSERT_EQ(drawn->joints.size(), 41U);
  ASSERT_EQ(drawn->input.joints.size(), 41U);
  std::vector<double> friction;
  for (const JointInfo& joint : drawn->joints) friction.push_back(joint.strength.friction().degrees());
  EXPECT_EQ(drawn->joints.items()[0].origin, JointOrigin::measured);
  EXPECT_EQ(drawn->joints.items()[1].source, "A #1");
  std::ranges::sort(friction);
  EXPECT_GT(friction.front(), 20);
  EXPECT_LT(friction.back(), 30);
  EXPECT_EQ(std::ranges::adjacent_find(friction), friction.end());
  EXPECT_GT(friction.back() - friction.front(), 6);
}

TEST(DrawTest, SameSeedSameJointsOtherSeedOthers) {
  Scene scene = scene_of(random_sets);
  const auto first = sample(scene), second = sample(scene);
  scene.seed = 2;
  const auto other = sample(scene);
  ASSERT_TRUE(first && second && other);
  std::size_t equal = 0;
  for (const topology::JointId joint : first->joints.ids()) {
    EXPECT_EQ(first->joints[joint].strength.friction(), second->joints[joint].strength.friction());
    EXPECT_EQ(first->joints[joint].normal, second->joints[joint].normal);
    equal += first->joints[joint].normal == other->joints[joint].normal ? 1U : 0U;
  }
  EXPECT_EQ(equal, 1U);  // the measured one
}

TEST(FrictionLawTest, QuantilesRunFromMinToMaxAndHitTheMedian) {
  using Kind = FrictionLaw::Kind;
  for (const FrictionLaw& law :
       {FrictionLaw{Kind::uniform, 0, 0, 20, 30}, FrictionLaw{Kind::normal, 25, 5, 20, 30},
        FrictionLaw{Kind::lognormal, 25, 5, 10, 60}, FrictionLaw{Kind::exponential, 25, 0, 1, 80}}) {
    double before = 0;
    for (int i = 1; i < 1000; ++i) {
      const double x = law.quantile(i / 1000.0).degrees();
      EXPECT_GE(x, before);
      EXPECT_GE(x, law.min);
      EXPECT_LE(x, law.max);
      before = x;
    }
    EXPECT_NEAR(law.quantile(1e-12).degrees(), law.min, 1e-6);
    EXPECT_NEAR(law.quantile(1 - 1e-12).degrees(), law.max, 1e-4);
  }
  EXPECT_NEAR((FrictionLaw{Kind::normal, 25, 5, 20, 30}.quantile(0.5).degrees()), 25, 1e-12);
  // exp(mu) with mu = ln m - sigma^2 / 2.
  EXPECT_NEAR((FrictionLaw{Kind::lognormal, 25, 5, 0, 89}.quantile(0.5).degrees()), 25 / std::sqrt(1.04), 1e-6);
  EXPECT_NEAR((FrictionLaw{Kind::exponential, 25, 0, 0, 89}.quantile(0.5).degrees()),
              -25 * std::log(1 - 0.5 * (1 - std::exp(-89.0 / 25))), 1e-12);
}

}  // namespace
}  // namespace cleave::scene::test
