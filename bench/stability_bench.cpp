/// Mode and factor of safety of single blocks, and the batches of a tunnel in rect-N against the cost of its cutting;
/// one thread. Answers checked.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <ctime>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "contacts.hpp"
#include "handmade.hpp"
#include "statics.hpp"
#include "verdict.hpp"
#include "workloads.hpp"

namespace cleave {
namespace {

using geometry::Vec3;

struct Loaded {
  stability::Contacts contacts;
  stability::Resultant resultant;
};

/// Blocks of eight joint faces: normals about a random axis, so that the block can move.
std::vector<Loaded> random_blocks(std::size_t count, bool exact) {
  Rng rng{{.seed = 3, .realization = 0, .purpose = 21, .index = 0}};
  const auto unit = [&] {
    for (;;) {
      const Vec3 v{2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1};
      if (norm(v) > 0.1 && norm(v) < 1) return geometry::normalized(v);
    }
  };
  std::vector<Loaded> blocks;
  while (blocks.size() < count) {
    const Vec3 axis = unit();
    std::vector<stability::Direction> rows;
    while (rows.size() < 8) {
      const Vec3 n = unit();
      if (dot(n, axis) > 0.1) rows.push_back(handmade::direction(n));
    }
    Loaded block{.contacts = {.cone = stability::Cone{rows}, .groups = {}, .exposed = true},
                 .resultant = stability::Resultant::along({0, 0, -1}, newtons(1))};
    if (!exact) block.resultant.add({0.1, 0.05, 0}, 0.2);
    for (std::size_t i = 0; i < block.contacts.cone.groups().size(); ++i) {
      stability::Contact contact{.face = topology::FaceId{static_cast<std::uint32_t>(i)}};
      contact.area = 1;
      contact.straight_area = 1;
      contact.tan_friction = 0.5;
      block.contacts.groups.push_back(std::move(contact));
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

void mode_and_factor(benchmark::State& state) {
  const auto blocks = random_blocks(1000, state.range(0) == 0);
  const stability::Settings settings = statics::settings({statics::strength(26.565)});
  double worst = 0;
  std::size_t moving = 0;
  for (auto _ : state) {
    moving = 0;
    for (const Loaded& block : blocks) {
      const auto verdict = stability::judge(block.contacts, block.resultant, settings);
      worst = std::max(worst, verdict.residual);
      moving += stability::moves(verdict.mode) ? 1U : 0U;
    }
  }
  if (worst > 1e-12 || moving < 300) state.SkipWithError("statics do not close, or hardly any block moves");
  state.counters["blocks/s"] =
      benchmark::Counter(static_cast<double>(blocks.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void removability(benchmark::State& state) {
  const auto blocks = random_blocks(1000, true);
  std::size_t removable = 0;
  for (auto _ : state) {
    removable = 0;
    for (const Loaded& block : blocks) removable += block.contacts.cone.dimension() > 0 ? 1U : 0U;
  }
  if (removable != blocks.size()) state.SkipWithError("all of them can move");
  state.counters["blocks/s"] =
      benchmark::Counter(static_cast<double>(blocks.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void batches_of_a_tunnel(benchmark::State& state) {
  // Processor time: other programs on the machine do not count.
  const auto now = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  topology::CutInput input = support::cut_input(support::rectangles(static_cast<std::uint32_t>(state.range(0))));
  input.excavations.push_back(geometry::make_box({35, -1, 25}, {45, 81, 35}).value());
  const double start = now();
  auto cut = topology::cut(input);
  const double cutting = now() - start;
  if (!cut) {
    state.SkipWithError("not cut");
    return;
  }
  const auto complex = topology::audit(*std::move(cut));
  if (!complex) {
    state.SkipWithError("the certificate did not pass");
    return;
  }
  stability::Settings settings = statics::settings({statics::strength(25)});
  double seconds = 0;
  std::size_t batches = 0, key = 0;
  for (auto _ : state) {
    const double before = now();
    const auto analysis = stability::analyse(*complex, settings);
    seconds = now() - before;
    batches = analysis.batches.size();
    key = 0;
    for (const auto& batch : analysis.batches) key += batch.blocks.size();
    if (analysis.equilibrium_residual > 1e-12) state.SkipWithError("statics do not close");
  }
  state.counters["blocks"] = static_cast<double>(complex->complex().blocks().size());
  state.counters["batches"] = static_cast<double>(batches);
  state.counters["key_blocks"] = static_cast<double>(key);
  state.counters["share_of_cutting"] = seconds / cutting;
}

BENCHMARK(mode_and_factor)->Arg(0)->Arg(1);
BENCHMARK(removability);
BENCHMARK(batches_of_a_tunnel)->Arg(50)->Arg(100)->Unit(benchmark::kMillisecond)->Iterations(2);

}  // namespace
}  // namespace cleave
