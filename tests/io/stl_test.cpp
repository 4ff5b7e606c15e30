#include <gtest/gtest.h>

#include <string>

#include "io_testing.hpp"

namespace cleave::io::stl_test {
namespace {

using testing::bytes_of;
using testing::data_file;
using testing::volume_of;

MeshData read(std::string_view name) {
  auto mesh = read_mesh(data_file("stl_cases/" + std::string{name}));
  EXPECT_TRUE(mesh.has_value()) << describe(mesh.error());
  return mesh ? *std::move(mesh) : MeshData{};
}

ReadFault fault_of(std::string_view bytes) {
  const auto mesh = parse_stl(bytes, "a.stl");
  EXPECT_FALSE(mesh.has_value()) << bytes;
  if (mesh) return ReadFault::cannot_open;
  EXPECT_EQ(mesh.error().file, "a.stl");
  EXPECT_FALSE(mesh.error().remedy.empty());
  return mesh.error().fault;
}

TEST(StlTest, TheSizeDecidesNotTheWordSolid) {
  EXPECT_TRUE(bytes_of("stl_cases/binary_Cube.stl").starts_with(" solid"));
  EXPECT_TRUE(bytes_of("stl_cases/ascii_Cube.stl").starts_with(" solid"));
  for (const char* name : {"ascii_Cube.stl", "binary_Cube.stl", "binary_CubeInvalidUnicode.stl"}) {
    SCOPED_TRACE(name);
    const MeshData cube = read(name);
    EXPECT_EQ(cube.faces(), 12U);
    EXPECT_NEAR(volume_of(cube), 8, 1e-12);
    EXPECT_TRUE(cube.notes.empty());
  }
}

TEST(StlTest, VolumesOfTheCollection) {
  EXPECT_NEAR(volume_of(read("ascii_Moon.stl")), 0.8887226275, 1e-9);
  EXPECT_NEAR(volume_of(read("tests_dos.stl")), 0.8887226275, 1e-9);
  EXPECT_NEAR(volume_of(read("binary_Moon.stl")), 0.8887225850, 1e-9);
  EXPECT_NEAR(volume_of(read("binary_Star.stl")), 1.4165993391, 1e-9);
  EXPECT_NEAR(volume_of(read("binary_StarWithEmptyHeader.stl")), 1.4165993391, 1e-9);
  EXPECT_EQ(read("ascii_Moon.stl").faces(), 116U);
}

TEST(StlTest, TrailingBytesAreNotedAndLongOnesRefused) {
  const MeshData donut = read("binary_HalfDonut.stl");
  EXPECT_EQ(donut.faces(), 288U);
  EXPECT_NEAR(volume_of(donut), 2.3431490374, 1e-6);
  ASSERT_EQ(donut.notes.size(), 1U);
  EXPECT_EQ(donut.notes[0], "1 bytes after the last triangle ignored");
  std::string bytes = bytes_of("stl_cases/binary_Cube.stl");
  EXPECT_EQ(fault_of(bytes + std::string(50, 'x')), ReadFault::syntax);
  EXPECT_EQ(parse_stl(bytes + std::string(49, 'x'), "a").value().notes.size(), 1U);
}

TEST(StlTest, InconsistentWindingNamesAnEdge) {
  const MeshData triamid = read("tests_triamid.stl");
  EXPECT_EQ(triamid.faces(), 10U);
  const auto solid = solid_of(triamid);
  ASSERT_FALSE(solid.has_value());
  EXPECT_TRUE(std::holds_alternative<geometry::InconsistentEdge>(solid.error())) << describe(solid.error());
}

TEST(StlTest, TruncatedFilesAreRefused) {
  const std::string binary = bytes_of("stl_cases/binary_Moon.stl");
  const std::string text = bytes_of("stl_cases/ascii_Cube.stl");
  for (const std::size_t cut : {1U, 50U, 51U, 1000U}) {
    EXPECT_EQ(fault_of(std::string_view{binary}.substr(0, binary.size() - cut)), ReadFault::truncated);
  }
  for (const std::size_t cut : {40U, 100U, 700U}) {
    EXPECT_EQ(fault_of(std::string_view{text}.substr(0, text.size() - cut)), ReadFault::truncated);
  }
  EXPECT_EQ(fault_of(binary.substr(0, 83)), ReadFault::unknown_format);
  EXPECT_EQ(fault_of(""), ReadFault::empty);
}

TEST(StlTest, TextMayHoldSeveralSolids) {
  const auto facet = [](std::string_view x) {
    return "facet normal nan 0 0\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 " + std::string{x} +
           " 0\n endloop\nendfacet\n";
  };
  const auto mesh =
      parse_stl("SOLID a b\n" + facet("1") + "endsolid a b\nsolid\n" + facet("2") + facet("3") + "EndSolid\n", "a");
  ASSERT_TRUE(mesh.has_value()) << describe(mesh.error());
  EXPECT_EQ(mesh->groups, (std::vector<std::string>{"a b", ""}));
  EXPECT_EQ(mesh->group, (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(mesh->lines, (std::vector<std::uint32_t>{2, 11, 18}));
  EXPECT_EQ(fault_of("solid a\n" + facet("inf") + "endsolid"), ReadFault::bad_number);
  EXPECT_EQ(fault_of("solid a\n" + facet("1e999") + "endsolid"), ReadFault::bad_number);
  EXPECT_EQ(fault_of("solid a\n" + facet("1") + "facet normal 0 0 1 outer loop endloop endfacet"), ReadFault::syntax);
  EXPECT_EQ(fault_of("solid a\n" + facet("1")), ReadFault::truncated);
  EXPECT_EQ(fault_of("solid a\nendsolid a\n"), ReadFault::empty);
  const auto wrong = parse_stl("solid a\n" + facet("1") + "fact\n", "a");
  EXPECT_EQ(wrong.error().line, 9U);
}

TEST(StlTest, BinaryWithNotANumberIsRefused) {
  std::string bytes = bytes_of("stl_cases/binary_Cube.stl");
  bytes.replace(84 + 50 + 12, 4, std::string{"\0\0\xc0\x7f", 4});
  EXPECT_EQ(fault_of(bytes), ReadFault::bad_number);
  std::string none = bytes.substr(0, 84);
  none.replace(80, 4, std::string(4, '\0'));
  EXPECT_EQ(fault_of(none), ReadFault::empty);
}

}  // namespace
}  // namespace cleave::io::stl_test
