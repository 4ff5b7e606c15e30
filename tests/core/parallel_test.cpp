#include "cleave/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <string>
#include <thread>

namespace cleave {
namespace {

TEST(ParallelTest, CallsEveryIndexOnce) {
  for (const std::size_t threads : {1U, 2U, 7U}) {
    for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, ThreadLimit{threads}, [&](std::size_t i) { ++calls[i]; });
      for (const auto& c : calls) EXPECT_EQ(c.load(), 1);
    }
  }
}

TEST(ParallelTest, MapKeepsTheOrderOfTheIndices) {
  const auto text = [](std::size_t i) { return std::to_string(i); };
  const auto one = parallel_map(500, ThreadLimit::one(), text);
  ASSERT_EQ(one.size(), 500U);
  EXPECT_EQ(one[321], "321");
  EXPECT_EQ(parallel_map(500, ThreadLimit{4}, text), one);
}

TEST(ParallelTest, OneThreadIsTheCallersOwnInOrder) {
  std::vector<std::size_t> order;
  const auto caller = std::this_thread::get_id();
  parallel_for(100, ThreadLimit::one(), [&](std::size_t i) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(i);
  });
  ASSERT_EQ(order.size(), 100U);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

TEST(ParallelTest, UsesNoMoreThreadsThanAllowed) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  parallel_for(10'000, ThreadLimit{2}, [&](std::size_t) {
    const std::scoped_lock lock{mutex};
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_LE(seen.size(), 2U);
  EXPECT_GE(ThreadLimit::all().count(), 1U);
}

TEST(ParallelTest, CanBeNested) {
  std::atomic<int> calls{0};
  parallel_for(8, ThreadLimit{2}, [&](std::size_t) { parallel_for(8, ThreadLimit{2}, [&](std::size_t) { ++calls; }); });
  EXPECT_EQ(calls.load(), 64);
}

}  // namespace
}  // namespace cleave
