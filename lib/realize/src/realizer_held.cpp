// What stays in place by something that may not be there, in every state that a realization has.
#include <algorithm>
#include <string>

#include "crumbs.hpp"
#include "held_notes.hpp"
#include "judge.hpp"
#include "realizer.hpp"

namespace cleave::scene {

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
  const topology::AuditedComplex& complex = *made_.complex;
  const auto crumbs = micro_blocks(complex.complex(), scene_->micro_blocks);
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
    const auto of_stage = micro_blocks(stage.complex(), scene_->micro_blocks);
    add_crumb_notes(held_by_crumbs(stage, settings(stage.complex()), *row.analysis, row.groups, of_stage, most),
                    made_.held_by_crumbs, "after stage " + std::to_string(row.stage) + ": ", notes_);
  }
}

void Realizer::left_out_and_moving() {
  if (scene_->micro_blocks.policy != MicroBlockPolicy::exclude) return;
  const topology::AuditedComplex& complex = *made_.complex;
  std::vector<HeldByCrumbs::Row> known;
  add_left_out_note(complex, settings(complex.complex()), known, "", notes_);
  for (const LoadCase& load : scene_->stability->cases) {
    add_left_out_note(complex, settings_on(complex.complex(), *scene_, made_, load.loads), known,
                      "load case " + load.name + ": ", notes_);
  }
  if (!made_.sequence) return;
  for (const StageResult& row : made_.sequence->stages) {
    if (!row.complex || !*row.complex || !row.analysis) continue;
    add_left_out_note(**row.complex, settings((*row.complex)->complex()), known,
                      "after stage " + std::to_string(row.stage) + ": ", notes_);
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

}  // namespace cleave::scene
