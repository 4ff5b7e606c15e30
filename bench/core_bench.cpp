/// Random streams and hashing: what a draw of a joint and the hash of a block system cost.

#include <benchmark/benchmark.h>

#include <string>

#include "cleave/core/rng.hpp"
#include "cleave/core/sha256.hpp"

namespace cleave {
namespace {

/// A new stream for every number, as the drawing of joints uses them.
void keyed_uniform(benchmark::State& state) {
  std::uint32_t index = 0;
  double sum = 0.0;
  for (auto _ : state) {
    Rng rng{StreamKey{.seed = 1, .realization = 0, .purpose = 1, .index = index++}};
    sum += rng.uniform();
  }
  const double mean = sum / static_cast<double>(index);
  if (index > 10'000 && (mean < 0.45 || mean > 0.55)) state.SkipWithError("the mean of uniform numbers is not 1/2");
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(keyed_uniform);

void sha256_of_a_megabyte(benchmark::State& state) {
  const std::string text(1'000'000, 'a');
  std::string digest;
  for (auto _ : state) digest = sha256_hex(text);
  if (digest != "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0") {
    state.SkipWithError("not the published digest");
  }
  state.SetBytesProcessed(state.iterations() * 1'000'000);
}
BENCHMARK(sha256_of_a_megabyte);

}  // namespace
}  // namespace cleave
