/// The cutter with its certificate, on one thread: blocks per second of processor time, block counts checked.

#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "workloads.hpp"

namespace cleave {
namespace {

using support::Workload;

/// From here on the kernel's high-water mark of this process counts anew. Only benchmarks do this: it hides the past.
void forget_peak_memory() {
  malloc_trim(0);
  std::ofstream{"/proc/self/clear_refs"} << 5;
}

double peak_memory_since_mb() {
  std::ifstream status{"/proc/self/status"};
  double kib = 0.0;
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") status >> kib;
  }
  return kib * 1024.0 / 1e6;
}

void cut_and_audit(benchmark::State& state, Workload (*make)(std::uint32_t)) {
  const Workload workload = make(static_cast<std::uint32_t>(state.range(0)));
  const topology::CutInput input = support::cut_input(workload);
  forget_peak_memory();
  std::uint64_t blocks = 0;
  double exact_share = 0.0;
  for (auto _ : state) {
    auto complex = topology::cut(input);
    if (!complex) {
      state.SkipWithError(describe(complex.error()).c_str());
      return;
    }
    const auto audited = topology::audit(*std::move(complex));
    if (!audited) {
      state.SkipWithError("the certificate did not pass");
      return;
    }
    blocks = audited->complex().blocks().size();
    const auto& report = audited->complex().report();
    if (report.predicate_calls > 0) {
      exact_share = static_cast<double>(report.predicate_exact) / static_cast<double>(report.predicate_calls);
    }
    if (audited->certificate().volume_relative_error > 1e-12) state.SkipWithError("the volumes do not add up");
  }
  if (workload.blocks && blocks != *workload.blocks) state.SkipWithError("wrong number of blocks");
  state.counters["blocks"] = static_cast<double>(blocks);
  state.counters["blocks/s"] =
      benchmark::Counter(static_cast<double>(blocks), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["exact_share"] = exact_share;
  const double peak_mb = peak_memory_since_mb();
  state.counters["peak_mb"] = peak_mb;
  state.counters["bytes/block"] = 1e6 * peak_mb / static_cast<double>(std::max<std::uint64_t>(1, blocks));
  state.counters["ns/block"] = benchmark::Counter(
      1e-9 * static_cast<double>(blocks), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// NOLINTBEGIN(cppcoreguidelines-interfaces-global-init): registration is Google Benchmark's way
BENCHMARK_CAPTURE(cut_and_audit, grid, support::grid)->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cut_and_audit, gridr, support::rotated_grid)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cut_and_audit, persist, support::persistent)
    ->Arg(13)
    ->Arg(26)
    ->Arg(39)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cut_and_audit, rect, support::rectangles)->Arg(13)->Arg(50)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(cut_and_audit, disc, support::discs)->Arg(1000)->Arg(5000)->Unit(benchmark::kMillisecond);
// NOLINTEND(cppcoreguidelines-interfaces-global-init)

}  // namespace
}  // namespace cleave
