#include "realizer.hpp"

#include <string>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/cut.hpp"
#include "cut_estimate.hpp"
#include "cut_problem.hpp"
#include "field_stress.hpp"
#include "flow_run.hpp"
#include "group_notes.hpp"
#include "judge.hpp"
#include "motion_run.hpp"

namespace cleave::scene {
namespace {

/// What the cutter did not see yet: nothing.
Realization nothing(const Scene& scene) { return {SampledScene{.input = {.domain = scene.domain}}}; }

}  // namespace

Realizer::Realizer(const Scene& scene, const RunOptions& options, Detail detail, StageTimer& timer, Progress& progress)
    : scene_{&scene},
      options_{options},
      detail_{detail},
      timer_{&timer},
      progress_{&progress},
      near_{scene.output.only_key_blocks && scene.stability && !scene.sequence},
      made_{nothing(scene)} {}

Realizer::Done Realizer::execute(const Plan& plan) {
  for (const PlannedStep& planned : plan.steps) {
    if (planned.run) CLEAVE_CHECK(step(planned.step));
  }
  return {};
}

Realizer::Done Realizer::next(const Plan& plan, std::uint64_t realization) {
  options_.realization = realization;
  drawn_ = false;
  // How far the rock must be cut depends on the strengths.
  if (near_ || !made_.complex) return execute(plan);
  CLEAVE_CHECK(draw_joints());
  for (const Step which : {Step::flow, Step::stability, Step::support, Step::elastic}) {
    if (plan.runs(which)) CLEAVE_CHECK(step(which));
  }
  return {};
}

Realizer::Done Realizer::step(Step which) {
  switch (which) {
    case Step::draw: return booked(which, [&] { return draw_joints(); });
    case Step::cut:
      if (!drawn_) CLEAVE_CHECK(draw_joints());  // none is random, but strengths may be
      return near_ ? cut_near_free_faces() : booked(which, [&] { return cut(); });
    case Step::audit:
      if (!near_) booked(which, [&] { audit(); });
      return {};
    case Step::stability: return made_.complex ? booked(which, [&] { return judge(); }) : Done{};
    case Step::support:
      if (made_.analysis && !near_) booked(which, [&] { support(); });
      if (made_.support) booked(which, [&] { support_of_groups(); });
      return {};
    case Step::elastic: return made_.analysis ? booked(which, [&] { return clamp(); }) : Done{};
    case Step::contact:
      if (!made_.analysis || !scene_->motion || detail_ != Detail::shown) return {};
      return booked(which, [&] { return move(); });
    case Step::flow:
      if (!made_.complex) return {};
      return booked(which, [&] { return send_water(); });
    case Step::read:
    case Step::monte_carlo:
    case Step::write:
    case Step::report: return {};  // not of a realization
  }
  std::unreachable();
}

Realizer::Done Realizer::draw_joints() {
  CLEAVE_TRY(SampledScene drawn, sample(*scene_, options_.realization));
  static_cast<SampledScene&>(made_) = std::move(drawn);
  drawn_ = true;
  return {};
}

Realizer::Done Realizer::fits_memory() const {
  if (!options_.memory_mb) return {};
  if (auto refused = too_large_for(*options_.memory_mb, *scene_, made_)) {
    return std::unexpected(std::vector<Problem>{*std::move(refused)});
  }
  return {};
}

Realizer::Done Realizer::cut() {
  CLEAVE_CHECK(fits_memory());
  made_.input.keep_network = scene_->flow.has_value();
  auto cut = [&]() -> std::expected<topology::BlockComplex, topology::CutError> {
    if (!scene_->sequence) return topology::cut(made_.input, {.threads = options_.threads});
    CLEAVE_TRY(in_stages_, topology::SequentialCut::make(made_.input, {.threads = options_.threads}));
    CLEAVE_TRY(final_state_, in_stages_->blocks({.excavated = std::vector<std::uint8_t>(scene_->excavations.size(), 1),
                                                 .fallen = {}}));
    return final_state_->complex;
  }();
  if (!cut) return std::unexpected(std::vector{problem_of(cut.error(), *scene_, made_)});
  made_.cut = cut->report();
  unchecked_ = *std::move(cut);
  return {};
}

void Realizer::audit() {
  CLEAVE_ASSERT(unchecked_.has_value());
  made_.complex = topology::audit(*std::exchange(unchecked_, std::nullopt), options_.threads);
  if (made_.complex && detail_ == Detail::shown) {
    made_.block_hash = topology::canonical_hash(made_.complex->complex(), options_.threads);
  }
}

Realizer::Done Realizer::cut_near_free_faces() {
  progress_->begin(name_of(Step::cut));
  const auto cases_and_support = [&](const topology::AuditedComplex& complex, const stability::Analysis& analysis) {
    forget_cases_and_support(made_);
    if (!scene_->stability->cases.empty()) {
      booked(Step::stability, [&] { judge_cases(*scene_, complex, made_); });
    }
    if (scene_->support && made_.undecided.empty()) {
      // Of a window: what it knows of groups is not that of all the rock.
      booked(Step::support, [&] { (void)judge_support(*scene_, complex, analysis, made_, detail_, options_.threads); });
    }
    // The replay of a realization cuts what the ensemble cut.
    const bool grows = judges_groups() && (!scene_->monte_carlo || scene_->stability->decides_by_groups());
    if (!made_.undecided.empty() || !grows) return made_.undecided;
    booked(Step::stability, [&] { find_groups(complex); });
    return made_.key_groups->edge;
  };
  made_.key_groups.reset();
  auto near = stability::analyse_near_field(made_.input, settings_of(*scene_, made_), {.threads = options_.threads},
                                            *timer_, {.depth = longest_bolt(*scene_), .undecided = cases_and_support});
  if (!near) {
    if (auto* error = std::get_if<topology::CutError>(&near.error())) {
      return std::unexpected(std::vector{problem_of(*error, *scene_, made_)});
    }
    made_.complex = std::unexpected(std::get<topology::Certificate>(std::move(near).error()));
    made_.analysis.reset();
    return {};
  }
  const topology::BlockComplex& complex = near->complex.complex();
  made_.cut = complex.report();
  made_.window.reset();
  if (near->window) {
    made_.window = WindowInfo{
        .min = near->window->min,
        .max = near->window->max,
        .rounds = near->rounds,
        .truncated = static_cast<std::uint64_t>(std::ranges::count_if(complex.blocks(), &topology::Block::truncated))};
  }
  if (detail_ == Detail::shown) made_.block_hash = topology::canonical_hash(complex, options_.threads);
  made_.analysis = std::move(near->analysis);
  made_.complex = std::move(near->complex);
  return {};
}

stability::Settings Realizer::settings(const topology::BlockComplex& complex) const {
  return settings_on(complex, *scene_, made_, scene_->stability->loads);
}

stability::Analysis Realizer::analyse(const topology::AuditedComplex& complex) const {
  return stability::analyse(complex, settings(complex.complex()));
}

/// Of the state of one stage: where blocks judged together decide, they leave there, too.
stability::Analysis Realizer::analyse_stage(const topology::AuditedComplex& complex) const {
  stability::Analysis analysis = analyse(complex);
  if (!scene_->stability->decides_by_groups()) return analysis;
  const stability::Settings with = settings(complex.complex());
  const stability::KeyGroups groups = stability::find_key_groups(complex, with, together(*scene_, options_.threads));
  stability::decide_by_groups(complex, with, groups, analysis);
  return analysis;
}

Realizer::Done Realizer::judge() {
  const topology::AuditedComplex& complex = *made_.complex;
  if (!near_) {
    forget_cases_and_support(made_);
    if (in_stages_ && final_state_) {
      made_.sequence =
          judge_stages(*scene_, *in_stages_, *final_state_, [&](const auto& state) { return analyse_stage(state); });
      if (detail_ == Detail::shown || scene_->support) judge_cases_in_stages(*scene_, made_);
      if (scene_->support) judge_support_in_stages(*scene_, made_, judges_groups(), options_.threads);
    }
    made_.analysis = analyse(complex);
  }
  if (auto misplaced = misplaced_loads(*scene_, made_, complex.complex()); !misplaced.empty()) {
    return std::unexpected(std::move(misplaced));
  }
  if (!near_) made_.key_groups.reset();
  if (detail_ == Detail::counted) {
    if (judges_groups()) judge_groups();
    hold_by_next_to_nothing(settings(complex.complex()));
    judge_load_cases();
    return {};
  }
  made_.key_block_hash = hash_of_key_blocks(complex.complex(), *made_.analysis);
  if (judges_groups()) judge_groups();
  made_.let_go.clear();
  if (made_.key_groups) made_.let_go = let_go(*scene_, made_, complex.complex(), *made_.key_groups, options_.threads);
  const stability::Settings with = settings(complex.complex());
  made_.held_from_within = stability::held_from_within(complex, with, *made_.analysis);
  if (!made_.key_groups || made_.key_groups->too_many) {
    made_.barred = stability::barred_by_lesser(complex, with, *made_.analysis);
  }
  hold_by_next_to_nothing(with);
  judge_load_cases();
  taper_of_stages();
  if (judges_groups()) {
    judge_groups_of_stages();
    judge_groups_below_target();
    made_.group_factor.reset();
    if (scene_->stability->group_factor) {
      made_.group_factor = stability::factor_together(complex, with);
    }
  }
  held_by_micro_blocks();
  left_out_and_moving();
  look_for_held();
  made_.sensitivity = stability::sensitivity(complex, with, *made_.analysis);
  judge_maximum_blocks(*scene_, made_);
  return {};
}

/// Those of a window were judged when it was cut.
void Realizer::judge_load_cases() {
  const topology::AuditedComplex& complex = *made_.complex;
  if (!near_) judge_cases(*scene_, complex, made_);
  if (judges_groups()) judge_groups_of_cases();
  for (std::size_t k = 0; k < made_.load_cases.size(); ++k) {
    CaseResult& load = made_.load_cases[k];
    const stability::Settings pushed =
        settings_on(complex.complex(), *scene_, made_, scene_->stability->cases[k].loads);
    load.held_alone = stability::domain_held(complex, pushed, load.analysis);
    load.domain_held =
        with_groups(*load.held_alone, pushed, load.analysis, load.groups, "load case " + load.name + ": ");
    load.tapered = stability::held_by_taper(complex, pushed, load.analysis);
    load.held_at_target = at_target(pushed, load.analysis, load.groups, &scene_->stability->cases[k]);
  }
}

void Realizer::support() {
  below_target_.clear();
  if (made_.undecided.empty())
    below_target_ = judge_support(*scene_, *made_.complex, *made_.analysis, made_, detail_, options_.threads);
  if (made_.undecided.empty()) supported_by_micro_blocks();
}

Realizer::Done Realizer::move() {
  auto moved = run_motion(*scene_, made_, made_.complex->complex(), options_.motion, options_.threads);
  if (!moved) return std::unexpected(std::vector{std::move(moved).error()});
  made_.motion = *std::move(moved);
  return {};
}

Realizer::Done Realizer::send_water() {
  auto flow = run_flow(*scene_, made_, made_.complex->complex(), detail_);
  if (!flow) return std::unexpected(std::vector{std::move(flow).error()});
  made_.flow = *std::move(flow);
  if (acts_on_blocks(*scene_)) made_.flow_water = water_on_blocks(*scene_, made_.complex->complex(), *made_.flow);
  return {};
}

Realizer::Done Realizer::clamp() {
  if (!options_.fields) {
    auto fields = TunnelFields::make(*scene_, options_.threads);
    if (!fields) {
      return std::unexpected(std::vector{Problem{scene_->shown, scene_->field_stress->line, "field_stress",
                                                 describe(fields.error()), "see docs/bem.md on field stress"}});
    }
    options_.fields = std::make_shared<const TunnelFields>(*std::move(fields));
  }
  made_.field_stress =
      clamp_blocks(*scene_, *options_.fields, made_, settings(made_.complex->complex()), options_.threads);
  return {};
}

std::shared_ptr<const TunnelFields> shared_fields(const Scene& scene, unsigned threads) {
  if (!scene.field_stress || !scene.stability) return nullptr;
  auto fields = TunnelFields::make(scene, threads);
  return fields ? std::make_shared<const TunnelFields>(*std::move(fields)) : nullptr;
}

void realize(const Scene& scene, const std::shared_ptr<const TunnelFields>& fields, std::uint64_t first,
             std::uint64_t count, StageTimer& timer,
             const std::function<void(std::uint64_t, const Realization*)>& use) {
  const Plan plan = make_plan(scene);
  Progress progress{ProgressStyle::quiet};
  Realizer realizer{scene, {.threads = 1, .realization = first, .fields = fields}, Detail::counted, timer, progress};
  for (std::uint64_t k = first; k < first + count; ++k) {
    const Realizer::Done done = k == first ? realizer.execute(plan) : realizer.next(plan, k);
    use(k, done ? &realizer.now() : nullptr);
  }
}

}  // namespace cleave::scene
