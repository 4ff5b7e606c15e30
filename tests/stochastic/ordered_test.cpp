#include "cleave/stochastic/ordered.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

namespace cleave::stochastic {
namespace {

/// Work that takes very different time from item to item.
double spin(std::uint64_t k) {
  double x = 0;
  for (std::uint64_t i = 0; i < (k % 7 == 0 ? 200'000U : 500U); ++i) x += std::sqrt(static_cast<double>(i + k));
  return x;
}

TEST(OrderedTest, CommitsInOrderWhateverTheThreads) {
  for (const std::size_t threads : {1U, 2U, 5U}) {
    std::vector<std::uint64_t> seen;
    run_ordered(3, 400, 4, ThreadLimit{threads}, 16, [&](std::uint64_t k) -> std::function<bool()> {
      const double x = spin(k);
      return [&, k, x] {
        EXPECT_EQ(x, spin(k));
        seen.push_back(k);
        return true;
      };
    });
    ASSERT_EQ(seen.size(), 100U);
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], 3 + 4 * i);
  }
}

TEST(OrderedTest, NothingIsMadeFarAheadOfTheCommits) {
  std::atomic<std::uint64_t> committed{0};
  std::atomic<bool> ahead{false};
  run_ordered(0, 500, 1, ThreadLimit{2}, 8, [&](std::uint64_t k) -> std::function<bool()> {
    if (k > committed + 8) ahead = true;
    const double x = spin(k);
    return [&, x] {
      ++committed;
      return x >= 0;
    };
  });
  EXPECT_FALSE(ahead);
  EXPECT_EQ(committed, 500U);
}

TEST(OrderedTest, StopsWhenACommitSaysSo) {
  for (const std::size_t threads : {1U, 2U}) {
    std::uint64_t commits = 0;
    run_ordered(0, 1'000'000, 1, ThreadLimit{threads}, 8,
                [&](std::uint64_t) -> std::function<bool()> { return [&] { return ++commits < 5; }; });
    EXPECT_EQ(commits, 5U);
  }
}

}  // namespace
}  // namespace cleave::stochastic
