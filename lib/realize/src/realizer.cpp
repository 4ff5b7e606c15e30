#include "realizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/cut.hpp"
#include "crumbs.hpp"
#include "cut_estimate.hpp"
#include "cut_problem.hpp"
#include "field_stress.hpp"
#include "flow_run.hpp"
#include "group_notes.hpp"
#include "judge.hpp"
#include "motion_run.hpp"

namespace cleave::scene {
namespace {

std::string hash_of_key_blocks(const topology::BlockComplex& complex, const stability::Analysis& analysis) {
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  return topology::canonical_hash(complex, leaving);
}

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
  look_for_held();
  made_.sensitivity = stability::sensitivity(complex, with, *made_.analysis);
  judge_maximum_blocks(*scene_, made_);
  return {};
}

/// In the base case.
void Realizer::hold_by_next_to_nothing(const stability::Settings& settings) {
  made_.tapered = stability::held_by_taper(*made_.complex, settings, *made_.analysis);
  made_.held_alone = stability::domain_held(*made_.complex, settings, *made_.analysis);
  made_.domain_held = with_groups(*made_.held_alone, settings, *made_.analysis, made_.key_groups, "");
  border_at_target_.clear();
  made_.held_at_target = at_target(settings, *made_.analysis, made_.key_groups, nullptr);
}

/// Of states in their order: base case, then load cases.
std::optional<HeldAtTarget> Realizer::at_target(const stability::Settings& settings,
                                                const stability::Analysis& analysis,
                                                const std::optional<stability::KeyGroups>& groups,
                                                const LoadCase* load) {
  const std::optional<Targets> target = target_of(load);
  if (!target) return std::nullopt;
  const stability::Settings with = with_strengths_over(settings, target->sliding);
  const auto* together = scene_->stability->decides_by_groups() ? &groups : nullptr;
  border_at_target_.push_back(held_by_border(*made_.complex, with, analysis, together));
  return held_at_target(*made_.complex, with, analysis, together, border_at_target_.back(), target->sliding);
}

stability::DomainHeld Realizer::with_groups(stability::DomainHeld held, const stability::Settings& settings,
                                            const stability::Analysis& analysis,
                                            const std::optional<stability::KeyGroups>& groups, std::string_view where) {
  if (groups && !groups->too_many) {
    (void)stability::add_held_together(*made_.complex, settings, analysis, *groups, held);
  } else if (!groups && detail_ == Detail::shown && analysis.batches.empty() && held.blocks.empty() &&
             std::ranges::any_of(made_.complex->complex().blocks(), &topology::Block::fixed)) {
    notes_.push_back(std::string{where} +
                     "no block moves by itself; whether blocks that would move together are held by sides of the "
                     "domain that are not free was not asked (groups = \"off\")");
  }
  return held;
}

std::optional<Targets> Realizer::target_of(const LoadCase* load) const { return targets_under(*scene_, load); }

std::optional<stability::KeyGroups> Realizer::groups_below(const topology::AuditedComplex& complex,
                                                           const stability::Settings& settings,
                                                           const std::optional<stability::KeyGroups>& groups,
                                                           const std::optional<Targets>& target) const {
  if (!target || scene_->support || !groups || groups->too_many) return std::nullopt;
  stability::SupportPlan plan;
  plan.target_sliding = target->sliding;
  return stability::groups_below_target(complex, settings, plan, together(*scene_, options_.threads));
}

/// As far as it knows all: where groups do not decide, that of single blocks.
const stability::DomainHeld* Realizer::border_at(std::size_t number) const {
  const bool all = scene_->stability->decides_by_groups() && number < border_at_target_.size();
  return all ? &border_at_target_[number] : nullptr;
}

void Realizer::look_for_held() {
  HeldNotes held{*scene_, together(*scene_, options_.threads), notes_};
  const topology::AuditedComplex& complex = *made_.complex;
  held.look({.complex = &complex,
             .settings = settings(complex.complex()),
             .analysis = &*made_.analysis,
             .groups = &made_.key_groups,
             .target = target_of(nullptr),
             .held = &*made_.domain_held,
             .border_at_target = border_at(0)});
  for (std::size_t k = 0; k < made_.load_cases.size(); ++k) {
    const CaseResult& load = made_.load_cases[k];
    const LoadCase& stated = scene_->stability->cases[k];
    held.look({.complex = &complex,
               .settings = settings_on(complex.complex(), *scene_, made_, stated.loads),
               .analysis = &load.analysis,
               .groups = &load.groups,
               .target = target_of(&stated),
               .where = "load case " + load.name + ": ",
               .place = JudgedState::Place::load,
               .held = &*load.domain_held,
               .below_target = &load.groups_below_target,
               .border_at_target = border_at(k + 1)});
  }
  if (made_.sequence) look_for_held_in_stages(held);
  made_.not_asked = held.not_asked();
}

/// But in the last where nothing fell before it: that is the base case.
void Realizer::look_for_held_in_stages(HeldNotes& held) {
  bool fell = false;
  for (const StageResult& row : made_.sequence->stages) {
    if (&row == &made_.sequence->stages.back() && (!fell || made_.sequence->fallen == Fallen::put_back)) break;
    if (!row.complex || !*row.complex || !row.analysis) continue;
    fell = fell || !row.analysis->batches.empty();
    const topology::AuditedComplex& complex = **row.complex;
    const std::string after = "after stage " + std::to_string(row.stage);
    const auto look = [&](const LoadCase* load, const stability::Analysis& analysis,
                          const std::optional<stability::KeyGroups>& groups) {
      const stability::Settings with =
          settings_on(complex.complex(), *scene_, made_, load != nullptr ? load->loads : scene_->stability->loads);
      const auto below = groups_below(complex, with, groups, target_of(load));
      held.look({.complex = &complex,
                 .settings = with,
                 .analysis = &analysis,
                 .groups = &groups,
                 .target = target_of(load),
                 .where = after + (load != nullptr ? ", load case " + load->name + ": " : ": "),
                 .place = load != nullptr ? JudgedState::Place::stage_under_load : JudgedState::Place::stage,
                 .below_target = &below});
    };
    look(nullptr, *row.analysis, row.groups);
    for (std::size_t k = 0; k < row.cases.size(); ++k) {
      look(&scene_->stability->cases[k], row.cases[k].analysis, row.cases[k].groups);
    }
  }
}

/// Of a scene with a target and without support, which asks for it itself.
void Realizer::judge_groups_below_target() {
  const topology::AuditedComplex& complex = *made_.complex;
  made_.groups_below_target =
      groups_below(complex, settings(complex.complex()), made_.key_groups, scene_->stability->target);
  for (std::size_t k = 0; k < made_.load_cases.size(); ++k) {
    const LoadCase& stated = scene_->stability->cases[k];
    made_.load_cases[k].groups_below_target =
        groups_below(complex, settings_on(complex.complex(), *scene_, made_, stated.loads), made_.load_cases[k].groups,
                     target_of(&stated));
  }
}

/// Ensembles count groups only where they decide.
bool Realizer::judges_groups() const {
  return detail_ == Detail::counted ? scene_->stability->decides_by_groups()
                                    : scene_->stability->groups != stability::GroupsCheck::off;
}

void Realizer::find_groups(const topology::AuditedComplex& complex) {
  made_.key_groups =
      stability::find_key_groups(complex, settings(complex.complex()), together(*scene_, options_.threads));
}

/// Those of a window were found when it was cut.
void Realizer::judge_groups() {
  const topology::AuditedComplex& complex = *made_.complex;
  if (!made_.key_groups) find_groups(complex);
  if (!scene_->stability->decides_by_groups()) return;
  stability::decide_by_groups(complex, settings(complex.complex()), *made_.key_groups, *made_.analysis);
  made_.key_block_hash = hash_of_key_blocks(complex.complex(), *made_.analysis);
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

void Realizer::judge_groups_of_cases() {
  const topology::AuditedComplex& complex = *made_.complex;
  for (std::size_t k = 0; k < made_.load_cases.size(); ++k) {
    CaseResult& load = made_.load_cases[k];
    const stability::Settings with = settings_on(complex.complex(), *scene_, made_, scene_->stability->cases[k].loads);
    load.groups = stability::find_key_groups(complex, with, together(*scene_, options_.threads));
    if (scene_->stability->decides_by_groups()) stability::decide_by_groups(complex, with, *load.groups, load.analysis);
    add_moving_group_notes(*load.groups, load.analysis, "load case " + load.name + ": ", notes_);
  }
}

void Realizer::taper_of_stages() {
  if (!made_.sequence) return;
  for (StageResult& row : made_.sequence->stages) {
    if (!row.complex || !*row.complex || !row.analysis) continue;
    const topology::AuditedComplex& complex = **row.complex;
    row.tapered = stability::held_by_taper(complex, settings(complex.complex()), *row.analysis);
  }
}

void Realizer::held_by_micro_blocks() {
  made_.held_by_crumbs.reset();
  if (scene_->micro_blocks.policy != MicroBlockPolicy::report || near_) return;
  const auto crumbs_of = [&](const topology::BlockComplex& complex) {
    return micro_blocks(complex, scene_->micro_blocks);
  };
  const topology::AuditedComplex& complex = *made_.complex;
  const auto crumbs = crumbs_of(complex.complex());
  const stability::Together most = together(*scene_, options_.threads);
  made_.held_by_crumbs =
      held_by_crumbs(complex, settings(complex.complex()), *made_.analysis, made_.key_groups, crumbs, most);
  for (std::size_t k = 0; k < made_.load_cases.size(); ++k) {
    const CaseResult& load = made_.load_cases[k];
    const stability::Settings pushed =
        settings_on(complex.complex(), *scene_, made_, scene_->stability->cases[k].loads);
    add_crumb_notes(held_by_crumbs(complex, pushed, load.analysis, load.groups, crumbs, most), made_.held_by_crumbs,
                    "load case " + load.name + ": ", notes_);
  }
  if (!made_.sequence) return;
  for (const StageResult& row : made_.sequence->stages) {
    if (!row.complex || !*row.complex || !row.analysis) continue;
    const topology::AuditedComplex& stage = **row.complex;
    add_crumb_notes(
        held_by_crumbs(stage, settings(stage.complex()), *row.analysis, row.groups, crumbs_of(stage.complex()), most),
        made_.held_by_crumbs, "after stage " + std::to_string(row.stage) + ": ", notes_);
  }
}

void Realizer::supported_by_micro_blocks() {
  if (scene_->micro_blocks.policy != MicroBlockPolicy::report || near_ || detail_ != Detail::shown) return;
  const topology::AuditedComplex& complex = *made_.complex;
  const auto crumbs = micro_blocks(complex.complex(), scene_->micro_blocks);
  add_supported_by_crumbs_note(complex, settings(complex.complex()), scene_->support->plan, *made_.support, crumbs, "",
                               notes_);
  for (std::size_t k = 0; k < made_.support_cases.size(); ++k) {
    const CaseSupport& load = made_.support_cases[k];
    const LoadCase& stated = scene_->stability->cases[k];
    add_supported_by_crumbs_note(complex, settings_on(complex.complex(), *scene_, made_, stated.loads),
                                 plan_under(stated, scene_->support->plan), load.support, crumbs,
                                 "load case " + load.name + ": ", notes_);
  }
}

/// Each stage, with what fell before it: a state of its own, in which groups may move that do not in the final one.
void Realizer::judge_groups_of_stages() {
  if (!made_.sequence) return;
  for (StageResult& row : made_.sequence->stages) {
    if (!row.complex || !*row.complex || !row.analysis) continue;
    const topology::AuditedComplex& complex = **row.complex;
    row.groups = stability::find_key_groups(complex, settings(complex.complex()), together(*scene_, options_.threads));
    const std::string after = "after stage " + std::to_string(row.stage);
    add_moving_group_notes(*row.groups, *row.analysis, after + ": ", notes_);
    for (std::size_t k = 0; k < row.cases.size(); ++k) {
      StageCase& under = row.cases[k];
      under.groups = stability::find_key_groups(
          complex, settings_on(complex.complex(), *scene_, made_, scene_->stability->cases[k].loads),
          together(*scene_, options_.threads));
      if (scene_->stability->decides_by_groups()) {
        const stability::Settings with =
            settings_on(complex.complex(), *scene_, made_, scene_->stability->cases[k].loads);
        stability::decide_by_groups(complex, with, *under.groups, under.analysis);
        under.key_blocks = count_key_blocks(under.analysis);
      }
      add_moving_group_notes(*under.groups, under.analysis, after + ", load case " + under.name + ": ", notes_);
    }
  }
}

void Realizer::support() {
  below_target_.clear();
  if (made_.undecided.empty())
    below_target_ = judge_support(*scene_, *made_.complex, *made_.analysis, made_, detail_, options_.threads);
  if (made_.undecided.empty()) supported_by_micro_blocks();
}

/// Whether it holds groups that miss their target, in the base case and in each load case; ensembles ask it where
/// groups decide.
void Realizer::support_of_groups() {
  made_.group_support.reset();
  for (CaseSupport& load : made_.support_cases) load.groups.reset();
  const topology::BlockComplex& complex = made_.complex->complex();
  if (!made_.key_groups && asks_what_turns()) find_groups(*made_.complex);
  if (!made_.key_groups || made_.key_groups->too_many) return;
  made_.group_support = groups_with_support(settings(complex), scene_->support->plan, *made_.support, "", 0);
  for (std::size_t k = 0; k < made_.support_cases.size(); ++k) {
    CaseSupport& load = made_.support_cases[k];
    const LoadCase& stated = scene_->stability->cases[k];
    load.groups = groups_with_support(settings_on(complex, *scene_, made_, stated.loads),
                                      plan_under(stated, scene_->support->plan), load.support,
                                      "load case " + load.name + ": ", k + 1);
  }
}

/// An ensemble that counts no groups: what only turns is asked as the replay of the realization asks it.
bool Realizer::asks_what_turns() const {
  if (scene_->stability->groups == stability::GroupsCheck::off) return false;
  return !made_.support->turning.empty() || std::ranges::any_of(made_.support_cases, [](const CaseSupport& load) {
    return !load.support.turning.empty();
  });
}

std::optional<stability::GroupSupport> Realizer::groups_with_support(const stability::Settings& settings,
                                                                     const stability::SupportPlan& plan,
                                                                     stability::SupportResult& support,
                                                                     std::string_view where, std::size_t number) {
  const stability::Together most = together(*scene_, options_.threads);
  assembly::UntiedSets untied;
  stability::GroupSupport found =
      number < below_target_.size()
          ? check_groups(*made_.complex, settings, plan, support, below_target_[number], untied, most)
          : check_groups(*made_.complex, settings, plan, support, most);
  if (found.too_many()) {
    notes_.push_back(too_many_with_support(where));
    return std::nullopt;
  }
  mark_bolts_of_groups(found, support);
  judge_turning(found, support);
  return found;
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
