#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "judge.hpp"
#include "support_plans.hpp"

namespace cleave::scene {
namespace {

using stability::Bolt;

void note(const std::vector<topology::BlockId>& undecided, Realization& made) {
  made.undecided.insert(made.undecided.end(), undecided.begin(), undecided.end());
}

}  // namespace

Length longest_bolt(const Scene& scene) {
  Length longest;
  if (!scene.support) return longest;
  for (const Bolt& bolt : scene.support->plan.bolts) longest = std::max(longest, bolt.length);
  if (scene.support->plan.spot) longest = std::max(longest, scene.support->plan.spot->length);
  if (scene.support->design) {
    for (const double length : scene.support->design->lengths) longest = std::max(longest, metres(length));
  }
  return longest;
}

std::optional<Length> tunnel_length(const std::vector<ExcavationInfo>& excavations) {
  std::optional<Length> length;
  for (const ExcavationInfo& excavation : excavations) {
    if (!excavation.tunnel) continue;
    const auto& axis = excavation.tunnel->axis;
    const double inside = 1 - excavation.outside_share.value_or(0);
    length = length.value_or(Length{});
    for (std::size_t i = 0; i + 1 < axis.size(); ++i) *length += metres(inside * geometry::norm(axis[i + 1] - axis[i]));
  }
  return length;
}

stability::Together together(const Scene& scene, unsigned threads) {
  stability::Together out = scene.stability->decides_by_groups() ? stability::most_together : stability::most_noted;
  out.threads = threads;
  return out;
}

stability::SupportPlan plan_under(const LoadCase& load, stability::SupportPlan plan) {
  return load.target ? with_targets(std::move(plan), *load.target) : plan;
}

void forget_cases_and_support(Realization& made) {
  made.load_cases.clear();
  made.support.reset();
  made.support_cases.clear();
  made.designs.clear();
  made.spot_bolts_of_stages.clear();
  made.undecided.clear();
}

void judge_cases(const Scene& scene, const topology::AuditedComplex& complex, Realization& made) {
  for (const LoadCase& load : scene.stability->cases) {
    made.load_cases.push_back(
        {load.name, stability::analyse(complex, settings_on(complex.complex(), scene, made, load.loads))});
    note(made.load_cases.back().analysis.undecided, made);
  }
}

void judge_cases_in_stages(const Scene& scene, Realization& made) {
  for (StageResult& row : made.sequence->stages) {
    row.cases.clear();
    if (!row.complex || !*row.complex || !row.analysis) continue;
    for (const LoadCase& load : scene.stability->cases) {
      const topology::AuditedComplex& complex = **row.complex;
      StageCase& under = row.cases.emplace_back(
          StageCase{load.name, stability::analyse(complex, settings_on(complex.complex(), scene, made, load.loads))});
      under.key_blocks = count_key_blocks(under.analysis);
    }
  }
}

namespace {

using Check = std::function<stability::SupportResult(const stability::SupportPlan&)>;

/// Checks of a plan in the base case and under each load; `cases`: what moves under each.
std::vector<Check> checks_of(const Scene& scene, const Realization& made, const topology::AuditedComplex& complex,
                             const stability::Analysis& base, std::span<const stability::Analysis* const> cases) {
  std::vector<Check> checks{[&](const stability::SupportPlan& plan) {
    return check_support(complex, settings_on(complex.complex(), scene, made, scene.stability->loads), base, plan);
  }};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    checks.emplace_back([&, k, analysis = cases[k]](const stability::SupportPlan& plan) {
      const LoadCase& load = scene.stability->cases[k];
      return check_support(complex, settings_on(complex.complex(), scene, made, load.loads), *analysis,
                           plan_under(load, plan));
    });
  }
  return checks;
}

template <class Case>
std::vector<const stability::Analysis*> analyses_of(const std::vector<Case>& cases) {
  std::vector<const stability::Analysis*> out;
  for (const Case& under : cases) out.push_back(&under.analysis);
  return out;
}

}  // namespace

void judge_support_in_stages(const Scene& scene, Realization& made, bool with_groups, unsigned threads) {
  // What only turns is asked of groups, in ensembles that count none, too.
  const auto asks = [&](const stability::SupportResult& support) {
    return with_groups || (!support.turning.empty() && scene.stability->groups != stability::GroupsCheck::off);
  };
  for (StageResult& row : made.sequence->stages) {
    if (!row.complex || !*row.complex || !row.analysis) continue;
    const topology::AuditedComplex& complex = **row.complex;
    const stability::Settings settings = settings_on(complex.complex(), scene, made, scene.stability->loads);
    stability::SupportPlan plan = scene.support->plan;
    plan.factors = false;
    const auto later = [&](std::uint32_t first) {
      return [first](const Bolt& bolt) { return bolt.after_stage >= first; };
    };
    std::erase_if(plan.bolts, later(row.stage + 1));
    plan.placed = made.spot_bolts_of_stages;
    const std::vector<const stability::Analysis*> under = analyses_of(row.cases);
    std::vector<Check> checks = checks_of(scene, made, complex, *row.analysis, under);
    const std::size_t earlier = plan.placed.size();
    if (plan.spot) place_spot_bolts(plan, checks);
    for (std::size_t k = earlier; k < plan.placed.size(); ++k) plan.placed[k].after_stage = row.stage;
    made.spot_bolts_of_stages = plan.placed;
    stability::SupportResult installed = checks.front()(plan);
    bool fails_under_load = false;
    for (std::size_t k = 0; k < row.cases.size(); ++k) {
      stability::SupportResult under_load = checks[k + 1](plan);
      StageCase& stage_case = row.cases[k];
      if (asks(under_load)) {
        const LoadCase& load = scene.stability->cases[k];
        const auto groups = check_groups(complex, settings_on(complex.complex(), scene, made, load.loads),
                                         plan_under(load, plan), under_load, together(scene, threads));
        judge_turning(groups, under_load);
        stage_case.too_many = groups.too_many();
        if (!stage_case.too_many) stage_case.supported_groups = count_supported_groups(groups);
      }
      const SupportFigures found = count_support(under_load);
      stage_case.not_held = found.not_held + found.turning_not_held;
      stage_case.combined_failing = found.combined_failing;
      fails_under_load = fails_under_load || stage_case.fails();
      stage_case.at_border = {under_load.held_by_border, under_load.sprayed_at_border};
    }
    std::optional<stability::GroupSupport> groups;
    if (asks(installed)) groups = check_groups(complex, settings, plan, installed, together(scene, threads));
    if (groups) judge_turning(*groups, installed);
    const SupportFigures with = count_support(installed);
    const bool too_many = groups && groups->too_many();
    std::erase_if(plan.bolts, later(row.stage));
    std::erase_if(plan.placed, later(row.stage));
    plan.shotcrete.reset();
    const SupportFigures before = count_support(check_support(complex, settings, *row.analysis, plan));
    row.support = StageSupport{.blocks = with.blocks + with.turning,
                               .bolts_before = before.bolts,
                               .not_held_before = before.not_held,
                               .bolts = with.bolts,
                               .spot_bolts = made.spot_bolts_of_stages.size() - earlier,
                               .not_held = with.not_held + with.turning_not_held,
                               .combined_failing = with.combined_failing,
                               .too_many = too_many};
    if (groups && !too_many) row.support->groups = count_supported_groups(*groups);
    row.support->fails_under_load = fails_under_load;
    row.support->at_border = {installed.held_by_border, installed.sprayed_at_border};
  }
}

std::vector<stability::KeyGroups> judge_support(const Scene& scene, const topology::AuditedComplex& complex,
                                                const stability::Analysis& analysis, Realization& made, Detail detail,
                                                unsigned threads) {
  const stability::Settings settings = settings_on(complex.complex(), scene, made, scene.stability->loads);
  const SupportSettings& support = *scene.support;
  stability::SupportPlan plan = support.plan;
  plan.factors = plan.factors && detail == Detail::shown;
  plan.placed = made.spot_bolts_of_stages;
  const std::vector<const stability::Analysis*> under = analyses_of(made.load_cases);
  std::vector<Check> by_load = checks_of(scene, made, complex, analysis, under);
  plan = with_spot_bolts(std::move(plan), by_load);
  made.support = by_load.front()(plan);
  note(made.support->undecided, made);
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    made.support_cases.push_back({scene.stability->cases[k].name, by_load[k + 1](plan)});
    note(made.support_cases.back().support.undecided, made);
  }
  if (!support.design || detail == Detail::counted || !made.undecided.empty()) return {};
  return search_designs(scene, complex, analysis, made, threads);
}

}  // namespace cleave::scene
