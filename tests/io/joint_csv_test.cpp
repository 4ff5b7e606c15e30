#include "cleave/io/joint_csv.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io_testing.hpp"

namespace cleave::io::joint_csv_test {
namespace {

JointTable read(std::string_view text, const JointCsvOptions& options = {}) {
  auto table = parse_joint_csv(text, "joints.csv", options);
  EXPECT_TRUE(table.has_value()) << describe(table.error().front());
  return table ? *std::move(table) : JointTable{};
}

std::vector<ReadError> problems(std::string_view text, const JointCsvOptions& options = {}) {
  const auto table = parse_joint_csv(text, "joints.csv", options);
  EXPECT_FALSE(table.has_value()) << text;
  if (table) return {{}};
  for (const ReadError& e : table.error()) {
    EXPECT_EQ(e.file, "joints.csv");
    EXPECT_FALSE(e.remedy.empty());
  }
  return table.error();
}

TEST(JointCsvTest, PolesByTrendAndPlunge) {
  const JointTable t = read("trend,plunge,x,y,z\n220,55,1,2,3\n30,0,0,0,0\n0,90,0,0,0\n");
  EXPECT_EQ(t.rows[0].plane.dip.degrees(), 35);  // the pole points down: the plane dips the other way
  EXPECT_EQ(t.rows[0].plane.direction.degrees(), 40);
  EXPECT_EQ(t.rows[1].plane.dip.degrees(), 90);
  EXPECT_EQ(t.rows[1].plane.direction.degrees(), 210);
  EXPECT_EQ(t.rows[2].plane.dip.degrees(), 0);
  const JointTable wrapped = read("trend,plunge,x,y,z\n-140,-55,1,2,3\n", {.wrap = true});
  EXPECT_EQ(wrapped.rows[0].plane.dip.degrees(), 35);
  EXPECT_EQ(wrapped.rows[0].plane.direction.degrees(), 220);
  EXPECT_EQ(problems("trend,plunge,x,y,z\n10,95,0,0,0\n").front().what, "plunge is 95, outside 0..90");
  EXPECT_EQ(problems("trend,x,y,z\n10,0,0,0\n").front().what, "of trend and plunge of the pole one is missing");
  const JointTable both = read("dip,dip_direction,trend,plunge,x,y,z\n30,40,1,2,0,0,0\n");
  EXPECT_EQ(both.rows[0].plane.dip.degrees(), 30);
  EXPECT_EQ(both.notes.back(), "trend and plunge are not used beside dip");
}

TEST(JointCsvTest, FormulasComeBackAndControlCharactersDoNotGetIn) {
  const JointTable t = read("x,y,z,dip,dip direction,set\n0,0,0,60,30,=A1\n0,0,0,50,20,'=A1\n0,0,0,40,10,'tis\n");
  EXPECT_EQ(t.rows[0].set, "=A1");
  EXPECT_EQ(t.rows[1].set, "=A1");
  EXPECT_EQ(t.rows[2].set, "'tis");
  const std::string written = write_joint_csv(t);
  EXPECT_TRUE(written.contains(",'=A1\n")) << written;
  EXPECT_EQ(read(written).rows[0].set, "=A1");
  const auto wrong = problems("x,y,z,dip,dip direction,set\n0,0,0,60,30,a\x1b[2J\n");
  EXPECT_EQ(wrong.front().line, 2U);
  EXPECT_EQ(wrong.front().what, "a cell holds control characters");
  const auto latin = problems(
      "x,y,z,dip,dip direction,set,site\n0,0,0,60,30,a,\xe4\n0,0,0,60,30,Kl\xfc"
      "fte,\n");
  ASSERT_EQ(latin.size(), 1U);
  EXPECT_EQ(latin.front().line, 3U);
  EXPECT_EQ(latin.front().what,
            "\"Kl\xEF\xBF\xBD"
            "fte\" is not UTF-8 text");
}

TEST(JointCsvTest, ColumnsInAnyOrderAndEverySize) {
  const JointTable t = read(
      "\xEF\xBB\xBF# measured in spring\r\n"
      "ID,Set,\"Easting\",northing,Elevation,Dip "
      "Direction,DIP,radius,side_a,side_b,rotation,friction,cohesion,remark\r\n"
      "\r\n"
      "7,A,1,2,3,30,60,5,,,,25,0,\"a \"\"good\"\" one, visible\"\r\n"
      "8,\"B, wet\",1.5,-2,3e2,360,90,,4,2,10,,,\r\n"
      "9,,0,0,0,0,0,,,,,,1e4,\r\n");
  ASSERT_EQ(t.rows.size(), 3U);
  EXPECT_EQ(t.rows[0].line, 4U);
  EXPECT_EQ(t.rows[0].plane, (geometry::Attitude{Dip::degrees(60), DipDirection::degrees(30)}));
  EXPECT_EQ(t.rows[0].position, (geometry::Vec3{1, 2, 3}));
  EXPECT_EQ(std::get<DiscSize>(t.rows[0].size).radius, metres(5));
  EXPECT_EQ(t.rows[0].friction, FrictionAngle::degrees(25));
  EXPECT_EQ(t.rows[0].set, "A");
  EXPECT_EQ(t.rows[1].set, "B, wet");
  EXPECT_EQ(t.rows[1].plane.direction.degrees(), 0);  // 360 is 0
  EXPECT_EQ(std::get<RectangleSize>(t.rows[1].size),
            (RectangleSize{metres(4), metres(2), geometry::InPlaneRotation::degrees(10)}));
  EXPECT_FALSE(t.rows[1].friction.has_value());
  EXPECT_TRUE(std::holds_alternative<Persistent>(t.rows[2].size));
  EXPECT_EQ(t.rows[2].cohesion, pascals(1e4));
  ASSERT_EQ(t.notes.size(), 3U);
  EXPECT_EQ(
      t.notes[0],
      "columns read: id, set, x (from \"easting\") in m, y (from \"northing\") in m, z (from \"elevation\") in m, "
      "dip_direction in degrees, dip in degrees, radius in m, side_a in m, side_b in m, rotation in degrees, "
      "friction in degrees, cohesion in Pa");
  EXPECT_EQ(t.notes[1], "column \"remark\" is not used");
  EXPECT_EQ(t.notes[2], "1 of 3 joints has no size (the first in line 6): it goes through the whole domain");
}

// Some call the strike so.
TEST(JointCsvTest, AnAzimuthIsSaidToBeTheDipDirection) {
  const JointTable t = read("dip,Azimuth,x,y,z\n60,30,1,2,3\n");
  EXPECT_EQ(
      std::ranges::count(t.notes, "\"azimuth\" is read as the dip direction; where it is the strike, name it strike"),
      1);
  EXPECT_EQ(read("dip,dd,x,y,z\n60,30,1,2,3\n").notes.size(), t.notes.size() - 1);
}

TEST(JointCsvTest, RowsThatRepeatAnEarlierOneAreSaid) {
  const std::string head = "dip,dip_direction,x,y,z,radius,friction,id\n";
  const auto twice =
      read(head + "60,30,1,2,3,4,30,a\n60,30,1,2,3.5,4,30,b\n60.0,30,1,2,3,4,35,c\n60,30,1,2,3,4,30,d\n").notes;
  ASSERT_EQ(twice.size(), 2U);
  EXPECT_EQ(twice[1], "2 rows repeat the joint of an earlier one (line 4 that of line 2): check them");
  EXPECT_EQ(read(head + "60,30,1,2,3,4,30,a\n60,30,1,2,3,5,30,a\n").notes.size(), 1U);
  // Of orientations alone many are the same.
  JointCsvOptions anywhere;
  anywhere.need_position = false;
  EXPECT_EQ(read("dip,dip_direction\n60,30\n60,30\n", anywhere).notes.size(), 1U);
}

TEST(JointCsvTest, CellsWithoutASizeAreSaid) {
  const auto notes = [](const std::string& header, const std::string& rows) {
    return read("dip,dip_direction,x,y,z" + header + "\n" + rows).notes;
  };
  const auto blank = notes(",diameter", "60,30,1,2,3,\n60,30,1,2,4,2\n60,30,1,2,5,\n");
  ASSERT_EQ(blank.size(), 2U);
  EXPECT_EQ(blank[1], "2 of 3 joints have no size (the first in line 2): they go through the whole domain");
  EXPECT_EQ(notes(",side_a,side_b", "60,30,1,2,3,,\n").size(), 2U);
  EXPECT_EQ(notes(",radius", "60,30,1,2,3,4\n").size(), 1U);
  EXPECT_EQ(notes("", "60,30,1,2,3\n").size(), 1U);  // nobody speaks of sizes
}

TEST(JointCsvTest, UnitsInBracketsCount) {
  const JointTable t = read(
      "Dip (deg),Dip Dir [\xC2\xB0],X (cm),y [M],Z (metres),Radius (mm),friction (rad),Cohesion (kPa)\n"
      "60,30,100,2,3,500,0.5,50\n");
  EXPECT_EQ(t.rows[0].plane.dip.degrees(), 60);
  EXPECT_EQ(t.rows[0].plane.direction.degrees(), 30);
  EXPECT_EQ(t.rows[0].position, (geometry::Vec3{1, 2, 3}));
  EXPECT_EQ(std::get<DiscSize>(t.rows[0].size).radius, metres(0.5));
  EXPECT_NEAR(t.rows[0].friction->degrees(), 28.6478897565412, 1e-12);
  EXPECT_EQ(t.rows[0].cohesion, pascals(50e3));
  EXPECT_NE(t.notes[0].find("cohesion in kPa"), std::string::npos);
  const auto wrong = problems("dip,dd,x,y,z,cohesion (furlongs)\n60,30,0,0,0,1\n");
  ASSERT_EQ(wrong.size(), 1U);
  EXPECT_EQ(wrong[0].what, "the unit \"furlongs\" of column cohesion is not understood");
  const auto latin = problems("dip (\xB0),dd,x,y,z\n60,30,0,0,0\n");
  ASSERT_EQ(latin.size(), 1U);
  EXPECT_EQ(latin[0].what, "the unit \"\xEF\xBF\xBD\" of column dip is not UTF-8 text");
  EXPECT_EQ(latin[0].remedy, "save the table as UTF-8");
  EXPECT_TRUE(problems("dip,dd,x,y,z,\xB0\n60,30,0,0,0,1\n")[0].what.starts_with("column \"\xEF\xBF\xBD\" is not"));
}

TEST(JointCsvTest, AnglesThatMayBeRadiansOrGonAreSaid) {
  const auto notes = [](const std::string& text) {
    std::string all;
    for (const std::string& note : read(text).notes) all += note + '\n';
    return all;
  };
  const std::string rows = "0.78,4.9,0,0,0\n1.2,0.4,0,0,0\n1.5,6.2,0,0,0\n";
  EXPECT_TRUE(notes("dip,dd,x,y,z\n" + rows).contains("no dip is above 1.5 and no direction above 6.2")) << rows;
  EXPECT_TRUE(notes("plunge,trend,x,y,z\n" + rows).contains("\"plunge (rad)\""));
  // Stated; steeper than a quarter turn; a bed that lies flat in whole degrees.
  EXPECT_FALSE(notes("dip (deg),dd,x,y,z\n" + rows).contains("rad"));
  EXPECT_FALSE(notes("dip,dd,x,y,z\n" + rows + "1.6,0.4,0,0,0\n").contains("rad"));
  EXPECT_FALSE(notes("dip,dd,x,y,z\n" + rows + "1.2,6.5,0,0,0\n").contains("rad"));
  EXPECT_FALSE(notes("dip,dd,x,y,z\n0,0,0,0,0\n1,6,0,0,0\n").contains("rad"));
  const auto in_radians = read("dip (rad),dd (rad),x,y,z\n" + rows);
  EXPECT_NEAR(in_radians.rows[0].plane.dip.degrees(), 44.6907, 1e-4);

  const auto in_gon = read("dip (gon),dd (grad),x,y,z\n50,390,0,0,0\n");
  EXPECT_EQ(in_gon.rows[0].plane.dip.degrees(), 45);
  EXPECT_EQ(in_gon.rows[0].plane.direction.degrees(), 351);
  const auto beyond = problems("dip,dd,x,y,z\n50,390,0,0,0\n");
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_TRUE(beyond[0].remedy.contains("\"dip_direction (gon)\"")) << beyond[0].remedy;
}

TEST(JointCsvTest, UnitsBehindAnUnderscoreCount) {
  const JointTable t = read(
      "dip_deg,dip_dir,x_m,y_m,z_m,radius_mm,phi,cohesion_kPa,tension_MPa\n"
      "60,30,1,2,3,500,25,50,0.1\n");
  EXPECT_EQ(t.rows[0].plane.dip.degrees(), 60);
  EXPECT_EQ(t.rows[0].position, (geometry::Vec3{1, 2, 3}));
  EXPECT_EQ(std::get<DiscSize>(t.rows[0].size).radius, metres(0.5));
  EXPECT_EQ(t.rows[0].friction, FrictionAngle::degrees(25));
  EXPECT_EQ(t.rows[0].cohesion, pascals(50e3));
  EXPECT_EQ(t.rows[0].tension, pascals(0.1e6));
  EXPECT_TRUE(t.cohesion_unit && t.tension_unit && !t.friction_unit);
  ASSERT_EQ(t.notes.size(), 1U);
  EXPECT_NE(t.notes[0].find("cohesion (from \"cohesion_kpa\") in kPa"), std::string::npos);
}

TEST(JointCsvTest, WhatMayBeAStrengthIsSaid) {
  const JointTable t = read("dip,dd,x,y,z,radius,frictoin,c,remark\n60,30,0,0,0,4,25,50,dry\n");
  ASSERT_EQ(t.notes.size(), 4U);
  EXPECT_EQ(t.notes[1], "column \"frictoin\" is not used; where it is meant as friction, name it friction");
  EXPECT_EQ(t.notes[2], "column \"c\" is not used; where it is meant as cohesion, name it cohesion");
  EXPECT_EQ(t.notes[3], "column \"remark\" is not used");
  EXPECT_FALSE(t.rows[0].cohesion);
}

TEST(JointCsvTest, WhatMayBeAStrengthIsNoSize) {
  const JointTable t = read("dip,dd,x,y,z,c,frictoin,JRC\n60,30,0,0,0,50,25,8\n");
  EXPECT_TRUE(std::holds_alternative<Persistent>(t.rows.at(0).size));
  ASSERT_EQ(t.notes.size(), 4U);
  EXPECT_EQ(t.notes[1], "column \"c\" is not used; where it is meant as cohesion, name it cohesion");
  EXPECT_EQ(t.notes[3],
            "column \"jrc\" is not used; the law of Barton and Bandis is given by set: jrc and jcs of [joints.NAME]");
  // But for a slip of a size.
  EXPECT_EQ(problems("dip,dd,x,y,z,diametre\n60,30,0,0,0,10\n").size(), 1U);
}

TEST(JointCsvTest, DiametersAreNotRadii) {
  const JointTable t = read("dip,dd,x,y,z,Diameter (m)\n60,30,0,0,0,10\n60,30,0,0,0,\n");
  EXPECT_EQ(std::get<DiscSize>(t.rows[0].size).radius, metres(5));
  EXPECT_TRUE(std::holds_alternative<Persistent>(t.rows[1].size));
  EXPECT_EQ(problems("dip,dd,x,y,z,radius,diameter\n60,30,0,0,0,5,10\n").at(0).what,
            "a joint has a radius or a diameter, not both");
}

TEST(JointCsvTest, AColumnThatIsNotUnderstoodLeavesNoJointPersistent) {
  const auto wrong = problems("dip,dd,x,y,z,persistence\n60,30,0,0,0,10\n50,30,0,0,0,12\n");
  ASSERT_EQ(wrong.size(), 1U);
  EXPECT_EQ(wrong[0].what, "column \"persistence\" is not understood, and the joint of line 2 has no size without it");
  EXPECT_EQ(problems("dip;dd;x;y;z;size\n60;30;0;0;0;10,5\n").size(), 1U);
  EXPECT_EQ(read("dip,dd,x,y,z,persistence\n60,30,0,0,0,\n").rows.size(), 1U);
  EXPECT_EQ(read("dip,dd,x,y,z,radius,persistence\n60,30,0,0,0,4,10\n").rows.size(), 1U);
  EXPECT_EQ(read("dip,dd,x,y,z,jrc\n60,30,0,0,0,10\n").rows.size(), 1U);
}

TEST(JointCsvTest, SwappedColumnsAreSuggestedBeforeWrap) {
  EXPECT_EQ(
      problems("dip,dip_direction,x,y,z\n210,60,0,0,0\n").at(0).remedy,
      "are dip and dip_direction swapped? Then swap their names in the header; else correct it, or set wrap = true");
  EXPECT_EQ(problems("dip,dip_direction,x,y,z\n210,160,0,0,0\n").at(0).remedy, "correct it, or set wrap = true");
}

TEST(JointCsvTest, StrikeFollowsTheRightHandRule) {
  const JointTable t = read("strike;dip;x;y;z\n300;45;0;0;0\n0;10;0;0;0\n");
  EXPECT_EQ(t.rows[0].plane.direction.degrees(), 30);
  EXPECT_EQ(t.rows[1].plane.direction.degrees(), 90);
}

TEST(JointCsvTest, DecimalCommasWhenTheyAreUsedThroughout) {
  const JointTable t = read("dip;dd;x;y;z\n45,5;120,25;1000;-3,5;0\n");
  EXPECT_EQ(t.rows[0].plane.dip.degrees(), 45.5);
  EXPECT_EQ(t.rows[0].position->y, -3.5);
  EXPECT_EQ(problems("dip;dd;x;y;z\n45,5;120.25;0;0;0\n").at(0).fault, ReadFault::bad_number);
  EXPECT_EQ(problems("dip;dd;x;y;z\n45.5;120;0;0;0\n45,5;120;0;0;0\n").at(0).line, 3U);
  EXPECT_EQ(problems("dip;dd;x;y;z\n45;120;1,000,5;0;0\n").at(0).fault, ReadFault::bad_number);
  EXPECT_EQ(problems("dip,dd,x,y,z\n45,5,120,1,2,3\n").at(0).fault, ReadFault::syntax);
}

TEST(JointCsvTest, AnglesOutsideAreErrorsUnlessWrapped) {
  const std::string head = "dip,dip_direction,x,y,z\n";
  const auto e = problems(head + "45,364,0,0,0\n95,10,0,0,0\n-5,10,0,0,0\n45,-1,0,0,0\n");
  ASSERT_EQ(e.size(), 4U);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(e[i].fault, ReadFault::out_of_range);
    EXPECT_EQ(e[i].line, i + 2);
    EXPECT_NE(e[i].remedy.find("wrap = true"), std::string::npos);
  }
  EXPECT_EQ(e[0].column, 2U);
  EXPECT_EQ(e[1].column, 1U);
  const JointTable t =
      read(head + "45,364,0,0,0\n95,10,0,0,0\n-5,10,0,0,0\n45,-1,0,0,0\n442,0,0,0,0\n", {.wrap = true});
  const auto plane = [&](std::size_t i) {
    return std::pair{t.rows[i].plane.dip.degrees(), t.rows[i].plane.direction.degrees()};
  };
  EXPECT_EQ(plane(0), (std::pair{45.0, 4.0}));
  EXPECT_EQ(plane(1), (std::pair{85.0, 190.0}));
  EXPECT_EQ(plane(2), (std::pair{5.0, 190.0}));
  EXPECT_EQ(plane(3), (std::pair{45.0, 359.0}));
  EXPECT_EQ(plane(4), (std::pair{82.0, 0.0}));
}

// The wrapped plane is the same plane: both normals are parallel.
TEST(JointCsvTest, WrappingKeepsThePlane) {
  for (int dip = -400; dip <= 400; dip += 37) {
    for (int direction = -700; direction < 800; direction += 101) {
      const JointTable t =
          read("dip,dd,x,y,z\n" + std::to_string(dip) + "," + std::to_string(direction) + ",0,0,0\n", {.wrap = true});
      const geometry::Vec3 given = geometry::upward_normal({Dip::degrees(dip), DipDirection::degrees(direction)});
      EXPECT_NEAR(std::abs(dot(given, geometry::upward_normal(t.rows[0].plane))), 1, 1e-14);
      EXPECT_GE(t.rows[0].plane.dip.degrees(), 0);
      EXPECT_LE(t.rows[0].plane.dip.degrees(), 90);
    }
  }
}

TEST(JointCsvTest, HeadersAreRequiredAndJudged) {
  const auto columns = [](std::string_view header) {
    const auto e = problems(std::string{header} + "\n1,2,3,4,5,6,7,8\n");
    EXPECT_EQ(e.at(0).fault, ReadFault::bad_columns);
    EXPECT_EQ(e.at(0).line, 1U);
  };
  columns("45,120,0,0,0");
  columns("dip,x,y,z");
  columns("dip_direction,x,y,z");
  columns("dip,dip_direction,strike,x,y,z");
  columns("dip,dip_direction,dd,x,y,z");
  columns("dip,dip_direction,x,y");
  columns("dip,dip_direction,x,y,z,side_a");
  columns("dip,dip_direction,x,y,z,rotation");
  columns("dip,dip_direction;x,y,z");
  const auto tabs = problems("dip\tdd\tx\ty\tz\n45\t120\t0\t0\t0\n");
  ASSERT_EQ(tabs.size(), 1U);
  EXPECT_EQ(tabs[0].fault, ReadFault::bad_columns);
  EXPECT_NE(tabs[0].what.find("has tabs between its columns"), std::string::npos);
  EXPECT_EQ(problems("").at(0).fault, ReadFault::empty);
  EXPECT_EQ(problems("# nothing\n\n").at(0).fault, ReadFault::empty);
  EXPECT_EQ(problems("dip,dd,x,y,z\n").at(0).fault, ReadFault::empty);
  EXPECT_EQ(problems("\xFF\xFE"
                     "d\0i\0p\0")
                .at(0)
                .fault,
            ReadFault::unknown_format);
}

TEST(JointCsvTest, RowsAreJudgedAndAllTold) {
  const auto fault = [](std::string_view row) {
    const auto e = problems("dip,dd,x,y,z,radius,side_a,side_b,friction,cohesion\n" + std::string{row} + "\n");
    EXPECT_EQ(e.at(0).line, 2U);
    return e.at(0).fault;
  };
  EXPECT_EQ(fault("45,120,0,0,0,-1,,,,"), ReadFault::out_of_range);
  EXPECT_EQ(fault("45,120,0,0,0,0,,,,"), ReadFault::out_of_range);
  EXPECT_EQ(fault("45,120,0,0,0,1,2,2,,"), ReadFault::syntax);
  EXPECT_EQ(fault("45,120,0,0,0,,2,,,"), ReadFault::syntax);
  EXPECT_EQ(fault("45,120,0,0,0,,,,-5,"), ReadFault::out_of_range);
  EXPECT_EQ(fault("45,120,0,0,0,,,,90,"), ReadFault::out_of_range);
  EXPECT_EQ(fault("45,120,0,0,0,,,,,-1"), ReadFault::out_of_range);
  EXPECT_EQ(fault("45,120,0,0,nan,,,,,"), ReadFault::bad_number);
  EXPECT_EQ(fault("45,120,0,0,1e999,,,,,"), ReadFault::bad_number);
  EXPECT_EQ(fault("45,120,0,,0,,,,,"), ReadFault::syntax);
  EXPECT_EQ(fault("45,120,0,0,0"), ReadFault::syntax);
  EXPECT_EQ(fault("\"45,120"), ReadFault::truncated);
  EXPECT_EQ(fault("\"45\"5,120,0,0,0,,,,,"), ReadFault::syntax);
  std::string many = "dip,dd,x,y,z\n";
  for (int i = 0; i < 100; ++i) many += "x,0,0,0,0\n";
  EXPECT_EQ(problems(many).size(), 20U);
  std::string wide = "dip";
  for (int i = 0; i < 100; ++i) wide += ",dip";
  EXPECT_EQ(problems(wide + "\n").size(), 20U);
}

TEST(JointCsvTest, MeasuredOrientationsWithoutPositions) {
  const std::string list = testing::bytes_of("orientations/kinematic_data1.txt");
  EXPECT_EQ(problems(list).at(0).fault, ReadFault::bad_columns);  // no header
  const std::string named = "dip,dip direction\n" + list;
  const auto e = problems(named, {.wrap = false, .need_position = false});
  EXPECT_EQ(e.at(0).fault, ReadFault::out_of_range);  // 364 occurs
  const JointTable t = read(named, {.wrap = true, .need_position = false});
  EXPECT_EQ(t.rows.size(), 200U);
  EXPECT_FALSE(t.rows[0].position.has_value());
}

TEST(JointCsvTest, TablesReadBackTheSame) {
  JointTable t = read(
      "dip,dd,x,y,z,radius,side_a,side_b,rotation,friction,cohesion,set,id\n"
      "60.1,30,1,2,3,5,,,,25,,A,\n8,0.30000000000000004,1,2,3,,4,2,10,,1e5,\"B,\"\"x\"\"\",9\n8,9,1e-300,2,3,,,,,,,,"
      "\n");
  JointTable back = read(write_joint_csv(t));
  for (JointTable* table : {&t, &back}) {
    for (JointRow& row : table->rows) row.line = 0;
  }
  EXPECT_EQ(t.rows, back.rows);
}

}  // namespace
}  // namespace cleave::io::joint_csv_test
