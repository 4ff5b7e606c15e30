#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cleave/core/rng.hpp"
#include "cleave/topology/block_complex.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Which block holds a point, beside solid angles: what a point sees of a block's surface, over the whole sphere. 1
// inside, 0 outside, a half on a face.

namespace cleave::testing::queries_test {
namespace {

using topology::BlockComplex;
using topology::BlockId;
using topology::BlockLocator;

double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(dot(a, cross(b, c)), below);
}
double seen_from(const BlockComplex& complex, BlockId block, Vec3 p) {
  double sum = 0;
  for (const topology::FaceId face : complex.blocks()[block].faces) {
    for (const auto& loop : complex.loops(complex.faces()[face])) {
      for (std::size_t i = 2; i < loop.size(); ++i) {
        sum += solid_angle(complex.position(loop[0]) - p, complex.position(loop[i - 1]) - p,
                           complex.position(loop[i]) - p);
      }
    }
  }
  return sum / (4 * std::numbers::pi);
}

topology::CutInput planes_through(topology::CutInput input, const std::vector<double>& at) {
  for (const double x : at) {
    for (const Vec3 normal : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      input.joints.emplace_back(topology::PersistentJoint{{x, x, x}, normal});
    }
  }
  return input;
}

std::vector<BlockComplex> complexes() {
  std::vector<BlockComplex> out;
  for (const char* name : {"deg-cavity", "deg-ring", "rect-13"}) {
    out.push_back(topology::cut(support::cut_input(support::workload_named(name).value())).value());
  }
  auto shaft =
      scene(box({0, 0, 0}, {4, 4, 4}), {rectangle(2, 2, {-1, -1}, {5, 5}), rectangle(1, 1.5, {-1, -1}, {5, 2})},
            {box({1, 1, -1}, {3, 3, 5})});
  out.push_back(topology::cut(shaft).value());
  return out;
}

Vec3 somewhere_in(const BlockComplex& complex, Rng& rng) {
  geometry::Box around;
  for (const topology::VertexId v : complex.vertices().ids()) around.add(complex.position(v));
  const Vec3 size = around.size();
  return around.min + Vec3{size.x * (1.1 * rng.uniform() - 0.05), size.y * (1.1 * rng.uniform() - 0.05),
                           size.z * (1.1 * rng.uniform() - 0.05)};
}

void expect_as_seen(const BlockComplex& complex, const BlockLocator& locator, Vec3 p) {
  const auto found = locator.block_at(p);
  for (const BlockId id : complex.blocks().ids()) {
    const double seen = seen_from(complex, id, p);
    if (seen < 0.01) {
      EXPECT_NE(found, id) << p.x << ' ' << p.y << ' ' << p.z;
    } else {
      ASSERT_TRUE(found.has_value()) << p.x << ' ' << p.y << ' ' << p.z;
      EXPECT_LE(*found, id);  // the lowest of those that share it
    }
  }
}

TEST(BlockLocator, AgreesWithSolidAngles) {
  Rng rng{{.seed = 7}};
  for (const BlockComplex& complex : complexes()) {
    const BlockLocator locator{complex};
    for (int k = 0; k < 300; ++k) expect_as_seen(complex, locator, somewhere_in(complex, rng));
  }
}

// On faces, edges and corners of blocks that are not convex: whole and half numbers in a scene on whole numbers.
TEST(BlockLocator, BlocksHoldTheirFaces) {
  const BlockComplex complex = complexes().back();
  EXPECT_TRUE(std::ranges::any_of(complex.blocks(), [](const topology::Block& b) { return !b.convex; }));
  const BlockLocator locator{complex};
  for (int i = -1; i <= 9; ++i) {
    for (int j = -1; j <= 9; ++j) {
      for (int k = -1; k <= 9; ++k) {
        const Vec3 p{0.5 * i, 0.5 * j, 0.5 * k};
        const bool outside = std::min({i, j, k}) < 0 || std::max({i, j, k}) > 8;
        const bool shaft = i > 2 && i < 6 && j > 2 && j < 6;
        EXPECT_EQ(locator.block_at(p).has_value(), !outside && !shaft) << p.x << ' ' << p.y << ' ' << p.z;
      }
    }
  }
}

// The neighbour of a double to either side of a plane is on that side, far from the origin too.
TEST(BlockLocator, IsExactBesidePlanes) {
  for (const Vec3 shift : {Vec3{0, 0, 0}, Vec3{4096000, -512000, 1024}}) {
    const auto input = scene(box(shift, shift + Vec3{3, 3, 3}));
    auto cut_at = input;
    for (const double x : {1.0, 2.0}) {
      for (const Vec3 normal : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        cut_at.joints.emplace_back(topology::PersistentJoint{shift + Vec3{x, x, x}, normal});
      }
    }
    const BlockComplex complex = topology::cut(cut_at).value();
    ASSERT_EQ(complex.blocks().size(), 27U);
    const BlockLocator locator{complex};
    for (const BlockId id : complex.blocks().ids()) {
      EXPECT_EQ(locator.block_at(complex.blocks()[id].centroid), id);
    }
    const Vec3 on = shift + Vec3{1, 0.5, 0.5};
    const auto left = locator.block_at(shift + Vec3{0.5, 0.5, 0.5}),
               right = locator.block_at(shift + Vec3{1.5, 0.5, 0.5});
    const double far = std::numeric_limits<double>::infinity();
    EXPECT_EQ(locator.block_at({std::nextafter(on.x, -far), on.y, on.z}), left);
    EXPECT_EQ(locator.block_at({std::nextafter(on.x, far), on.y, on.z}), right);
    EXPECT_EQ(locator.block_at(on), std::min(*left, *right));
    // The domain holds its sides, and nothing beyond.
    EXPECT_EQ(locator.block_at({shift.x, on.y, on.z}), left);
    EXPECT_FALSE(locator.block_at({std::nextafter(shift.x, -far), on.y, on.z}));
    EXPECT_FALSE(locator.block_at({std::nan(""), on.y, on.z}));
    EXPECT_FALSE(locator.block_at({far, on.y, on.z}));
  }
}

TEST(Neighbours, AreThoseAcrossJoints) {
  const BlockComplex grid = topology::cut(planes_through(scene(box({0, 0, 0}, {3, 3, 3})), {1, 2})).value();
  std::size_t inner = 0;
  for (const BlockId id : grid.blocks().ids()) {
    const auto around = neighbours_of(grid, id);
    EXPECT_TRUE(std::ranges::is_sorted(around));
    for (const BlockId other : grid.blocks().ids()) {
      // Cubes of 1 m that share a face are 1 m apart.
      const double apart = norm(grid.blocks()[id].centroid - grid.blocks()[other].centroid);
      EXPECT_EQ(std::ranges::binary_search(around, other), std::abs(apart - 1) < 1e-9);
    }
    if (around.size() == 6) ++inner;
  }
  EXPECT_EQ(inner, 1U);
  for (const BlockComplex& complex : complexes()) {
    for (const BlockId id : complex.blocks().ids()) {
      for (const BlockId other : neighbours_of(complex, id)) {
        EXPECT_TRUE(std::ranges::binary_search(neighbours_of(complex, other), id));
      }
    }
  }
}

}  // namespace
}  // namespace cleave::testing::queries_test
