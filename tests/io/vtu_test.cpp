#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "cleave/io/mesh.hpp"

namespace cleave::io::vtu_test {
namespace {

const std::string faces = "4 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3";
const std::string points = "0 0 0 1 0 0 0 1 0 0 0 1";

/// A tetrahedron; arrays as given.
std::string vtu(const std::string& stream, const std::string& places, const std::string& block = "7",
                const std::string& offset = "17") {
  const auto array = [](const std::string& type, const std::string& name, const std::string& text) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">\n" + text + "\n</DataArray>\n";
  };
  return "<?xml version=\"1.0\"?>\n<!-- < a comment > -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
         "byte_order=\"LittleEndian\" header_type='UInt64'>\n<UnstructuredGrid>\n<FieldData><Array type=\"String\" "
         "Name=\"title\">65 0</Array></FieldData>\n<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>\n" +
         array("Float64", "Points", places) + "</Points>\n<Cells>\n" + array("Int64", "connectivity", "0 1 2 3") +
         array("Int64", "offsets", "4") + array("UInt8", "types", "42") + array("Int64", "faces", stream) +
         array("Int64", "faceoffsets", offset) + "</Cells>\n<CellData>\n" + array("Int64", "block", block) +
         array("Float64", "other", "nan") + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

void expect_refused(std::string_view text, ReadFault fault) {
  const auto cells = parse_vtu(text, "a.vtu");
  ASSERT_FALSE(cells.has_value()) << text;
  EXPECT_EQ(cells.error().fault, fault) << describe(cells.error());
  EXPECT_EQ(cells.error().file, "a.vtu");
  EXPECT_FALSE(cells.error().remedy.empty());
}

TEST(VtuReaderTest, PolyhedraAsText) {
  const auto cells = parse_vtu(vtu(faces, points), "a");
  ASSERT_TRUE(cells.has_value()) << describe(cells.error());
  EXPECT_EQ(cells->points[3], (geometry::Vec3{0, 0, 1}));
  EXPECT_EQ(cells->face_ends, (std::vector<std::int64_t>{17}));
  EXPECT_EQ(cells->face_stream.front(), 4);
  EXPECT_EQ(cells->block, (std::vector<std::uint32_t>{7}));
}

TEST(VtuReaderTest, Base64OfBothHeaderSizesAndByteOrders) {
  const std::string text = "<DataArray type=\"Int64\" Name=\"block\" format=\"ascii\">\n7\n</DataArray>";
  // 8 bytes follow; then 7
  const std::string inline64 =
      "<DataArray type=\"Int64\" Name=\"block\" format=\"binary\">\n CAAAAAAAAAAHAAAAAAAAAA== \n</DataArray>";
  EXPECT_EQ(parse_vtu(replaced(vtu(faces, points), text, inline64), "a").value().block[0], 7U);
  // VTK: the count is a run of its own, 32 bits
  const std::string apart = "<DataArray type=\"UInt16\" Name=\"block\" format=\"binary\">AgAAAA==BwA=</DataArray>";
  const std::string small = replaced(vtu(faces, points), "UInt64", "UInt32");
  EXPECT_EQ(parse_vtu(replaced(small, text, apart), "a").value().block[0], 7U);
  const std::string big = replaced(small, "LittleEndian", "BigEndian");
  const std::string turned = "<DataArray type=\"Int16\" Name=\"block\" format=\"binary\">AAAAAgAH</DataArray>";
  EXPECT_EQ(parse_vtu(replaced(big, text, turned), "a").value().block[0], 7U);
  const std::string cut = "<DataArray type=\"Int64\" Name=\"block\" format=\"binary\">CAAAAAAAAAAHAA==</DataArray>";
  expect_refused(replaced(vtu(faces, points), text, cut), ReadFault::truncated);
  expect_refused(
      replaced(vtu(faces, points), text, "<DataArray type=\"Int64\" Name=\"block\" format=\"binary\">?</DataArray>"),
      ReadFault::syntax);
}

TEST(VtuReaderTest, CellsWithoutBlocksAreNumbered) {
  const std::string text = replaced(vtu(faces, points), "Name=\"block\"", "Name=\"rock\"");
  EXPECT_EQ(parse_vtu(text, "a").value().block, (std::vector<std::uint32_t>{0}));
}

/// Of a cell: what is wrong and what to do.
std::string refusal(const std::string& text) {
  const auto cells = parse_vtu(text, "a.vtu");
  return cells ? "" : describe(cells.error());
}

TEST(VtuReaderTest, CellsThatAreNoSolidAreRefusedWithTheirBlock) {
  EXPECT_EQ(refusal(vtu("4 3 0 2 1 3 0 1 3 3 0 3 2 3 1 3 2", points)),
            "a.vtu: block 7 (cell 0) has faces that look inwards: the edge (1, 0, 0) to (0, 1, 0) is passed in one "
            "direction by both its faces; give the corners of all faces counter-clockwise as seen from outside");
  EXPECT_EQ(refusal(vtu("4 3 0 1 2 3 0 3 1 3 0 2 3 3 1 3 2", points)),
            "a.vtu: block 7 (cell 0) has the volume -0.1666667 m3: its faces look inwards; give the corners of all "
            "faces counter-clockwise as seen from outside");
  EXPECT_EQ(refusal(vtu("5 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3 3 2 3 1", points, "7", "21")),
            "a.vtu: block 7 (cell 0) has one face twice: 3 and 4, counted from 0; remove one of them");
  // three faces of one tetrahedron and one of another
  const std::string five = replaced(vtu("4 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 4", points + " 5 5 5"), "NumberOfPoints=\"4\"",
                                    "NumberOfPoints=\"5\"");
  EXPECT_TRUE(
      refusal(five).contains("block 7 (cell 0) is not closed: the edge (1, 0, 0) to (0, 0, 1) belongs to 1 face"))
      << refusal(five);
  EXPECT_TRUE(
      refusal(vtu(faces, "0 0 0 1 0 0 0 1 0 0 0 1e10")).contains("corner (0, 0, 10000000000) further than 1e9 m"));
  EXPECT_TRUE(refusal(vtu(faces, "0 0 0 1 0 0 0 1 0 1 1 0")).contains("has no volume"));
}

TEST(VtuReaderTest, VolumesAndCountsThatTheFileStatesAreCompared) {
  const auto stated = [](const std::string& volume) {
    return replaced(replaced(vtu(faces, points), "Name=\"other\"", "Name=\"volume\""), "nan", volume);
  };
  EXPECT_EQ(refusal(stated("0.1666667")), "");  // 2e-7 off
  EXPECT_TRUE(
      refusal(stated("0.166668")).contains("has the volume 0.1666666667 m3, but the cell array \"volume\" says"));
  expect_refused(stated("nan"), ReadFault::bad_number);
  expect_refused(stated("0.1666667 1"), ReadFault::out_of_range);
  expect_refused(stated("-0.1666667"), ReadFault::out_of_range);
  expect_refused(replaced(vtu(faces, points), "NumberOfPoints=\"4\"", "NumberOfPoints=\"5\""), ReadFault::truncated);
  expect_refused(replaced(vtu(faces, points), "NumberOfCells=\"1\"", "NumberOfCells=\"5\""), ReadFault::truncated);
  expect_refused(replaced(vtu(faces, points), "NumberOfCells=\"1\"", "NumberOfCells=\"?\""), ReadFault::truncated);
  EXPECT_EQ(refusal(replaced(vtu(faces, points), " NumberOfCells=\"1\"", "")), "");
}

/// Cells of a wide map have volumes of few digits: rounded corners are no fault.
TEST(VtuReaderTest, PointsOfTheirOwnForEachFaceAndThinCellsAreRead) {
  const std::string own = replaced(vtu("4 3 0 2 1 3 3 4 5 3 6 7 8 3 9 10 11",
                                       "0 0 0 1 0 0 0 1 0  0 0 0 1 0 0 0 0 1  0 0 0 0 0 1 0 1 0  1 0 0 0 1 0 0 0 1"),
                                   "NumberOfPoints=\"4\"", "NumberOfPoints=\"12\"");
  EXPECT_EQ(refusal(own), "");
  const std::string far = "500000 5400000 0 500001 5400000 0 500000 5400001 0 500000.3 5400000.3 1e-8";
  const std::string thin = replaced(replaced(vtu(faces, far), "Name=\"other\"", "Name=\"volume\""), "nan", "1.6667e-9");
  EXPECT_EQ(refusal(thin), "");
  // two faces folded to the edge from 0 to 1, to the last digit or to all of them
  const std::string folded = "6 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3 3 0 4 1 3 4 1 0";
  const std::string five = "NumberOfPoints=\"5\"";
  EXPECT_EQ(refusal(replaced(vtu(folded, points + " 0 0 0", "7", "25"), "NumberOfPoints=\"4\"", five)), "");
  // the same one twice
  const std::string twice = "6 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3 3 0 4 1 3 0 4 1";
  EXPECT_EQ(refusal(replaced(vtu(twice, points + " 0 0 0", "7", "25"), "NumberOfPoints=\"4\"", five)), "");
  const std::string two =
      replaced(vtu("6 3 0 2 4 3 0 1 3 3 0 3 2 3 1 2 3 3 0 4 1 3 4 2 1", "0 0 0 1 0 0 0 1 0 0 0 1 1 1e-16 0", "7", "25"),
               "NumberOfPoints=\"4\"", five);
  EXPECT_EQ(refusal(two), "");
}

TEST(VtuReaderTest, Faults) {
  const std::string good = vtu(faces, points);
  expect_refused("", ReadFault::unknown_format);
  expect_refused("<html></html>", ReadFault::unknown_format);
  expect_refused(
      "\x7f"
      "ELF<<<>>>",
      ReadFault::unknown_format);
  expect_refused(good.substr(0, good.size() - 12), ReadFault::truncated);
  expect_refused(replaced(good, "UnstructuredGrid", "PolyData"), ReadFault::unknown_format);
  expect_refused(replaced(good, "byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order"),
                 ReadFault::unknown_format);
  expect_refused(replaced(good, "format=\"ascii\"", "format=\"appended\" offset=\"0\""), ReadFault::unknown_format);
  expect_refused(replaced(good, "<UnstructuredGrid>", "<UnstructuredGrid><Piece></Piece>"), ReadFault::unknown_format);
  expect_refused(replaced(good, "42", "10"), ReadFault::unknown_format);
  expect_refused(replaced(good, "Float64", "Complex"), ReadFault::syntax);
  expect_refused(replaced(good, "Float64", "Int32"), ReadFault::syntax);
  expect_refused(replaced(good, "Name=\"faces\"", "Name=\"face_connectivity\""), ReadFault::syntax);
  expect_refused(vtu(faces, points + " 1"), ReadFault::truncated);
  expect_refused(vtu(faces, "0 0 0 1 0 0 0 1 0 0 0 nan"), ReadFault::bad_number);
  expect_refused(vtu(faces, "0 0 0 1 0 0 0 1 0 0 0 1e400"), ReadFault::bad_number);
  expect_refused(vtu(faces, points, "-1"), ReadFault::out_of_range);
  expect_refused(vtu(faces, points, "1 2"), ReadFault::out_of_range);
  expect_refused(vtu(faces, points, "1.5"), ReadFault::bad_number);
  expect_refused(vtu(faces, points, "7", "18"), ReadFault::out_of_range);
  expect_refused(vtu(faces, points, "7", "-1"), ReadFault::out_of_range);
  expect_refused(vtu(faces, points, "7", "16"), ReadFault::out_of_range);
  expect_refused(vtu("4 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 4", points), ReadFault::out_of_range);
  expect_refused(vtu("4 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 -3", points), ReadFault::out_of_range);
  expect_refused(vtu("4 3 0 2 1 3 0 1 3 3 0 3 2 9000000000000000 1 2 3", points), ReadFault::out_of_range);
  expect_refused(vtu("9000000000000000 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3", points), ReadFault::out_of_range);
  expect_refused(vtu("3 3 0 2 1 3 0 1 3 3 0 3 2", points, "7", "13"), ReadFault::out_of_range);
  for (std::size_t n = 0; n + 11 < good.size(); n += 7)
    EXPECT_FALSE(parse_vtu(good.substr(0, n), "a").has_value()) << n;
}

}  // namespace
}  // namespace cleave::io::vtu_test
