#include "cleave/core/cost.hpp"

#include <sys/resource.h>

#include <chrono>
#include <ctime>

namespace cleave {

double peak_memory_mb() noexcept {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
  return static_cast<double>(usage.ru_maxrss) * 1024.0 * 1e-6;  // Linux counts in KiB
}

double cpu_seconds() noexcept {
  timespec t{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t) != 0) return 0.0;
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

StageTimer::StageTimer() : start_{now()} {}

StageTimer::Clock StageTimer::now() noexcept {
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {.wall_s = std::chrono::duration<double>(wall).count(), .cpu_s = cpu_seconds()};
}

StageCost StageTimer::since(Clock start, std::string_view stage) {
  const Clock end = now();
  return {.stage = std::string{stage},
          .wall_s = end.wall_s - start.wall_s,
          .cpu_s = end.cpu_s - start.cpu_s,
          .peak_rss_mb = peak_memory_mb()};
}

StageCost StageTimer::total() const { return since(start_, "total"); }

}  // namespace cleave
