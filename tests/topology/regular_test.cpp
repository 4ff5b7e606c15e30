#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "complexes.hpp"

// The regular tests of Fu (2014), figure 3-9: blocks, faces and vertices, those of each block counted by themselves.

namespace cleave::testing {
namespace {

struct Totals {
  std::size_t blocks = 0, faces = 0, vertices = 0;
  friend bool operator==(const Totals&, const Totals&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Totals& t) {
    return out << t.blocks << " blocks, " << t.faces << " faces, " << t.vertices << " vertices";
  }
};
Totals totals(const topology::CutInput& input) {
  const auto audited = certified(input);
  Totals sum;
  for (const topology::Block& block : audited.complex().blocks()) {
    ++sum.blocks;
    sum.faces += block.counts.faces;
    sum.vertices += block.counts.vertices;
  }
  return sum;
}

// The one of 64,000 is among the large scenes.
TEST(Regular, EightThousandBlocks) {
  auto input = scene(box({0, 0, 0}, {1, 1, 1}));
  for (int k = 1; k < 20; ++k) {
    input.joints.emplace_back(topology::PersistentJoint{{0.05 * k, 0.5, 0.5}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.05 * k, 0.5}, {0, 1, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{0.5, 0.5, 0.05 * k}, {0, 0, 1}});
  }
  EXPECT_EQ(totals(input), (Totals{8000, 48000, 64000}));
}

/// Bodies given by their corners and the normals of their faces, side by side in one domain.
struct Bodies {
  std::vector<Vec3> vertices;
  std::vector<geometry::SolidFace> faces;

  void add(const std::vector<Vec3>& corners, const std::vector<Vec3>& normals, Vec3 at) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Vec3& c : corners) vertices.push_back(at + c);
    for (const Vec3& n : normals) {
      double furthest = 0;
      for (const Vec3& c : corners) furthest = std::max(furthest, geometry::dot(n, c));
      std::vector<std::uint32_t> on;
      Vec3 middle{};
      for (std::uint32_t k = 0; k < corners.size(); ++k) {
        if (geometry::dot(n, corners[k]) != furthest) continue;
        on.push_back(k);
        middle += corners[k];
      }
      middle = middle / static_cast<double>(on.size());
      const Vec3 u = corners[on[0]] - middle, v = geometry::cross(n, u) / geometry::norm(n);
      std::ranges::sort(on, {}, [&](std::uint32_t k) {
        const Vec3 d = corners[k] - middle;
        return std::atan2(geometry::dot(d, v), geometry::dot(d, u));
      });
      for (std::uint32_t& k : on) k += first;
      faces.push_back({std::move(on), 0});
    }
  }
};

std::vector<Vec3> with_signs(const std::vector<Vec3>& of) {  // all signs and cyclic orders, each once
  std::vector<Vec3> out;
  for (const Vec3& p : of) {
    for (const Vec3 q : {p, Vec3{p.y, p.z, p.x}, Vec3{p.z, p.x, p.y}}) {
      for (const double sx : {1.0, -1.0}) {
        for (const double sy : {1.0, -1.0}) {
          for (const double sz : {1.0, -1.0}) {
            const Vec3 signed_one{sx * q.x, sy * q.y, sz * q.z};
            if (std::ranges::find(out, signed_one) == out.end()) out.push_back(signed_one);
          }
        }
      }
    }
  }
  return out;
}

// Of the 160 blocks with 1,576 faces and 2,344 vertices only the numbers are known. Boxes (6 faces, 8 vertices),
// truncated octahedra (14, 24) and rhombic dodecahedra (12, 14) have them when there are 76, 56 and 28: the only
// numbers of these three bodies that do. (Bodies with three edges at each vertex alone cannot: V = 2 F - 4 for each.)
TEST(Regular, AHundredAndSixtyBlocks) {
  const std::vector<Vec3> axes = with_signs({{1, 0, 0}}), diagonals = with_signs({{1, 1, 1}}),
                          pairs = with_signs({{1, 1, 0}});
  std::vector<Vec3> fourteen = axes;
  fourteen.insert(fourteen.end(), diagonals.begin(), diagonals.end());
  Bodies bodies;
  for (int k = 0; k < 160; ++k) {
    const Vec3 at{6.0 * (k % 8), 6.0 * (k / 8 % 5), 6.0 * (k / 40)};
    if (k < 76) {
      bodies.add(diagonals, axes, at);
    } else if (k < 76 + 56) {
      bodies.add(with_signs({{0, 1, 2}, {0, 2, 1}}), fourteen, at);
    } else {
      bodies.add(with_signs({{1, 1, 1}, {2, 0, 0}}), pairs, at);
    }
  }
  auto domain = geometry::Solid::make(bodies.vertices, bodies.faces, {"surface"});
  ASSERT_TRUE(domain.has_value()) << describe(domain.error());
  EXPECT_EQ(totals(scene(std::move(*domain))), (Totals{160, 1576, 2344}));
}

}  // namespace
}  // namespace cleave::testing
