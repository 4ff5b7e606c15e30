/// `bench_cut_once WORKLOAD`: one cut with its certificate on one thread, for counting instructions (under callgrind,
/// which collects inside `cleave_bench_measured` only), with the number of allocations. Prints one line:
/// `blocks allocations allocated_bytes exact_share`. Exit code 1 when the answer is wrong.

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <span>
#include <string_view>
#include <utility>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "workloads.hpp"

namespace {

struct Allocations {
  std::uint64_t count = 0, bytes = 0;
};
Allocations allocations;

void* counted(std::size_t size) {
  ++allocations.count;
  allocations.bytes += size;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc{};
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

/// What is measured. Not inlined and with a plain name, so that callgrind finds it.
extern "C" [[gnu::noinline]] bool cleave_bench_measured(const cleave::topology::CutInput& input, std::uint64_t& blocks,
                                                        double& exact_share) {
  auto complex = cleave::topology::cut(input);
  if (!complex) return false;
  const auto audited = cleave::topology::audit(*std::move(complex));
  if (!audited) return false;
  blocks = audited->complex().blocks().size();
  const auto& report = audited->complex().report();
  exact_share = report.predicate_calls == 0
                    ? 0
                    : static_cast<double>(report.predicate_exact) / static_cast<double>(report.predicate_calls);
  return true;
}

int main(int argc, char** argv) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::string_view name = argc > 1 ? argv[1] : "";
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  const auto workload = cleave::support::workload_named(name);
  if (!workload) {
    fmt::print(stderr, "error: no workload '{}'\n", name);
    return 2;
  }
  const auto input = cleave::support::cut_input(*workload);
  std::uint64_t blocks = 0;
  double exact_share = 0;
  const Allocations before = allocations;
  const bool good = cleave_bench_measured(input, blocks, exact_share);
  const Allocations after = allocations;
  if (!good || (workload->blocks && *workload->blocks != blocks)) {
    fmt::print(stderr, "error: {}: wrong answer\n", name);
    return 1;
  }
  fmt::print("{} {} {} {:.4g}\n", blocks, after.count - before.count, after.bytes - before.bytes, exact_share);
  return 0;
}
