#include <gtest/gtest.h>

#include <string>

#include "cleave/io/joint_csv.hpp"

// Tables of traces on faces and of picks in holes.

namespace cleave::io {
namespace {

std::string trace_error(std::string_view bytes) {
  const auto table = parse_trace_csv(bytes, "t.csv");
  return table ? "taken" : describe(table.error().front());
}
std::string pick_error(std::string_view bytes) {
  const auto table = parse_pick_csv(bytes, "p.csv");
  return table ? "taken" : describe(table.error().front());
}

TEST(MappedCsv, TracesAreRead) {
  const auto table = parse_trace_csv(
      "Joint-ID;Set;Face;X1 (mm);y1;z1;easting2;y2;z2;End1;weather\n7;A;F 1;1500;2,5;3;4;5;6;goes "
      "on;wet\n;;;0;0;0;1;1;1;;\n",
      "t.csv");
  ASSERT_TRUE(table.has_value()) << describe(table.error().front());
  ASSERT_EQ(table->rows.size(), 2U);
  const TraceRow& row = table->rows.front();
  EXPECT_EQ(row.line, 2U);
  EXPECT_EQ(row.face, "F 1");
  EXPECT_EQ(row.set, "A");
  EXPECT_EQ(row.joint, "7");
  EXPECT_EQ(row.ends[0], (geometry::Vec3{1.5, 2.5, 3}));
  EXPECT_EQ(row.ends[1], (geometry::Vec3{4, 5, 6}));
  EXPECT_EQ(row.goes_on[0], true);
  EXPECT_EQ(row.goes_on[1], std::nullopt);
  EXPECT_TRUE(table->rows[1].joint.empty());
  ASSERT_EQ(table->notes.size(), 2U);
  EXPECT_TRUE(table->notes[0].contains("x1 in mm")) << table->notes[0];
  EXPECT_TRUE(table->notes[0].contains("joint (from \"joint_id\")")) << table->notes[0];
  EXPECT_TRUE(table->notes[1].contains("\"weather\" is not used")) << table->notes[1];
  EXPECT_TRUE(parse_trace_csv("x1,y1,z1,x2,y2,z2\n", "t.csv")->rows.empty()) << "nothing was seen";
}

TEST(MappedCsv, PicksAreRead) {
  const auto table = parse_pick_csv("hole,depth,x,y,z,dip,strike,set,id\nH,3,,,,40,350,A,j\nH,,1,2,3,,,,\n", "p.csv");
  ASSERT_TRUE(table.has_value()) << describe(table.error().front());
  EXPECT_DOUBLE_EQ(table->rows[0].depth->si(), 3);
  EXPECT_FALSE(table->rows[0].position.has_value());
  EXPECT_DOUBLE_EQ(table->rows[0].plane->dip.degrees(), 40);
  EXPECT_DOUBLE_EQ(table->rows[0].plane->direction.degrees(), 80);
  EXPECT_EQ(table->rows[0].joint, "j");
  EXPECT_FALSE(table->rows[1].depth.has_value());
  EXPECT_EQ(table->rows[1].position, (geometry::Vec3{1, 2, 3}));
  EXPECT_FALSE(table->rows[1].plane.has_value());
}

TEST(MappedCsv, TracesMayHaveTheirPlanes) {
  const auto table = parse_trace_csv("x1,y1,z1,x2,y2,z2,dip,dip_dir\n1,2,3,4,5,6,40,350\n1,2,3,4,5,7,,\n", "t.csv");
  ASSERT_TRUE(table.has_value()) << describe(table.error().front());
  EXPECT_DOUBLE_EQ(table->rows[0].plane->dip.degrees(), 40);
  EXPECT_DOUBLE_EQ(table->rows[0].plane->direction.degrees(), 350);
  EXPECT_FALSE(table->rows[1].plane.has_value());
  EXPECT_TRUE(trace_error("x1,y1,z1,x2,y2,z2,dip\n1,2,3,4,5,6,40\n").contains("no column dip_direction or strike"));
  EXPECT_TRUE(trace_error("x1,y1,z1,x2,y2,z2,dip,strike\n1,2,3,4,5,6,95,10\n").contains("outside 0..90"));
}

TEST(MappedCsv, WhatIsWrongIsSaid) {
  EXPECT_TRUE(
      trace_error("x1,y1,x2,y2\n1,2,3,4\n").contains("t.csv:1: columns of the ends of traces are missing: z1, z2"));
  EXPECT_TRUE(trace_error("1,2,3,4,5,6\n").contains("add a header"));
  const std::string head = "x1,y1,z1,x2,y2,z2,end1\n";
  EXPECT_TRUE(trace_error(head + "1,2,3,4,5,,ends\n").contains("z2 is empty"));
  EXPECT_TRUE(trace_error(head + "1,2,3,4,5,6,maybe\n").contains("write ends (the joint ends there) or goes_on"));
  EXPECT_TRUE(trace_error(head + "1,2,3,4,5\n").contains("t.csv:2: 5 cells"));
  EXPECT_TRUE(pick_error("hole,x,y\nH,1,2\n").contains("add depth"));
  EXPECT_TRUE(pick_error("hole,depth,dip\nH,1,2\n").contains("no column dip_direction or strike"));
  EXPECT_TRUE(pick_error("hole,depth,x,y,z\nH,1,2,3,4\n").contains("gives a depth and x, y, z"));
  EXPECT_TRUE(pick_error("hole,depth\nH,\n").contains("does not say where the pick is"));
  EXPECT_TRUE(pick_error("hole,depth,dip,dd\nH,1,95,10\n").contains("dip is 95, outside 0..90"));
  EXPECT_TRUE(pick_error("hole,depth,dip,dd\nH,1,45,400\n").contains("dip_direction is 400, outside 0..360"));
  EXPECT_EQ(parse_pick_csv("hole,dpeth\n", "p.csv").error().size(), 1U);
}

}  // namespace
}  // namespace cleave::io
