#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "cleave/geometry/polygon.hpp"
#include "io_testing.hpp"

namespace cleave::io {
namespace {

using testing::tetrahedron_obj;

ReadError refused(std::string_view text) {
  const auto mesh = parse_obj(text, "a.obj");
  EXPECT_FALSE(mesh.has_value()) << text;
  return mesh ? ReadError{} : mesh.error();
}

std::vector<std::uint32_t> face(const MeshData& mesh, std::size_t f) {
  return {mesh.face(f).begin(), mesh.face(f).end()};
}

TEST(ObjTest, FacesAreReadInEveryNotation) {
  const auto mesh = parse_obj(
      "\xEF\xBB\xBF# head\r\n"
      "mtllib rock.mtl\r\n"
      "v 0 0 0\r\n\tv +1.5e0 0 0 1.0\t\r\nv 1 1 0 0.5 0.5 0.5\r\nv 0 1 0\r\n"
      "vt 0 0\nvn 0 0 1\n"
      "f 1 2 3 4\n"
      "f 1/1 2/1 3/1\n"
      "f 1//1 3//1 4//1\n"
      "f -4/1/1 -3/1/1 -1/1/1  # from the end\n"
      "f 1 \\\n 2 \\\r\n 5\n"
      "v 9 9 9",
      "a.obj");
  ASSERT_TRUE(mesh.has_value()) << describe(mesh.error());
  ASSERT_EQ(mesh->faces(), 5U);
  EXPECT_EQ(face(*mesh, 0), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(face(*mesh, 1), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(face(*mesh, 2), (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(face(*mesh, 3), (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(face(*mesh, 4), (std::vector<std::uint32_t>{0, 1, 4}));  // the vertex comes after the face
  EXPECT_EQ(mesh->vertices[1], (geometry::Vec3{1.5, 0, 0}));
  EXPECT_EQ(mesh->lines, (std::vector<std::uint32_t>{9, 10, 11, 12, 15}));
}

TEST(ObjTest, GroupsAreKeptInOrderOfTheirFaces) {
  const auto mesh = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no Mesh 0\ng unused\no B\nf 1 2 3\no Mesh 0\nf 1 2 3\nf 3 2 1\n", "a");
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->groups, (std::vector<std::string>{"", "B", "Mesh 0"}));
  EXPECT_EQ(mesh->group, (std::vector<std::uint32_t>{0, 1, 2, 2}));
}

TEST(ObjTest, FaultsNameTheLine) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto expect = [&](const std::string& text, ReadFault fault, std::optional<std::uint32_t> line) {
    const ReadError e = refused(text);
    EXPECT_EQ(e.fault, fault) << text << describe(e);
    EXPECT_EQ(e.line, line) << text;
    EXPECT_EQ(e.file, "a.obj");
    EXPECT_FALSE(e.remedy.empty());
  };
  expect("", ReadFault::empty, {});
  expect(v, ReadFault::empty, {});
  expect(v + "f 1 2 4\n", ReadFault::out_of_range, 4);
  expect(v + "f 1 2 0\n", ReadFault::out_of_range, 4);
  expect(v + "f 1 2 -4\n", ReadFault::out_of_range, 4);
  expect(v + "f 1 2 99999999999\n", ReadFault::out_of_range, 4);
  expect(v + "f 1 2 99999999999999999999999\n", ReadFault::syntax, 4);
  expect(v + "f 1 2 x\n", ReadFault::syntax, 4);
  expect(v + "f 1 2 3.5\n", ReadFault::syntax, 4);
  expect(v + "f\n", ReadFault::syntax, 4);
  expect("v 0 0\n", ReadFault::syntax, 1);
  expect("v 0 0 nan\n", ReadFault::bad_number, 1);
  expect("v 0 0 inf\n", ReadFault::bad_number, 1);
  expect("v 0 0 1e400\n", ReadFault::bad_number, 1);
  expect("v 0 0 1,5\n", ReadFault::bad_number, 1);
  expect("v 0 0 +-1\n", ReadFault::bad_number, 1);
  expect("\n\nsolid cube\n", ReadFault::syntax, 3);
  expect(
      v + "f" +
          [] {
            std::string s;
            for (int i = 0; i < 5000; ++i) s += " 1";
            return s;
          }(),
      ReadFault::too_large, 4);
}

TEST(ObjTest, ShortFacesAreLeftToGeometry) {
  const auto mesh = parse_obj("v 0 0 0\nv 1 0 0\nf 1 2\n", "a");
  ASSERT_TRUE(mesh.has_value());
  const auto polygon = geometry::Polygon::make(mesh->corners_of(0));
  EXPECT_TRUE(std::holds_alternative<geometry::TooFewCorners>(polygon.error()));
  EXPECT_TRUE(std::holds_alternative<geometry::BadFace>(solid_of(*mesh).error()));
}

TEST(ObjTest, ClosedMeshesBecomeSolids) {
  const auto mesh = parse_obj(tetrahedron_obj, "a").value();
  EXPECT_DOUBLE_EQ(testing::volume_of(mesh), 1.0 / 6);
  EXPECT_EQ(solid_of(mesh).value().tags()[0], "surface");
  // the same with vertices of its own for every face: welding makes it whole
  MeshData loose = mesh;
  loose.vertices.clear();
  loose.corners.clear();
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    for (const geometry::Vec3 p : mesh.corners_of(f)) {
      loose.corners.push_back(static_cast<std::uint32_t>(loose.vertices.size()));
      loose.vertices.push_back({p.x, p.y, p.z == 0 && f == 1 ? -0.0 : p.z});
    }
  }
  EXPECT_EQ(loose.vertices.size(), 12U);
  EXPECT_EQ(welded(loose).vertices.size(), 4U);
  EXPECT_DOUBLE_EQ(testing::volume_of(loose), 1.0 / 6);
}

TEST(ObjTest, WallOfMasonryIs38Boxes) {
  const auto wall = read_mesh(testing::data_file("masonry_meshes/wall.obj"));
  ASSERT_TRUE(wall.has_value()) << describe(wall.error());
  EXPECT_EQ(wall->vertices.size(), 304U);
  EXPECT_EQ(wall->faces(), 228U);
  EXPECT_EQ(wall->groups.size(), 38U);
  double sum = 0;
  for (std::uint32_t g = 0; g < 38; ++g) {
    MeshData block = *wall;
    block.corners.clear();
    block.ends.clear();
    block.group.clear();
    for (std::size_t f = 0; f < wall->faces(); ++f) {
      if (wall->group[f] != g) continue;
      block.corners.insert(block.corners.end(), wall->face(f).begin(), wall->face(f).end());
      block.ends.push_back(static_cast<std::uint32_t>(block.corners.size()));
      block.group.push_back(g);
    }
    ASSERT_EQ(block.faces(), 6U);
    sum += testing::volume_of(block);
  }
  EXPECT_NEAR(sum, 4.365625, 1e-12);
  // all blocks at once lie face to face, so they are not one body
  EXPECT_FALSE(solid_of(*wall).has_value());
}

TEST(ObjTest, DoubledFacesAreNotManifold) {
  const auto dome = read_mesh(testing::data_file("masonry_meshes/dome_first_block.obj")).value();
  const auto solid = solid_of(dome);
  ASSERT_FALSE(solid.has_value());
  const auto* edge = std::get_if<geometry::NonManifoldEdge>(&solid.error());
  ASSERT_NE(edge, nullptr) << describe(solid.error());
  EXPECT_EQ(edge->uses, 4U);
}

}  // namespace
}  // namespace cleave::io
