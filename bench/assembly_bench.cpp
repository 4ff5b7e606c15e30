/// Key groups of 1,000 and 10,000 blocks judged together with moments; one thread. Answers checked.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cleave/assembly/groups.hpp"
#include "lattice.hpp"

namespace cleave {
namespace {

/// Whether the loose cubes and nothing else move, each with its factor.
bool right(const assembly::Groups& found, const assembly::test::Lattice& lattice) {
  std::vector<std::uint32_t> moving;
  for (const assembly::Group& group : found.groups) {
    const bool known = group.verdict == assembly::Verdict::certain && group.bodies.size() == 1 &&
                       std::abs(group.moving.factor - lattice.factor) < 1e-6;
    if (!known) return false;
    moving.push_back(group.bodies.front());
  }
  return moving == lattice.loose;
}

void key_groups(benchmark::State& state) {
  const assembly::test::Lattice lattice = assembly::test::lattice(static_cast<std::uint32_t>(state.range(0)));
  const assembly::Assembly whole = lattice.builder.made();
  assembly::Groups found;
  for (auto _ : state) found = assembly::find_groups(whole);
  if (!right(found, lattice)) state.SkipWithError("not the loose cubes, or not with their factor");
  state.counters["blocks"] = static_cast<double>(whole.bodies().size());
}
BENCHMARK(key_groups)->Arg(22)->Arg(68)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cleave
