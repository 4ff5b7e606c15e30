#include <gtest/gtest.h>

#include "cleave/geometry/tunnel.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Domains and excavations that are not boxes.

namespace cleave::testing {
namespace {

using geometry::Solid;
using geometry::SolidFace;
using Shapes = std::vector<Shape>;

/// Prism over a plane outline (counter-clockwise) from z = 0 to h.
Solid prism(const std::vector<std::array<double, 2>>& outline, double h) {
  std::vector<Vec3> vertices;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, h}) {
    for (const auto& [x, y] : outline) vertices.push_back({x, y, z});
  }
  SolidFace bottom, top;
  std::vector<SolidFace> faces;
  for (std::uint32_t i = 0; i < n; ++i) {
    bottom.corners.push_back(n - 1 - i);
    top.corners.push_back(n + i);
    const std::uint32_t j = (i + 1) % n;
    faces.push_back({.corners = {i, j, n + j, n + i}});
  }
  faces.push_back(bottom);
  faces.push_back(top);
  return Solid::make(vertices, faces).value();
}
Solid l_prism() { return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1); }
/// A fork with two prongs that point up (+y).
Solid fork() { return prism({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 1); }

constexpr std::array<std::array<std::uint32_t, 4>, 6> box_faces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
void append_box(std::vector<Vec3>& vertices, std::vector<SolidFace>& faces, Vec3 lo, Vec3 hi, bool inwards,
                bool triangles) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (unsigned i = 0; i < 8; ++i) {
    vertices.push_back({(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
  }
  for (const auto& face : box_faces) {
    SolidFace quad;
    for (const std::uint32_t c : face) quad.corners.push_back(first + c);
    if (inwards) std::ranges::reverse(quad.corners);
    if (triangles) {
      faces.push_back({.corners = {quad.corners[0], quad.corners[1], quad.corners[2]}});
      faces.push_back({.corners = {quad.corners[0], quad.corners[2], quad.corners[3]}});
    } else {
      faces.push_back(quad);
    }
  }
}
Solid box_mesh(Vec3 lo, Vec3 hi, bool triangles) {
  std::vector<Vec3> vertices;
  std::vector<SolidFace> faces;
  append_box(vertices, faces, lo, hi, false, triangles);
  return Solid::make(vertices, faces).value();
}
Solid box_with_cavity() {
  std::vector<Vec3> vertices;
  std::vector<SolidFace> faces;
  append_box(vertices, faces, {0, 0, 0}, {3, 3, 3}, false, true);
  append_box(vertices, faces, {1, 1, 1}, {2, 2, 2}, true, true);
  return Solid::make(vertices, faces).value();
}
/// [0,3]^2 x [0,1] less [1,2]^2 x [0,1].
Solid square_ring() {
  std::vector<Vec3> vertices;
  for (const double z : {0.0, 1.0}) {
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}}) {
      vertices.push_back({static_cast<double>(x), static_cast<double>(y), z});
    }
  }
  std::vector<SolidFace> faces;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    faces.push_back({.corners = {i, j, 8 + j, 8 + i}});            // outer wall
    faces.push_back({.corners = {4 + j, 4 + i, 12 + i, 12 + j}});  // inner wall
    faces.push_back({.corners = {8 + i, 8 + j, 12 + j, 12 + i}});  // top
    faces.push_back({.corners = {j, i, 4 + i, 4 + j}});            // bottom
  }
  return Solid::make(vertices, faces).value();
}

TEST(DomainAsAMesh, GivesTheBlocksOfTheBox) {
  const auto rect13 = support::workload_named("rect-13").value();
  auto input = support::cut_input(rect13);
  const auto reference = certified(input);
  for (const bool triangles : {false, true}) {
    input.domain = box_mesh({0, 0, 0}, {80, 80, 60}, triangles);
    const auto audited = certified(input);
    EXPECT_EQ(shapes(audited.complex()), shapes(reference.complex()));
    EXPECT_EQ(canonical_hash(audited.complex()), canonical_hash(reference.complex()));
  }
}

TEST(DomainAsAMesh, FacesOfTheUncutBodyAreMerged) {
  EXPECT_EQ(shapes(scene(box_mesh({0, 0, 0}, {1, 2, 3}, true))), (Shapes{{cuboid, 6}}));
  EXPECT_EQ(shapes(scene(box_with_cavity())), (Shapes{{{16, 24, 12, 12, 2, 0}, 26}}));
  EXPECT_EQ(shapes(scene(square_ring())), (Shapes{{{16, 24, 10, 12, 1, 1}, 8}}));
  EXPECT_EQ(shapes(scene(l_prism())), (Shapes{{{12, 18, 8, 8, 1, 0}, 3}}));
}

TEST(ConcaveDomain, LPrism) {
  constexpr std::array<unsigned, 6> l{12, 18, 8, 8, 1, 0};
  EXPECT_EQ(shapes(scene(l_prism(), {rectangle(2, 0.5, {-1, -1}, {3, 3})})), (Shapes{{l, 1.5}, {l, 1.5}}));
  EXPECT_EQ(shapes(scene(l_prism(), {rectangle(0, 1, {-1, -1}, {3, 3})})),
            (Shapes{{cuboid, 1}, {{10, 15, 7, 7, 1, 0}, 2}}))
      << "the joint runs on in a side of the domain: half of that side of the block is joint, half is fixed";
  EXPECT_EQ(shapes(scene(l_prism(), {rectangle(0, 1, {-1, -1}, {3, 3}), rectangle(1, 1, {-1, -1}, {3, 3})})),
            Shapes(3, {cuboid, 1}));
  const auto whole = certified(scene(l_prism()));
  EXPECT_FALSE(whole.complex().blocks().items()[0].convex);
  EXPECT_NEAR(whole.complex().blocks().items()[0].centroid.x, 5.0 / 6, 1e-14);
  EXPECT_NEAR(whole.complex().blocks().items()[0].centroid.y, 5.0 / 6, 1e-14);
  EXPECT_NEAR(whole.complex().blocks().items()[0].centroid.z, 0.5, 1e-14);
}

TEST(ConcaveDomain, OneJointCutsBothProngsOfAFork) {
  const auto input = scene(fork(), {rectangle(1, 2, {-1, -1}, {4, 2})});
  EXPECT_EQ(shapes(input), (Shapes{{cuboid, 1}, {cuboid, 1}, {{16, 24, 10, 10, 1, 0}, 5}}));
  auto persistent = scene(fork());
  persistent.joints.emplace_back(topology::PersistentJoint{{0, 2, 0}, {0, 1, 0}});
  EXPECT_EQ(shapes(persistent), shapes(input));
}

TEST(ConcaveDomain, CavityOfTheDomain) {
  EXPECT_EQ(shapes(scene(box_with_cavity(), {rectangle(2, 1.5, {-1, -1}, {4, 4})})),
            (Shapes{{{16, 24, 11, 12, 1, 0}, 13}, {{16, 24, 11, 12, 1, 0}, 13}}));
  EXPECT_EQ(shapes(scene(box_with_cavity(), {rectangle(2, 0.5, {-1, -1}, {4, 4})})),
            (Shapes{{cuboid, 4.5}, {{16, 24, 12, 12, 2, 0}, 21.5}}));
  EXPECT_EQ(shapes(scene(box_with_cavity(), {rectangle(2, 1.5, {0.5, 0.5}, {2.5, 2.5})})),
            (Shapes{{{16, 24, 12, 12, 2, 0}, 26}}))
      << "a collar around the cavity cuts nothing off";
}

TEST(ConcaveDomain, SquareRing) {
  constexpr std::array<unsigned, 6> u_shape{16, 24, 10, 10, 1, 0};
  EXPECT_EQ(shapes(scene(square_ring(), {rectangle(1, 1.5, {-1, -1}, {4, 2})})), (Shapes{{u_shape, 4}, {u_shape, 4}}));
  EXPECT_EQ(shapes(scene(square_ring(), {rectangle(1, 1.5, {-1, -1}, {1.5, 2})})),
            (Shapes{{{16, 24, 10, 12, 1, 1}, 8}}))
      << "one cut opens the ring but makes no second block";
  EXPECT_EQ(shapes(scene(square_ring(), {rectangle(2, 0.25, {-1, -1}, {4, 4})})),
            (Shapes{{{16, 24, 10, 12, 1, 1}, 2}, {{16, 24, 10, 12, 1, 1}, 6}}));
}

TEST(Excavations, AsMeshesAndAsBoxes) {
  const auto rock = box({0, 0, 0}, {4, 4, 4});
  const auto joints = {rectangle(2, 2, {-1, -1}, {5, 5}), rectangle(0, 2, {-1, -1}, {5, 5})};
  const auto reference = shapes(scene(rock, joints, {box({1, 1, 1}, {3, 3, 5})}));
  EXPECT_EQ(shapes(scene(rock, joints, {box_mesh({1, 1, 1}, {3, 3, 5}, false)})), reference);
  EXPECT_EQ(shapes(scene(rock, joints, {box_mesh({1, 1, 1}, {3, 3, 5}, true)})), reference);
}

TEST(Excavations, ATunnelTakesItsVolume) {
  for (const bool slanted : {false, true}) {
    const auto tunnel = geometry::make_tunnel(geometry::HorseshoeSection{metres(4), metres(5)},
                                              {{10, slanted ? 3.0 : 0.0, 10}, {10 + (slanted ? 2.5 : 0.0), 17, 10}})
                            .value();
    auto input = scene(box({0, 0, 0}, {20, 20, 20}), {}, {tunnel});
    const auto audited = certified(input);
    ASSERT_EQ(audited.complex().blocks().size(), 1U);
    EXPECT_NEAR(audited.certificate().volume.si(), 8000 - tunnel.volume().si(), 1e-8);
    EXPECT_EQ(audited.complex().blocks().items()[0].counts.genus, 0U);
    EXPECT_LE(audited.certificate().volume_relative_error, 1e-12);
  }
}

}  // namespace
}  // namespace cleave::testing
