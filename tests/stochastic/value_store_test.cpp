#include "cleave/stochastic/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cleave::stochastic {
namespace {

TEST(ValueStoreTest, GivesBackEverythingInOrderAsOftenAsAsked) {
  for (const std::size_t n : {0U, 1U, 2047U, 2048U, 2049U, 4096U, 100'000U}) {
    ValueStore store;
    std::vector<double> expected;
    for (std::size_t i = 0; i < n; ++i) {
      store.push_back(std::sqrt(static_cast<double>(i)));
      expected.push_back(std::sqrt(static_cast<double>(i)));
    }
    EXPECT_EQ(store.size(), n);
    EXPECT_EQ(store.empty(), n == 0);
    EXPECT_EQ(store.all(), expected) << n;
    // Goes on after it was read.
    for (std::size_t i = 0; i < 3000; ++i) {
      store.push_back(-1.5);
      expected.push_back(-1.5);
    }
    EXPECT_EQ(store.all(), expected) << n;
  }
}

}  // namespace
}  // namespace cleave::stochastic
