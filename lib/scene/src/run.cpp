#include "cleave/scene/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/cut.hpp"
#include "cleave/topology/sequence.hpp"

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
                               [&](const topology::TerminationUndecided& e) {
                                 const MeasuredJoint& joint = scene.joints[e.joint.index()];
                                 return Problem{joint.file, joint.line, "joint.ends_on", what, ""};
                               },
                               [&](const topology::DomainSwallowed&) {
                                 const std::uint32_t line =
                                     scene.excavations.empty() ? 1 : scene.excavations.front().line;
                                 return Problem{scene.shown, line, "excavation", what, ""};
                               },
                               [&](const topology::TooLarge&) { return whole(); }},
                    error);
}

/// All of it was checked when the scene was parsed, so none of the factories can refuse.
stability::Analysis judge(const Scene& scene, const Drawn& drawn, const StabilitySettings& wanted,
                          const topology::AuditedComplex& complex) {
  const auto strength_of = [](const Strength& s) {
    auto made = stability::JointStrength::make(s.friction, s.cohesion, s.tension);
    CLEAVE_ASSERT(made.has_value());
    return *made;
  };
  const auto rock = stability::RockMass::make(scene.rock.density);
  const auto loads = stability::Loads::make(wanted.gravity, wanted.seismic);
  const auto partial =
      stability::PartialFactors::make(wanted.partial.friction, wanted.partial.cohesion, wanted.partial.weight);
  CLEAVE_ASSERT(rock.has_value() && loads.has_value() && partial.has_value());
  stability::StrengthTable strengths{strength_of({FrictionAngle::degrees(0), pascals(0), pascals(0)})};
  for (const topology::JointId joint : drawn.joints.ids()) {
    strengths.set(joint, strength_of(drawn.joints[joint].strength));
  }
  return stability::analyse(complex, {.rock = *rock,
                                      .strengths = std::move(strengths),
                                      .loads = *loads,
                                      .partial = *partial,
                                      .force_transfer = wanted.force_transfer,
                                      .max_batches = wanted.max_batches});
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

SequenceResult sequence_of(const Scene& scene, const topology::SequentialCut& cut,
                           const topology::StageBlocks& final_state, const Judge& judge) {
  std::vector<std::uint32_t> stages;
  std::vector<std::string> names;
  for (const Excavation& excavation : scene.excavations) {
    stages.push_back(excavation.stage);
    names.push_back(excavation.name);
  }
  return run_sequence(cut, final_state, *scene.sequence, stages, names, judge);
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

  std::optional<topology::SequentialCut> in_stages;
  std::optional<topology::StageBlocks> final_state;
  auto cut = stage(Stage::cut, [&]() -> std::expected<topology::BlockComplex, topology::CutError> {
    if (!scene.sequence) return topology::cut(drawn->input, {.threads = options.threads});
    CLEAVE_TRY(in_stages, topology::SequentialCut::make(drawn->input, {.threads = options.threads}));
    CLEAVE_TRY(final_state,
               in_stages->blocks({.excavated = std::vector<std::uint8_t>(scene.excavations.size(), 1), .fallen = {}}));
    return final_state->complex;
  });
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
  std::optional<SequenceResult> sequence;
  if (complex && scene.stability) {
    const Judge judged = [&](const topology::AuditedComplex& state) {
      return judge(scene, *drawn, *scene.stability, state);
    };
    analysis = stage(Stage::stability, [&] {
      if (in_stages && final_state) sequence = sequence_of(scene, *in_stages, *final_state, judged);
      return judged(*complex);
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
                   .sequence = std::move(sequence),
                   .notes = std::move(notes)};
}

}  // namespace cleave::scene
