#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cleave/dfn/sample.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "run_scene.hpp"

// [mapped] in scenes: rows of traces and picks, what is refused, what is drawn. Domain: 8 x 8 x 6 m; the face lies in
// x = 4.

namespace cleave::scene::test::mapped_scene_test {
namespace {

std::string set_of(const std::string& name, const std::string& more = "intensity = { p32 = 0.6 }\n") {
  return "[[joint_set]]\nname = \"" + name +
         "\"\norientation = { dip = 70, dip_direction = 0, distribution = \"fisher\", kappa = 60 }\n"
         "shape = \"disc\"\nsize = { distribution = \"uniform\", min = 2, max = 5 }\n" +
         more;
}
const std::string face = "[[mapped.face]]\nname = \"F\"\ncorners = [[4, 1, 1], [4, 7, 1], [4, 7, 5], [4, 1, 5]]\n";
const std::string hole = "[[mapped.hole]]\nname = \"H\"\nfrom = [6, 1, 3]\nto = [6, 7, 3]\n";
const std::string scene_text = with_box(set_of("A")) + "[mapped]\ntraces = \"t.csv\"\n" + face;
const std::string head = "face,set,joint,x1,y1,z1,x2,y2,z2\n";
const std::string trace = "F,A,,4,3,4,4,3.684,2.121\n";

Scene mapped_scene(const std::string& rows = trace, const std::string& text = scene_text) {
  return scene_of(text, {{"t.csv", head + rows}});
}
std::string row_error(const std::string& rows, const std::string& text = scene_text, const std::string& header = head) {
  return error_of(text, {{"t.csv", header + rows}});
}
std::string pick_error(const std::string& rows) {
  return error_of(with_box(set_of("A")) + "[mapped]\npicks = \"p.csv\"\n" + hole,
                  {{"p.csv", "hole,set,joint,depth,x,y,z\n" + rows}});
}
bool has_note(const Scene& scene, std::string_view words) {
  return std::ranges::any_of(scene.notes, [&](const Problem& note) { return describe(note).contains(words); });
}

/// A joint as the cutter gets it.
dfn::SampledJoint joint_of(const SampledScene& drawn, topology::JointId id) {
  const auto& polygon = std::get<topology::Joint>(drawn.input.joints[id.index()]).polygons.front();
  return {polygon, {}, drawn.joints[id].normal, 0};
}
/// Joints that show on a face, of one set.
std::vector<std::string> on_face(const Scene& scene, const SampledScene& drawn, std::string_view set) {
  std::vector<std::string> sources;
  for (const topology::JointId id : drawn.joints.ids()) {
    if (scene.sets[drawn.joints[id].set].name != set) continue;
    if (!dfn::traces_on(joint_of(drawn, id), scene.mapped->seen, 0).empty()) sources.push_back(drawn.joints[id].source);
  }
  return sources;
}

TEST(MappedScene, ATraceIsInEveryRealizationAndTheRestIsDrawnAnew) {
  const Scene scene = mapped_scene();
  ASSERT_TRUE(scene.mapped.has_value());
  std::vector<geometry::Vec3> centres;
  std::uint64_t taken_out = 0;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const SampledScene drawn = sample(scene, k).value();
    ASSERT_TRUE(drawn.mapped.has_value());
    ASSERT_EQ(drawn.mapped->joints.size(), 1U);
    const MappedJointResult& row = drawn.mapped->joints.front();
    EXPECT_TRUE(row.honours);
    EXPECT_LE(row.misfit.si(), 0.1);
    EXPECT_EQ(row.source, "t.csv:2");
    EXPECT_EQ(row.rows, std::vector<std::string>{"t.csv:2"});
    EXPECT_EQ(row.traces, 1U);
    EXPECT_TRUE(row.set_known);
    EXPECT_EQ(drawn.joints[row.joint].source, "A seen t.csv:2");
    EXPECT_NEAR(drawn.joints[row.joint].dip.degrees(), row.dip.degrees(), 1e-9);
    const auto shown = dfn::traces_on(joint_of(drawn, row.joint), scene.mapped->seen, 0);
    ASSERT_EQ(shown.size(), 1U);
    const bool turned = shown[0].ends[0].z < shown[0].ends[1].z;
    EXPECT_LE(norm(shown[0].ends[turned ? 1 : 0] - geometry::Vec3{4, 3, 4}), 0.1);
    EXPECT_LE(norm(shown[0].ends[turned ? 0 : 1] - geometry::Vec3{4, 3.684, 2.121}), 0.1);
    // Nothing else shows on the face.
    EXPECT_EQ(on_face(scene, drawn, "A"), std::vector<std::string>{"A seen t.csv:2"});
    EXPECT_GT(drawn.joints.size(), 5U);
    taken_out += drawn.mapped->taken_out;
    centres.push_back(row.centre);
  }
  EXPECT_NE(centres[0], centres[1]);
  EXPECT_NE(centres[1], centres[2]);
  EXPECT_GT(taken_out, 10U) << "about ten of a realization show";
  EXPECT_EQ(sample(scene, 1).value().mapped->joints[0].centre, centres[1]);
}

TEST(MappedScene, SetsThatAreNotMappedAreDrawnAsIfNothingHadBeenSeen) {
  const std::string two = with_box(set_of("A") + set_of("B"));
  const Scene plain = scene_of(two);
  const Scene scene = mapped_scene(trace, two + "[mapped]\ntraces = \"t.csv\"\nsets = [\"A\"]\n" + face);
  const auto of = [](const Scene& s, const SampledScene& drawn, std::string_view set) {
    std::vector<std::string> sources;
    for (const JointInfo& joint : drawn.joints) {
      if (s.sets[joint.set].name == set) sources.push_back(joint.source);
    }
    return sources;
  };
  const SampledScene before = sample(plain).value(), after = sample(scene).value();
  EXPECT_EQ(of(plain, before, "B"), of(scene, after, "B"));
  const auto all = of(plain, before, "A"), left = of(scene, after, "A");
  EXPECT_EQ(left.size(), all.size() - after.mapped->taken_out + 1);
  EXPECT_TRUE(std::ranges::includes(
      all, std::vector(left.begin(), left.end() - 1), {},
      [](const std::string& s) { return std::stoi(s.substr(s.find('#') + 1)); },
      [](const std::string& s) { return std::stoi(s.substr(s.find('#') + 1)); }));
}

TEST(MappedScene, RowsOfOneJointGoTogetherOverFiles) {
  const std::string text =
      with_box(set_of("A") + set_of("B")) + "[mapped]\ntraces = \"t.csv\"\npicks = \"p.csv\"\n" + face + hole;
  const Files files{{"t.csv", head + "F,,j1,4,3,4,4,3.684,2.121\nF,B,,4,5,4,4,5.684,2.121\n"},
                    {"p.csv", "set,joint,depth,dip,dip_direction\nA,j1,2.364,70,0\nA,,5,70,0\n"}};
  const Scene scene = scene_of(text, files);
  const dfn::Mapping& seen = scene.mapped->seen;
  ASSERT_EQ(seen.joints.size(), 3U);
  EXPECT_EQ(seen.joints[0].set, 0U) << "the pick names it";
  EXPECT_EQ(seen.joints[1].set, 1U);
  EXPECT_EQ(seen.joints[0].traces.size(), 1U);
  ASSERT_EQ(seen.joints[0].picks.size(), 1U);
  EXPECT_NEAR(norm(seen.joints[0].picks[0].at - geometry::Vec3{6, 3.364, 3}), 0, 1e-12);
  ASSERT_TRUE(seen.joints[0].picks[0].normal.has_value());
  EXPECT_NEAR(seen.joints[0].picks[0].normal->y, std::sin(70 * 3.14159265358979 / 180), 1e-12);
  EXPECT_EQ(scene.mapped->sources[0].name, "j1");
  EXPECT_EQ(scene.files.size(), 2U) << "their hashes stand in the results";
  const RunResult result = run_of(text, files);
  ASSERT_TRUE(result.mapped.has_value());
  EXPECT_EQ(result.mapped->holes, 1U);
  EXPECT_EQ(result.mapped->joints[0].rows, (std::vector<std::string>{"t.csv:2", "p.csv:2"}));
  EXPECT_EQ(result.mapped->joints[0].picks, 1U);
  EXPECT_EQ(result.mapped->honoured(), 3U);
  // North turns what the compass showed.
  const Scene turned = scene_of("north = 90\n" + text, files);
  EXPECT_NEAR(turned.mapped->seen.joints[0].picks[0].normal->x, std::sin(70 * 3.14159265358979 / 180), 1e-12);
  const std::string clash =
      error_of(text, {{"t.csv", head + "F,A,j,4,3,4,4,3.684,2.121\n"}, {"p.csv", "set,joint,depth\nB,j,2.4\n"}});
  EXPECT_TRUE(clash.contains("p.csv:2: joint: \"j\" is of the set \"B\", and of \"A\" in t.csv:2")) << clash;
}

TEST(MappedScene, APlaneMeasuredOnATraceIsThatOfItsJoint) {
  // The trace dips 70 degrees to the south in the face x = 4; the plane strikes 20 degrees off the normal of the face.
  const std::string planes = "face,set,joint,x1,y1,z1,x2,y2,z2,dip,dip_direction\n";
  const auto rows = [&](const std::string& plane) {
    return Files{{"t.csv", planes + "F,A,,4,3,4,4,3.684,3.134," + plane}};
  };
  const Scene scene = scene_of(scene_text, rows("53,20\n"));
  const auto& measured = scene.mapped->seen.joints[0].traces[0].normal;
  ASSERT_TRUE(measured.has_value());
  const SampledScene drawn = sample(scene).value();
  const auto seen = std::ranges::find_if(drawn.joints, [](const JointInfo& j) { return j.source.contains("seen"); });
  ASSERT_NE(seen, drawn.joints.end());
  EXPECT_GT(std::abs(dot(seen->normal, *measured)), std::cos(3 * 3.14159265358979 / 180));
  EXPECT_NEAR(dot(seen->normal,
                  scene.mapped->seen.joints[0].traces[0].ends[1] - scene.mapped->seen.joints[0].traces[0].ends[0]),
              0, 1e-9);
  EXPECT_FALSE(has_note(scene, "off their traces"));
  EXPECT_TRUE(has_note(scene_of(scene_text, rows("70,180\n")), "1 of 1 planes lie more than 15 degrees off"));
  const Scene turned = scene_of("north = 90\n" + scene_text, rows("53,290\n"));
  EXPECT_NEAR(norm(*turned.mapped->seen.joints[0].traces[0].normal - *measured), 0, 1e-12);
}

TEST(MappedScene, FacesAreFoundEndsAreProjectedAndGoOnAtTheBorder) {
  const Scene scene = mapped_scene(",A,,4.05,3,4.95,3.96,3.9,2.5\n");
  const dfn::MappedTrace& row = scene.mapped->seen.joints[0].traces[0];
  EXPECT_DOUBLE_EQ(row.ends[0].x, 4);
  EXPECT_DOUBLE_EQ(row.ends[1].x, 4);
  EXPECT_TRUE(row.goes_on[0]);
  EXPECT_FALSE(row.goes_on[1]);
  EXPECT_TRUE(has_note(scene, "1 of 2 ends of traces lie within 0.1 m of the border"));
  const std::string with_ends = "face,set,joint,x1,y1,z1,x2,y2,z2,end1\n";
  const Scene ends = scene_of(scene_text, {{"t.csv", with_ends + "F,A,,4,3,4.95,4,3.9,2.5,ends\n"}});
  EXPECT_FALSE(ends.mapped->seen.joints[0].traces[0].goes_on[0]);
  EXPECT_FALSE(has_note(ends, "ends of traces lie within"));
  // Where the border ends a joint's trace the joint itself reaches beyond: more than one length is possible.
  EXPECT_TRUE(sample(scene).value().mapped->joints[0].honours);
  const std::string two = scene_text + "[[mapped.face]]\nname = \"G\"\ncorners = [[4, 1, 1], [4, 7, 1], [4, 7, 5]]\n";
  EXPECT_TRUE(row_error(",A,,4,4,2,4,4.2,1.5\n", two).contains("lies on the faces \"F\" and \"G\""));
}

TEST(MappedScene, ATunnelsSectionIsAFace) {
  const std::string text =
      with_box(set_of("A")) +
      "[[excavation]]\nname = \"adit\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 2, height = 3 }\n"
      "axis = [[4, -1, 3], [4, 9, 3]]\n[mapped]\n[[mapped.face]]\nexcavation = \"adit\"\nchainage = ";
  const Scene scene = scene_of(text + "4\n");
  EXPECT_EQ(scene.mapped->faces, std::vector<std::string>{"1"});
  const Box box = box_of(scene.mapped->seen.faces[0].outline.corners());
  EXPECT_NEAR(norm(box.min - geometry::Vec3{3, 3, 1.5}), 0, 1e-12);
  EXPECT_NEAR(norm(box.max - geometry::Vec3{5, 3, 4.5}), 0, 1e-12);
  EXPECT_TRUE(has_note(scene, "mapped.face: \"1\" shows no joint"));
  EXPECT_TRUE(error_of(text + "11\n").contains("chainage: is 11 m, beyond the end of the axis; its last one is 10 m"));
  EXPECT_TRUE(error_of(text + "4\ncorners = [[1, 1, 1], [2, 1, 1], [2, 2, 1]]\n").contains("excavation"));
}

TEST(MappedScene, TracesThatMeetAtACornerAreJoined) {
  const std::string text =
      scene_text + "[[mapped.face]]\nname = \"R\"\ncorners = [[4, 1, 5], [4, 7, 5], [7, 7, 5], [7, 1, 5]]\n";
  const Scene scene = mapped_scene("F,A,,4,3,5,4,3.684,3.121\nF,A,,4,6,4,4,6.5,2.6\nR,,,4,3,5,6,3,5\n", text);
  ASSERT_EQ(scene.mapped->seen.joints.size(), 2U);
  EXPECT_EQ(scene.mapped->seen.joints[0].traces.size(), 2U);
  ASSERT_EQ(scene.mapped->sources.size(), 2U);
  EXPECT_EQ(scene.mapped->sources[0].rows.size(), 2U);
  EXPECT_EQ(scene.mapped->sources[0].rows[1].line, 4U);
  EXPECT_EQ(scene.mapped->sources[1].rows[0].line, 3U);
  EXPECT_TRUE(has_note(scene, "a pair of traces is at the border of two faces joined"));
}

TEST(MappedScene, PairsThatMayBeOneJointAreNoted) {
  const std::string text =
      scene_text + "[[mapped.face]]\nname = \"G\"\ncorners = [[5, 1, 1], [5, 7, 1], [5, 7, 5], [5, 1, 5]]\n";
  const std::string pair = "F,A,,4,3,4,4,3.684,2.121\nG,A,,5,3.05,4,5,3.73,2.121\n";
  const Scene scene = mapped_scene(pair, text);
  EXPECT_TRUE(
      has_note(scene, "t.csv:2: joint: 1 pair of traces on different faces may be of one joint: this one and line 3"));
  const std::string named = "F,A,a,4,3,4,4,3.684,2.121\nG,A,b,5,3.05,4,5,3.73,2.121\n";
  EXPECT_FALSE(has_note(mapped_scene(named, text), "may be of one joint")) << "they are said to be two";
  // In a plane across the set's: no joint of it lies so.
  const std::string across = "F,A,,4,3,4,4,3.684,2.121\nG,A,,5,6,4,5,6.684,2.121\n";
  EXPECT_FALSE(has_note(mapped_scene(across, text), "may be of one joint"));
}

TEST(MappedScene, PlanesThatTheirSetHasHardlyAreNoted) {
  // The set dips 70 degrees to the north, 95 % of its joints within 18 degrees of it; planes are good to 3.
  const std::string text = with_box(set_of("A")) + "[mapped]\npicks = \"p.csv\"\n" + hole;
  const auto scene = [&](const std::string& rows) {
    return scene_of(text, {{"p.csv", "hole,set,joint,depth,dip,dip_direction\n" + rows}});
  };
  EXPECT_FALSE(has_note(scene("H,A,,2,60,10\nH,A,,3,,\nH,A,,4,89,0\n"), "mean plane"));
  EXPECT_TRUE(has_note(scene("H,A,,2,20,0\n"), "p.csv:2: dip: 1 plane of picks lies further off"));
  const Scene two = scene("H,A,,2,30,0\nH,A,,3,,\nH,A,,4,10,90\n");
  EXPECT_TRUE(has_note(two, "p.csv:4: dip: 2 planes of picks lie further off"));
  EXPECT_TRUE(has_note(two, "70 degrees off that of \"A\""));
  EXPECT_FALSE(has_note(scene("H,,,2,20,0\n"), "mean plane")) << "of no set it is asked of";
}

TEST(MappedScene, WhatCannotBeHonouredIsSaid) {
  // Three holes pick it on no plane.
  const std::string text = with_box(set_of("A")) + "[mapped]\npicks = \"p.csv\"\n" +
                           "[[mapped.hole]]\nname = \"1\"\nfrom = [2, 1, 3]\nto = [2, 7, 3]\n"
                           "[[mapped.hole]]\nname = \"2\"\nfrom = [3, 1, 3]\nto = [3, 7, 3]\n"
                           "[[mapped.hole]]\nname = \"3\"\nfrom = [4, 1, 3]\nto = [4, 7, 3]\n";
  const RunResult result = run_of(text, {{"p.csv", "hole,set,joint,depth\n1,A,j,2\n2,A,j,3.5\n3,A,j,2\n"}});
  ASSERT_TRUE(result.mapped.has_value());
  EXPECT_FALSE(result.mapped->joints[0].honours);
  EXPECT_EQ(notes_with(result, "1 of 1 mapped joints is not honoured within 0.1 m and by the laws of its set"), 1U);
  EXPECT_EQ(notes_with(result, "p.csv:2"), 1U);
}

TEST(MappedScene, OthersMayEndAtSeenJoints) {
  const std::string ends_at =
      "model = \"enhanced_baecher\"\nterminates_at = [\"A\"]\nprobability = 1\nintensity = { p32 = 0.4 }\n";
  const std::string text = with_box(set_of("A") + set_of("B", ends_at)) + "[mapped]\ntraces = \"t.csv\"\n";
  const Scene scene = mapped_scene(trace, text + "sets = [\"A\"]\n" + face);
  EXPECT_TRUE(sample(scene).has_value());
  const std::string refused = row_error(trace, text + face);
  EXPECT_TRUE(refused.contains("mapped.sets: set \"B\" (line ")) << refused;
  EXPECT_TRUE(refused.contains("name the other sets in mapped.sets")) << refused;
}

TEST(MappedScene, WrongTablesAreRefused) {
  const auto wrong = [](const std::string& sets, const std::string& text) {
    return error_of(with_box(sets) + text, {{"t.csv", head}, {"p.csv", "depth\n"}});
  };
  EXPECT_TRUE(wrong(set_of("A"), "[mapped]\n").contains("mapped.face: is missing"));
  EXPECT_TRUE(
      wrong(set_of("A"), "[mapped]\ntraces = \"t.csv\"\n" + hole).contains("mapped.traces: stands without a face"));
  EXPECT_TRUE(
      wrong(set_of("A"), "[mapped]\npicks = \"p.csv\"\n" + face).contains("mapped.picks: stands without a hole"));
  EXPECT_TRUE(wrong("", "[mapped]\n" + face).contains("the scene has no [[joint_set]]"));
  EXPECT_TRUE(wrong(set_of("A"), "[mapped]\nsets = [\"Aa\"]\n" + face).contains("did you mean \"A\"?"));
  EXPECT_TRUE(wrong(set_of("A"), "[mapped]\nsets = []\n" + face).contains("is empty"));
  EXPECT_TRUE(wrong(set_of("A"), "[mapped]\nsets = [\"A\", \"A\"]\n" + face).contains("named twice"));
  EXPECT_TRUE(wrong(set_of("A") + set_of("A"), "[mapped]\nsets = [\"A\"]\n" + face).contains("the name of several"));
  std::string nameless = set_of("A");
  nameless.erase(nameless.find("name = \"A\"\n"), std::string_view{"name = \"A\"\n"}.size());
  EXPECT_TRUE(wrong(nameless + nameless, "[mapped]\n" + face).contains("several [[joint_set]] have no name"));
  EXPECT_TRUE(wrong(set_of("A"), "[mapped]\n" + face + face).contains("\"F\" is used twice"));
  EXPECT_TRUE(
      wrong(set_of("A"), "[mapped]\n[[mapped.hole]]\nfrom = [1, 1, 1]\nto = [1, 1, 1]\n").contains("give it a length"));
  EXPECT_TRUE(
      wrong(set_of("A"), "[mapped]\n[[mapped.face]]\ncorners = [[4, 1, 1], [4, 7, 1], [4.5, 7, 5], [4, 1, 5]]\n")
          .contains("mapped.face[1].corners"));
  EXPECT_TRUE(wrong(set_of("A", "intensity = { count = 20 }\n"), "[mapped]\n" + face).contains("set \"A\" (line "));
  EXPECT_TRUE(wrong(set_of("A", "intensity = { p32 = 0 }\n"), "[mapped]\n" + face).contains("has the intensity 0"));
  const std::string endless =
      "[[joint_set]]\nname = \"P\"\norientation = { dip = 70, dip_direction = 0 }\nsize = \"persistent\"\nintensity = "
      "{ "
      "spacing = 2 }\n";
  EXPECT_TRUE(wrong(endless, "[mapped]\n" + face).contains("set \"P\" (line "));
  EXPECT_TRUE(has_note(scene_of(with_box(set_of("A")) + "[mapped]\n[[mapped.face]]\ncorners = [[40, 1, 1], [40, 7, 1], "
                                                        "[40, 7, 5]]\n"),
                       "lies wholly outside of the domain"));
}

TEST(MappedScene, WrongRowsAreRefused) {
  EXPECT_TRUE(
      row_error("Q,A,,4,3,4,4,3.684,2.121\n").contains("t.csv:2: face: \"Q\" is no [[mapped.face]]; faces are: F"));
  EXPECT_TRUE(row_error("F,a2,,4,3,4,4,3.684,2.121\n").contains("\"a2\" is no [[joint_set]]; did you mean \"A\"?"));
  EXPECT_TRUE(row_error("F,A,,4.3,3,4,4,3.684,2.121\n").contains("end 1 lies 0.3 m off the plane of face \"F\""));
  EXPECT_TRUE(row_error("F,A,,4,3,4,4,3.5,5.5\n").contains("end 2 lies 0.5 m outside of face \"F\""));
  EXPECT_TRUE(row_error(",A,,4.3,3,4,4,3.684,2.121\n").contains("lies on no face within 0.1 m"));
  EXPECT_TRUE(row_error("F,A,,4,3,4,4,3,4\n").contains("is where the trace begins"));
  EXPECT_TRUE(row_error(trace + trace).contains("t.csv:3: x1: is the trace of line 2 again"));
  const std::string small = with_box(
                                "[[joint_set]]\nname = \"A\"\norientation = { dip = 70, dip_direction = 0 }\nshape = "
                                "\"disc\"\nsize = 1\nintensity = { p32 = 0.6 }\n") +
                            "[mapped]\ntraces = \"t.csv\"\n" + face;
  EXPECT_TRUE(row_error(trace, small).contains("makes a trace of 2 m, and joints of set \"A\" leave none longer than"));
  EXPECT_TRUE(row_error("F,A,,4,3,4,4,3.684,2.121,goes_on\n", scene_text, "face,set,joint,x1,y1,z1,x2,y2,z2,end1\n")
                  .contains("goes on 1 m from the border"));
  const std::string two = with_box(set_of("A") + set_of("B")) + "[mapped]\nsets = [\"B\"]\ntraces = \"t.csv\"\n" + face;
  EXPECT_TRUE(row_error(trace, two).contains("\"A\" is not among mapped.sets"));
  const Scene left_out = mapped_scene(trace + "F,A,,4,5,4,4,5.1,3.8\n",
                                      with_box(set_of("A")) + "[mapped]\nshortest = 0.5\ntraces = \"t.csv\"\n" + face);
  EXPECT_EQ(left_out.mapped->seen.joints.size(), 1U);
  EXPECT_TRUE(has_note(left_out, "t.csv:3: x1: 1 of 2 traces are shorter than mapped.shortest = 0.5 m"));
  EXPECT_TRUE(pick_error("X,A,,2,,,\n").contains("\"X\" is no [[mapped.hole]]; holes are: H"));
  EXPECT_TRUE(pick_error("H,A,,7,,,\n").contains("depth: is 7 m, and hole \"H\" is 6 m long"));
  EXPECT_TRUE(pick_error("H,A,,,6.5,3,3\n").contains("lies 0.5 m off hole \"H\""));
  EXPECT_TRUE(pick_error("H,A,j,2,,,\nH,A,j,3,,,\n").contains("\"j\" was picked in hole \"H\" before"));
  EXPECT_TRUE(error_of(scene_text).contains("mapped.traces: the file does not exist"));
}

TEST(MappedScene, RealizationsOfOneGeometryAreTheSameAlone) {
  const Scene scene = mapped_scene(trace, scene_text + "[monte_carlo]\nrealizations = 6\nstrengths_per_geometry = 2\n");
  const Shared shared = shared_by_realizations(scene, 1);
  for (const std::uint64_t geometry : {std::uint64_t{0}, std::uint64_t{2}}) {
    const auto both = make_records(scene, shared, 2 * geometry, 2);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(stochastic::line_of(both[1]), stochastic::line_of(make_record(scene, shared, 2 * geometry + 1)));
  }
  const auto centre = [&](std::uint64_t k) { return sample(scene, k).value().mapped->joints[0].centre; };
  EXPECT_EQ(centre(2), centre(3));
  EXPECT_NE(centre(1), centre(2));
  EXPECT_TRUE(has_note(scene, "how often a joint is not honoured is not counted in ensembles"));
  EXPECT_TRUE(make_plan(scene).runs(Step::draw));
  EXPECT_TRUE(make_costed_plan(scene).has_value());
}

}  // namespace
}  // namespace cleave::scene::test::mapped_scene_test
