#include <gtest/gtest.h>

#include <numeric>

#include "cleave/core/rng.hpp"
#include "complexes.hpp"

// Many planes through one line or one point.

namespace cleave::testing {
namespace {

/// Directions of whole numbers round half a turn, none parallel to another.
std::vector<std::array<int, 2>> directions(std::size_t count) {
  std::vector<std::array<int, 2>> out;
  for (int sum = 1; out.size() < count; ++sum) {
    for (int x = 1 - sum; x <= sum && out.size() < count; ++x) {
      const int y = sum - std::abs(x);
      if (std::gcd(x, y) == 1) out.push_back({x, y});
    }
  }
  return out;
}

TEST(OneLine, PlanesThroughIt) {
  for (const std::size_t count : {3U, 40U, 200U}) {
    auto input = scene(box({-8, -8, -8}, {8, 8, 8}));
    for (const auto& [x, y] : directions(count)) {
      input.joints.emplace_back(
          topology::PersistentJoint{{1, 2, 0}, {static_cast<double>(x), static_cast<double>(y), 0}});
    }
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), 2 * count);
    // All pairs in all planes would be the cube.
    EXPECT_LT(audited.complex().report().predicate_calls, 100 * count * count + 1000);
  }
}

TEST(OneLine, RectanglesAlongPartsOfIt) {
  // Each level has two wedges for each rectangle that goes through it; many rectangles start and end together.
  Rng rng{5};
  constexpr int levels = 12;
  for (int k = 0; k < 30; ++k) {
    auto input = scene(box({-8, -8, 0}, {8, 8, levels}));
    for (int z = 1; z < levels; ++z) {
      input.joints.emplace_back(topology::PersistentJoint{{0, 0, static_cast<double>(z)}, {0, 0, 1}});
    }
    std::array<std::size_t, levels> through{};
    for (const auto& [x, y] : directions(2 + static_cast<std::size_t>(k))) {
      const auto from = rng.between(0, levels - 1), to = rng.between(from + 1, levels);
      for (auto z = from; z < to; ++z) ++through.at(static_cast<std::size_t>(z));
      const Vec3 out{16.0 * x, 16.0 * y, 0}, up{0, 0, 0.5 * static_cast<double>(to - from)};
      input.joints.emplace_back(parallelogram({0, 0, 0.5 * static_cast<double>(from + to)}, out, up));
    }
    std::size_t blocks = 0;
    for (const std::size_t n : through) blocks += std::max<std::size_t>(1, 2 * n);
    EXPECT_EQ(count_blocks(input), blocks);
  }
}

TEST(OneLine, OrderAndThreadsChangeNothing) {
  auto input = scene(box({-8, -8, 0}, {8, 8, 12}));
  Rng rng{6};
  for (const auto& [x, y] : directions(60)) {
    const auto from = rng.between(0, 11), to = rng.between(from + 1, 12);
    const Vec3 out{16.0 * x, 16.0 * y, 0}, up{0, 0, 0.5 * static_cast<double>(to - from)};
    input.joints.emplace_back(parallelogram({0, 0, 0.5 * static_cast<double>(from + to)}, out, up));
  }
  for (const double z : {2.0, 5.0, 7.0}) input.joints.emplace_back(topology::PersistentJoint{{0, 0, z}, {0, 0, 1}});
  const auto one = certified(input);
  const auto parallel = topology::cut(input, {.threads = 7}).value();
  EXPECT_EQ(canonical_hash(parallel), canonical_hash(one.complex()));
  EXPECT_EQ(parallel.report().predicate_calls, one.complex().report().predicate_calls);
  std::ranges::reverse(input.joints);
  EXPECT_EQ(hash_of(input), canonical_hash(one.complex()));
  std::ranges::rotate(input.joints, input.joints.begin() + 20);
  EXPECT_EQ(hash_of(input), canonical_hash(one.complex()));
}

TEST(OneLine, PlanesThatNearlyGoThroughIt) {
  // In general position: n (n + 1) / 2 + 1 regions of the plane across.
  for (const double off : {1e-7, 1e-9}) {
    Rng rng{7};
    auto input = scene(box({-8, -8, -8}, {8, 8, 8}));
    constexpr std::size_t count = 30;
    for (const auto& [x, y] : directions(count)) {
      const Vec3 through{1 + off * rng.uniform(), 2 + off * rng.uniform(), 0};
      input.joints.emplace_back(
          topology::PersistentJoint{through, {static_cast<double>(x), static_cast<double>(y), 0}});
    }
    EXPECT_EQ(count_blocks(input), count * (count + 1) / 2 + 1);
  }
}

TEST(OneLine, PlanesThroughOnePoint) {
  // n (n - 1) + 2 regions of space, where no three of them share a line.
  Rng rng{8};
  auto input = scene(box({-8, -8, -8}, {8, 8, 8}));
  constexpr std::size_t count = 24;
  std::vector<Vec3> normals;
  while (normals.size() < count) {
    const Vec3 n{static_cast<double>(rng.between(-9, 9)), static_cast<double>(rng.between(-9, 9)),
                 static_cast<double>(rng.between(1, 9))};
    bool general = true;
    for (std::size_t a = 0; a < normals.size(); ++a) {
      general = general && norm(cross(normals[a], n)) > 0.5;
      for (std::size_t b = 0; b < a; ++b) general = general && std::abs(dot(cross(normals[a], normals[b]), n)) > 0.5;
    }
    if (general) normals.push_back(n);
  }
  // Corners on whole numbers, so that all go exactly through the point.
  for (const Vec3& n : normals) {
    const Vec3 u = cross(n, std::abs(n.x) + std::abs(n.y) > 0 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}), v = cross(n, u);
    input.joints.emplace_back(parallelogram({1, 2, 3}, 64 * u, 64 * v));
  }
  EXPECT_EQ(count_blocks(input), count * (count - 1) + 2);
}

}  // namespace
}  // namespace cleave::testing
