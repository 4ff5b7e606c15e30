#include "crumbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave::scene {
namespace {

using topology::BlockId;

std::vector<BlockId> leaving(const stability::Analysis& analysis) {
  std::vector<BlockId> out;
  for (const stability::Batch& batch : analysis.batches)
    out.insert(out.end(), batch.blocks.begin(), batch.blocks.end());
  std::ranges::sort(out);
  return out;
}

/// Whether a group has crumbs among its blocks or right beside them, and is more than that.
bool leans_on(const topology::BlockComplex& complex, const stability::KeyGroup& group,
              const std::vector<BlockId>& crumbs) {
  const auto is_crumb = [&](BlockId id) { return std::ranges::binary_search(crumbs, id); };
  if (std::ranges::all_of(group.blocks, is_crumb)) return false;
  for (const BlockId id : group.blocks) {
    if (is_crumb(id)) return true;
    for (const topology::FaceId face : complex.blocks()[id].faces) {
      for (const topology::Patch& patch : complex.patches(complex.faces()[face])) {
        if (patch.neighbour && is_crumb(*patch.neighbour)) return true;
      }
    }
  }
  return false;
}

/// "a micro-block (0.004 m3 in all)", "7 micro-blocks (0.03 m3 in all)".
std::string text_of(std::size_t crumbs, Volume volume) {
  return fmt::format("{} ({:.3g} m3 in all)", crumbs == 1 ? "a micro-block" : fmt::format("{} micro-blocks", crumbs),
                     volume.si());
}

std::string counted_blocks(std::size_t count, double volume) {
  return fmt::format("{} ({:.4g} m3)", counted(count, "block", "blocks"), volume);
}

double volume_of(const std::vector<HeldByCrumbs::Row>& rows) {
  double volume = 0;
  for (const HeldByCrumbs::Row& row : rows) volume += row.volume.si();
  return volume;
}

double factor_of(const stability::Analysis& analysis, BlockId id) {
  const auto judged = std::ranges::lower_bound(analysis.judgements, id, {}, &stability::Judgement::block);
  return judged != analysis.judgements.end() && judged->block == id ? judged->factor_of_safety : 0;
}

/// Said once: under another load, or in another stage, it is the same block.
std::vector<HeldByCrumbs::Row> fresh(std::vector<HeldByCrumbs::Row> rows,
                                     const std::vector<HeldByCrumbs::Row>& others) {
  std::erase_if(rows, [&](const HeldByCrumbs::Row& own) {
    return std::ranges::any_of(others, [&](const HeldByCrumbs::Row& other) {
      return std::abs((own.volume - other.volume).si()) <= 1e-9 * own.volume.si();
    });
  });
  return rows;
}

/// Whether a group moves, or is in doubt, at the same factor where the crumbs are left out.
bool same_without(const stability::KeyGroup& group, const stability::KeyGroups& free) {
  if (free.too_many) return false;
  double least = std::numeric_limits<double>::infinity();
  for (const stability::KeyGroup& other : free.groups) {
    const bool shares =
        std::ranges::any_of(other.blocks, [&](BlockId id) { return std::ranges::binary_search(group.blocks, id); });
    if (!shares) continue;
    if (other.verdict != group.verdict) return false;
    least = std::min(least, other.least_factor());
  }
  return std::abs(least - group.least_factor()) <= 1e-6 * group.least_factor();
}

constexpr std::string_view leave_out = "[micro_blocks] policy = \"exclude\"";

}  // namespace

std::optional<HeldByCrumbs> held_by_crumbs(const topology::AuditedComplex& complex, stability::Settings settings,
                                           const stability::Analysis& analysis,
                                           const std::optional<stability::KeyGroups>& groups,
                                           std::vector<BlockId> crumbs, const stability::Together& most) {
  if (crumbs.empty()) return std::nullopt;
  const auto volume = [&](BlockId id) { return complex.complex().blocks()[id].volume; };
  HeldByCrumbs held{.crumbs = crumbs.size()};
  for (const BlockId id : crumbs) held.volume_of_crumbs += volume(id);
  std::vector<BlockId> known = leaving(analysis);
  std::vector<const stability::KeyGroup*> leaning;
  if (groups) {
    for (const stability::KeyGroup& group : groups->groups) {
      known.insert(known.end(), group.blocks.begin(), group.blocks.end());
      if (!leans_on(complex.complex(), group, crumbs)) continue;
      leaning.push_back(&group);
      HeldByCrumbs::Row& row = held.groups.emplace_back(
          HeldByCrumbs::Row{.block = group.blocks.front(), .factor_of_safety = group.least_factor()});
      for (const BlockId id : group.blocks) row.volume += volume(id);
    }
  }
  std::ranges::sort(known);
  settings.left_out = std::move(crumbs);
  const stability::Analysis without = stability::analyse(complex, settings);
  for (const BlockId id : leaving(without)) {
    const double factor = factor_of(without, id);
    for (std::size_t g = 0; g < leaning.size(); ++g) {
      const auto& blocks = leaning[g]->blocks;
      if (std::ranges::find(blocks, id) == blocks.end()) continue;
      held.groups[g].alone = std::min(held.groups[g].alone, factor);
    }
    if (!std::ranges::binary_search(known, id)) held.blocks.push_back({id, volume(id), factor});
  }
  if (!leaning.empty()) {
    const stability::KeyGroups free = stability::find_key_groups(complex, settings, most);
    std::vector<HeldByCrumbs::Row> rows;
    for (std::size_t g = 0; g < leaning.size(); ++g) {
      const HeldByCrumbs::Row& row = held.groups[g];
      if (row.alone < row.factor_of_safety || !same_without(*leaning[g], free)) rows.push_back(row);
    }
    held.groups = std::move(rows);
  }
  return held.blocks.empty() && held.groups.empty() ? std::nullopt : std::optional{std::move(held)};
}

void add_crumb_notes(const std::optional<HeldByCrumbs>& held, const std::optional<HeldByCrumbs>& known,
                     std::string_view where, std::vector<std::string>& notes) {
  if (!held) return;
  const std::vector<HeldByCrumbs::Row> none, blocks = fresh(held->blocks, known ? known->blocks : none),
                                             groups = fresh(held->groups, known ? known->groups : none);
  const std::string crumbs = text_of(held->crumbs, held->volume_of_crumbs);
  const std::string_view them = held->crumbs == 1 ? "it" : "them";
  if (!blocks.empty()) {
    const auto least = std::ranges::min_element(blocks, {}, &HeldByCrumbs::Row::factor_of_safety);
    notes.push_back(fmt::format(
        "{}{} {} only because of {}: without {} the least factor of safety is {:.3g} (block {}); count on no crumbs: "
        "{} leaves them out",
        where, counted_blocks(blocks.size(), volume_of(blocks)), blocks.size() == 1 ? "stays" : "stay", crumbs, them,
        least->factor_of_safety, least->block.value(), leave_out));
  }
  if (!groups.empty()) {
    const bool one = held->crumbs == 1;
    const auto least = std::ranges::min_element(groups, {}, &HeldByCrumbs::Row::factor_of_safety);
    const auto alone = std::ranges::min_element(groups, {}, &HeldByCrumbs::Row::alone);
    notes.push_back(
        fmt::format("{}{} on {}{}: what {} in {} {:.3g}{}; {} judges without", where,
                    counted(groups.size(), "key group leans", "key groups lean"), one ? "" : "some of ", crumbs,
                    one ? "it holds is" : "these hold is",
                    groups.size() == 1 ? "the factor of" : "their factors, the least of them", least->factor_of_safety,
                    alone->alone < least->factor_of_safety
                        ? fmt::format("; without {} a block of the group has {:.3g} by itself", them, alone->alone)
                        : "",
                    leave_out));
  }
}

void add_left_out_note(const topology::AuditedComplex& complex, stability::Settings settings,
                       std::vector<HeldByCrumbs::Row>& known, std::string_view where, std::vector<std::string>& notes) {
  const std::vector<BlockId> crumbs = std::exchange(settings.left_out, {});
  const stability::Analysis with = stability::analyse(complex, settings);
  std::vector<HeldByCrumbs::Row> rows;
  for (const BlockId id : leaving(with)) {
    const Volume volume = complex.complex().blocks()[id].volume;
    if (std::ranges::binary_search(crumbs, id)) rows.push_back({id, volume, factor_of(with, id)});
  }
  rows = fresh(std::move(rows), known);
  known.insert(known.end(), rows.begin(), rows.end());
  if (rows.empty()) return;
  const auto least = std::ranges::min_element(rows, {}, &HeldByCrumbs::Row::factor_of_safety);
  notes.push_back(fmt::format(
      "{}{} left out by [micro_blocks] would move, and {} in no count of key blocks: the least factor of safety is "
      "{:.3g} (block {}); policy = \"report\" judges such",
      where, counted_blocks(rows.size(), volume_of(rows)), rows.size() == 1 ? "is" : "are", least->factor_of_safety,
      least->block.value()));
}

void add_supported_by_crumbs_note(const topology::AuditedComplex& complex, stability::Settings settings,
                                  stability::SupportPlan plan, const stability::SupportResult& support,
                                  std::vector<BlockId> crumbs, std::string_view where,
                                  std::vector<std::string>& notes) {
  if (crumbs.empty()) return;
  Volume small;
  for (const BlockId id : crumbs) small += complex.complex().blocks()[id].volume;
  const std::string text = text_of(crumbs.size(), small);
  const std::string_view them = crumbs.size() == 1 ? "it" : "them";
  settings.left_out = std::move(crumbs);
  // The same bolts: none is placed for what falls then.
  plan.placed.clear();
  plan.placed = newly_placed(support, plan);
  plan.spot.reset();
  const stability::Analysis without = stability::analyse(complex, settings);
  const auto not_held = [](const stability::SupportResult& result) {
    std::vector<const stability::SupportedBlock*> rows;
    for (const stability::SupportedBlock& row : result.blocks) {
      if (row.held == stability::Held::not_held) rows.push_back(&row);
    }
    return rows;
  };
  const auto known = not_held(support);
  const auto fresh = [&](const stability::SupportResult& result) {
    std::vector<const stability::SupportedBlock*> rows = not_held(result);
    std::erase_if(rows, [&](const stability::SupportedBlock* row) {
      return std::ranges::any_of(known, [&](const auto* other) { return other->block == row->block; });
    });
    return rows;
  };
  plan.factors = false;
  if (fresh(check_support(complex, settings, without, plan)).empty()) return;
  plan.factors = true;
  const stability::SupportResult found = check_support(complex, settings, without, plan);
  const auto rows = fresh(found);
  const auto factor = [](const auto* row) { return row->factor_with_support.value_or(0); };
  const auto* least = *std::ranges::min_element(rows, {}, factor);
  double volume = 0;
  for (const auto* row : rows) volume += complex.complex().blocks()[row->block].volume.si();
  notes.push_back(fmt::format(
      "{}{} {} the required factor of safety with the support only because of {}: without {} the least is {:.3g} of "
      "{:g} (block {}); count on no crumbs: {} leaves them out",
      where, counted_blocks(rows.size(), volume), rows.size() == 1 ? "reaches" : "reach", text, them, factor(least),
      least->target, least->block.value(), leave_out));
}

}  // namespace cleave::scene
