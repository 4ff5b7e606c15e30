// Interior points, which look for motion that no path leads to, against key block theory and the cases.

#include <gtest/gtest.h>

#include <vector>

#include "branch.hpp"
#include "cases.hpp"
#include "cleave/core/rng.hpp"
#include "elements.hpp"
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
