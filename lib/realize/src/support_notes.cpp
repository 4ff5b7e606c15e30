#include "support_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "group_notes.hpp"
#include "holds_at_border.hpp"

namespace cleave::scene {
namespace {

/// Of the support of a stage, or of one under a load. `where`: before the note.
void add_stage_groups_notes(const std::optional<SupportedGroupFigures>& groups, bool too_many, const std::string& where,
                            std::vector<std::string>& notes) {
  if (too_many) notes.push_back(too_many_with_support(where));
  if (!groups || groups->all_held()) return;
  notes.push_back(
      fmt::format("{}the support installed by then does not hold {} of {} {} of blocks below the target ({:.4g} m3), "
                  "{} in doubt: see sequence in summary.json",
                  where, groups->not_held, groups->count, groups->count == 1 ? "group" : "groups",
                  groups->not_held_volume.si(), groups->in_doubt));
}

/// Key blocks that only turn and that nothing was asked to hold. `where`: the load case, before the note.
void add_turning_note(const stability::SupportResult& support, const std::optional<stability::GroupSupport>& groups,
                      std::string_view where, std::vector<std::string>& notes) {
  std::size_t unasked = 0;
  for (const stability::OnlyTurns& turning : support.turning) {
    const bool asked = groups && !groups->below.without_moments && !groups->left.without_moments &&
                       std::ranges::any_of(groups->below.groups, [&](const stability::KeyGroup& group) {
                         return std::ranges::binary_search(group.blocks, turning.block);
                       });
    unasked += turning.held || asked ? 0U : 1U;
  }
  if (unasked == 0) return;
  const bool one = unasked == 1;
  notes.push_back(
      fmt::format("{}{} that only turn{} {} with the support in translation alone, in which {} at rest: whether it "
                  "holds {} is not known, and it does not pass; groups = \"decide\" judges moments too",
                  where, one ? "1 key block" : fmt::format("{} key blocks", unasked), one ? "s" : "",
                  one ? "was judged" : "were judged", one ? "it is" : "they are", one ? "it" : "them"));
}

/// Bolts that grip where nothing is known of the rock.
void add_outside_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  std::size_t count = 0;
  double outside = 0, most = 0;
  for (const stability::BoltResult& bolt : support.bolts) {
    if (!(bolt.outside > Length{})) continue;
    ++count;
    outside += bolt.outside.si();
    most = std::max(most, bolt.outside.si());
  }
  if (count == 0) return;
  notes.push_back(fmt::format(
      "{} of {} bolts {} the domain through a side that is not free: {:.3g} m of {}{} lie outside and grip as rock "
      "that goes on there would; where air or an opening is there instead, enlarge the domain; see outside_m in "
      "bolts.csv",
      count, support.bolts.size(), count == 1 ? "leaves" : "leave", outside, count == 1 ? "it" : "them",
      count == 1 ? "" : fmt::format(", up to {:.3g} m of one,", most)));
}

/// Whether a bolt that a block moves askew to has a shear capacity, and too little grip in the block for it to count.
bool is_short_of_shear(const stability::BoltResult& bolt) {
  constexpr double askew = 1;  // degrees
  const stability::BoltType& type = bolt.bolt.type;
  const auto* bar = std::get_if<stability::GroutedBar>(&type.kind);
  const auto* tube = std::get_if<stability::FrictionTube>(&type.kind);
  const Force shear = bar != nullptr ? bar->shear : tube != nullptr ? tube->shear : Force{};
  if (bolt.status != stability::BoltStatus::holds || !bolt.serves || !(shear > Force{}) || !(bolt.angle > askew)) {
    return false;
  }
  double grip = 0;
  for (const stability::Pierced& p : bolt.pierced) {
    if (p.block == *bolt.serves) grip += stability::gripped_length(type, bolt.bolt.length.si(), p.from, p.to);
  }
  return !stability::anchors(type, grip);
}

void add_shear_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  const auto count = std::ranges::count_if(support.bolts, is_short_of_shear);
  if (count == 0) return;
  const bool one = count == 1;
  notes.push_back(fmt::format(
      "{} of {} bolts {} gripped less than {} anchorage in the block that {}: {} shear_capacity does not count there, "
      "the plate holds in tension alone; place bolts where the block is thicker, or lessen anchorage where less grip "
      "bears shear",
      count, support.bolts.size(), one ? "is" : "are", one ? "its" : "their", one ? "it serves" : "they serve",
      one ? "its" : "their"));
}

/// Bolts that are not in the rock at all.
void add_off_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  const auto off =
      std::ranges::count_if(support.bolts, [](const auto& b) { return b.status == stability::BoltStatus::off; });
  if (off == 0) return;
  notes.push_back(fmt::format(
      "{} of {} bolts {} off the rock: they point away from it, run in a free face of it, their heads stand where "
      "nothing is left, or the axis of their tunnel goes on outside the domain; they hold nothing; see bolts.csv",
      off, support.bolts.size(), off == 1 ? "is" : "are"));
}

}  // namespace

void add_stage_support_notes(const SequenceResult& sequence, std::vector<std::string>& notes) {
  for (const StageResult& row : sequence.stages) {
    if (!row.support) continue;
    const std::string after = fmt::format("after stage {}", row.stage);
    add_stage_groups_notes(row.support->groups, row.support->too_many, after + ": ", notes);
    for (const StageCase& under : row.cases) {
      add_stage_groups_notes(under.supported_groups, under.too_many,
                             fmt::format("{}, load case {}: ", after, under.name), notes);
      if (under.not_held.value_or(0) == 0 && under.combined_failing.value_or(0) == 0) continue;
      notes.push_back(
          fmt::format("after stage {}, load case {}: the support installed by then leaves {} {} and {} stitched bodies "
                      "below the required factors of safety",
                      row.stage, under.name, *under.not_held, *under.not_held == 1 ? "block" : "blocks",
                      under.combined_failing.value_or(0)));
    }
    if (row.support->spot_bolts > 0 && &row != &sequence.stages.back()) {
      notes.push_back(fmt::format(
          "after stage {} {} put in for what stands then: see after_stage in bolts.csv", row.stage,
          row.support->spot_bolts == 1 ? "1 spot bolt is" : fmt::format("{} spot bolts are", row.support->spot_bolts)));
    }
    if (row.support->not_held == 0 && row.support->combined_failing == 0) continue;
    notes.push_back(
        fmt::format("after stage {} the support installed by then leaves {} of {} blocks and {} stitched bodies below "
                    "the required factors of safety: see sequence in summary.json",
                    row.stage, row.support->not_held, row.support->blocks, row.support->combined_failing));
  }
}

void add_support_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  if (!made.support) return;
  add_holds_at_border_notes(made, notes);
  add_turning_note(*made.support, made.group_support, "", notes);
  for (const CaseSupport& load : made.support_cases) {
    add_turning_note(load.support, load.groups, fmt::format("load case {}: ", load.name), notes);
  }
  add_outside_note(*made.support, notes);
  add_shear_note(*made.support, notes);
  // Beyond what was cut on demand rock is not known.
  if (!made.window) add_off_note(*made.support, notes);
  if (scene.stability->groups == stability::GroupsCheck::off) {
    notes.emplace_back(
        "support: with groups = \"off\" it was not asked whether it holds blocks that move together, nor whether a "
        "bolt carries all blocks it goes through at once");
  }
}

}  // namespace cleave::scene
