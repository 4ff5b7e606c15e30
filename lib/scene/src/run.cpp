#include "cleave/scene/run.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/expected.hpp"
#include "judge.hpp"
#include "realizer.hpp"
#include "run_notes.hpp"

namespace cleave::scene {
namespace {

std::optional<Stage> stage_named(std::string_view name) {
  const auto it = std::ranges::find(all_stages, name, [](Stage stage) { return name_of(stage); });
  return it == all_stages.end() ? std::nullopt : std::optional{*it};
}

}  // namespace

RunCost cost_of(const StageTimer& timer, unsigned threads) {
  const cleave::StageCost total = timer.total();
  RunCost cost{
      .wall_s = total.wall_s, .cpu_s = total.cpu_s, .peak_rss_mb = total.peak_rss_mb, .threads = threads, .stages = {}};
  for (const cleave::StageCost& booked : timer.stages()) {
    if (const auto stage = stage_named(booked.stage)) {
      const auto earlier = std::ranges::find(cost.stages, *stage, &StageCost::stage);
      if (earlier != cost.stages.end()) {  // several windows were cut
        earlier->wall_s += booked.wall_s;
        earlier->cpu_s += booked.cpu_s;
        earlier->peak_rss_mb = std::max(earlier->peak_rss_mb, booked.peak_rss_mb);
        continue;
      }
      cost.stages.push_back({*stage, booked.wall_s, booked.cpu_s, booked.peak_rss_mb});
    }
  }
  return cost;
}

std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options, StageTimer& timer,
                                                   Progress& progress) {
  Plan plan = make_plan(scene);
  Realizer realizer{scene, options, Detail::shown, timer, progress};
  const auto done = realizer.execute(plan);
  progress.end();
  if (!done) return std::unexpected(done.error());
  RunResult result{std::move(realizer).take()};
  result.notes = notes_of(scene, result);
  result.title = scene.title;
  result.seed = scene.seed;
  result.scene_file = scene.file_name;
  result.scene_sha256 = scene.sha256;
  result.files = scene.files;
  result.north = scene.north;
  result.plan = std::move(plan);
  result.cost = cost_of(timer, options.threads);
  result.output = scene.output;
  result.rock = scene.rock;
  result.stability = scene.stability;
  for (const Excavation& excavation : scene.excavations) {
    result.excavations.push_back({excavation.name, excavation.stage, excavation.tunnel});
  }
  result.micro_blocks = scene.micro_blocks;
  if (scene.support) result.bolt_groups = scene.support->groups;
  result.tunnel_length = tunnel_length(scene);
  result.figures = count(result);
  return result;
}

}  // namespace cleave::scene
