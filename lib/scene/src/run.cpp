#include "cleave/scene/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/held_from_within.hpp"
#include "cleave/stability/near_field.hpp"
#include "cleave/topology/cut.hpp"
#include "cleave/topology/sequence.hpp"
#include "field_stress.hpp"
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
                               [&](const topology::TerminationUndecided& e) {
                                 const MeasuredJoint& joint = scene.joints[e.joint.index()];
                                 return Problem{joint.file, joint.line, "joint.ends_on", what, ""};
                               },
                               [&](const topology::DomainSwallowed&) {
                                 const std::uint32_t line =
                                     scene.excavations.empty() ? 1 : scene.excavations.front().line;
                                 return Problem{scene.shown, line, "excavation", what, ""};
                               },
                               [&](const topology::WindowOutside&) { return whole(); },
                               [&](const topology::TooLarge&) { return whole(); }},
                    error);
}

stability::Settings settings_of(const Scene& scene, const Drawn& drawn) {
  return settings_of(scene, drawn, *scene.stability, scene.stability->loads);
}

/// Ensembles count nothing that is only flagged.
stability::Settings unflagged(stability::Settings settings) {
  if (settings.rotation == stability::RotationCheck::flag) settings.rotation = stability::RotationCheck::off;
  return settings;
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

void add_micro_note(const topology::BlockComplex& complex, const MicroBlocks& limits, std::vector<std::string>& notes) {
  if (limits.policy == MicroBlockPolicy::keep) return;
  const auto found = micro_blocks(complex, limits);
  if (found.empty()) return;
  double volume = 0;
  for (const topology::BlockId b : found) volume += complex.blocks()[b].volume.si();
  notes.push_back(fmt::format("{} of {} blocks are micro-blocks ({:.3g} m3 in all){}", found.size(),
                              complex.blocks().size(), volume,
                              limits.policy == MicroBlockPolicy::exclude ? ": left out of stability" : ""));
}

/// Blocks that translation leaves in place, but no statics does.
void add_rotation_note(const stability::Analysis& analysis, std::vector<std::string>& notes) {
  std::size_t turning = 0;
  std::string first;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.rotation || !j.rotation->turns) continue;
    ++turning;
    if (turning <= 10) first += (first.empty() ? "" : ", ") + std::to_string(j.block.value());
  }
  if (turning == 0) return;
  notes.push_back(fmt::format("{} {} would turn or topple though {} cannot slide: {}{}{}", turning,
                              turning == 1 ? "block" : "blocks", turning == 1 ? "it" : "they", first,
                              turning > 10 ? ", ..." : "",
                              analysis.rotation == stability::RotationCheck::decide
                                  ? "; counted as key blocks"
                                  : "; counted as key blocks only with rotation = \"decide\""));
}

/// Blocks that only what lies inside them keeps in place: never left unsaid, for they are not in the batches.
void add_enclosed_notes(const topology::AuditedComplex& complex, const stability::Settings& settings,
                        const stability::Analysis& analysis, std::vector<std::string>& notes) {
  constexpr std::size_t most = 10;
  const auto rows = stability::held_from_within(complex, settings, analysis);
  for (std::size_t i = 0; i < std::min(rows.size(), most); ++i) {
    const stability::HeldFromWithin& row = rows[i];
    notes.push_back(fmt::format(
        "block {} is not in the batches only because {} {} wholly inside it: as one body {}, factor of safety {:.3g}, "
        "net force {:.4g} kN",
        row.block.value(),
        row.inside.size() == 1 ? fmt::format("block {}", row.inside[0].value())
                               : fmt::format("{} blocks", row.inside.size()),
        row.inside.size() == 1 ? "lies" : "lie",
        row.mode == stability::Mode::falling ? std::string{"they fall"} : fmt::format("they move ({})", name(row.mode)),
        row.factor_of_safety, row.net.si() / 1000));
  }
  if (rows.size() > most) notes.push_back(fmt::format("and {} more blocks like that", rows.size() - most));
}

std::optional<Stage> stage_named(std::string_view name) {
  const auto it = std::ranges::find(all_stages, name, [](Stage stage) { return name_of(stage); });
  return it == all_stages.end() ? std::nullopt : std::optional{*it};
}

/// The blocks and what is known of them. `window` when only the rock near free faces was cut.
struct System {
  std::expected<topology::AuditedComplex, topology::Certificate> complex;
  topology::CutReport report;
  std::optional<stability::Analysis> analysis;
  std::string hash, key_hash;
  std::optional<WindowInfo> window;
  std::optional<SequenceResult> sequence = {};
};

std::string hash_of_key_blocks(const topology::BlockComplex& complex, const stability::Analysis& analysis) {
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  return topology::canonical_hash(complex, leaving);
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

std::expected<System, topology::CutError> cut_all(const Scene& scene, const Drawn& drawn, const RunOptions& options,
                                                  StageTimer& timer, Progress& progress) {
  const auto stage = [&](Stage which, auto&& work) {
    progress.begin(name_of(which));
    return timer.run(name_of(which), work);
  };
  std::optional<topology::SequentialCut> in_stages;
  std::optional<topology::StageBlocks> final_state;
  auto cut = stage(Stage::cut, [&]() -> std::expected<topology::BlockComplex, topology::CutError> {
    if (!scene.sequence) return topology::cut(drawn.input, {.threads = options.threads});
    CLEAVE_TRY(in_stages, topology::SequentialCut::make(drawn.input, {.threads = options.threads}));
    CLEAVE_TRY(final_state,
               in_stages->blocks({.excavated = std::vector<std::uint8_t>(scene.excavations.size(), 1), .fallen = {}}));
    return final_state->complex;
  });
  if (!cut) return std::unexpected(std::move(cut).error());
  topology::CutReport report = cut->report();
  std::string hash;
  auto complex = stage(Stage::audit, [&] {
    auto audited = topology::audit(*std::move(cut), options.threads);
    if (audited) hash = topology::canonical_hash(audited->complex(), options.threads);
    return audited;
  });
  System system{std::move(complex), std::move(report), {}, std::move(hash), {}, {}};
  if (system.complex && scene.stability) {
    const Judge judge = [&](const topology::AuditedComplex& complex_of_state) {
      stability::Settings settings = settings_of(scene, drawn);
      if (scene.micro_blocks.policy == MicroBlockPolicy::exclude) {
        settings.left_out = micro_blocks(complex_of_state.complex(), scene.micro_blocks);
      }
      return stability::analyse(complex_of_state, settings);
    };
    system.analysis = stage(Stage::stability, [&] {
      if (in_stages && final_state) system.sequence = sequence_of(scene, *in_stages, *final_state, judge);
      return judge(*system.complex);
    });
    system.key_hash = hash_of_key_blocks(system.complex->complex(), *system.analysis);
  }
  return system;
}

void judge_cases_and_support(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                             const stability::Analysis& analysis, StageTimer& timer, Progress& progress,
                             JudgedMore& more) {
  const auto stage = [&](Stage which, auto&& work) {
    progress.begin(name_of(which));
    timer.run(name_of(which), work);
  };
  if (!scene.stability->cases.empty()) stage(Stage::stability, [&] { judge_cases(scene, drawn, complex, more); });
  if (scene.support && more.undecided.empty()) {
    stage(Stage::support, [&] { judge_support(scene, drawn, complex, analysis, more); });
  }
}

std::expected<System, topology::CutError> cut_near_free_faces(const Scene& scene, const Drawn& drawn,
                                                              const RunOptions& options, StageTimer& timer,
                                                              Progress& progress, JudgedMore& more) {
  progress.begin(name_of(Stage::cut));
  const auto cases_and_support = [&](const topology::AuditedComplex& complex, const stability::Analysis& analysis) {
    more = {};
    judge_cases_and_support(scene, drawn, complex, analysis, timer, progress, more);
    return more.undecided;
  };
  auto near = stability::analyse_near_field(drawn.input, settings_of(scene, drawn), {.threads = options.threads}, timer,
                                            {.depth = longest_bolt(scene), .undecided = cases_and_support});
  if (!near) {
    if (auto* error = std::get_if<topology::CutError>(&near.error())) return std::unexpected(std::move(*error));
    return System{std::unexpected(std::get<topology::Certificate>(std::move(near).error())), {}, {}, {}, {}, {}};
  }
  const topology::BlockComplex& complex = near->complex.complex();
  System system{
      near->complex, complex.report(), near->analysis, topology::canonical_hash(complex, options.threads), {}, {}};
  system.key_hash = hash_of_key_blocks(complex, near->analysis);
  if (near->window) {
    system.window = WindowInfo{
        .min = near->window->min,
        .max = near->window->max,
        .rounds = near->rounds,
        .truncated = static_cast<std::uint64_t>(std::ranges::count_if(complex.blocks(), &topology::Block::truncated))};
  }
  return system;
}

std::string note_on(const WindowInfo& window) {
  return fmt::format(
      "only key blocks were asked for: of the rock only the box from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, "
      "{:.6g}) "
      "was cut; {} of its blocks go on outside it and are shown as far as it goes",
      window.min.x, window.min.y, window.min.z, window.max.x, window.max.y, window.max.z, window.truncated);
}

}  // namespace

std::vector<topology::BlockId> micro_blocks(const topology::BlockComplex& complex, const MicroBlocks& limits) {
  std::vector<topology::BlockId> found;
  for (const topology::BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    const bool micro = limits.thickness || limits.volume
                           ? (limits.thickness && block.thickness.si() < limits.thickness->si()) ||
                                 (limits.volume && block.volume.si() < limits.volume->si())
                           : block.sliver;
    if (micro) found.push_back(id);
  }
  return found;
}

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

namespace {

/// Judges what was cut for other strengths of the same joints.
void judge_realized(const Scene& scene, const std::optional<topology::SequentialCut>& in_stages,
                    const std::optional<topology::StageBlocks>& final_state, Realized& realized) {
  if (!realized.complex || !scene.stability) return;
  const Judge judge = [&](const topology::AuditedComplex& complex) {
    stability::Settings settings = unflagged(settings_of(scene, realized.drawn));
    if (scene.micro_blocks.policy == MicroBlockPolicy::exclude) {
      settings.left_out = micro_blocks(complex.complex(), scene.micro_blocks);
    }
    return stability::analyse(complex, settings);
  };
  if (in_stages && final_state) realized.sequence = sequence_of(scene, *in_stages, *final_state, judge);
  realized.analysis = judge(*realized.complex);
  if (scene.support) {
    realized.support = judge_plan(scene, realized.drawn, *realized.complex, *realized.analysis);
  }
}

std::expected<Realized, std::vector<Problem>> realize_near(const Scene& scene, Drawn drawn) {
  StageTimer timer;
  JudgedMore more;
  const auto cases_and_support = [&](const topology::AuditedComplex& complex, const stability::Analysis& analysis) {
    more = {};
    if (!scene.stability->cases.empty()) judge_cases(scene, drawn, complex, more);
    if (scene.support && more.undecided.empty()) judge_support(scene, drawn, complex, analysis, more, false);
    return more.undecided;
  };
  auto near = stability::analyse_near_field(drawn.input, unflagged(settings_of(scene, drawn)), {.threads = 1}, timer,
                                            {.depth = longest_bolt(scene), .undecided = cases_and_support});
  if (near) {
    return Realized{std::move(drawn), std::move(near->complex), std::move(near->analysis), {}, std::move(more.support)};
  }
  if (auto* error = std::get_if<topology::CutError>(&near.error())) {
    return std::unexpected(std::vector{problem_of(*error, scene, drawn)});
  }
  return Realized{
      std::move(drawn), std::unexpected(std::get<topology::Certificate>(std::move(near).error())), {}, {}, {}};
}

}  // namespace

void realize(const Scene& scene, std::uint64_t first, std::uint64_t count,
             const std::function<void(std::uint64_t, const std::expected<Realized, std::vector<Problem>>&)>& use) {
  using Result = std::expected<Realized, std::vector<Problem>>;
  const auto fail = [&](std::vector<Problem> problems) {
    const Result failed = std::unexpected(std::move(problems));
    for (std::uint64_t k = first; k < first + count; ++k) use(k, failed);
  };
  auto drawn = draw(scene, first);
  if (!drawn) return fail(std::move(drawn).error());
  const auto next_strengths = [&](std::uint64_t k) {
    auto again = draw(scene, k);
    CLEAVE_ASSERT(again.has_value());  // the same joints as before
    return *std::move(again);
  };
  if (scene.output.only_key_blocks && scene.stability && !scene.sequence) {
    // How far the rock must be cut depends on the strengths.
    use(first, realize_near(scene, *std::move(drawn)));
    for (std::uint64_t k = first + 1; k < first + count; ++k) use(k, realize_near(scene, next_strengths(k)));
    return;
  }
  std::optional<topology::SequentialCut> in_stages;
  std::optional<topology::StageBlocks> final_state;
  auto cut = [&]() -> std::expected<topology::BlockComplex, topology::CutError> {
    if (!scene.sequence) return topology::cut(drawn->input, {.threads = 1});
    CLEAVE_TRY(in_stages, topology::SequentialCut::make(drawn->input, {.threads = 1}));
    CLEAVE_TRY(final_state,
               in_stages->blocks({.excavated = std::vector<std::uint8_t>(scene.excavations.size(), 1), .fallen = {}}));
    return final_state->complex;
  }();
  if (!cut) return fail(std::vector{problem_of(cut.error(), scene, *drawn)});
  Result result = Realized{*std::move(drawn), topology::audit(*std::move(cut)), {}, {}, {}};
  for (std::uint64_t k = first; k < first + count; ++k) {
    if (k > first) result->drawn = next_strengths(k);
    judge_realized(scene, in_stages, final_state, *result);
    use(k, result);
  }
}

std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options, StageTimer& timer,
                                                   Progress& progress) {
  Plan plan = make_plan(scene);
  const auto stage = [&](Stage which, auto&& work) {
    progress.begin(name_of(which));
    return timer.run(name_of(which), work);
  };

  auto drawn = plan.runs(Stage::draw) ? stage(Stage::draw, [&] { return draw(scene, options.realization); })
                                      : draw(scene, options.realization);
  if (!drawn) {
    progress.end();
    return std::unexpected(std::move(drawn).error());
  }

  const bool on_demand = scene.output.only_key_blocks && scene.stability && !scene.sequence;
  JudgedMore more;
  auto made = on_demand ? cut_near_free_faces(scene, *drawn, options, timer, progress, more)
                        : cut_all(scene, *drawn, options, timer, progress);
  if (!made) {
    progress.end();
    return std::unexpected(std::vector{problem_of(made.error(), scene, *drawn)});
  }
  System& system = *made;
  auto& analysis = system.analysis;
  std::optional<FieldStressResult> clamped;
  if (analysis) {
    if (auto misplaced = misplaced_loads(scene, *drawn, *scene.stability, system.complex->complex());
        !misplaced.empty()) {
      progress.end();
      return std::unexpected(std::move(misplaced));
    }
    if (!on_demand) judge_cases_and_support(scene, *drawn, *system.complex, *analysis, timer, progress, more);
    judge_sensitivity(scene, *drawn, *system.complex, *analysis, more);
    judge_maximum_blocks(scene, *drawn, more);
    if (scene.field_stress) {
      auto done = stage(Stage::elastic, [&]() -> std::expected<FieldStressResult, bem::SolveError> {
        CLEAVE_TRY(const TunnelField field, TunnelField::make(scene, *scene.field_stress, options.threads));
        stability::Settings settings = settings_of(scene, *drawn);
        if (scene.micro_blocks.policy == MicroBlockPolicy::exclude) {
          settings.left_out = micro_blocks(system.complex->complex(), scene.micro_blocks);
        }
        return clamp_blocks(scene, field, system.complex->complex(), *analysis, settings, options.threads);
      });
      if (!done) {
        progress.end();
        return std::unexpected(std::vector{Problem{scene.shown, scene.field_stress->line, "field_stress",
                                                   describe(done.error()), "see docs/bem.md on field stress"}});
      }
      clamped = *std::move(done);
    }
  }
  progress.end();

  std::vector<std::string> notes;
  for (const Problem& note : scene.notes) notes.push_back(describe(note));
  if (system.window) {
    notes.push_back(note_on(*system.window));
  } else {
    add_cut_notes(system.report, drawn->joints.size(), notes);
  }
  if (system.complex) add_micro_note(system.complex->complex(), scene.micro_blocks, notes);
  if (analysis && analysis->stopped_at_max_batches) {
    notes.push_back(
        fmt::format("stopped after max_batches = {} batches: more blocks may move", scene.stability->max_batches));
  }
  if (more.support && !more.support->passes()) {
    notes.push_back(
        "the support does not reach the required factors of safety: see bolts.csv and the columns of key_blocks.csv");
  }
  for (const CaseSupport& load : more.support_cases) {
    if (!load.support.passes()) {
      notes.push_back(
          fmt::format("load case {}: the support does not reach the required factors of safety: see support_blocks.csv",
                      load.name));
    }
  }
  if (analysis) add_rotation_note(*analysis, notes);
  if (analysis && system.complex) {
    stability::Settings settings = settings_of(scene, *drawn);
    if (scene.micro_blocks.policy == MicroBlockPolicy::exclude) {
      settings.left_out = micro_blocks(system.complex->complex(), scene.micro_blocks);
    }
    add_enclosed_notes(*system.complex, settings, *analysis, notes);
  }
  if (system.window && system.window->truncated > 0 && analysis &&
      analysis->rotation == stability::RotationCheck::flag) {
    notes.push_back("blocks that go on outside the box that was cut are not asked whether they turn");
  }
  if (clamped && !clamped->reached) {
    notes.push_back(fmt::format("field stress: displacements of the section still change by {:.1e} (asked: {:.1e})",
                                clamped->error, scene.field_stress->tolerance));
  }
  if (clamped && clamped->held > 0) {
    notes.push_back(fmt::format("field stress: {} unstable {} held by the stress across {} joints; without it {}",
                                clamped->held, clamped->held == 1 ? "block is" : "blocks are",
                                clamped->held == 1 ? "its" : "their", clamped->held == 1 ? "it falls" : "they fall"));
  }
  for (const CaseResult& load : more.cases) {
    std::size_t leaving = 0, base = 0;
    for (const stability::Batch& batch : load.analysis.batches) leaving += batch.blocks.size();
    for (const stability::Batch& batch : analysis->batches) base += batch.blocks.size();
    if (leaving != base) {
      notes.push_back(fmt::format("load case {}: {} key blocks, {} in the base case", load.name, leaving, base));
    }
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
                   .complex = std::move(system.complex),
                   .block_hash = std::move(system.hash),
                   .key_block_hash = std::move(system.key_hash),
                   .window = system.window,
                   .analysis = std::move(analysis),
                   .sequence = std::move(system.sequence),
                   .micro_blocks = scene.micro_blocks,
                   .field_stress = std::move(clamped),
                   .support = std::move(more.support),
                   .support_cases = std::move(more.support_cases),
                   .bolt_groups = scene.support ? scene.support->groups : std::vector<std::string>{},
                   .designs = std::move(more.designs),
                   .maximum_blocks = std::move(more.maximum_blocks),
                   .tunnel_length = tunnel_length(scene),
                   .sensitivity = std::move(more.sensitivity),
                   .load_cases = std::move(more.cases),
                   .notes = std::move(notes)};
}

}  // namespace cleave::scene
