#include "cleave/core/cost.hpp"

#ifndef __wasm__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string_view>
#include <system_error>

namespace cleave {
namespace {

#ifndef __wasm__
/// VmHWM of this process, KiB; 0 where it is not told. What getrusage tells was taken over from the process that
/// started this one.
double high_water_kib() noexcept {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file{std::fopen("/proc/self/status", "re")};
  if (!file) return 0;
  std::array<char, 256> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), file.get()) != nullptr) {
    const std::string_view text{line.data()};
    constexpr std::string_view key = "VmHWM:";
    if (!text.starts_with(key)) continue;
    const std::string_view rest = text.substr(std::min(text.find_first_not_of(" \t", key.size()), text.size()));
    std::uint64_t kib = 0;
    const auto [end, failure] = std::from_chars(rest.data(), std::to_address(rest.end()), kib);
    return failure == std::errc{} && end != rest.data() ? static_cast<double>(kib) : 0;
  }
  return 0;
}
#endif

}  // namespace

double peak_memory_mb() noexcept {
#ifdef __wasm__
  return static_cast<double>(__builtin_wasm_memory_size(0)) * 65536e-6;  // it never shrinks
#else
  if (const double kib = high_water_kib(); kib > 0) return kib * 1024.0 * 1e-6;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
  return static_cast<double>(usage.ru_maxrss) * 1024.0 * 1e-6;  // Linux counts in KiB
#endif
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
