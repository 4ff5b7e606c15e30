#include <algorithm>
#include <optional>
#include <string_view>

#include "cleave/scene/plan.hpp"

namespace cleave::scene {
namespace {

std::optional<Step> step_named(std::string_view name) {
  const auto it = std::ranges::find(all_steps, name, [](Step step) { return name_of(step); });
  return it == all_steps.end() ? std::nullopt : std::optional{*it};
}

}  // namespace

RunCost cost_of(const StageTimer& timer, unsigned threads) {
  const cleave::StageCost total = timer.total();
  RunCost cost{
      .wall_s = total.wall_s, .cpu_s = total.cpu_s, .peak_rss_mb = total.peak_rss_mb, .threads = threads, .steps = {}};
  for (const cleave::StageCost& booked : timer.stages()) {
    if (const auto step = step_named(booked.stage)) {
      const auto earlier = std::ranges::find(cost.steps, *step, &StepCost::step);
      if (earlier != cost.steps.end()) {  // several windows were cut
        earlier->wall_s += booked.wall_s;
        earlier->cpu_s += booked.cpu_s;
        earlier->peak_rss_mb = std::max(earlier->peak_rss_mb, booked.peak_rss_mb);
        continue;
      }
      cost.steps.push_back({*step, booked.wall_s, booked.cpu_s, booked.peak_rss_mb});
    }
  }
  return cost;
}

}  // namespace cleave::scene
