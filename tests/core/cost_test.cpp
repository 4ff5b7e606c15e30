#include "cleave/core/cost.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace cleave {
namespace {

/// Spends processor time, whatever the machine's speed.
void burn(double seconds) {
  const double end = cpu_seconds() + seconds;
  while (cpu_seconds() < end) {
  }
}

TEST(StageTimerTest, BooksStagesInOrderAndReturnsTheWorksValue) {
  StageTimer timer;
  EXPECT_EQ(timer.run("read", [] { return 42; }), 42);
  timer.run("cut", [] { burn(0.02); });
  ASSERT_EQ(timer.stages().size(), 2U);
  EXPECT_EQ(timer.stages()[0].stage, "read");
  EXPECT_EQ(timer.stages()[1].stage, "cut");
  EXPECT_GE(timer.stages()[1].cpu_s, 0.02);
  EXPECT_GE(timer.total().cpu_s, timer.stages()[0].cpu_s + timer.stages()[1].cpu_s);
  EXPECT_GE(timer.total().wall_s, timer.stages()[0].wall_s + timer.stages()[1].wall_s);
}

TEST(PeakMemoryTest, SeesWhatWasHeldAndLetGo) {
  const double before = peak_memory_mb();
  EXPECT_GT(before, 1.0);
  constexpr std::size_t bytes = 200'000'000;
  {
    // Touched page by page: what is only reserved is not resident.
    const auto held = std::make_unique<std::vector<unsigned char>>(bytes, static_cast<unsigned char>(1));
    EXPECT_EQ(held->back(), 1);
  }
  EXPECT_GE(peak_memory_mb(), 200.0);
  EXPECT_GE(peak_memory_mb(), before);
  // The unit: the kernel's own high-water mark, in KiB.
  std::ifstream status{"/proc/self/status"};
  double kib = 0.0;
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") status >> kib;
  }
  EXPECT_NEAR(peak_memory_mb(), kib * 1024.0 / 1e6, 0.02 * peak_memory_mb());
}

}  // namespace
}  // namespace cleave
