#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/scene3d/scene.hpp"

// Tables of orientations as field programs write them, against planes worked out by hand.

namespace cleave::scene {
namespace {

using geometry::Vec3;

std::expected<SurveyScene, std::vector<Problem>> parsed(const std::string& toml, const std::string& table) {
  return parse_survey(toml, "s.toml", [table](const std::string& name) -> std::expected<LoadedFile, FileRefusal> {
    if (name != "t.csv") return std::unexpected(FileRefusal{"the file does not exist", "check the name"});
    return LoadedFile{table, name};
  });
}
std::vector<survey::MeasuredOrientation> read(const std::string& toml, const std::string& table) {
  const auto survey = parsed(toml, table);
  if (!survey) {
    for (const Problem& problem : survey.error()) ADD_FAILURE() << describe(problem);
    return {};
  }
  return survey->input.orientations;
}
std::string error_of(const std::string& toml, const std::string& table) {
  const auto survey = parsed(toml, table);
  return survey ? "taken" : describe(survey.error().front());
}
std::vector<std::string> notes_of(const std::string& toml, const std::string& table) {
  std::vector<std::string> notes;
  if (const auto survey = parsed(toml, table)) {
    for (const Problem& note : survey->notes) notes.push_back(describe(note));
  }
  return notes;
}
void expect_plane(Vec3 normal, double dip, double direction) {
  const Vec3 n = geometry::upward_normal({Dip::degrees(dip), DipDirection::degrees(direction)});
  EXPECT_NEAR(std::abs(dot(normal, n)), 1, 1e-12) << dip << "/" << direction;
  EXPECT_GE(normal.z, 0);
}

const std::string poles = "[[orientations]]\nfile = \"t.csv\"\n";

// A table that holds its rows twice has twice the joints.
TEST(FieldTables, RowsOfALineThatRepeatAnEarlierOneAreSaid) {
  const std::string line = "[[scanline]]\ntrend = 30\nplunge = 0\nlength = 40\nfile = \"t.csv\"\n";
  const std::string rows = "1,55,34,1\n2.7,62,39,4\n";
  const auto repeated = [&](const std::string& table) {
    std::string found;
    for (const std::string& note : notes_of(line, table)) {
      if (note.contains("repeat")) found += note;
    }
    return found;
  };
  EXPECT_EQ(
      repeated("distance,dip,dip_direction,length\n" + rows + rows),
      "t.csv:4: row: 2 rows repeat the measurements of an earlier one (this one those of line 2): each counts as a "
      "joint of its own; remove them where the table holds them twice");
  EXPECT_EQ(repeated("distance,dip,dip_direction,length\n" + rows + "1,55,34,2\n"), "");
  EXPECT_EQ(repeated("distance\n1\n1\n2\n"), "") << "of distances alone many may be the same";
}

TEST(FieldTables, AnglesBeyondTheirRangeTurnThePlane) {
  const auto rows = read(poles + "wrap = true\n", "dip,dip_direction\n-35,400\n100,20\n35,-140\n35,580\n190,10\n");
  ASSERT_EQ(rows.size(), 5U);
  expect_plane(rows[0].normal, 35, 220);  // so the manual of Dips has it
  expect_plane(rows[1].normal, 80, 200);
  expect_plane(rows[2].normal, 35, 220);
  expect_plane(rows[3].normal, 35, 220);
  expect_plane(rows[4].normal, 10, 10);
  EXPECT_TRUE(error_of(poles, "dip,dip_direction\n-35,400\n").contains("outside 0 to 90 degrees"));
  const auto trends = read(poles + "wrap = true\n", "trend,plunge\n400,-55\n");
  expect_plane(trends[0].normal, 35, 40);  // the line points up: so does the normal
}

TEST(FieldTables, DeclinationTurnsEveryDirection) {
  for (const auto& [table, direction] : std::map<std::string, double>{{"dip,dip_direction\n40,355\n", 7.5},
                                                                      {"dip,strike\n40,265\n", 7.5},
                                                                      {"trend,plunge\n175,50\n", 7.5 + 1e-13}}) {
    const auto rows = read(poles + "declination = 12.5\n", table);
    ASSERT_EQ(rows.size(), 1U);
    expect_plane(rows[0].normal, 40, direction);
  }
}

TEST(FieldTables, QuantitiesAreSoManyJoints) {
  const auto rows = read(poles, "Dip,Dip Direction,Quantity,Set\n40,100,3,a\n50,200,0,b\n60,300,,c\n");
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[2].set, "a");
  EXPECT_EQ(rows[3].set, "c");
  EXPECT_TRUE(error_of(poles, "dip,dip_direction,quantity\n40,100,1.5\n").contains("quantity: is 1.5"));
  EXPECT_TRUE(error_of(poles, "dip,dip_direction,quantity\n40,100,-1\n").contains("quantity: is -1"));
}

TEST(FieldTables, TraversesSayHowEachWasMet) {
  const std::string toml = poles +
                           "[[orientations.traverse]]\nname = \"1\"\nline = { trend = 90, plunge = 0 }\n"
                           "[[orientations.traverse]]\nname = \"2\"\noutcrop = { dip = 90, dip_direction = 0 }\n";
  const auto rows = read(toml, "Dip,Dip Direction,Traverse\n40,90,1\n40,180,2\n40,180,\n");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_NEAR(survey::weight_of(rows[0], 10), 1 / std::sin(40 * std::numbers::pi / 180), 1e-12);
  EXPECT_NEAR(survey::weight_of(rows[1], 10), 1 / std::sin(50 * std::numbers::pi / 180), 1e-12);
  EXPECT_EQ(survey::weight_of(rows[2], 10), 1);
  EXPECT_TRUE(error_of(toml, "dip,dip_direction,traverse\n40,90,3\n").contains("traverse: \"3\" is not described"));
  EXPECT_TRUE(error_of(toml, "dip,dip_direction\n40,90\n").contains("lacks the column traverse"));
  const auto notes = notes_of(poles, "dip,dip_direction,traverse\n40,90,1\n");
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].contains("how each was laid is not described"));
}

// Kulatilake & Wu (1984): window 3 by 2 m, discs of 2.4 m, plane 50/070, level window: 23.171108 joints a P30.
TEST(FieldTables, OutcropsOfASizeMeetJointsBySize) {
  const std::string toml = poles + "outcrop = { dip = 0, dip_direction = 90, width = 3, height = 2, diameter = 2.4 }\n";
  const auto rows = read(toml, "dip,dip_direction\n50,70\n");
  ASSERT_EQ(rows.size(), 1U);
  // The width lies along the strike, north here; the reference has it to the east: the trace runs 340.
  const double v = std::sin(50 * std::numbers::pi / 180), beta = 20 * std::numbers::pi / 180;
  const double met = v * (2.4 * 6 + std::numbers::pi / 4 * 2.4 * 2.4 * (3 * std::sin(beta) + 2 * std::cos(beta)));
  EXPECT_NEAR(survey::weight_of(rows[0], 10), 2.4 * 6 / met, 1e-12);
  const auto east = read(poles + "outcrop = { dip = 0, dip_direction = 0, width = 3, height = 2, diameter = 2.4 }\n",
                         "dip,dip_direction\n50,70\n");
  EXPECT_NEAR(2.4 * 6 / survey::weight_of(east[0], 10), 23.171108, 5e-7);
  EXPECT_TRUE(error_of(poles + "outcrop = { dip = 0, dip_direction = 90, width = 3 }\n", "dip,dip_direction\n50,70\n")
                  .contains("outcrop.height: is missing"));
}

const std::string hole = "[[borehole]]\nlength = 100\nfile = \"t.csv\"\n";

TEST(FieldTables, OrientedCoreOfAVerticalHole) {
  // Down the hole with the reference to the north: beta turns clockwise, so east at 90; the plane dips towards its
  // ellipse's lower end, by 90 - alpha.
  const auto rows =
      read(hole + "trend = 0\nplunge = 90\nreference = 0\n", "depth,alpha,beta\n1,30,0\n2,30,90\n3,65,200\n4,90,77\n");
  ASSERT_EQ(rows.size(), 4U);
  expect_plane(rows[0].normal, 60, 0);
  expect_plane(rows[1].normal, 60, 90);
  expect_plane(rows[2].normal, 25, 200);
  expect_plane(rows[3].normal, 0, 0);
  EXPECT_TRUE(error_of(hole + "trend = 0\nplunge = 90\n", "depth,alpha,beta\n1,30,0\n")
                  .contains("a vertical hole has no lower side"));
}

TEST(FieldTables, OrientedCoreOfAnInclinedHole) {
  // Hole 60 down to the east (090). A plane that it meets at alpha = 40 with the lower end at the bottom (beta 0): the
  // long axis plunges 60 - 40 = 20 to the east where it turns to the bottom side... by vectors: axis = cos 40 d + sin
  // 40 b, b = the bottom's direction (towards 270, 30 down).
  const auto rows = read(hole + "trend = 90\nplunge = 60\n", "depth,alpha,beta\n10,40,0\n20,40,180\n30,50,90\n");
  ASSERT_EQ(rows.size(), 3U);
  // d = (cos 60, 0, -sin 60), b = (-sin 60, 0, -cos 60): the long axis at 60 + 40 = 100 degrees down from east: the
  // plane strikes north and dips 80 to the west.
  expect_plane(rows[0].normal, 80, 270);
  // The other way: 60 - 40 = 20 degrees down to the east.
  expect_plane(rows[1].normal, 20, 90);
  // beta 90: clockwise seen down a hole to the east from its bottom is d x b = north or south: d x b = (0, cos^2 +
  // sin^2, 0).
  const double s = std::sin(50 * std::numbers::pi / 180), c = std::cos(50 * std::numbers::pi / 180);
  const Vec3 normal = s * Vec3{0.5, 0, -std::sqrt(0.75)} - c * Vec3{0, 1, 0};
  EXPECT_NEAR(std::abs(dot(rows[2].normal, normal)), 1, 1e-12);
  // From the top of the hole all turn by half.
  const auto top = read(hole + "trend = 90\nplunge = 60\nreference = \"top\"\n", "depth,alpha,beta\n10,40,180\n");
  expect_plane(top[0].normal, 80, 270);
  EXPECT_TRUE(error_of(hole + "trend = 90\nplunge = 60\n", "depth,alpha,beta\n10,95,0\n").contains("alpha: is 95"));
  EXPECT_TRUE(error_of(poles, "alpha,beta\n40,0\n").contains("needs the line of its core"));
  const auto met = read(poles + "line = { trend = 90, plunge = 60 }\n", "alpha,beta\n40,0\n");
  expect_plane(met[0].normal, 80, 270);
}

TEST(FieldTables, EveryPlaneOfACoreComesBack) {
  const Vec3 d = geometry::line_vector({geometry::Trend::degrees(217), geometry::Plunge::degrees(38)});
  Vec3 b = Vec3{0, 0, -1} - dot(Vec3{0, 0, -1}, d) * d;
  b = b / norm(b);
  for (int dip = 5; dip <= 85; dip += 20) {
    for (int direction = 3; direction < 360; direction += 40) {
      Vec3 n = geometry::upward_normal({Dip::degrees(dip), DipDirection::degrees(direction)});
      if (dot(n, d) < 0) n = -n;  // alpha = asin(n.d); the ellipse's lower end lies against n across the core
      const double alpha = std::asin(dot(n, d)) * 180 / std::numbers::pi;
      const Vec3 end = -(n - dot(n, d) * d);
      double beta = std::atan2(dot(end, cross(d, b)), dot(end, b)) * 180 / std::numbers::pi;
      if (beta < 0) beta += 360;
      const auto rows = read(poles + "line = { trend = 217, plunge = 38 }\n",
                             "alpha,beta\n" + std::to_string(alpha) + "," + std::to_string(beta) + "\n");
      ASSERT_EQ(rows.size(), 1U);
      EXPECT_NEAR(std::abs(dot(rows[0].normal, n)), 1, 1e-12);
    }
  }
}

TEST(FieldTables, TablesOfShapeMetriX) {
  const std::string table =
      "Version,1\nUnits,m\nDeclination,3.5\nX (Easting),Y (Northing),Z (Elevation),Persistence (m),Dip,Dip "
      "Direction,Set ID,Colour\n10.5,20.25,3,4.5,60,120,1,#ff0000\n11,21,4,2.5,62,125,2,#00ff00\nSet ID,Set "
      "Name,Mean Dip\n1,A,61\n";
  const auto rows = read(poles, table);
  ASSERT_EQ(rows.size(), 2U);
  expect_plane(rows[0].normal, 60, 120);
  EXPECT_EQ(rows[1].set, "2");
  const auto notes = notes_of(poles, table);
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_TRUE(notes[0].contains("3.5 degrees, which are not added")) << notes[0];
  EXPECT_TRUE(notes[1].contains("what follows the joints is not read")) << notes[1];
  EXPECT_TRUE(
      notes[2].contains("not read: \"X (Easting)\", \"Y (Northing)\", \"Z (Elevation)\", \"Persistence (m)\", "
                        "\"Colour\""))
      << notes[2];
  EXPECT_TRUE(error_of(poles, "Units,furlong\nDip,Dip Direction\n1,2\n").contains("units: are \"furlong\""));
}

// Lengths are in the unit that the table states above its header, but for columns that state their own.
TEST(FieldTables, UnitsAboveTheTableAreThoseOfItsLengths) {
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 0\nlength = 20\n";
  const auto place = [&](const std::string& toml, const std::string& table) {
    const auto survey = parsed(toml, table);
    if (!survey || survey->input.lines[0].positions.size() != 1) return std::pair{-1.0, -1.0};
    const survey::LineSurvey& read = survey->input.lines[0];
    return std::pair{read.positions[0], read.lengths[0]->length};
  };
  const auto in_feet = place(line, "Version,1\nUnits,ft\ndistance,length,ends\n10,5,2\n");
  EXPECT_NEAR(in_feet.first, 3.048, 1e-12);
  EXPECT_NEAR(in_feet.second, 1.524, 1e-12);
  const auto own = place(line, "Units: mm\ndistance [m],length,ends\n10,500,2\n");
  EXPECT_NEAR(own.first, 10, 1e-12);
  EXPECT_NEAR(own.second, 0.5, 1e-12);
  const auto stated = place(line + "columns = [\"distance\", \"length\"]\n", "Units,ft\ndistance,length\n10,5\n");
  EXPECT_NEAR(stated.first, 3.048, 1e-12);
  EXPECT_NEAR(place(line, "Units,m\ndistance,length,ends\n10,5,2\n").first, 10, 1e-12);
}

TEST(FieldTables, JointsWithoutAPlaceOnTheLineAreRefused) {
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 0\nlength = 20\n";
  EXPECT_TRUE(error_of(line, "distance,dip,dip_direction\n1,80,85\n,82,95\n7,78,91\n")
                  .contains("t.csv:3: distance: is empty; give metres along the line, or remove the row"))
      << error_of(line, "distance,dip,dip_direction\n1,80,85\n,82,95\n7,78,91\n");
}

// Each pair of columns that a row fills counts, whatever the others are.
TEST(FieldTables, ConventionsOfARowAreComparedAndStandInForEachOther) {
  EXPECT_TRUE(error_of(poles, "dip,strike,trend,plunge\n35,120,10,70\n")
                  .contains("trend and plunge and dip and strike of this row are not the same plane"));
  expect_plane(read(poles, "dip,strike,trend,plunge\n35,120,30,55\n").at(0).normal, 35, 210);
  expect_plane(read(poles, "dip,dip_direction,trend,plunge\n35,210,,\n").at(0).normal, 35, 210);
  expect_plane(read(poles, "dip,dip_direction,strike\n35,,120\n").at(0).normal, 35, 210);
}

// Traces too short to be mapped are not drawn either, and sets.toml says of which joints its intensity is.
TEST(FieldTables, SimulatedMapsAreTruncatedLikeTheWindow) {
  std::string table = "x1,y1,x2,y2\n";
  for (int i = 0; i < 60; ++i) {
    const double x = 0.3 * i - 9, y = i % 7 - 3, half = 1 + 0.05 * ((i * 17) % 60);
    table += std::to_string(x) + "," + std::to_string(y - half) + "," + std::to_string(x) + "," +
             std::to_string(y + half) + "\n";
  }
  const auto survey = parsed(
      "[[window]]\ntraces = \"t.csv\"\ncircle = { centre = [0, 0], radius = 10 }\ntruncation = 2\n"
      "[[set]]\nname = \"A\"\ndip = 90\ndip_direction = 90\nkappa = 50\n",
      table);
  ASSERT_TRUE(survey.has_value());
  survey::SurveyResult result = survey::analyse(survey->input);
  for (const SimulatedTraceMaps& maps : simulated_trace_maps(*survey, result)) {
    ASSERT_TRUE(maps.first.has_value());
    for (const survey::SeenTrace& t : seen_through(survey->input.windows[0].window, *maps.first, 0)) {
      EXPECT_GE(t.length, 2);
    }
  }
  EXPECT_TRUE(sets_file(*survey, result).toml.contains("# P32 is that of joints with traces of 2 m and more"))
      << sets_file(*survey, result).toml;
  // Most joints of a wide gamma law are too small to have corners.
  result.sets[0].size->family = survey::Family::gamma;
  EXPECT_TRUE(sets_file(*survey, result).toml.contains(", min = ")) << sets_file(*survey, result).toml;
}

TEST(FieldTables, WindowsWhoseOutlineCrossesItselfAreRefused) {
  const auto window = [](const std::string& corners) {
    return error_of("[[window]]\ntraces = \"t.csv\"\npolygon = " + corners + "\n", "x1,y1,x2,y2\n1,1,2,2\n");
  };
  EXPECT_TRUE(window("[[0, 0], [10, 10], [10, 0], [0, 9]]")
                  .contains("polygon: is an outline that crosses itself: side 1 crosses side 3; give the corners in "
                            "their order round the window"))
      << window("[[0, 0], [10, 10], [10, 0], [0, 9]]");
  EXPECT_EQ(window("[[0, 0], [10, 0], [10, 10], [0, 9]]"), "taken");
  EXPECT_EQ(window("[[0, 0], [10, 0], [5, 4], [10, 10], [0, 9]]"), "taken");  // not convex
  EXPECT_EQ(window("[[0, 0], [10, 0], [10, 10], [0, 9], [0, 0]]"), "taken");  // closed by its first corner
}

// A trace length or a spacing beside orientations alone counts for nothing: that is said, and where it would count.
TEST(FieldTables, ColumnsThatAreNotReadAreSaid) {
  const auto said = notes_of(poles, "ID,Dip,Dip Direction,Set,Trace Length,Spacing (m)\n1,55,40,J1,8.2,3.5\n");
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(said[0].contains("not read: \"ID\", \"Trace Length\", \"Spacing (m)\"")) << said[0];
  EXPECT_TRUE(said[0].contains("[[scanline]]")) << said[0];
  const auto plain = notes_of(poles, "ID,Dip,Dip Direction,Quantity\n1,55,40,2\n");
  ASSERT_EQ(plain.size(), 1U);
  EXPECT_FALSE(plain[0].contains("[[scanline]]")) << plain[0];
  EXPECT_TRUE(notes_of(poles, "Dip,Dip Direction,Set,Quantity\n55,40,J1,2\n").empty());
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 0\nlength = 60\n";
  EXPECT_TRUE(notes_of(line, "Distance,Dip,Dip Direction,Set,Persistence,Ends\n5,55,40,J1,2,1\n").empty());
  const auto spaced = notes_of(line, "Distance,Spacing\n5,0.2\n");
  ASSERT_EQ(spaced.size(), 1U);
  EXPECT_TRUE(spaced[0].contains("not read: \"Spacing\"; spacings follow from the distances")) << spaced[0];
}

// Half an orientation is no orientation: it is refused, and beside a whole one it is said not to count.
TEST(FieldTables, HalfAnOrientationIsRefused) {
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 0\nlength = 60\n";
  const std::string core = "[[borehole]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 60\nlength = 60\n";
  EXPECT_TRUE(
      error_of(line, "distance,dip,set\n5,55,A\n")
          .contains("t.csv:1: columns: lacks the columns of an orientation: dip without dip_direction or strike"));
  EXPECT_TRUE(
      error_of(line, "distance,Dip Dir,set\n5,55,A\n")
          .contains("t.csv:1: columns: lacks the columns of an orientation: dip_direction (\"Dip Dir\") without dip;"));
  EXPECT_TRUE(error_of(line, "distance,strike\n5,55\n").contains("strike without dip;"));
  EXPECT_TRUE(error_of(line, "distance,trend\n5,55\n").contains("trend without plunge;"));
  EXPECT_TRUE(error_of(line, "distance,plunge\n5,55\n").contains("plunge without trend;"));
  EXPECT_TRUE(error_of(core, "depth,alpha,set\n5,55,A\n").contains("alpha without beta;"));
  EXPECT_TRUE(error_of(core, "depth,beta,set\n5,55,A\n").contains("beta without alpha;"));
  EXPECT_TRUE(error_of(poles, "dip,set\n55,A\n").contains("dip without dip_direction or strike;"));
  const auto said = notes_of(line, "distance,dip,dip_direction,alpha\n5,55,40,30\n");
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(said[0].contains("alpha is not used: there is no beta")) << said[0];
  const auto rows = notes_of(line, "distance,dip,dip_direction\n5,55,40\n6,55,\n7,,\n8,,40\n");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_TRUE(rows[0].contains("t.csv:3: dip: 2 rows from here on have dip or dip_direction alone")) << rows[0];
  EXPECT_TRUE(notes_of(line, "distance,set\n5,A\n").empty());
  EXPECT_TRUE(notes_of(line, "distance,dip,strike,dip_direction\n5,55,310,40\n").empty());
}

// Some call the strike azimuth.
TEST(FieldTables, AnAzimuthIsSaidToBeTheDipDirection) {
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 90\nplunge = 0\nlength = 60\n";
  const std::string what = "\" is read as the dip direction; where it is the strike, name it strike";
  for (const auto& [toml, table] :
       {std::pair{line, "distance,dip,Azimuth (deg)\n5,55,40\n"}, std::pair{poles, "dip,Azimuth (deg)\n55,40\n"}}) {
    const auto said = notes_of(toml, table);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_TRUE(said[0].contains("t.csv:1: columns: \"Azimuth (deg)" + what)) << said[0];
    const auto rows = read(toml, table);
    ASSERT_EQ(rows.size(), 1U);
    expect_plane(rows[0].normal, 55, 40);
  }
  EXPECT_TRUE(notes_of(line, "distance,dip,dd\n5,55,40\n").empty());
}

// What is read ends up in the file of sets that a scene includes: nothing may break out of its comments and texts.
TEST(FieldTables, NamesAreTextAndFilesOfSetsCanBeRead) {
  EXPECT_TRUE(error_of(poles,
                       "dip,dip_direction,set\n60,120,a\x01"
                       "b\n")
                  .contains("t.csv:2: file: a cell holds control"));
  EXPECT_TRUE(
      error_of(poles, "dip,dip_direction,set\n60,120,\xe4\n").contains("t.csv:2: set: \"\xEF\xBF\xBD\" is not"));
  const std::string line = "[[scanline]]\ntrend = 0\nplunge = 0\nlength = 20\nfile = \"t.csv\"\n";
  EXPECT_TRUE(error_of(line, "distance,dip,dip_direction,set\n1,60,120,\xe4\n").contains("is not UTF-8 text"));
  EXPECT_TRUE(
      error_of(line, "distance,dip (\xB0),dip_direction\n1,60,120\n")
          .contains("t.csv:1: columns: the column \"dip (\xEF\xBF\xBD)\" is not UTF-8 text; save the table as UTF-8"));
  const std::string table = "distance,dip,dip_direction,set\n1,60,120,\"a\\\"\" = \xC3\xA4\"\n2,61,121,b]#\n";
  const auto survey = parse_survey(
      line, "two\n[lines]\x7f\xff.toml",
      [&](const std::string& name) -> std::expected<LoadedFile, FileRefusal> { return LoadedFile{table, name}; });
  ASSERT_TRUE(survey.has_value());
  const SetsFile sets = sets_file(*survey, survey::analyse(survey->input));
  EXPECT_TRUE(sets.toml.starts_with("# Joint sets of two [lines] \xEF\xBF\xBD.toml (sha256")) << sets.toml;
  const auto scene = parse(
      "schema = 1\ninclude = [\"s.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n", "scene.toml",
      [&](const std::string& name) -> std::expected<LoadedFile, FileRefusal> { return LoadedFile{sets.toml, name}; });
  ASSERT_TRUE(scene.has_value()) << describe(scene.error().front());
}

TEST(FieldTables, SetsOfOneNameAndClustersBesideSetsAreRefused) {
  const std::string table = "dip,dip_direction\n60,40\n62,43\n80,120\n";
  const auto set = [](const std::string& name) {
    return "[[set]]\nname = \"" + name + "\"\npolygon = [[200, 10], [240, 10], [240, 50], [200, 50]]\n";
  };
  EXPECT_EQ(
      error_of(poles + set("A") + set("A"), table),
      "s.toml:7: set[2].name: \"A\" is the name of another [[set]]; give each set a name of its own; a set has one "
      "polygon");
  EXPECT_EQ(error_of(poles + set("A") + set("B"), table), "taken");
  const std::string clusters = "clusters = 2\n" + poles;
  EXPECT_EQ(error_of(clusters + set("A"), table),
            "s.toml:1: clusters: stands beside the polygon of the set \"A\": both would say which joints belong to it; "
            "remove `clusters`, or the polygons");
  EXPECT_EQ(
      error_of(clusters, "dip,dip_direction,set\n60,40,A\n62,43,\n"),
      "s.toml:1: clusters: stands beside sets that the tables state: both would say which joints belong to which; "
      "remove `clusters`, or the column (or key) `set`");
  EXPECT_EQ(
      error_of("clusters = 2\n[[scanline]]\ntrend = 0\nplunge = 0\nlength = 20\nfile = \"t.csv\"\n",
               "distance,dip,dip_direction,set\n1,60,120,A\n"),
      "s.toml:1: clusters: stands beside sets that the tables state: both would say which joints belong to which; "
      "remove `clusters`, or the column (or key) `set`");
  EXPECT_EQ(error_of(clusters, table), "taken");
  EXPECT_EQ(error_of("clusters = 0\n" + poles + set("A"), table), "taken");
}

// Rows with more or fewer cells than columns were read from the left, and quotes did not hold a cell together:
// "60,5","240,5" was 60/005, and a set "A, west" was A.
TEST(FieldTables, CellsAreThoseOfTheColumns) {
  const std::string both = "dip,dip_direction\n";
  EXPECT_TRUE(error_of(poles, both + "60,5,240,5\n")
                  .contains("t.csv:2: row: 4 cells, the header has 2; give every "
                            "column; with decimal commas separate columns by"));
  EXPECT_TRUE(error_of(poles, both + "60\n").contains("t.csv:2: row: 1 cells, the header has 2"));
  EXPECT_TRUE(error_of(poles + "columns = [\"dip\", \"dip_direction\"]\n", "60 240 5\n").contains("`columns` has 2"));
  EXPECT_TRUE(error_of(poles, both + "\"60,5\",\"240,5\"\n")
                  .contains("t.csv:2: dip: \"60,5\" is not a number; write a decimal point; with decimal commas"));
  EXPECT_TRUE(
      error_of(poles, "dip,dip_direction,set\n60,40,\"A\n west\"\n").contains("t.csv:2: set: holds a line end"));
  EXPECT_TRUE(error_of(poles, "dip,dip_direction,set\n60,40,\"A\n").contains("a quoted cell is not closed"));
  const auto named = read(poles, "dip,dip_direction,set\n60,40,\"A, west\"\n60,40, B ,,\n,,\n\"60\",\"40\",C \"c\"\n");
  ASSERT_EQ(named.size(), 3U);
  EXPECT_EQ(named[0].set, "A, west");
  EXPECT_EQ(named[1].set, "B");
  EXPECT_EQ(named[2].set, "C \"c\"");
  for (const char* table : {"dip;dip_direction;set\n60,5;\"240,5\";St. 1\n", "dip\tset\tdip_direction\n60.5\t\t240.5\n",
                            "dip dip_direction  set\n 60.5\t240.5 \"A b\" \n"}) {
    const auto rows = read(poles, table);
    ASSERT_EQ(rows.size(), 1U) << table;
    expect_plane(rows[0].normal, 60.5, 240.5);
  }
  EXPECT_TRUE(error_of(poles, "dip;dip_direction\n60,5;240.5\n").contains("use decimal points, or decimal commas"));
}

// alpha and beta won over a contradicting dip and dip direction: 88.1/197.5 for 60/040.
TEST(FieldTables, CoreAnglesAreThoseOfTheStatedPlane) {
  const std::string table = "depth,alpha,beta,dip,dip_direction\n";
  const std::string inclined = hole + "trend = 90\nplunge = 60\n";
  EXPECT_TRUE(error_of(inclined, table + "10,40,0,60,40\n")
                  .contains("t.csv:2: alpha: alpha and beta give the plane 80.0/270.0 in this hole"))
      << error_of(inclined, table + "10,40,0,60,40\n");
  // As the hole runs, not as a straight line does.
  for (const std::string row : {"10,40,0,80,270\n", "10,40,0,72,268\n", "10,40,0,,\n", "10,40,0,80,\n"}) {
    const auto rows = read(inclined, table + row);
    ASSERT_EQ(rows.size(), 1U);
    expect_plane(rows[0].normal, 80, 270);
  }
  EXPECT_TRUE(error_of(inclined, table + "10,40,0,68,270\n").contains("12 degrees off"));
  EXPECT_TRUE(error_of(inclined, "depth,alpha,beta,trend,plunge\n10,40,0,10,10\n").contains("in this hole"));
}

TEST(FieldTables, AnglesThatMayBeRadiansAreSaid) {
  const auto said = [](const std::string& toml, const std::string& table) {
    const auto notes = notes_of(toml, table);
    return notes.size() == 1 && notes[0].contains("if they are meant in radians");
  };
  EXPECT_TRUE(said(poles, "dip,dip_direction\n1.05,0.70\n0.98,5.9\n"));
  EXPECT_TRUE(said(poles, "dip,strike\n1.05,0.70\n"));
  EXPECT_TRUE(said(poles, "trend,plunge\n1.05,0.70\n"));
  const std::string inclined = hole + "trend = 90\nplunge = 60\n";
  EXPECT_TRUE(said(inclined, "depth,alpha,beta\n1,1.05,0.70\n"));
  EXPECT_TRUE(said(inclined, "depth,dip,dip_direction\n1,1.05,0.70\n"));
  EXPECT_TRUE(notes_of(poles, "dip (rad),dip_direction (rad)\n1.05,0.70\n").empty());
  EXPECT_TRUE(notes_of(poles, "dip,dip_direction\n1.05,0.70\n1.6,0.7\n").empty());
  EXPECT_TRUE(notes_of(poles, "dip,dip_direction\n1,2\n").empty());
}

TEST(FieldTables, LengthsThatCountForNothingAreSaid) {
  const std::string line = "[[scanline]]\nfile = \"t.csv\"\ntrend = 40\nplunge = 0\nlength = 7\n";
  const std::string header = "distance,dip,dip_direction,length,ends\n";
  const auto whole = notes_of(line, "distance,dip,dip_direction,length\n1,60,40,3\n2,61,41,\n3,60,40,5\n");
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_TRUE(whole[0].contains("there is no column ends: both ends of all 2 traces are taken as seen")) << whole[0];
  EXPECT_TRUE(notes_of(line, "distance,dip,dip_direction,length\n1,60,40,\n").empty());
  const auto zero = notes_of(line, header + "1,60,40,0,2\n2,61,41,4,2\n");
  ASSERT_EQ(zero.size(), 1U);
  EXPECT_TRUE(zero[0].contains("length: 1 of 2 are 0 and count as not measured")) << zero[0];
  const std::string rows = header + "1,60,40,3,2\n2,61,41,4,1\n3,60,40,5,2\n4,59,40,3,2\n";
  const auto below = notes_of(line + "truncation = 4\n", rows);
  ASSERT_EQ(below.size(), 1U);
  EXPECT_TRUE(below[0].contains("length: 2 of 4 are below the truncation, 4 m, and count for nothing")) << below[0];
  EXPECT_TRUE(notes_of(line + "truncation = 3\n", rows).empty());
  // The reason in the file of sets was that no end had been seen.
  const auto survey = parsed(line + "truncation = 200\n", rows);
  ASSERT_TRUE(survey.has_value());
  const SetsFile sets = sets_file(*survey, survey::analyse(survey->input));
  EXPECT_TRUE(sets.toml.contains("size = \"persistent\"   # all traces are shorter than the truncation, 200 m"))
      << sets.toml;
}

TEST(FieldTables, ColumnsThatComeTwiceAreRefused) {
  EXPECT_TRUE(error_of(poles, "dip,dip_direction,Dip\n60,40,50\n")
                  .contains("t.csv:1: columns: dip comes twice: \"dip\" and \"Dip\"; remove one"));
  EXPECT_TRUE(error_of(poles, "dip,dip_direction,Azimuth\n60,40,50\n").contains("\"dip_direction\" and \"Azimuth\""));
  EXPECT_TRUE(error_of("[[scanline]]\nfile = \"t.csv\"\ntrend = 40\nplunge = 0\nlength = 7\n",
                       "distance,Trace Length,Persistence\n1,2,3\n")
                  .contains("length comes twice"));
  EXPECT_EQ(read(poles, "dip,dip_direction,remark,remark,,\n60,40,a,b,,\n").size(), 1U);
}

// Sets of which Fisher's law does not hold take their poles from a file each, whatever their names have in common.
TEST(FieldTables, SetsOfLikeNamesHaveFilesOfTheirOwn) {
  std::string table = "distance,dip,dip_direction,set\n";
  // Two bunches of poles.
  const auto bunches = [&](const std::string& name, int dip) {
    for (int i = 0; i < 40; ++i) {
      table += std::to_string(0.1 * i + 0.01) + "," + std::to_string(dip) + "," + (i % 2 == 0 ? "0" : "90") + "," +
               name + "\n";
    }
  };
  bunches("A 1", 40);
  bunches("a-1", 70);
  bunches("A_1", 55);
  const auto survey = parsed("[[scanline]]\ntrend = 0\nplunge = 0\nlength = 20\nfile = \"t.csv\"\n", table);
  ASSERT_TRUE(survey.has_value());
  const SetsFile sets = sets_file(*survey, survey::analyse(survey->input));
  ASSERT_EQ(sets.files.size(), 3U) << sets.toml;
  std::map<std::string, std::string> by_name(sets.files.begin(), sets.files.end());
  EXPECT_EQ(by_name.size(), 3U);
  for (const auto& [name, dip] : std::map<std::string, double>{{"A 1", 40}, {"a-1", 70}, {"A_1", 55}}) {
    const std::string after = sets.toml.substr(sets.toml.find("name = \"" + name + "\""));
    const std::size_t at = after.find("file = \"") + 8;
    const std::string& csv = by_name.at(after.substr(at, after.find('"', at) - at));
    EXPECT_NEAR(std::stod(csv.substr(csv.find('\n') + 1)), dip, 1e-9) << name;
  }
}

// A line that meets no joint is data; a table of orientations without any is none.
TEST(FieldTables, BarrenLinesAreTaken) {
  const std::string line = "[[scanline]]\ntrend = 0\nplunge = 0\nlength = 20\nfile = \"t.csv\"\n";
  const auto survey = parsed(line, "distance,dip,dip_direction\n");
  ASSERT_TRUE(survey.has_value());
  ASSERT_EQ(survey->input.lines.size(), 1U);
  EXPECT_EQ(survey->input.lines[0].length(), 20);
  EXPECT_TRUE(survey->input.lines[0].positions.empty());
  const survey::SurveyResult result = survey::analyse(survey->input);
  EXPECT_EQ(result.lines[0].frequency.value.value(), 0);
  EXPECT_NEAR(result.lines[0].frequency.high, 3.688879 / 20, 1e-6);  // exact Poisson
  EXPECT_EQ(result.lines[0].rqd_measured, 100);
  EXPECT_TRUE(std::isnan(result.tensor.values[0]));  // no orientation: no zeros
  EXPECT_TRUE(error_of(line, "").contains("holds no measurements"));
  EXPECT_TRUE(
      error_of("[[orientations]]\nfile = \"t.csv\"\n", "dip,dip_direction\n").contains("holds no measurements"));
}

}  // namespace
}  // namespace cleave::scene
