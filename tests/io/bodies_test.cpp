#include "cleave/io/bodies.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "cleave/io/mesh.hpp"
#include "io_testing.hpp"

namespace cleave::io::bodies_test {
namespace {

/// Faces of a cube from `low` to `high`; the corner (high, high, high) is moved up by `lift`.
std::string cube(double low, double high, int first = 1, double lift = 0) {
  std::string text;
  for (const double z : {low, high}) {
    text += fmt::format("v {0} {0} {2}\nv {1} {0} {2}\nv {1} {1} {3}\nv {0} {1} {2}\n", low, high, z,
                        z == high ? z + lift : z);
  }
  for (const std::string_view face : {"3210", "4567", "0154", "1265", "2376", "3047"}) {
    text += "f";
    for (const char c : face) text += fmt::format(" {}", first + (c - '0'));
    text += "\n";
  }
  return text;
}

MeshData mesh(const std::string& obj) { return parse_obj(obj, "a.obj").value(); }

TEST(BodiesTest, BentFacesBecomeTheTrianglesOfTheCutter) {
  const Unbent bent = without_bent_faces(mesh(cube(0, 1, 1, 0.2)));
  EXPECT_EQ(bent.mesh.faces(), 7U);  // the two sides beside the corner stay plane
  ASSERT_TRUE(bent.note.has_value());
  EXPECT_EQ(
      *bent.note,
      "1 faces of bodies are bent, with corners up to 0.0495 m off their plane: each is cut into triangles, along "
      "its shortest diagonals");
  // the shorter diagonal of the top passes beside the corner: a tetrahedron of 0.2 / 6 m3 stands on it
  EXPECT_NEAR(testing::volume_of(bent.mesh), 1 + 0.2 / 6, 1e-12);
  EXPECT_EQ(bent.mesh.lines.size(), 7U);
  EXPECT_EQ(bent.mesh.group.size(), 7U);
  const Unbent plane = without_bent_faces(mesh(cube(0, 1)));
  EXPECT_FALSE(plane.note.has_value());
  EXPECT_EQ(plane.mesh, mesh(cube(0, 1)));
}

TEST(BodiesTest, BentFacesOfCellsToo) {
  Polyhedra cells{
      .points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1.2}, {0, 1, 1}},
      .face_stream = {6, 4, 3, 2, 1, 0, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7},
      .face_ends = {31},
      .block = {3}};
  const UnbentCells bent = without_bent_faces(cells);
  EXPECT_TRUE(bent.note.has_value());
  EXPECT_EQ(bent.cells.face_stream[0], 7);
  EXPECT_EQ(bent.cells.face_ends.back(), static_cast<std::int64_t>(bent.cells.face_stream.size()));
  EXPECT_EQ(bent.cells.face_stream.size(), 31U - 5 + 8);
  cells.points[6].z = 1;
  EXPECT_EQ(without_bent_faces(cells).cells, cells);
}

TEST(BodiesTest, SurfacesOfOneBodyMayTouchButNotOverlap) {
  EXPECT_FALSE(overlap_of(mesh(cube(0, 1))).has_value());
  EXPECT_FALSE(overlap_of(mesh(cube(0, 1) + cube(2, 3, 9))).has_value());
  EXPECT_FALSE(overlap_of(mesh(cube(0, 1) + cube(1, 2, 9))).has_value());  // in a corner
  const auto kind = [](const std::string& obj) { return overlap_of(mesh(obj)).value(); };
  EXPECT_TRUE(std::holds_alternative<geometry::FacesCross>(kind(cube(0, 1) + cube(0, 1, 9))));
  EXPECT_TRUE(std::holds_alternative<geometry::FacesCross>(kind(cube(0, 1) + cube(0.5, 1.5, 9))));
  EXPECT_TRUE(std::holds_alternative<geometry::InsideOut>(kind(cube(-1, 2) + cube(0, 1, 9))));
  // whatever its name
  EXPECT_TRUE(overlap_of(mesh("g block_3\n" + cube(0, 1) + cube(0, 1, 9))).has_value());
  // what is thinner than its coordinates can show is let pass
  EXPECT_FALSE(overlap_of(mesh(cube(5e6, 5e6 + 1e-9) + cube(5e6, 5e6 + 1e-9, 9))).has_value());
}

}  // namespace
}  // namespace cleave::io::bodies_test
