#include "cleave/io/mesh.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io_testing.hpp"

namespace cleave::io {
namespace {

MeshData without_lines(MeshData mesh) {
  mesh.lines.clear();
  return mesh;
}

const MeshData& sample() {
  static const MeshData mesh = parse_obj(
                                   "v 0.1 -1e-300 3\nv 1 0.3333333333333333 4e17\nv 2 2 2\nv 0 9 1\nf 1 2 3 4\ng b\nf "
                                   "3 2 1\ng a\nf 1 2 3\ng b\nf 4 2 1\n",
                                   "a")
                                   .value();
  return mesh;
}

TEST(MeshWriteTest, ObjReadsBackTheSame) {
  const std::string text = write_obj(sample(), std::vector<std::string>{"cleave", "unit m"});
  EXPECT_TRUE(text.starts_with("# cleave\n# unit m\nv 0.1 -1e-300 3\n")) << text;
  EXPECT_EQ(without_lines(parse_obj(text, "b").value()), without_lines(sample()));
}

TEST(MeshWriteTest, PlyReadsBackTheSameButForGroups) {
  const MeshData back = parse_ply(write_ply(sample(), std::vector<std::string>{"cleave"}), "b").value();
  EXPECT_EQ(back.vertices, sample().vertices);
  EXPECT_EQ(back.corners, sample().corners);
  EXPECT_EQ(back.ends, sample().ends);
}

TEST(MeshWriteTest, StlHoldsTheSameBody) {
  const MeshData wall = read_mesh(testing::data_file("masonry_meshes/ursula.obj")).value();
  const MeshData box = parse_obj(
                           "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 2 3 0\nv 0 0 4\nv 2 0 4\nv 0 3 4\nv 2 3 4\n"
                           "g side\nf 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\ng cap\nf 1 3 4 2\nf 5 6 8 7\n",
                           "a")
                           .value();
  EXPECT_DOUBLE_EQ(testing::volume_of(box), 24);
  const MeshData text = parse_stl(write_stl_text(box), "b").value();
  EXPECT_EQ(text.faces(), 12U);
  EXPECT_EQ(text.groups, (std::vector<std::string>{"side", "cap"}));
  EXPECT_DOUBLE_EQ(testing::volume_of(text), 24);
  const MeshData binary = parse_stl(write_stl_binary(box).value(), "b").value();
  EXPECT_DOUBLE_EQ(testing::volume_of(binary), 24);
  const auto solid = solid_of(text).value();
  EXPECT_EQ(solid.tags()[solid.faces().back().tag], "cap");
  EXPECT_GT(parse_stl(write_stl_text(wall), "b").value().faces(), wall.faces());
}

TEST(MeshWriteTest, FloatsTooCoarseForTheCoordinatesAreRefused) {
  MeshData far = sample();
  for (geometry::Vec3& v : far.vertices) v = geometry::Vec3{500000, 5000000, 100} + geometry::Vec3{v.x, v.x * v.x, 1};
  const auto refused = write_stl_binary(far);
  ASSERT_FALSE(refused.has_value());
  EXPECT_GT(refused.error().step, 0.5);
  EXPECT_NE(describe(refused.error()).find("; subtract an origin"), std::string::npos);
  EXPECT_TRUE(write_stl_binary(far, {500000, 5000000, 100}).has_value());
}

}  // namespace
}  // namespace cleave::io
