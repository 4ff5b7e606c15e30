#include "group_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "cleave/realize/figures.hpp"

namespace cleave::scene {
namespace {

constexpr std::string_view see_groups = ": see key_groups.csv";

/// What the search for groups did not look at.
void add_unasked_notes(const stability::KeyGroups& groups, std::string_view where, std::vector<std::string>& notes) {
  if (groups.too_many) {
    notes.push_back(fmt::format(
        "{}key groups: {} blocks near free faces are too many to be judged together; only single blocks were "
        "judged, and what they say holds for each alone (groups = \"decide\" judges up to {})",
        where, groups.blocks, stability::most_together.blocks));
  }
  if (groups.without_moments) {
    notes.push_back(
        fmt::format("{}key groups: {} blocks near free faces were judged together in translation only; groups = "
                    "\"decide\" looks at "
                    "moments too",
                    where, groups.blocks));
  }
  if (groups.cut_off) {
    notes.push_back(fmt::format(
        "{}key groups: one that moves touches more blocks than are judged together; more may move than it says",
        where));
  }
}

}  // namespace

std::vector<stability::Barred> in_no_group(std::vector<stability::Barred> blocks,
                                           const std::optional<stability::KeyGroups>& groups) {
  if (!groups) return blocks;
  for (const stability::KeyGroup& group : groups->groups) {
    std::erase_if(blocks, [&](const auto& row) { return std::ranges::binary_search(group.blocks, row.block); });
  }
  return blocks;
}

std::string too_many_with_support(std::string_view where) {
  return std::string{where} +
         "support: at strengths over the target more blocks are near free faces than are judged together: whether it "
         "holds groups of blocks was not asked";
}

KeyGroupFigures count_key_groups(const stability::KeyGroups& groups) {
  KeyGroupFigures figures{.judged = !groups.too_many};
  Volume largest = {};
  for (const stability::KeyGroup& group : groups.groups) {
    const bool doubt = group.verdict == assembly::Verdict::in_doubt;
    figures.certain += group.verdict == assembly::Verdict::certain ? 1U : 0U;
    figures.unsafe += group.verdict == assembly::Verdict::unsafe ? 1U : 0U;
    figures.in_doubt += doubt ? 1U : 0U;
    if (doubt) continue;
    ++figures.count;
    figures.volume_m3 += group.volume.si();
    if (!group.factors) continue;
    figures.factor = std::min(figures.factor, group.factor_move);
    figures.least_factor = std::min(figures.least_factor, group.least_factor());
    if (!(group.volume > largest)) continue;
    largest = group.volume;
    figures.factor_of_largest = group.factor_of_largest.value_or(group.least_factor());
  }
  return figures;
}

void add_below_target(const stability::KeyGroups& found, KeyGroupFigures& figures) {
  figures.below_target = 0;
  for (const stability::KeyGroup& group : found.groups) {
    if (group.verdict == assembly::Verdict::in_doubt) continue;
    ++*figures.below_target;
    figures.below_target_volume += group.volume;
  }
}

namespace {

/// Never "1" for what moves.
std::string words_of_factor(double factor) {
  return factor < 1 && factor > 0.9995 ? "just below 1" : fmt::format("{:.3g}", factor);
}

/// Groups in doubt for one reason.
struct Doubts {
  std::size_t groups = 0, blocks = 0;
  Volume volume = {};
  void add(const stability::KeyGroup& group) {
    ++groups;
    blocks += group.blocks.size();
    volume += group.volume;
  }
  /// "3 groups of blocks", of which each has one block: "3 blocks".
  [[nodiscard]] std::string words() const {
    if (blocks == groups) return fmt::format("{} {}", blocks, blocks == 1 ? "block" : "blocks");
    return fmt::format("{} {} of blocks", groups, groups == 1 ? "group" : "groups");
  }
};

}  // namespace

void add_moving_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis,
                            std::string_view where, std::vector<std::string>& notes) {
  std::size_t beyond = 0;
  double volume = 0, least = std::numeric_limits<double>::infinity();
  Doubts weaker, undecided;
  for (const stability::KeyGroup& group : groups.groups) {
    if (group.verdict == assembly::Verdict::in_doubt) {
      (group.weaker ? weaker : undecided).add(group);
      continue;
    }
    const bool known = std::ranges::all_of(group.blocks, [&](topology::BlockId id) {
      const auto it = std::ranges::lower_bound(analysis.judgements, id, {}, &stability::Judgement::block);
      return it != analysis.judgements.end() && it->block == id && it->key;
    });
    if (known) continue;
    ++beyond;
    volume += group.volume.si();
    least = std::min(least, group.least_factor());
  }
  if (beyond > 0) {
    notes.push_back(
        fmt::format("{}{} key {} ({:.4g} m3) of blocks that do not all move by themselves, least factor of "
                    "safety {}{}",
                    where, beyond, beyond == 1 ? "group" : "groups", volume, words_of_factor(least), see_groups));
  }
  if (weaker.groups > 0) {
    notes.push_back(fmt::format(
        "{}{} ({:.4g} m3) at rest would move with 5 % less strength, half of the cohesion lost as it breaks "
        "bit by bit: in doubt, not stable{}",
        where, weaker.words(), weaker.volume.si(), see_groups));
  }
  if (undecided.groups > 0) {
    notes.push_back(fmt::format("{}{} ({:.4g} m3) could not be decided: in doubt, not stable{}", where,
                                undecided.words(), undecided.volume.si(), see_groups));
  }
  add_unasked_notes(groups, where, notes);
  if (groups.at_the_edge && beyond + weaker.groups + undecided.groups > 0) {
    notes.push_back(
        fmt::format("{}key groups reach the edge of the box that was cut: what lies beyond was taken to stay, so that "
                    "more may move; [output] blocks = \"all\" takes it in",
                    where));
  }
}

void add_group_support_notes(const stability::GroupSupport& groups, std::string_view where,
                             std::vector<std::string>& notes) {
  const SupportedGroupFigures f = count_supported_groups(groups);
  if (f.not_held > 0) {
    notes.push_back(
        fmt::format("{}the support does not hold {} {} of blocks ({:.4g} m3) that move together below their target: "
                    "see supported_groups.csv",
                    where, f.not_held, f.not_held == 1 ? "group" : "groups", f.not_held_volume.si()));
  }
  if (f.in_doubt > 0) {
    notes.push_back(fmt::format(
        "{}whether the support holds {} {} of blocks could not be decided, or lies within 5 % of the target: in "
        "doubt, not held: see supported_groups.csv",
        where, f.in_doubt, f.in_doubt == 1 ? "group" : "groups"));
  }
  if (groups.below.without_moments || groups.left.without_moments) {
    notes.push_back(
        fmt::format("{}support: {} blocks at strengths over the target were judged together in translation only: "
                    "whether it holds what turns or topples was not asked; groups = \"decide\" asks",
                    where, groups.below.blocks));
  }
  if (groups.below.cut_off || groups.left.cut_off) {
    notes.push_back(
        fmt::format("{}support: a group that moves at strengths over the target touches more blocks than are judged "
                    "together; more may have to be held than supported_groups.csv says",
                    where));
  }
  if (groups.below.at_the_edge || groups.left.at_the_edge) {
    notes.push_back(
        fmt::format("{}support: groups that move at strengths over the target reach the edge of the box that was cut: "
                    "what lies beyond was taken to stay, so that more may have to be held; [output] blocks = \"all\" "
                    "takes it in",
                    where));
  }
}

void add_design_notes(const std::vector<DesignResult>& designs, std::vector<std::string>& notes) {
  for (const DesignResult& design : designs) {
    if (design.found && design.failing > 0) {
      notes.push_back(fmt::format(
          "design: bolts of {:g} m hold where the pattern was tried, and miss a target at {} of {} random offsets of "
          "it "
          "({:.0f} to {:.0f} %): no pattern is set that exactly; see `offsets_failing`",
          design.length, design.failing, design.offsets, 100 * design.failing_share[0], 100 * design.failing_share[1]));
    }
    if (design.at_widest) {
      notes.push_back(
          fmt::format("design: bolts of {:g} m hold at {:.4g} x {:.4g} m, the widest that `scale` lets the search try: "
                      "no optimum; give `scale` a larger second number, or set bolts for what a pattern so wide is for",
                      design.length, design.spacing[0], design.spacing[1]));
    }
    if (!design.found && design.governing) {
      notes.push_back(fmt::format(
          "design: at the tightest pattern of bolts of {:g} m block {}, of {:.3g} m3, misses its target most "
          "often; what no bolt meets needs shotcrete, and crumbs can be left out by [micro_blocks]",
          design.length, *design.governing, design.governing_volume.si()));
    }
    if (!design.found || !design.groups || design.groups->all_held()) continue;
    const SupportedGroupFigures& groups = *design.groups;
    notes.push_back(fmt::format(
        "no pattern of bolts of {:g} m holds {} of {} {} of blocks that move together below their target, and {} {} in "
        "doubt: the one found holds single blocks and stitched bodies",
        design.length, groups.not_held, groups.count, groups.count == 1 ? "group" : "groups", groups.in_doubt,
        groups.in_doubt == 1 ? "is" : "are"));
  }
}

void add_let_go_note(const std::vector<std::optional<LetGo>>& outcomes, std::vector<std::string>& notes) {
  const auto count = [&](LetGo what) { return std::ranges::count(outcomes, std::optional{what}); };
  const auto moved = count(LetGo::moved), stayed = count(LetGo::stayed);
  const auto other = count(LetGo::stopped) + count(LetGo::not_tried);
  if (moved + stayed + other == 0) return;
  notes.push_back(
      fmt::format("groups in doubt, let go from rest as rigid blocks in motion for 0.2 s: {} moved, {} stayed, "
                  "{} could not be tried; a group that stayed is no proof: see let_go in key_groups.csv",
                  moved, stayed, other));
}

void add_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis, bool unasked,
                     std::vector<std::string>& notes) {
  add_moving_group_notes(groups, analysis, "", notes);
  if (unasked && (groups.too_many || !groups.groups.empty())) {
    notes.push_back(
        "the support was checked block by block and for stitched bodies: whether it holds groups of blocks was not "
        "asked");
  }
}

void add_below_target_note(const stability::KeyGroups& found, const stability::KeyGroups& groups, double target,
                           std::string_view where, std::vector<std::string>& notes) {
  KeyGroupFigures figures;
  add_below_target(found, figures);
  if (*figures.below_target <= count_key_groups(groups).count) return;
  notes.push_back(
      fmt::format("{}{} {} of blocks ({:.4g} m3) would move at strengths over the target of {:g} for sliding, {} "
                  "at strengths as they are",
                  where, *figures.below_target, *figures.below_target == 1 ? "group" : "groups",
                  figures.below_target_volume.si(), target, count_key_groups(groups).count));
}

void add_group_factor_note(const std::optional<stability::FactorTogether>& found, std::vector<std::string>& notes) {
  if (!found) {
    notes.emplace_back("group_factor: too many blocks near free faces to be judged together");
    return;
  }
  const std::string stands = found->stands > 0 ? fmt::format("strengths over {:.3g} all stands", found->stands)
                                               : "at no strengths up to tenfold is all clear of doubt";
  const std::size_t count = found->blocks.size();
  const std::string over = found->moves > 0 ? fmt::format("over {:.3g}", found->moves) : "even tenfold";
  const std::string moves =
      count == 0 ? "nothing moves at strengths over 10"
                 : fmt::format("{} {} {}, block {}{}", over, count, count == 1 ? "block moves" : "blocks move",
                               found->blocks.front().value(), count > 1 ? ", ..." : "");
  notes.push_back("all blocks near free faces together, of the base case when all is excavated, without support: " +
                  stands + ", " + moves + (found->without_moments ? "; in translation only: there are too many" : ""));
}

void add_target_notes(const Realization& made, std::vector<std::string>& notes) {
  if (made.groups_below_target) {
    add_unasked_notes(*made.groups_below_target, "at strengths over the target: ", notes);
  }
}

}  // namespace cleave::scene
