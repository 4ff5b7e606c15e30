#include "cleave/exchange/exports.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "convex_parts.hpp"
#include "hand_made.hpp"

namespace cleave::report {
namespace {

using namespace testing;

std::size_t count(const std::string& text, std::string_view what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

void expect_convex_parts(const topology::BlockComplex& complex, std::size_t fewest, std::size_t most) {
  const Cells cells = make_cells(complex);
  double sum = 0;
  std::size_t parts = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const auto cut = detail::convex_parts(cells, cell);
    ASSERT_TRUE(cut.has_value());
    parts += cut->size();
    for (const detail::ConvexPart& part : *cut) {
      const double volume = part.volume();
      EXPECT_GT(volume, 0);
      sum += volume;
      for (const auto& face : part.faces) {
        const Vec3 a = part.points[face[0]];
        const Vec3 normal = cross(part.points[face[1]] - a, part.points[face[2]] - a);
        for (const Vec3& p : part.points) EXPECT_LT(dot(p - a, normal), 1e-9);
      }
    }
  }
  EXPECT_GE(parts, fewest);
  EXPECT_LE(parts, most);
  EXPECT_NEAR(sum, complex.rock_volume().si(), 1e-10 * sum);
}

TEST(ConvexParts, ConvexBlocksStayWhole) { expect_convex_parts(grid(3, {100, 200, 300}), 27, 27); }

TEST(ConvexParts, BlocksWithHolesAreCut) {
  expect_convex_parts(box_with_shafts({{1, 1, 2, 2}}, 0, {16, 24, 10, 12, 1, 1}), 4, 8);
  expect_convex_parts(box_with_shafts({{1, 1, 2, 2}}, 1, {16, 24, 11, 12, 1, 0}), 5, 12);
  // shafts that touch along an edge
  expect_convex_parts(box_with_shafts({{1, 1, 2, 2}, {2, 2, 3, 3}}, 0, {24, 36, 14, 16, 1, 1}), 5, 20);
}

TEST(ConvexParts, TooManyPartsAreRefused) {
  const Cells cells = make_cells(box_with_shafts({{1, 1, 2, 2}}, 0, {16, 24, 10, 12, 1, 1}));
  EXPECT_FALSE(detail::convex_parts(cells, 0, 2).has_value());
}

TEST(Exports, ShortEdgesAreToldFor3dec) {
  const auto thin = box_with_shafts({{1, 1, 1.00001, 2}}, 0, {16, 24, 10, 12, 1, 1});
  const Exported result = export_blocks(make_cells(thin), ExportFormat::threedec, "t");
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_NE(result.notes[0].find("shorter than 1e-4"), std::string::npos) << result.notes[0];
  EXPECT_TRUE(export_blocks(make_cells(grid(2)), ExportFormat::threedec, "t").notes.empty());
}

TEST(Exports, FieldsOfLsdynaKeepTheirColumns) {
  const Exported result = export_blocks(make_cells(grid(1, {359123.456789012345, 5.4e6 + 1.0 / 3, -1e-7 / 3})),
                                        ExportFormat::lsdyna, "two\nlines");
  EXPECT_NE(result.bytes.find("origin subtracted: 359000 5400000 0\n"), std::string::npos) << result.bytes;
  EXPECT_EQ(count(result.bytes, "two lines"), 1U);
  std::size_t begin = result.bytes.find("*NODE\n") + 6;
  for (int node = 0; node < 8; ++node) {
    const std::size_t end = result.bytes.find('\n', begin);
    EXPECT_EQ(end - begin, 80U);
    begin = end + 1;
  }
  EXPECT_EQ(result.bytes.substr(begin, 15), "*ELEMENT_SHELL\n");
}

TEST(Exports, TheSectionOfAGridIsItsLines) {
  // 4 x 4 squares: four lines around, three each way inside; neighbouring pieces are one line
  const Exported result = export_blocks(make_cells(grid(4)), ExportFormat::dda, "t");
  EXPECT_NE(result.bytes.find("\n10\n4\n0\n0\n0\n0\n0\n0\n0\n"), std::string::npos) << result.bytes;
  EXPECT_EQ(count(result.bytes, "\n"), 3U + 7U + 10U);
}

TEST(Exports, NothingIsWrittenOfNoBlocks) {
  for (const ExportName& name : export_names()) {
    EXPECT_EQ(count(export_blocks(Cells{}, name.format, "empty").bytes, "block_0"), 0U) << name.name;
  }
}

TEST(Exports, NamesAndEndingsAreUnique) {
  for (const ExportName& a : export_names()) {
    EXPECT_EQ(name_of(a.format).name, a.name);
    EXPECT_EQ(std::ranges::count(export_names(), a.name, &ExportName::name), 1);
    EXPECT_EQ(std::ranges::count(export_names(), a.ending, &ExportName::ending), 1);
  }
}

}  // namespace
}  // namespace cleave::report
