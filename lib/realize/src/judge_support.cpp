#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/stochastic/statistics.hpp"
#include "judge.hpp"

namespace cleave::scene {
namespace {

using stability::Bolt;

/// Shares of a spacing by which offsets move.
struct Phase {
  double along = 0, around = 0;
};

/// An offset moved by a share of the scaled spacing, and back by a spacing where it goes beyond one. The whole spacings
/// of a stated offset are length without bolts: that stays.
Length moved(Length offset, Length spacing, double scale, double share) {
  constexpr double rounding = 1e-9;  // 0.3 is three times 0.1
  const Length bare = std::floor(offset / spacing + rounding) * spacing;
  const Length scaled = scale * spacing;
  return bare + metres(std::fmod(std::max(0.0, (offset - bare + share * scaled).si()), scaled.si()));
}

/// All bolts with the spacings times `scale`, another length, and the offsets moved by a share of a spacing.
std::vector<Bolt> bolts_with(const SupportSettings& support, double scale, double length, Phase phase) {
  std::vector<Bolt> bolts = support.single;
  for (const auto& pattern : support.patterns) {
    const auto more =
        std::visit(overloaded{[&](stability::RingPattern ring) {
                                ring.offset_along = moved(ring.offset_along, ring.along, scale, phase.along);
                                ring.offset_around = moved(ring.offset_around, ring.around, scale, phase.around);
                                ring.along *= scale;
                                ring.around *= scale;
                                ring.length = metres(length);
                                return bolts_of(ring);
                              },
                              [&](stability::GridPattern grid) {
                                grid.spacing_across *= scale;
                                grid.spacing_down *= scale;
                                grid.offset_across += phase.along * grid.spacing_across;
                                grid.offset_down += phase.around * grid.spacing_down;
                                grid.length = metres(length);
                                return bolts_of(grid);
                              }},
                   pattern);
    bolts.insert(bolts.end(), more.begin(), more.end());
  }
  return bolts;
}

std::size_t rings_of(stability::RingPattern ring, double scale) {
  ring.offset_along = moved(ring.offset_along, ring.along, scale, 0);
  ring.along *= scale;
  ring.offset_around = {};
  ring.around = metres(std::numeric_limits<double>::max());  // one bolt a ring
  ring.stagger = false;
  return bolts_of(ring).size();
}

/// Beside those of draw.cpp for the whole scene.
constexpr auto offsets_stream = static_cast<Draw>(66);

/// How much of the groups of blocks a pattern holds. Each value holds what the ones before it do.
enum class GroupsHeld : std::uint8_t {
  unasked,     ///< single blocks and stitched bodies alone
  none_moves,  ///< no group moves; some may be in doubt
  all,
};

stability::SupportPlan with_targets(stability::SupportPlan plan, const Targets& target) {
  plan.target_falling = target.falling;
  plan.target_sliding = target.sliding;
  return plan;
}

/// Spot bolts where one load after the other asks for them beside what stands by then: under every load all of them
/// stand. `checks`: of a plan under each load.
void place_spot_bolts(stability::SupportPlan& plan, auto& checks) {
  const bool factors = std::exchange(plan.factors, false);
  for (auto& check : checks) std::ranges::copy(newly_placed(check(plan), plan), std::back_inserter(plan.placed));
  plan.factors = factors;
  plan.spot.reset();
}
/// One load alone places them as it is checked.
stability::SupportPlan with_spot_bolts(stability::SupportPlan plan, auto& checks) {
  if (plan.spot && checks.size() > 1) place_spot_bolts(plan, checks);
  return plan;
}

/// What a search asks of a plan under one load case.
class PlanCheck {
 public:
  /// `plan` has the targets. `groups`: whether blocks are judged together too.
  PlanCheck(const topology::AuditedComplex& complex, stability::Settings settings, const stability::Analysis& analysis,
            const stability::SupportPlan& plan, std::optional<stability::Together> groups)
      : complex_{&complex},
        settings_{std::move(settings)},
        analysis_{&analysis},
        target_{.falling = plan.target_falling, .sliding = plan.target_sliding} {
    if (!groups) return;
    stability::KeyGroups below = stability::groups_below_target(complex, settings_, plan, *groups);
    if (below.too_many || below.groups.empty()) return;
    below_ = std::move(below);
    together_ = *groups;
  }
  [[nodiscard]] bool has_groups() const noexcept { return below_.has_value(); }
  [[nodiscard]] const std::vector<topology::BlockId>& undecided() const noexcept { return undecided_; }

  stability::SupportResult operator()(const stability::SupportPlan& plan) {
    stability::SupportResult result = check_support(*complex_, settings_, *analysis_, with_targets(plan, target_));
    undecided_.insert(undecided_.end(), result.undecided.begin(), result.undecided.end());
    return result;
  }
  /// Where `has_groups`.
  [[nodiscard]] stability::GroupSupport groups(const stability::SupportPlan& plan,
                                               const stability::SupportResult& result) const {
    return check_groups(*complex_, settings_, with_targets(plan, target_), result, *below_, *untied_, together_);
  }

 private:
  const topology::AuditedComplex* complex_;
  stability::Settings settings_;
  const stability::Analysis* analysis_;
  Targets target_;  ///< of the load case
  std::optional<stability::KeyGroups> below_;
  std::unique_ptr<assembly::UntiedSets> untied_ = std::make_unique<assembly::UntiedSets>();
  stability::Together together_;
  std::vector<topology::BlockId> undecided_;
};

bool holds(const stability::GroupSupport& groups, GroupsHeld asked) {
  if (groups.too_many()) return false;  // nothing is known
  const SupportedGroupFigures figures = count_supported_groups(groups);
  return asked == GroupsHeld::none_moves ? figures.not_held == 0 : figures.all_held();
}

/// Looks for the widest spacings of one length of bolt.
class DesignSearch {
 public:
  /// Every check must pass: that of the base case and of each load case.
  DesignSearch(const SupportSettings& support, double length, std::uint64_t seed, std::span<PlanCheck> checks)
      : support_{&support}, length_{length}, seed_{seed}, checks_{checks}, plan_{support.plan} {
    if (!support.design->spot) plan_.spot.reset();  // spot bolts would hide what the pattern lacks
    plan_.factors = false;
  }

  DesignResult run() {
    const DesignSettings& design = *support_->design;
    DesignResult row{.length = length_};
    double scale = design.tightest;
    row.found = passes(scale);
    if (row.found) {
      scale = widest(design.widest);
      if (has_groups()) scale = widest_with_groups(scale);
      row.at_widest = scale == design.widest;
      plan_.bolts = bolts_with(*support_, scale, length_, {});
      row.bolts = plan_.bolts.size();
      row.cost = static_cast<double>(row.bolts) * (design.cost_per_bolt + design.cost_per_metre * length_);
      if (plan_.spot) {
        const stability::SupportPlan whole = with_spot_bolts(plan_, checks_);
        for (PlanCheck& check : checks_) row.spot_bolts = std::max(row.spot_bolts, check(whole).spot_bolts);
        row.cost += static_cast<double>(row.spot_bolts) *
                    (design.cost_per_bolt + design.cost_per_metre * plan_.spot->length.si());
      }
    }
    row.scale = scale;
    if (has_groups()) row.groups = groups_at(scale);
    describe(scale, row);
    try_offsets(scale, row);
    if (!row.found) row.scale = 0;
    return row;
  }

 private:
  /// A pattern is as good as its worst place: every phase must pass.
  bool passes(double scale) {
    for (std::uint32_t k = 0; k < support_->design->phases; ++k) {
      place(scale, k);
      const stability::SupportPlan whole = with_spot_bolts(plan_, checks_);
      for (PlanCheck& check : checks_) {
        const stability::SupportResult result = check(whole);
        if (!result.passes()) return false;
        if (asks_groups(check) && !holds(check.groups(whole, result), asked_)) return false;
      }
    }
    return true;
  }
  [[nodiscard]] bool has_groups() const { return std::ranges::any_of(checks_, &PlanCheck::has_groups); }
  [[nodiscard]] bool asks_groups(const PlanCheck& check) const {
    return asked_ != GroupsHeld::unasked && check.has_groups();
  }
  void place(double scale, std::uint32_t phase) {
    const double share = static_cast<double>(phase) / support_->design->phases;
    plan_.bolts = bolts_with(*support_, scale, length_, {share, share});
  }

  /// The tightest pattern passes.
  double widest(double high) {
    double low = support_->design->tightest;
    if (passes(high)) return high;
    for (int i = 0; i < 7; ++i) {
      const double middle = std::sqrt(low * high);
      (passes(middle) ? low : high) = middle;
    }
    return low;
  }

  /// `high` holds block by block. Groups that even the tightest pattern leaves in doubt, or does not hold, do not
  /// decide on it: they are said.
  double widest_with_groups(double high) {
    for (const GroupsHeld ask : {GroupsHeld::all, GroupsHeld::none_moves}) {
      asked_ = ask;
      if (passes(high)) return high;
      if (passes(support_->design->tightest)) return widest(high);
    }
    asked_ = GroupsHeld::unasked;
    return high;
  }

  /// At the worst of the phases and load cases.
  SupportedGroupFigures groups_at(double scale) {
    std::optional<SupportedGroupFigures> worst;
    const auto lacks = [](const SupportedGroupFigures& f) { return std::pair{f.not_held, f.in_doubt}; };
    for (std::uint32_t k = 0; k < support_->design->phases; ++k) {
      place(scale, k);
      const stability::SupportPlan whole = with_spot_bolts(plan_, checks_);
      for (PlanCheck& check : checks_) {
        if (!check.has_groups()) continue;
        const SupportedGroupFigures now = count_supported_groups(check.groups(whole, check(whole)));
        if (!worst || lacks(now) > lacks(*worst)) worst = now;
      }
    }
    return worst.value_or(SupportedGroupFigures{});
  }

  void describe(double scale, DesignResult& row) const {
    std::visit(overloaded{[&](const stability::RingPattern& ring) {
                            row.spacing = {scale * ring.along.si(), scale * ring.around.si()};
                            row.rings = rings_of(ring, scale);
                          },
                          [&](const stability::GridPattern& grid) {
                            row.spacing = {scale * grid.spacing_across.si(), scale * grid.spacing_down.si()};
                          }},
               support_->patterns.front());
  }

  /// How often a block was not held.
  using Missing = std::map<topology::BlockId, std::uint64_t>;

  /// Whether the plan as it lies holds everything under one load case.
  bool held_under(PlanCheck& check, const stability::SupportPlan& plan, Missing& missing) {
    const stability::SupportResult result = check(plan);
    bool held = result.passes();
    if (held && asks_groups(check)) {
      const stability::GroupSupport groups = check.groups(plan, result);
      held = holds(groups, asked_);
      if (!held && !groups.left.groups.empty()) ++missing[groups.left.groups.front().blocks.front()];
    }
    for (const stability::SupportedBlock& b : result.blocks) {
      if (b.held == stability::Held::not_held) ++missing[b.block];
    }
    for (const stability::CombinedBlock& b : result.combined) {
      if (!b.passes) ++missing[b.members.front()];
    }
    return held;
  }

  /// The phases of the search are a few places of the pattern; what share of all places fails is another question.
  void try_offsets(double scale, DesignResult& row) {
    Missing missing;
    Rng rng{{.seed = seed_, .purpose = stream_purpose(0, offsets_stream), .index = 0}};
    row.offsets = support_->design->offsets;
    for (std::uint64_t k = 0; k < row.offsets; ++k) {
      const double along = rng.uniform(), around = rng.uniform();
      plan_.bolts = bolts_with(*support_, scale, length_, {along, around});
      bool held = true;
      const stability::SupportPlan whole = with_spot_bolts(plan_, checks_);
      for (PlanCheck& check : checks_) held = held_under(check, whole, missing) && held;
      row.failing += held ? 0U : 1U;
    }
    const stochastic::Interval share = stochastic::clopper_pearson(row.failing, row.offsets, 0.95);
    row.failing_share = {share.low, share.high};
    if (!missing.empty()) {
      row.governing = std::ranges::max_element(missing, {}, [](const auto& m) { return m.second; })->first.value();
    } else {
      name_least(scale, row);
    }
  }

  /// The block nearest to its target.
  void name_least(double scale, DesignResult& row) {
    plan_.factors = true;
    plan_.bolts = bolts_with(*support_, scale, length_, {});
    double least = std::numeric_limits<double>::infinity();
    const auto ask = [&](topology::BlockId block, std::optional<double> factor, double target) {
      if (!factor || !(*factor / target < least)) return;
      least = *factor / target;
      row.governing = block.value();
    };
    const stability::SupportPlan whole = with_spot_bolts(plan_, checks_);
    for (PlanCheck& check : checks_) {
      const stability::SupportResult result = check(whole);
      for (const stability::SupportedBlock& b : result.blocks) ask(b.block, b.factor_with_support, b.target);
      for (const stability::CombinedBlock& b : result.combined) ask(b.members.front(), b.factor_with_support, b.target);
    }
    plan_.factors = false;
  }

  const SupportSettings* support_;
  double length_;
  std::uint64_t seed_;
  std::span<PlanCheck> checks_;
  stability::SupportPlan plan_;
  GroupsHeld asked_ = GroupsHeld::unasked;
};

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

void judge_support_in_stages(const Scene& scene, Realization& made, unsigned threads) {
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
    const stability::SupportResult installed = checks.front()(plan);
    bool fails_under_load = false;
    for (std::size_t k = 0; k < row.cases.size(); ++k) {
      const SupportFigures found = count_support(checks[k + 1](plan));
      row.cases[k].not_held = found.not_held;
      row.cases[k].combined_failing = found.combined_failing;
      fails_under_load = fails_under_load || found.not_held > 0 || found.combined_failing > 0;
    }
    const SupportFigures with = count_support(installed);
    std::optional<stability::GroupSupport> groups;
    if (scene.stability->groups != stability::GroupsCheck::off) {
      groups = check_groups(complex, settings, plan, installed, together(scene, threads));
    }
    const bool too_many = groups && groups->too_many();
    std::erase_if(plan.bolts, later(row.stage));
    std::erase_if(plan.placed, later(row.stage));
    plan.shotcrete.reset();
    const SupportFigures before = count_support(check_support(complex, settings, *row.analysis, plan));
    row.support = StageSupport{.blocks = with.blocks,
                               .bolts_before = before.bolts,
                               .not_held_before = before.not_held,
                               .bolts = with.bolts,
                               .spot_bolts = made.spot_bolts_of_stages.size() - earlier,
                               .not_held = with.not_held,
                               .combined_failing = with.combined_failing,
                               .too_many = too_many};
    if (groups && !too_many) row.support->groups = count_supported_groups(*groups);
    row.support->fails_under_load = fails_under_load;
  }
}

void judge_support(const Scene& scene, const topology::AuditedComplex& complex, const stability::Analysis& analysis,
                   Realization& made, Detail detail, unsigned threads) {
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
  if (!support.design || detail == Detail::counted || !made.undecided.empty()) return;
  const bool groups = scene.stability->groups != stability::GroupsCheck::off;
  const auto asked = groups ? std::optional{together(scene, threads)} : std::nullopt;
  std::vector<PlanCheck> checks;
  checks.emplace_back(complex, settings, analysis, support.plan, asked);
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const LoadCase& load = scene.stability->cases[k];
    checks.emplace_back(complex, settings_on(complex.complex(), scene, made, load.loads), made.load_cases[k].analysis,
                        plan_under(load, support.plan), asked);
  }
  for (const double length : support.design->lengths) {
    DesignResult& design = made.designs.emplace_back(DesignSearch{support, length, scene.seed, checks}.run());
    if (!design.governing) continue;
    design.governing_volume = complex.complex().blocks()[topology::BlockId{*design.governing}].volume;
  }
  for (const PlanCheck& check : checks) note(check.undecided(), made);
}

}  // namespace cleave::scene
