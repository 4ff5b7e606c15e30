#include "cleave/geometry/solid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace cleave::geometry {
namespace {

/// Vertices and faces before they are a Solid, to be spoilt.
struct Surface {
  std::vector<Vec3> vertices;
  std::vector<SolidFace> faces;

  static Surface box(Vec3 min, Vec3 max) {
    const Solid solid = make_box(min, max).value();
    Surface s{{solid.vertices().begin(), solid.vertices().end()}, {solid.faces().begin(), solid.faces().end()}};
    for (SolidFace& f : s.faces) f.tag = 0;
    return s;
  }
  Surface& add(const Surface& other) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (SolidFace f : other.faces) {
      for (std::uint32_t& c : f.corners) c += first;
      faces.push_back(std::move(f));
    }
    return *this;
  }
  Surface& reversed() {
    for (SolidFace& f : faces) std::ranges::reverse(f.corners);
    return *this;
  }
  Surface& triangulated() {
    std::vector<SolidFace> triangles;
    for (const SolidFace& f : faces) {
      for (std::size_t i = 1; i + 1 < f.corners.size(); ++i) {
        triangles.push_back({{f.corners[0], f.corners[i], f.corners[i + 1]}, 0});
      }
    }
    faces = triangles;
    return *this;
  }
  [[nodiscard]] auto make() const { return Solid::make(vertices, faces); }
  template <class Error>
  [[nodiscard]] bool refused_as() const {
    const auto solid = make();
    if (solid) return false;
    EXPECT_NE(describe(solid.error()).find("; "), std::string::npos);
    return std::holds_alternative<Error>(solid.error());
  }
};

/// A torus of n x m quads, all bent: vertices of a surface with a handle.
Surface torus(std::uint32_t n, std::uint32_t m) {
  Surface s;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      const double r = 3 + std::cos(b);
      s.vertices.push_back({r * std::cos(a), r * std::sin(a), std::sin(b)});
      const auto at = [&](std::uint32_t k, std::uint32_t l) { return (k % n) * m + l % m; };
      s.faces.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, 0});
    }
  }
  return s;
}

TEST(SolidTest, BoxHasItsVolumeTagsAndOutwardFaces) {
  const auto box = make_box({1, 2, 3}, {2, 4, 6});
  ASSERT_TRUE(box.has_value());
  EXPECT_EQ(box->volume().si(), 6);
  EXPECT_TRUE(box->from_half_spaces());
  const std::vector<std::string> tags{"west", "east", "south", "north", "bottom", "top"};
  EXPECT_TRUE(std::ranges::equal(box->tags(), tags));
  const std::vector<Vec3> outward{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (std::size_t f = 0; f < 6; ++f) {
    const SolidFace& face = box->faces()[f];
    EXPECT_EQ(face.tag, f);
    const auto v = box->vertices();
    EXPECT_EQ(normalized(cross(v[face.corners[1]] - v[face.corners[0]], v[face.corners[2]] - v[face.corners[1]])),
              outward[f]);
  }
}

TEST(SolidTest, EmptyAndBadBoxesAreRefused) {
  EXPECT_TRUE(std::holds_alternative<NoVolume>(make_box({0, 0, 0}, {1, 1, 0}).error()));
  EXPECT_TRUE(std::holds_alternative<NoVolume>(make_box({0, 0, 0}, {-1, -1, 1}).error()));
  EXPECT_TRUE(std::holds_alternative<BadVertex>(make_box({0, 0, 0}, {1, 1, 1e300}).error()));
  EXPECT_TRUE(std::holds_alternative<BadVertex>(make_box({0, 0, std::nan("")}, {1, 1, 1}).error()));
}

TEST(SolidTest, HexahedronTakesEitherHandAndKeepsTheNames) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {  // a sheared box
    const Vec3 p{(i & 1U) != 0 ? 2.0 : 0, (i & 2U) != 0 ? 3.0 : 0, (i & 4U) != 0 ? 4.0 : 0};
    corners[i] = {p.x + 0.25 * p.z, p.y - 0.125 * p.z, p.z};
  }
  const auto right = make_hexahedron(corners);
  ASSERT_TRUE(right.has_value()) << describe(right.error());
  EXPECT_DOUBLE_EQ(right->volume().si(), 24);
  std::array<Vec3, 8> mirrored;
  for (std::size_t i = 0; i < 8; ++i) mirrored[i] = corners[i ^ 1U];
  const auto left = make_hexahedron(mirrored);
  ASSERT_TRUE(left.has_value()) << describe(left.error());
  EXPECT_DOUBLE_EQ(left->volume().si(), 24);
  // "east" is the face of the corners with bit 0, although it now looks west
  const SolidFace& east = left->faces()[1];
  EXPECT_EQ(left->tags()[east.tag], "east");
  for (const std::uint32_t c : east.corners) EXPECT_EQ(c & 1U, 1U);
}

TEST(SolidTest, BadHexahedraAreRefused) {
  const auto with = [](std::size_t corner, Vec3 p) {
    std::array<Vec3, 8> c;
    for (std::size_t i = 0; i < 8; ++i) c[i] = {i & 1U ? 1.0 : 0, i & 2U ? 1.0 : 0, i & 4U ? 1.0 : 0};
    c[corner] = p;
    return make_hexahedron(c);
  };
  EXPECT_TRUE(with(7, {1, 1, 1}).has_value());
  EXPECT_TRUE(std::holds_alternative<FaceNotPlanar>(with(7, {1.1, 1.1, 1.1}).error()));
  EXPECT_TRUE(std::holds_alternative<BadVertex>(with(7, {1, 1, std::numeric_limits<double>::infinity()}).error()));
  std::array<Vec3, 8> flat{};
  EXPECT_TRUE(std::holds_alternative<NoVolume>(make_hexahedron(flat).error()));
  // corners in the order of a mesher (round the bottom, round the top): the faces by bits cross themselves
  const std::array<Vec3, 8> ring{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  const auto crossed = make_hexahedron(ring);
  ASSERT_FALSE(crossed.has_value());
  // a frustum turned outside in: planar faces, not convex
  std::array<Vec3, 8> bow;
  for (std::size_t i = 0; i < 8; ++i) {
    const double s = i & 4U ? -0.25 : 1.0;
    bow[i] = {s * (i & 1U ? 1.0 : -1), s * (i & 2U ? 1.0 : -1), i & 4U ? 1.0 : 0};
  }
  EXPECT_FALSE(make_hexahedron(bow).has_value());
}

TEST(SolidTest, HexahedronWithBentFacesIsASurfaceOfTrianglesWhenWished) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) corners[i] = {i & 1U ? 1.0 : 0, i & 2U ? 1.0 : 0, i & 4U ? 1.0 : 0};
  corners[7].z = 1.3;  // bends the top only
  const auto bent = make_hexahedron(corners, BentFaces::triangulate);
  ASSERT_TRUE(bent.has_value());
  EXPECT_FALSE(bent->from_half_spaces());
  ASSERT_EQ(bent->tags().size(), 6U);
  EXPECT_EQ(bent->tags()[5], "top");
  // Above the unit cube: one pyramid over half of the top or two, after which diagonal the top is folded.
  const double more = bent->volume().si() - 1;
  EXPECT_TRUE(std::abs(more - 0.3 / 6) < 1e-14 || std::abs(more - 0.3 / 3) < 1e-14) << more;
  // Mirrored it is the same body.
  for (Vec3& c : corners) c.x = 1 - c.x;
  const auto mirrored = make_hexahedron(corners, BentFaces::triangulate);
  ASSERT_TRUE(mirrored.has_value());
  EXPECT_GT(mirrored->volume().si(), 1);
  // What is wrong otherwise stays wrong.
  std::array<Vec3, 8> flat{};
  EXPECT_TRUE(std::holds_alternative<NoVolume>(make_hexahedron(flat, BentFaces::triangulate).error()));
  corners[7] = {0.2, 0.2, 0.2};
  corners[0] = {0.9, 0.9, 0.9};
  EXPECT_FALSE(make_hexahedron(corners, BentFaces::triangulate).has_value());
}

TEST(SolidTest, HexahedronMayBeBentByRoundingOnly) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 p{i & 1U ? 80.0 : 0, i & 2U ? 80.0 : 0, i & 4U ? 60.0 : 0};
    const Vec3 ex = normalized(Vec3{1, 2, 3}), ey = normalized(cross(Vec3{1, 0, 0}, ex)), ez = cross(ex, ey);
    corners[i] = Vec3{4e5, 5e6, 100} + p.x * ex + p.y * ey + p.z * ez;
  }
  const auto solid = make_hexahedron(corners);
  ASSERT_TRUE(solid.has_value()) << describe(solid.error());
  EXPECT_NEAR(solid->volume().si(), 384000, 384000 * 1e-9);
}

TEST(SolidTest, ClosednessIsJudgedEdgeByEdge) {
  const Surface box = Surface::box({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(box.make().has_value());
  Surface open = box;
  open.faces.pop_back();
  EXPECT_TRUE(open.refused_as<OpenEdge>());
  Surface doubled = box;
  doubled.faces.push_back(box.faces[0]);
  EXPECT_TRUE(doubled.refused_as<NonManifoldEdge>());
  Surface turned = box;
  std::ranges::reverse(turned.faces[2].corners);
  EXPECT_TRUE(turned.refused_as<InconsistentEdge>());
  EXPECT_TRUE(Surface(box).reversed().refused_as<InsideOut>());
  EXPECT_TRUE((Surface{{}, {}}).refused_as<NoFaces>());
  // two boxes that share one edge: four faces at it
  Surface hinge = box;
  hinge.add(Surface::box({1, 1, 0}, {2, 2, 1}));
  for (SolidFace& f : hinge.faces) {
    for (std::uint32_t& c : f.corners) c = c == 8 ? 3 : c == 12 ? 7 : c;
  }
  EXPECT_TRUE(hinge.refused_as<NonManifoldEdge>());
}

TEST(SolidTest, SingleFacesAreJudged) {
  const Surface box = Surface::box({0, 0, 0}, {1, 1, 1});
  const auto with_face = [&](std::vector<std::uint32_t> corners) {
    Surface s = box;
    s.faces.push_back({std::move(corners), 0});
    const auto solid = s.make();
    EXPECT_FALSE(solid.has_value());
    const auto* bad = std::get_if<BadFace>(&solid.error());
    EXPECT_NE(bad, nullptr);
    EXPECT_EQ(bad->face, 6U);
    return bad->fault;
  };
  EXPECT_EQ(with_face({0, 1}), FaceFault::too_few_corners);
  EXPECT_EQ(with_face({0, 1, 8}), FaceFault::index_out_of_range);
  EXPECT_EQ(with_face({0, 1, 0}), FaceFault::corner_twice);
  Surface twisted = box;
  std::swap(twisted.vertices[6], twisted.vertices[7]);  // closed as ever, but top and north are bow ties
  const auto bow_tie = twisted.make();
  ASSERT_FALSE(bow_tie.has_value());
  EXPECT_EQ(std::get<BadFace>(bow_tie.error()).fault, FaceFault::crosses_itself);
  const Surface line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 1}},
                     {{{0, 2, 1}, 0}, {{0, 1, 3}, 0}, {{1, 2, 3}, 0}, {{2, 0, 3}, 0}}};
  const auto refused = line.make();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(std::get<BadFace>(refused.error()).fault, FaceFault::no_area);
  Surface tagged = box;
  tagged.faces[0].tag = 1;
  EXPECT_TRUE(tagged.refused_as<BadFace>());
}

TEST(SolidTest, FlatBodiesHaveNoVolume) {
  const Surface sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}, 0}, {{2, 1, 0}, 0}}};
  EXPECT_TRUE(sheet.refused_as<NoVolume>());
}

TEST(SolidTest, ShellsMustLookTheRightWay) {
  const Surface outer = Surface::box({0, 0, 0}, {9, 9, 9});
  const Surface inner = Surface::box({3, 3, 3}, {6, 6, 6});
  const Surface apart = Surface::box({20, 0, 0}, {21, 1, 1});
  const Surface core = Surface::box({4, 4, 4}, {5, 5, 5});
  EXPECT_DOUBLE_EQ(Surface(outer).add(Surface(inner).reversed()).make().value().volume().si(), 729 - 27);
  EXPECT_DOUBLE_EQ(Surface(outer).add(apart).make().value().volume().si(), 730);
  EXPECT_DOUBLE_EQ(Surface(outer).add(Surface(inner).reversed()).add(core).make().value().volume().si(), 729 - 27 + 1);
  EXPECT_TRUE(Surface(outer).add(inner).refused_as<InsideOut>());
  EXPECT_TRUE(Surface(outer).add(Surface(apart).reversed()).refused_as<InsideOut>());
  EXPECT_TRUE(Surface(outer).add(Surface(inner).reversed()).add(Surface(core).reversed()).refused_as<InsideOut>());
}

TEST(SolidTest, SurfacesThatCrossThemselvesAreRefused) {
  const Surface box = Surface::box({0, 0, 0}, {2, 2, 2});
  const auto with = [&](Vec3 min, Vec3 max) { return Surface(box).add(Surface::box(min, max)); };
  EXPECT_TRUE(with({1, 1, 1}, {3, 3, 3}).refused_as<FacesCross>());
  EXPECT_TRUE(with({1, 0.5, 0.5}, {3, 1.5, 1.5}).refused_as<FacesCross>());     // edges pierce a face
  EXPECT_TRUE(with({0, 0, 2}, {1, 1, 3}).refused_as<FacesCross>());             // stands on it
  EXPECT_TRUE(with({2, 2, 0.5}, {3, 3, 1.5}).refused_as<FacesCross>());         // along an edge
  EXPECT_TRUE(with({2.0000000000000004, 0, 0}, {3, 2, 2}).make().has_value());  // one ulp apart
  EXPECT_TRUE(with({2, 2, 2}, {3, 3, 3}).make().has_value());                   // one common corner: both keep it
  // the same on triangles
  EXPECT_TRUE(Surface(box).triangulated().make().has_value());
  EXPECT_TRUE(with({1, 1, 1}, {3, 3, 3}).triangulated().refused_as<FacesCross>());
  // two tetrahedra of the stella octangula: only edges cross edges, exactly
  const auto tetrahedron = [](double s) {
    Surface t{{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}},
              {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}, {{0, 3, 1}, 0}, {{1, 3, 2}, 0}}};
    if (s < 0) t.reversed();
    return t;
  };
  EXPECT_TRUE(tetrahedron(1).make().has_value());
  EXPECT_TRUE(tetrahedron(-1).make().has_value());
  EXPECT_TRUE(tetrahedron(1).add(tetrahedron(-1)).refused_as<FacesCross>());
}

TEST(SolidTest, FacesFoldedOntoTheirNeighbourAreRefused) {
  // a tetrahedron with a fin of no thickness: triangles (0,4,1) and (1,4,0) lie on each other
  Surface fin{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {2, -2, 0}},
              {{{0, 2, 1}, 0}, {{0, 4, 1}, 0}, {{0, 1, 4}, 0}, {{0, 1, 3}, 0}, {{0, 3, 2}, 0}, {{1, 2, 3}, 0}}};
  EXPECT_FALSE(fin.make().has_value());
  // a tetrahedron whose top corner was pushed into the base's plane, beside the base
  Surface flat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {2, 0.5, 0}},
               {{{0, 2, 1}, 0}, {{0, 1, 4}, 0}, {{0, 4, 3}, 0}, {{4, 1, 3}, 0}, {{0, 3, 2}, 0}, {{1, 2, 3}, 0}}};
  EXPECT_TRUE(flat.refused_as<FacesCross>());
}

TEST(SolidTest, HandlesAndBentQuadsAreFine) {
  const auto ring = torus(40, 20).make();
  ASSERT_TRUE(ring.has_value()) << describe(ring.error());
  EXPECT_NEAR(ring->volume().si(), 2 * std::numbers::pi * std::numbers::pi * 3, 1.5);
  EXPECT_FALSE(ring->from_half_spaces());
}

// A hundred thousand triangles pass the crossing check in well under a second; quadratic would be 5e9 pairs.
TEST(SolidTest, LargeMeshesAreChecked) {
  Surface large = torus(400, 125).triangulated();
  ASSERT_EQ(large.faces.size(), 100000U);
  EXPECT_TRUE(large.make().has_value());
  large.add(Surface::box({2.9, 0.1, -0.2}, {3.1, 3, 0.2}).triangulated());
  EXPECT_TRUE(large.refused_as<FacesCross>());
}

}  // namespace
}  // namespace cleave::geometry
