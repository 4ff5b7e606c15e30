#include "cleave/io/joint_csv.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace cleave::io::trace_map_test {
namespace {

TraceMap map_of(std::string_view text, std::string_view name) {
  auto map = parse_trace_map(text, name);
  EXPECT_TRUE(map.has_value()) << describe(map.error());
  return map ? *std::move(map) : TraceMap{};
}
std::string refused(std::string_view text, std::string_view name) {
  const auto map = parse_trace_map(text, name);
  EXPECT_FALSE(map.has_value()) << text;
  return map ? std::string{} : describe(map.error());
}

TEST(TraceMapTest, EachFormatGivesTheSameTraces) {
  const TraceMap segments = map_of("x1,y1,x2,y2\n0,0,1,2\n3,3,4,5\n", "a.csv");
  const TraceMap points = map_of("trace,x,y\nA,0,0\nA,1,2\nB,3,3\nB,4,5\n", "a.csv");
  const TraceMap fracpaq = map_of("0\t0\t1\t2\n3\t3\t4\t5\n", "a.txt");
  const TraceMap geojson = map_of(
      R"({"type":"FeatureCollection","crs":{},"features":[{"type":"Feature","geometry":
      {"type":"MultiLineString","coordinates":[[[0,0],[1,2]],[[3,3],[4,5]]]}}]})",
      "a.geojson");
  ASSERT_EQ(segments.lines.size(), 2U);
  EXPECT_EQ(points.lines, segments.lines);
  EXPECT_EQ(fracpaq.lines, segments.lines);
  EXPECT_EQ(geojson.lines, segments.lines);
  EXPECT_TRUE(segments.unit_known);
  EXPECT_FALSE(fracpaq.unit_known);  // pixels
}

// Found by fuzzing: such a trace has neither length nor direction, and was counted.
TEST(TraceMapTest, TracesOfOnePointAreRefusedByTheirLine) {
  EXPECT_NE(refused("trace,x,y\nA,0,0\nA,1,2\nB,3,3\nC,4,5\nC,5,5\n", "a.csv").find("a.csv:4"), std::string::npos);
  EXPECT_NE(refused("trace,x,y\nA,0,0\nA,1,2\nB,3,3\n", "a.csv").find("a.csv:4"), std::string::npos);
  EXPECT_NE(refused("1\t2\n", "a.txt").find("a.txt:1"), std::string::npos);
  refused(R"({"type":"LineString","crs":{},"coordinates":[[0,0]]})", "a.geojson");
  refused(R"({"type":"Polygon","crs":{},"coordinates":[[[0,0],[1000,0],[0,0]]]})", "a.geojson");
}

// A trace "1,5,2,5,3,5,4,5" was one from (1, 5) to (2, 5).
TEST(TraceMapTest, CoordinatesWithDecimalCommas) {
  const std::string_view header = "x1,y1,x2,y2\n";
  EXPECT_TRUE(refused(std::string{header} + "1,5,2,5,3,5,4,5\n", "a.csv")
                  .contains("a.csv:2: 8 cells, the header has 4; give every column; with decimal commas separate"))
      << refused(std::string{header} + "1,5,2,5,3,5,4,5\n", "a.csv");
  EXPECT_TRUE(refused(std::string{header} + "1,2,3\n", "a.csv").contains("3 cells, the header has 4"));
  EXPECT_TRUE(refused(std::string{header} + "1,\"2,5\",3,4\n", "a.csv").contains("a.csv:2: y1: \"2,5\" is not"))
      << refused(std::string{header} + "1,\"2,5\",3,4\n", "a.csv");
  const TraceMap map = map_of("x1;y1;x2;y2\n1,5;2;3,5;\"4,25\"\n", "a.csv");
  ASSERT_EQ(map.lines.size(), 1U);
  EXPECT_EQ(map.lines[0], (std::vector<std::array<double, 2>>{{1.5, 2}, {3.5, 4.25}}));
  EXPECT_TRUE(refused("trace;x;y\nA;1,5;2\nA;1.5;3\n", "a.csv").contains("some numbers have a decimal comma"));
  EXPECT_TRUE(refused("trace;x;y\nA;1.234,5;2\nA;1;3\n", "a.csv").contains("nothing between thousands"));
  EXPECT_TRUE(refused("1,5\t2,5\t3,5\t4,5\n", "a.txt").contains("a.txt:1: holds both commas and blanks"));
  EXPECT_TRUE(refused("1,5 2,5 3,5 4,5\n", "a.txt").contains("write decimal points"));
  EXPECT_EQ(map_of("1.5, 2.5, 3.5, 4.5\r\n", "a.txt").lines, map_of("1.5\t2.5\t3.5\t4.5\n", "a.txt").lines);
  EXPECT_EQ(map_of("1.5,2.5,3.5,4.5\n", "a.txt").lines.size(), 1U);
}

// Ten metres in degrees are 1e-4: a P32 of thousands came of maps whose crs says that they are in degrees.
TEST(TraceMapTest, MapsInDegreesAreRefused) {
  const auto map = [](const std::string& crs, const std::string& start) {
    return R"({"type":"LineString",)" + crs + R"("coordinates":[)" + start + ",[11.50001,48.00003]]}";
  };
  const auto named = [](const std::string& name) {
    return R"("crs":{"type":"name","properties":{"name":")" + name + "\"}},";
  };
  EXPECT_TRUE(refused(map("", "[11.5,48]"), "a.geojson").contains("seems to be in degrees"));
  for (const std::string name :
       {"urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4326", "EPSG:4258",
        "urn:ogc:def:crs:EPSG::4937", "http://www.opengis.net/def/crs/EPSG/0/4269", "WGS 84", "EPSG:7844"}) {
    const std::string why = refused(map(named(name), "[11.5,48]"), "a.geojson");
    EXPECT_TRUE(why.contains("is in degrees: its crs is") && why.contains("project it to metres")) << name << why;
  }
  EXPECT_TRUE(refused(map(R"("crs":{"type":"EPSG","properties":{"code":4326}},)", "[11.5,48]"), "a.json")
                  .contains("\"EPSG:4326\""));
  // Local coordinates of a projected system, and one of the few projected ones with a number of 4000 and more.
  for (const std::string name : {"EPSG:25832", "urn:ogc:def:crs:EPSG::3067", "WGS 84 / UTM zone 32N", ""}) {
    EXPECT_EQ(map_of(map(named(name), "[11.5,48]"), "a.geojson").lines.size(), 1U) << name;
  }
  EXPECT_EQ(map_of(map(named("EPSG:4547"), "[500000,48]"), "a.geojson").lines.size(), 1U);
}

// Columns dip, dip_direction and set of a map were left out without a word.
TEST(TraceMapTest, ColumnsThatAreNotReadAreSaid) {
  EXPECT_TRUE(map_of("x1,y1,x2,y2,\n0,0,1,2,\n", "a.csv").notes.empty());
  const TraceMap map = map_of("Trace,x,y,Dip,Dip Direction,Set\nA,0,0,60,40,J1\nA,1,2,60,40,J1\n", "a.csv");
  ASSERT_EQ(map.notes.size(), 1U);
  EXPECT_TRUE(map.notes[0].starts_with("columns not read: \"dip\", \"dip_direction\", \"set\"; traces have no "))
      << map.notes[0];
  EXPECT_TRUE(refused("trace,x,y,x\nA,0,0,1\n", "a.csv").contains("column \"x\" comes twice"));
}

}  // namespace
}  // namespace cleave::io::trace_map_test
