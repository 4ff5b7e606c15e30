#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "closed_scenes.hpp"

// The border of the exact world: what lies closer together than doubles can tell, and what lies far outside.

namespace cleave::testing {
namespace {

/// Four triangles about a point.
std::vector<Corners> tetrahedron(geometry::Vec3 middle, double size) {
  const std::array corners{middle + size * geometry::Vec3{1, 1, 1}, middle + size * geometry::Vec3{1, -1, -1},
                           middle + size * geometry::Vec3{-1, 1, -1}, middle + size * geometry::Vec3{-1, -1, 1}};
  std::vector<Corners> faces;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    Corners face;
    for (std::size_t k = 0; k < 4; ++k) {
      if (k != left_out) face.push_back(corners[k]);
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

TEST(Nesting, PiecesTooCloseForDoubles) {
  // One within the other within the other, closer together than any ray in doubles can tell.
  const auto u = uniform(11);
  for (const double size : {1e-3, 1e-8, 2e-9, 5e-10, 2e-10}) {
    for (int k = 0; k < 8; ++k) {
      auto input = scene(box({0, 0, 0}, {10, 10, 10}));
      const Placement at{{6 * u(), 6 * u(), 6 * u()}, size, {1, 2, 3}};
      for (const double part : {1.0, 0.3, 0.09}) {
        add(input, placed({"tetrahedron", tetrahedron({}, part), 1, true}, at).polygons);
      }
      const auto audited = certified(input);
      ASSERT_EQ(audited.complex().blocks().size(), 4U) << size;
      std::vector<std::uint32_t> shells;
      for (const topology::Block& block : audited.complex().blocks()) shells.push_back(block.counts.shells);
      std::ranges::sort(shells);
      EXPECT_EQ(shells, (std::vector<std::uint32_t>{1, 2, 2, 2})) << size;
    }
  }
}

TEST(Nesting, PiecesBesideOneAnother) {
  // A speck just off a face of a large piece, on either side of it.
  const geometry::Vec3 middle{5, 5, 5};
  for (const double off : {-1e-3, -1e-9, -3e-10, 3e-10, 1e-9, 1e-3}) {
    for (const double size : {1e-4, 1e-10, 5e-11}) {
      auto input = scene(box({0, 0, 0}, {10, 10, 10}));
      add(input, tetrahedron(middle, 2));
      const geometry::Vec3 out = geometry::normalized({1, 1, -1});
      if (std::abs(off) < 3 * size) continue;
      add(input, tetrahedron(middle + (2 / std::sqrt(3) + off) * out, size));
      const auto audited = certified(input);
      ASSERT_EQ(audited.complex().blocks().size(), 3U) << off << ", " << size;
      std::vector<std::pair<double, std::uint32_t>> own;
      for (const topology::Block& b : audited.complex().blocks()) own.emplace_back(b.volume.si(), b.counts.shells);
      std::ranges::sort(own);
      EXPECT_EQ(own[0].second, 1U);
      EXPECT_EQ(own[1].second, off < 0 ? 2U : 1U) << off << ", " << size;
      EXPECT_EQ(own[2].second, off < 0 ? 2U : 3U) << off << ", " << size;
    }
  }
}

TEST(Lattice, JointsFarOutsideChangeNothing) {
  const auto input = [](bool far) {
    auto made = scene(box({0, 0, 0}, {10, 10, 10}),
                      {rectangle(2, 5, {-1, -1}, {11, 11}), rectangle(2, 5 + 1e-6, {-1, -1}, {11, 11})});
    if (far) {
      made.joints.emplace_back(rectangle(0, 5e8, {5e8, 5e8}, {5e8 + 10, 5e8 + 10}));
      made.joints.emplace_back(topology::PersistentJoint{{5e8, 0, 0}, {1, 0, 0}});
    }
    return made;
  };
  EXPECT_EQ(count_blocks(input(false)), 3U);
  EXPECT_EQ(count_blocks(input(true)), 3U);
  EXPECT_EQ(hash_of(input(true)), hash_of(input(false)));
}

TEST(Convex, WhereAnExcavationEndsAtAJoint) {
  auto input = scene(box({0, 0, 0}, {10, 10, 10}), {rectangle(2, 5, {-1, -1}, {11, 11})}, {box({3, 3, 5}, {7, 7, 8})});
  const auto audited = certified(input);
  ASSERT_EQ(audited.complex().blocks().size(), 2U);
  for (const topology::Block& block : audited.complex().blocks()) {
    EXPECT_EQ(block.convex, block.centroid.z < 5) << "the one below is a cuboid, whatever is on the other side";
  }
}

}  // namespace
}  // namespace cleave::testing
