#include "cleave/scene/plan_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cleave/core/enum_names.hpp"

namespace cleave::scene {

std::string_view name_of(Stage stage) noexcept { return enum_name(stage); }

bool Plan::runs(Stage stage) const noexcept {
  return std::ranges::any_of(stages,
                             [&](const PlannedStage& planned) { return planned.stage == stage && planned.run; });
}

std::string describe(const Plan& plan, bool inputs) {
  std::string text;
  for (const PlannedStage& stage : plan.stages) {
    text += fmt::format("  {:<12} {:<9} {}", name_of(stage.stage), stage.run ? "run" : "left out", stage.why);
    if (inputs && stage.run && !stage.inputs.empty()) text += fmt::format(" [{}]", fmt::join(stage.inputs, ", "));
    if (inputs && stage.run && stage.seconds >= 0.1) text += fmt::format(" (about {:.1f} s)", stage.seconds);
    text += "\n";
  }
  return text;
}

void add_inputs(const KeyTable& keys, const std::vector<std::string>& given, Plan& plan) {
  for (const auto& [stage, names] : keys.steps) {
    const auto planned = std::ranges::find(plan.stages, stage, &PlannedStage::stage);
    if (planned == plan.stages.end() || !planned->run) continue;
    for (const std::string_view name : names) {
      if (std::ranges::find(given, name) != given.end()) planned->inputs.emplace_back(name);
    }
  }
}

ResultHead head_of(const SceneHead& scene, Plan plan) {
  return {.title = scene.title,
          .project = scene.project,
          .seed = scene.seed,
          .scene_file = scene.file_name,
          .scene_sha256 = scene.sha256,
          .plan = std::move(plan),
          .output = scene.output};
}

Plan plan_of_bodies(Stage work, const std::string& why, const std::string& files, bool report) {
  const auto planned = [&](Stage stage) -> PlannedStage {
    if (stage == work) return {stage, true, why};
    switch (stage) {
      case Stage::read: return {stage, true, "the scene"};
      case Stage::draw:
      case Stage::cut:
      case Stage::audit:
      case Stage::stability: return {stage, false, "no [domain]: a scene of bodies"};
      case Stage::support: return {stage, false, "no [support]"};
      case Stage::monte_carlo: return {stage, false, "no [monte_carlo]: one run"};
      case Stage::elastic: return {stage, false, "no [elastic]: the bodies are in contact"};
      case Stage::contact: return {stage, false, "no contacts between bodies"};
      case Stage::write: return {stage, true, "summary.json, log.txt" + files};
      case Stage::report: return {stage, report, report ? "report.html" : "output.report = false"};
    }
    std::unreachable();
  };
  Plan plan;
  for (const Stage stage : all_stages) plan.stages.push_back(planned(stage));
  plan.estimate.blocks_low = plan.estimate.blocks_high = 0;
  return plan;
}

}  // namespace cleave::scene
