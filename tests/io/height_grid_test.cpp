#include "cleave/io/height_grid.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io_testing.hpp"

namespace cleave::io::height_grid_test {
namespace {

std::string fmt_line(double x, double y, double z) { return fmt::format("{:.2f} {:.2f} {}\n", x, y, z); }

HeightGrid read(std::string_view text, const HeightGridOptions& options = {}) {
  auto grid = parse_height_grid(text, "a.asc", options);
  EXPECT_TRUE(grid.has_value()) << text << "\n" << (grid ? "" : describe(grid.error()));
  return grid ? *grid : HeightGrid{};
}

void expect_refused(std::string_view text, ReadFault fault, std::optional<std::uint32_t> line,
                    const HeightGridOptions& options = {}) {
  const auto grid = parse_height_grid(text, "a.asc", options);
  ASSERT_FALSE(grid.has_value()) << text;
  EXPECT_EQ(grid.error().fault, fault) << describe(grid.error());
  EXPECT_EQ(grid.error().line, line) << describe(grid.error());
  EXPECT_EQ(grid.error().file, "a.asc");
  EXPECT_FALSE(grid.error().what.empty());
  EXPECT_FALSE(grid.error().remedy.empty());
}

TEST(HeightGridTest, FirstRowIsTheNorthAndCornersAreHalfACellOut) {
  const HeightGrid grid = read(
      "\xEF\xBB\xBFnCols 3\r\nNROWS 2\r\nxllcorner 100\r\nyllcenter 200\r\ncellsize 10\r\n"
      "1 2 3 4\r\n-9999\t\r\n\r\n6.5e0");
  ASSERT_EQ(grid.columns, 3U);
  ASSERT_EQ(grid.rows, 2U);
  EXPECT_EQ(grid.x_of(0), 105);
  EXPECT_EQ(grid.x_of(2), 125);
  EXPECT_EQ(grid.y_of(0), 210);
  EXPECT_EQ(grid.y_of(1), 200);
  EXPECT_EQ(grid.height(0, 0), 1);
  EXPECT_EQ(grid.height(2, 0), 3);
  EXPECT_EQ(grid.height(0, 1), 4);
  EXPECT_EQ(grid.height(1, 1), std::nullopt);
  EXPECT_EQ(grid.height(2, 1), 6.5);
  EXPECT_EQ(grid.known(), 5U);
}

TEST(HeightGridTest, WhatStandsForNoHeight) {
  const std::string head = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  EXPECT_EQ(read(head + "nodata_value 0\n0 5").height(0, 0), std::nullopt);
  EXPECT_EQ(read(head + "-9999 0").known(), 1U);  // not stated
  EXPECT_EQ(read(head + "NODATA_value -1\n-9999 -1").height(0, 0), -9999);
  EXPECT_EQ(read(head + "NODATA_value nan\nNaN 7").known(), 1U);
  // the most negative float32, with fewer digits in one place than in the other
  EXPECT_EQ(read(head + "NODATA_value -3.40282346639e+38\n-3.402823466385289e+38 7").known(), 1U);
  EXPECT_EQ(read(head + "1e20 7", {.no_data = 1e20}).known(), 1U);
  EXPECT_EQ(read("0 0 -99\n1 0 5\n", {.no_data = -99}).known(), 1U);
}

TEST(HeightGridTest, CellsNeedNotBeSquare) {
  const HeightGrid grid = read("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ndx 2\ndy 4\n1 2 3 4\n");
  EXPECT_EQ(grid.x_of(1), 3);
  EXPECT_EQ(grid.y_of(0), 6);
}

TEST(HeightGridTest, FaultsOfEsriGridsNameTheLine) {
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  expect_refused(head + "1 2\n3\n", ReadFault::truncated, 7);
  expect_refused(head + "1 2\n3 4\n5", ReadFault::syntax, 8);
  expect_refused(head + "1 2\n3 nan\n", ReadFault::bad_number, 7);
  expect_refused(head + "1 2\n3 1e400\n", ReadFault::bad_number, 7);
  expect_refused(head + "1 2\n1e300 3\n", ReadFault::out_of_range, 7);
  expect_refused(head + "1 2\n3 4,5\n", ReadFault::bad_number, 7);
  expect_refused(head, ReadFault::truncated, 1);
  expect_refused(head + "-9999 -9999 -9999 -9999", ReadFault::empty, {});
  expect_refused("ncols 2\nnrows", ReadFault::truncated, 2);
  expect_refused("ncols 2\nncols 2\n", ReadFault::syntax, 2);
  expect_refused("ncols 0\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1", ReadFault::out_of_range, 1);
  expect_refused("ncols 1.5\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1", ReadFault::out_of_range, 1);
  expect_refused("ncols -1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1", ReadFault::out_of_range, 1);
  expect_refused("ncols 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1", ReadFault::syntax, 1);
  expect_refused("ncols 1\nnrows 1\nyllcorner 0\ncellsize 1\n1", ReadFault::syntax, 1);
  expect_refused("ncols 1\nnrows 1\nxllcorner 0\nxllcenter 0\nyllcorner 0\ncellsize 1\n1", ReadFault::syntax, 4);
  expect_refused("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\n1", ReadFault::syntax, 1);
  expect_refused("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0\n1", ReadFault::out_of_range, 5);
  expect_refused("ncols 1\nnrows 1\nxllcorner 1e300\nyllcorner 0\ncellsize 1\n1", ReadFault::out_of_range, 3);
  expect_refused("ncols 9\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 9e8\n1", ReadFault::out_of_range, 1);
  expect_refused("ncols abc\n", ReadFault::bad_number, 1);
  // what the header promises takes no memory before it is there
  expect_refused("ncols 1000000000\nnrows 1000000000\nxllcorner 0\nyllcorner 0\ncellsize 1e-6\n1 2 3",
                 ReadFault::truncated, 1);
}

TEST(HeightGridTest, PointsInAnyOrderMakeTheSameGrid) {
  std::vector<std::string> lines;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 5; ++column) {
      if (row == 2 && column == 3) continue;  // a hole
      lines.push_back(fmt_line(500000 + column / 3.0, 5400000 - 0.5 * row, 10 * row + column));
    }
  }
  const auto check = [&] {
    std::string text = "X Y Z\n";
    for (const std::string& line : lines) text += line;
    const HeightGrid grid = read(text);
    ASSERT_EQ(grid.columns, 5U);
    ASSERT_EQ(grid.rows, 4U);
    EXPECT_NEAR(grid.step_x, 1 / 3.0, 1e-3);  // written with two decimals
    EXPECT_EQ(grid.step_y, 0.5);
    EXPECT_EQ(grid.y_of(0), 5400000);
    EXPECT_EQ(grid.known(), 19U);
    EXPECT_EQ(grid.height(3, 2), std::nullopt);
    EXPECT_EQ(grid.height(4, 3), 34);
    EXPECT_EQ(grid.height(0, 0), 0);
  };
  check();
  std::ranges::reverse(lines);
  check();
  std::ranges::rotate(lines, lines.begin() + 7);
  check();
}

TEST(HeightGridTest, SeparatorsAndComments) {
  for (const std::string_view text :
       {"# made by hand\nx,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4,\n", "0;0;1\r\n1;0;2\r\n\r\n0;1;3\r\n1;1;4",
        "0 0 1\n1\t0\t2 # here\n0 , 1 , 3\n1 1 4"}) {
    const HeightGrid grid = read(text);
    EXPECT_EQ(grid.columns, 2U) << text;
    EXPECT_EQ(grid.heights, (std::vector<double>{3, 4, 1, 2})) << text;
  }
  const HeightGrid twice = read("0 0 1\n1 0 2\n0 0 1\n");
  EXPECT_EQ(twice.notes.size(), 1U);
  EXPECT_EQ(twice.rows, 1U);
}

/// What is wrong with a text, and what to do.
std::string refusal(std::string_view text) {
  const auto grid = parse_height_grid(text, "a.xyz");
  return grid ? "" : describe(grid.error());
}

TEST(HeightGridTest, DecimalCommasOfPointsAreReadWithSemicolonsAndRefusedElsewhere) {
  const HeightGrid grid = read("0;0;0,9\n10,5;0;-0,9\n0;7;10,25\n10,5;7;1e1\n");
  EXPECT_EQ(grid.heights, (std::vector<double>{10.25, 10, 0.9, -0.9}));
  EXPECT_EQ(grid.step_x, 10.5);
  EXPECT_EQ(read("X;Y;Z\n0;0;\"0,9\"\n").heights, (std::vector<double>{0.9}));
  // With other signs between them they cannot be told from further numbers; each is refused, with its line.
  expect_refused("0 0 1\n0 10 10,9\n", ReadFault::syntax, 2);
  expect_refused("0\t0\t1\n0\t10\t10,9\n", ReadFault::syntax, 2);
  expect_refused("0 0 1\n0,5 10,5 10\n", ReadFault::bad_number, 2);
  expect_refused("0,0,1\n0,10,10,9\n", ReadFault::syntax, 2);
  EXPECT_TRUE(refusal("0\t10\t10,9\n").contains("with decimal commas part them by semicolons"));
  expect_refused("0;0;0,9\n1;0;1.9\n", ReadFault::bad_number, 2);
  expect_refused("x;y;z\n0;0;1 020\n", ReadFault::bad_number, 2);
  EXPECT_TRUE(refusal("x;y;z\n0;0;1 020\n").contains("write nothing between thousands"));
  expect_refused("x;y;z\n0;0;1.020,5\n", ReadFault::bad_number, 2);
}

TEST(HeightGridTest, LinesHaveAsManyNumbersAsColumns) {
  expect_refused("0 0 1 255\n1 0 2 255\n", ReadFault::syntax, 1);
  expect_refused("x,y,z\n0,0,1\n1,1,4,17\n", ReadFault::syntax, 3);
  expect_refused("x,y,z,red\n0,0,1\n", ReadFault::syntax, 2);
  EXPECT_EQ(
      refusal("0 0 1 255\n"),
      "a.xyz:1: 4 cells, a table without a header has 3; give x, y and z alone, or a first line with the names of "
      "all columns; with decimal commas part them by semicolons");
}

TEST(HeightGridTest, HeadersOfPointsAreReadByNameAndUnit) {
  const HeightGrid turned = read("northing,easting,z\n0,0,1\n0,10,2\n0,20,3\n5,0,4\n5,10,5\n5,20,6\n");
  EXPECT_EQ(turned.columns, 3U);
  EXPECT_EQ(turned.step_x, 10);
  EXPECT_EQ(turned.heights, (std::vector<double>{4, 5, 6, 1, 2, 3}));
  ASSERT_EQ(turned.notes.size(), 1U);
  EXPECT_EQ(turned.notes[0], "columns read: y (from \"northing\") in m, x (from \"easting\") in m, z in m");
  for (const std::string_view z : {"x,y,z_ft", "x,y,z (ft)", "x;y;z[ft]", "X Y Z (ft)", "x\ty\tElevation [feet]"}) {
    const HeightGrid feet = read(std::string{z} + "\n0;0;100\n10;0;200\n");
    EXPECT_NEAR(feet.height(1, 0).value_or(0), 60.96, 1e-12) << z;
    EXPECT_EQ(feet.step_x, 10) << z;
    ASSERT_EQ(feet.notes.size(), 1U) << z;
    EXPECT_TRUE(feet.notes[0].ends_with("in ft")) << feet.notes[0];
  }
  const HeightGrid colours = read("//X Y Z R G B # of a scan\n0 0 1 255 0 0\n1 0 2 255 0 0\n");
  EXPECT_EQ(colours.heights, (std::vector<double>{1, 2}));
  ASSERT_EQ(colours.notes.size(), 2U);
  EXPECT_EQ(colours.notes[1], "columns not used: \"R\", \"G\", \"B\"");
  EXPECT_EQ(read("Point id\tz\ty\tx\nP 1\t3\t0\t0\n").heights, (std::vector<double>{3}));
}

TEST(HeightGridTest, HeadersOfPointsThatDoNotSayWhereAreRefused) {
  expect_refused("x,y,depth\n0,0,0\n", ReadFault::bad_columns, 1);
  EXPECT_EQ(
      refusal("x,y,depth\n0,0,0\n"),
      "a.xyz:1: there is no column z; not understood: \"depth\"; give heights above a level, which grow upwards, in "
      "a column z (or elevation, height)");
  expect_refused("# made\nlon,lat,z\n0,0,0\n", ReadFault::bad_columns, 2);
  expect_refused("x,y,z,elevation\n0,0,0,0\n", ReadFault::bad_columns, 1);
  expect_refused("x,y,z (furlong)\n0,0,0\n", ReadFault::bad_columns, 1);
  expect_refused("x,y\n0,0\n", ReadFault::bad_columns, 1);
  expect_refused("\"x\n\",y,z\n0,0,0\n", ReadFault::syntax, 2);
  expect_refused("\"1\n\" 0 0\n0 0 0\n", ReadFault::bad_number, 1);
}

TEST(HeightGridTest, FaultsOfPointsNameTheLine) {
  expect_refused("", ReadFault::empty, {});
  expect_refused("x y z\n", ReadFault::empty, {});
  expect_refused("0 0 1\n1 0\n", ReadFault::syntax, 2);
  expect_refused("0 0 1\n1 0 nan\n", ReadFault::bad_number, 2);
  expect_refused("0 0 1\n1 0 1e300\n", ReadFault::out_of_range, 2);
  expect_refused("0 0 1\n1 0 1e999\n", ReadFault::bad_number, 2);
  expect_refused("0 0 1\nx y z\n", ReadFault::bad_number, 2);
  expect_refused("0 0 1\n1 0 2\n0 0 3\n", ReadFault::out_of_range, 3);
  expect_refused("0 0 1\n1 0 2\n2 0 2\n2.4 0 2\n4 0 1\n5 0 1\n6 0 1\n", ReadFault::out_of_range, 4);
  expect_refused("nan 0 1\n", ReadFault::bad_number, 1);
  expect_refused(std::string_view{"\x7f\x45\x4c\x46\0\1\2", 7}, ReadFault::syntax, 1);
  // points anywhere: each has a column of its own
  std::string scattered;
  for (int i = 0; i < 200; ++i) scattered += fmt_line(i, (i * 37) % 200, 0);
  expect_refused(scattered, ReadFault::out_of_range, {});
  expect_refused("0 0 1\n1 1 1\n2 2 1\n1e8 1e8 0\n", ReadFault::out_of_range, {});
}

TEST(HeightGridTest, RealGroundIsRead) {
  const HeightGrid gully = read_height_grid(testing::data_file("terrain_gully/west_bijou_gully.asc")).value();
  EXPECT_EQ(gully.columns, 43U);
  EXPECT_EQ(gully.rows, 89U);
  EXPECT_EQ(gully.known(), 1088U);  // NODATA is 0 here: no cliff of 1,680 m
  EXPECT_EQ(gully.x_of(0), 559706.5);
  double low = 1e9;
  double high = -1e9;
  for (const double z : gully.heights) {
    if (std::isnan(z)) continue;
    low = std::min(low, z);
    high = std::max(high, z);
  }
  EXPECT_NEAR(low, 1680.7793918, 1e-7);
  EXPECT_NEAR(high, 1725.4326308, 1e-7);

  const HeightGrid bank = read_height_grid(testing::data_file("terrain_gully/DEM-kootenai_37x50_1x1.asc")).value();
  EXPECT_EQ(bank.columns, 50U);
  EXPECT_EQ(bank.rows, 37U);
  EXPECT_EQ(bank.known(), 1850U);

  // the same ground as points
  std::string text;
  for (std::uint32_t row = 0; row < gully.rows; ++row) {
    for (std::uint32_t column = 0; column < gully.columns; ++column) {
      const auto z = gully.height(column, row);
      if (z) text += fmt_line(gully.x_of(column), gully.y_of(row), *z);
    }
  }
  const HeightGrid points = read(text);
  EXPECT_EQ(points.known(), 1088U);
  EXPECT_EQ(points.step_x, 3);
  EXPECT_EQ(points.step_y, 3);
}

}  // namespace
}  // namespace cleave::io::height_grid_test
