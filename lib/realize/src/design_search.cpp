#include <algorithm>
#include <cmath>
#include <cstdint>
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
#include "support_plans.hpp"

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

/// What a search asks of a plan under one load case.
class PlanCheck {
 public:
  /// `plan` has the targets. `below`: groups that miss them, where blocks are judged together too.
  PlanCheck(const topology::AuditedComplex& complex, stability::Settings settings, const stability::Analysis& analysis,
            const stability::SupportPlan& plan, const stability::KeyGroups* below, stability::Together together)
      : complex_{&complex},
        settings_{std::move(settings)},
        analysis_{&analysis},
        target_{.falling = plan.target_falling, .sliding = plan.target_sliding} {
    if (below == nullptr || below->too_many || below->groups.empty()) return;
    below_ = *below;
    together_ = together;
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

/// What a pattern leaves of the groups.
struct GroupsLeft {
  SupportedGroupFigures figures;
  bool too_many = false;  ///< nothing is known
};

GroupsLeft groups_left(const stability::GroupSupport& groups) {
  return {count_supported_groups(groups), groups.too_many()};
}

bool holds(const GroupsLeft& groups, GroupsHeld asked) {
  if (groups.too_many) return false;
  return asked == GroupsHeld::none_moves ? groups.figures.not_held == 0 : groups.figures.all_held();
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
      Placed placed{*this, scale, k};
      for (std::size_t c = 0; c < checks_.size(); ++c) {
        if (!placed.passes(c)) return false;
        if (asks_groups(checks_[c]) && !holds(placed.groups(c), asked_)) return false;
      }
    }
    return true;
  }

  /// What was found of one phase of a pattern under one load.
  struct Found {
    std::optional<bool> passes;  ///< block by block and stitched
    std::optional<GroupsLeft> groups;
  };
  /// A phase of the pattern with the spacings times `scale`. The search comes back to the same ones as it asks for more
  /// or less of the groups: what they hold is found once.
  class Placed {
   public:
    Placed(DesignSearch& search, double scale, std::uint32_t phase) : search_{&search}, scale_{scale}, phase_{phase} {
      std::vector<Found>& found = search.found_[{scale, phase}];
      found.resize(search.checks_.size());
      found_ = &found;
    }
    bool passes(std::size_t check) {
      Found& found = (*found_)[check];
      if (!found.passes) found.passes = search_->passes(checked(check), search_->checks_[check]);
      return *found.passes;
    }
    const GroupsLeft& groups(std::size_t check) {
      Found& found = (*found_)[check];
      if (!found.groups) {
        const stability::SupportResult result = checked(check);
        found.groups = groups_left(search_->checks_[check].groups(*whole_, result));
      }
      return *found.groups;
    }

   private:
    stability::SupportResult checked(std::size_t check) {
      if (!whole_) {
        search_->place(scale_, phase_);
        whole_ = with_spot_bolts(search_->plan_, search_->checks_);
      }
      return search_->checks_[check](*whole_);
    }
    DesignSearch* search_;
    double scale_;
    std::uint32_t phase_;
    std::vector<Found>* found_;
    std::optional<stability::SupportPlan> whole_;
  };
  [[nodiscard]] bool has_groups() const { return std::ranges::any_of(checks_, &PlanCheck::has_groups); }
  /// Block by block; what only turns is asked of groups.
  [[nodiscard]] bool passes(const stability::SupportResult& result, const PlanCheck& check) const {
    return result.passes() && (check.has_groups() || result.holds_what_turns());
  }
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
      Placed placed{*this, scale, k};
      for (std::size_t c = 0; c < checks_.size(); ++c) {
        if (!checks_[c].has_groups()) continue;
        const SupportedGroupFigures& now = placed.groups(c).figures;
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
    bool held = passes(result, check);
    if (held && asks_groups(check)) {
      const stability::GroupSupport groups = check.groups(plan, result);
      held = holds(groups_left(groups), asked_);
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
  std::map<std::pair<double, std::uint32_t>, std::vector<Found>> found_;  ///< of scale and phase
};

}  // namespace

std::vector<stability::KeyGroups> search_designs(const Scene& scene, const topology::AuditedComplex& complex,
                                                 const stability::Analysis& analysis, Realization& made,
                                                 unsigned threads) {
  const SupportSettings& support = *scene.support;
  const stability::Settings settings = settings_on(complex.complex(), scene, made, scene.stability->loads);
  const bool groups = scene.stability->groups != stability::GroupsCheck::off;
  const stability::Together most = together(scene, threads);
  std::vector<stability::KeyGroups> below;
  std::vector<PlanCheck> checks;
  const auto add = [&](const stability::Settings& with, const stability::Analysis& alone,
                       const stability::SupportPlan& plan) {
    if (groups) below.push_back(stability::groups_below_target(complex, with, plan, most));
    checks.emplace_back(complex, with, alone, plan, groups ? &below.back() : nullptr, most);
  };
  add(settings, analysis, support.plan);
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const LoadCase& load = scene.stability->cases[k];
    add(settings_on(complex.complex(), scene, made, load.loads), made.load_cases[k].analysis,
        plan_under(load, support.plan));
  }
  for (const double length : support.design->lengths) {
    DesignResult& design = made.designs.emplace_back(DesignSearch{support, length, scene.seed, checks}.run());
    if (!design.governing) continue;
    design.governing_volume = complex.complex().blocks()[topology::BlockId{*design.governing}].volume;
  }
  for (const PlanCheck& check : checks) {
    made.undecided.insert(made.undecided.end(), check.undecided().begin(), check.undecided().end());
  }
  return below;
}

}  // namespace cleave::scene
