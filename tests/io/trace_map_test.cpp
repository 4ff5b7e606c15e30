#include "cleave/io/trace_map.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

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

}  // namespace
}  // namespace cleave::io::trace_map_test
