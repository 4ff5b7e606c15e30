#include "cleave/scene/plan_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cleave/core/fields.hpp"

namespace cleave::scene {

std::string_view name_of(Step step) noexcept { return enum_name(step); }

bool Plan::runs(Step step) const noexcept {
  return std::ranges::any_of(steps, [&](const PlannedStep& planned) { return planned.step == step && planned.run; });
}

std::string describe(const Plan& plan, bool inputs) {
  std::string text;
  for (const PlannedStep& planned : plan.steps) {
    text += fmt::format("  {:<12} {:<9} {}", name_of(planned.step), planned.run ? "run" : "left out", planned.why);
    if (inputs && planned.run && !planned.inputs.empty()) text += fmt::format(" [{}]", fmt::join(planned.inputs, ", "));
    if (inputs && planned.run && planned.seconds >= 0.1) text += fmt::format(" (about {:.1f} s)", planned.seconds);
    text += "\n";
  }
  return text;
}

void add_inputs(const KeyTable& keys, const std::vector<std::string>& given, Plan& plan) {
  for (const auto& [step, names] : keys.steps) {
    const auto planned = std::ranges::find(plan.steps, step, &PlannedStep::step);
    if (planned == plan.steps.end() || !planned->run) continue;
    for (const std::string_view name : names) {
      if (std::ranges::find(given, name) != given.end()) planned->inputs.emplace_back(name);
    }
  }
}

std::string from_scene(const SceneHead& scene, std::string file) {
  if (!scene.shown.ends_with(scene.file_name)) return file;
  const std::string_view folder{scene.shown.data(), scene.shown.size() - scene.file_name.size()};
  if (file.starts_with(folder)) file.erase(0, folder.size());
  return file;
}

std::vector<std::string> notes_of(const SceneHead& scene) {
  std::vector<std::string> notes;
  for (Problem note : scene.notes) {
    note.file = from_scene(scene, std::move(note.file));
    notes.push_back(describe(note));
  }
  return notes;
}

ResultHead head_of(const SceneHead& scene, Plan plan) {
  return {.title = scene.title,
          .project = scene.project,
          .seed = scene.seed,
          .scene_file = scene.file_name,
          .scene_sha256 = scene.sha256,
          .plan = std::move(plan),
          .output = scene.output,
          .notes = notes_of(scene)};
}

Plan plan_of_bodies(Step work, const std::string& why, const std::string& files, bool report) {
  const auto planned = [&](Step step) -> PlannedStep {
    if (step == work) return {step, true, why};
    switch (step) {
      case Step::read: return {step, true, "the scene"};
      case Step::draw:
      case Step::cut:
      case Step::audit:
      case Step::stability: return {step, false, "no [domain]: a scene of bodies"};
      case Step::support: return {step, false, "no [support]"};
      case Step::monte_carlo: return {step, false, "no [monte_carlo]: one run"};
      case Step::elastic: return {step, false, "no [elastic]: the bodies are in contact"};
      case Step::contact: return {step, false, "no contacts between bodies"};
      case Step::flow: return {step, false, "no joints"};
      case Step::write: return {step, true, "summary.json, log.txt" + files};
      case Step::report: return {step, report, report ? "report.html" : "output.report = false"};
    }
    std::unreachable();
  };
  Plan plan;
  for (const Step step : all_steps) {
    if (step != Step::flow) plan.steps.push_back(planned(step));
  }
  plan.estimate.blocks_low = plan.estimate.blocks_high = 0;
  return plan;
}

}  // namespace cleave::scene
