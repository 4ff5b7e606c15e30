#include "cleave/scene/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/cut.hpp"
#include "judge.hpp"

namespace cleave::scene {
namespace {

Problem problem_of(const topology::CutError& error, const Scene& scene, const Drawn& drawn) {
  const std::string what = describe(error);
  const auto whole = [&] { return Problem{scene.shown, 1, "scene", what, ""}; };
  return std::visit(overloaded{[&](const topology::JointCollapsed& e) {
                                 if (e.joint.index() < scene.joints.size()) {
                                   const MeasuredJoint& joint = scene.joints[e.joint.index()];
                                   return Problem{joint.file, joint.line, "joint", what, ""};
                                 }
                                 const JointInfo& info = drawn.joints[e.joint];
                                 return Problem{scene.shown, 1, fmt::format("joint_set {}", info.source), what, ""};
                               },
                               [&](const topology::SolidCollapsed& e) {
                                 if (!e.excavation) return Problem{scene.shown, 1, "domain", what, ""};
                                 return Problem{scene.shown, scene.excavations[*e.excavation].line,
                                                fmt::format("excavation[{}]", *e.excavation + 1), what, ""};
                               },
                               [&](const topology::DomainSwallowed&) {
                                 const std::uint32_t line =
                                     scene.excavations.empty() ? 1 : scene.excavations.front().line;
                                 return Problem{scene.shown, line, "excavation", what, ""};
                               },
                               [&](const topology::TooLarge&) { return whole(); }},
                    error);
}

void add_cut_notes(const topology::CutReport& report, std::size_t joints, std::vector<std::string>& notes) {
  if (report.joints_outside > 0) {
    notes.push_back(fmt::format("{} of {} joints lie outside the rock and cut nothing", report.joints_outside, joints));
  }
  if (!report.dangling.empty()) {
    notes.push_back(
        fmt::format("{} of {} joints end inside the rock and part no two blocks", report.dangling.size(), joints));
  }
}

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
      cost.stages.push_back({*stage, booked.wall_s, booked.cpu_s, booked.peak_rss_mb});
    }
  }
  return cost;
}

std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options, StageTimer& timer,
                                                   Progress& progress) {
  Plan plan = make_plan(scene);
  const auto stage = [&](Stage which, auto&& work) {
    progress.begin(name_of(which));
    return timer.run(name_of(which), work);
  };

  auto drawn = plan.runs(Stage::draw) ? stage(Stage::draw, [&] { return draw(scene); }) : draw(scene);
  if (!drawn) {
    progress.end();
    return std::unexpected(std::move(drawn).error());
  }

  auto cut = stage(Stage::cut, [&] { return topology::cut(drawn->input, {.threads = options.threads}); });
  if (!cut) {
    progress.end();
    return std::unexpected(std::vector{problem_of(cut.error(), scene, *drawn)});
  }
  const topology::CutReport report = cut->report();
  std::string hash;
  auto complex = stage(Stage::audit, [&] {
    auto audited = topology::audit(*std::move(cut));
    if (audited) hash = topology::canonical_hash(audited->complex());
    return audited;
  });
  std::optional<stability::Analysis> analysis;
  std::vector<CaseResult> cases;
  if (complex && scene.stability) {
    if (auto misplaced = misplaced_loads(scene, *drawn, *scene.stability, complex->complex()); !misplaced.empty()) {
      progress.end();
      return std::unexpected(std::move(misplaced));
    }
    stage(Stage::stability, [&] {
      const StabilitySettings& wanted = *scene.stability;
      analysis = stability::analyse(*complex, settings_of(scene, *drawn, wanted, wanted.loads));
      for (const LoadCase& load : wanted.cases) {
        cases.push_back({load.name, stability::analyse(*complex, settings_of(scene, *drawn, wanted, load.loads))});
      }
    });
  }
  progress.end();

  std::vector<std::string> notes;
  for (const Problem& note : scene.notes) notes.push_back(describe(note));
  add_cut_notes(report, drawn->joints.size(), notes);
  if (analysis && analysis->stopped_at_max_batches) {
    notes.push_back(
        fmt::format("stopped after max_batches = {} batches: more blocks may move", scene.stability->max_batches));
  }
  std::vector<ExcavationInfo> excavations;
  for (const Excavation& excavation : scene.excavations) excavations.push_back({excavation.name, excavation.stage});
  return RunResult{.title = scene.title,
                   .seed = scene.seed,
                   .scene_file = scene.file_name,
                   .scene_sha256 = scene.sha256,
                   .files = scene.files,
                   .north = scene.north,
                   .plan = std::move(plan),
                   .cost = cost_of(timer, options.threads),
                   .output = scene.output,
                   .rock = scene.rock,
                   .stability = scene.stability,
                   .input = std::move(drawn->input),
                   .sets = std::move(drawn->sets),
                   .joints = std::move(drawn->joints),
                   .excavations = std::move(excavations),
                   .complex = std::move(complex),
                   .block_hash = std::move(hash),
                   .analysis = std::move(analysis),
                   .load_cases = std::move(cases),
                   .notes = std::move(notes)};
}

}  // namespace cleave::scene
