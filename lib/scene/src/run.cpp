#include "cleave/scene/run.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/near_field.hpp"
#include "cleave/topology/cut.hpp"
#include "cleave/topology/sequence.hpp"
#include "cut_problem.hpp"
#include "field_stress.hpp"
#include "judge.hpp"
#include "run_notes.hpp"
#include "system.hpp"

namespace cleave::scene {
namespace {

std::optional<Stage> stage_named(std::string_view name) {
  const auto it = std::ranges::find(all_stages, name, [](Stage stage) { return name_of(stage); });
  return it == all_stages.end() ? std::nullopt : std::optional{*it};
}

std::string hash_of_key_blocks(const topology::BlockComplex& complex, const stability::Analysis& analysis) {
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  return topology::canonical_hash(complex, leaving);
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
      return stability::analyse(complex_of_state,
                                settings_on(complex_of_state.complex(), scene, drawn, scene.stability->loads));
    };
    system.analysis = stage(Stage::stability, [&] {
      if (in_stages && final_state) system.sequence = judge_stages(scene, *in_stages, *final_state, judge);
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
  std::optional<stability::KeyGroups> key_groups;
  if (analysis) {
    if (auto misplaced = misplaced_loads(scene, *drawn, *scene.stability, system.complex->complex());
        !misplaced.empty()) {
      progress.end();
      return std::unexpected(std::move(misplaced));
    }
    if (scene.stability->groups != stability::GroupsCheck::off) {
      stage(Stage::stability, [&] {
        const stability::Settings settings =
            settings_on(system.complex->complex(), scene, *drawn, scene.stability->loads);
        const bool decides = scene.stability->groups == stability::GroupsCheck::decide;
        key_groups = stability::find_key_groups(*system.complex, settings,
                                                decides ? stability::most_together : stability::most_noted);
        if (scene.stability->groups == stability::GroupsCheck::decide) {
          stability::decide_by_groups(*system.complex, settings, *key_groups, *analysis);
          system.key_hash = hash_of_key_blocks(system.complex->complex(), *analysis);
        }
      });
    }
    if (!on_demand) judge_cases_and_support(scene, *drawn, *system.complex, *analysis, timer, progress, more);
    judge_sensitivity(scene, *drawn, *system.complex, *analysis, more);
    judge_maximum_blocks(scene, *drawn, more);
    if (scene.field_stress) {
      auto done = stage(Stage::elastic, [&]() -> std::expected<FieldStressResult, bem::SolveError> {
        CLEAVE_TRY(const TunnelField field, TunnelField::make(scene, *scene.field_stress, options.threads));
        const topology::BlockComplex& complex = system.complex->complex();
        return clamp_blocks(scene, field, complex, *analysis,
                            settings_on(complex, scene, *drawn, scene.stability->loads), options.threads);
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

  std::vector<std::string> notes = notes_of(scene, *drawn, system, more, clamped);
  if (key_groups) add_group_notes(*key_groups, *analysis, notes);
  std::vector<ExcavationInfo> excavations;
  for (const Excavation& excavation : scene.excavations)
    excavations.push_back({excavation.name, excavation.stage, excavation.tunnel});
  RunResult result{.title = scene.title,
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
                   .key_groups = std::move(key_groups),
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
  result.figures = count(result);
  return result;
}

}  // namespace cleave::scene
