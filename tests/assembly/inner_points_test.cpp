// Interior points, which look for motion that no path leads to, against key block theory and the cases.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "branch.hpp"
#include "cases.hpp"
#include "cleave/core/rng.hpp"
#include "elements.hpp"
#include "inner_points.hpp"
#include "theory.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

bool found_to_move(const Assembly& assembly, double divisor) {
  const Elements elements{assembly};
  const Branch branch{elements};
  const auto found = branch.by_inner_points(divisor);
  if (!found) return false;
  EXPECT_EQ(found->what, FromRest::moves);
  EXPECT_LE(violation(elements, divisor, found->state), exact_enough);
  return true;
}

TEST(InnerPoints, OneBlockMovesAboveItsFactorAndRestsBelow) {
  Rng rng{20261127};
  int finite = 0, missed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const std::vector<Side> sides = random_sides(rng);
    const double factor = conventional(sides, {0, 0, -1});
    const Assembly block = single(sides).made();
    if (factor == infinite) {
      EXPECT_FALSE(found_to_move(block, 1));
      continue;
    }
    ++finite;
    if (factor == 0) {
      missed += found_to_move(block, 1) ? 0 : 1;
      continue;
    }
    missed += found_to_move(block, 1.01 * factor) ? 0 : 1;
    EXPECT_FALSE(found_to_move(block, 0.99 * factor)) << factor;
  }
  EXPECT_GT(finite, 50);
  // Where friction locks as well, that may be what they find.
  EXPECT_LE(missed, finite / 3);
}

// Before anything is polished: forces that balance the load. Below the factor nothing moves; above it what moves does
// as the law says (friction that locks as well may be what they find).
TEST(InnerPoints, EndNearASolution) {
  Rng rng{20261128};
  int asked = 0, resting = 0, moving = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    const std::vector<Side> sides = random_sides(rng);
    const double factor = conventional(sides, {0, 0, -1});
    if (factor == infinite || factor == 0) continue;
    ++asked;
    const Assembly block = single(sides).made();
    const Elements elements{block};
    const std::vector<std::uint8_t> pressing(elements.all().size(), 1);
    const auto speed = [](const Near& near) { return near.state.v.lpNorm<Eigen::Infinity>(); };
    const Near below = by_inner_points(elements, 0.9 * factor, pressing, {});
    if (below.left < 1e-6) {
      ++resting;
      EXPECT_LT(speed(below), 1e-5);
    }
    const Near above = by_inner_points(elements, 1.1 * factor, pressing, {});
    if (!(above.left < 1e-6) || !(speed(above) > 1e-4)) continue;
    ++moving;
    EXPECT_LT(violation(elements, 1.1 * factor, above.state), 1e-4);
  }
  EXPECT_GT(asked, 50);
  EXPECT_GT(resting, asked * 9 / 10);
  EXPECT_GT(moving, asked / 2);
}

TEST(InnerPoints, Pairs) {
  const auto check = [](const Builder& b, double factor) {
    EXPECT_TRUE(found_to_move(b.made(), 1.1 * factor)) << factor;
    EXPECT_FALSE(found_to_move(b.made(), 0.99 * factor)) << factor;
  };
  check(toe(false), 0.942790);
  // Between rough sides it may lock: nothing is said to move that does not.
  EXPECT_FALSE(found_to_move(toe(true).made(), 0.99 * 0.942790));
  check(toe_section(), 0.894759);
}

}  // namespace
}  // namespace cleave::assembly
