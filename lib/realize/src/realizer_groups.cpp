// Blocks judged together, in every state that a realization has.
#include <algorithm>
#include <string>

#include "group_notes.hpp"
#include "judge.hpp"
#include "realizer.hpp"

namespace cleave::scene {

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

std::optional<stability::KeyGroups> Realizer::groups_below(const topology::AuditedComplex& complex,
                                                           const stability::Settings& settings,
                                                           const std::optional<stability::KeyGroups>& groups,
                                                           const std::optional<Targets>& target) const {
  if (!target || scene_->support || !groups || groups->too_many) return std::nullopt;
  stability::SupportPlan plan;
  plan.target_sliding = target->sliding;
  return stability::groups_below_target(complex, settings, plan, together(*scene_, options_.threads));
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

}  // namespace cleave::scene
