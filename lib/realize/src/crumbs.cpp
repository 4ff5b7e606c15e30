#include "crumbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

}  // namespace

std::optional<HeldByCrumbs> held_by_crumbs(const topology::AuditedComplex& complex, stability::Settings settings,
                                           const stability::Analysis& analysis,
                                           const std::optional<stability::KeyGroups>& groups,
                                           std::vector<BlockId> crumbs) {
  if (crumbs.empty()) return std::nullopt;
  HeldByCrumbs held{.crumbs = crumbs.size()};
  for (const BlockId id : crumbs) held.volume_of_crumbs += complex.complex().blocks()[id].volume;
  std::vector<BlockId> known = leaving(analysis), leaning;
  if (groups) {
    for (const stability::KeyGroup& group : groups->groups) {
      known.insert(known.end(), group.blocks.begin(), group.blocks.end());
      if (!leans_on(complex.complex(), group, crumbs)) continue;
      leaning.insert(leaning.end(), group.blocks.begin(), group.blocks.end());
      ++held.groups;
      held.least_of_groups = std::min(held.least_of_groups, group.least_factor());
    }
  }
  std::ranges::sort(known);
  std::ranges::sort(leaning);
  settings.left_out = std::move(crumbs);
  const stability::Analysis without = stability::analyse(complex, settings);
  for (const BlockId id : leaving(without)) {
    const auto judged = std::ranges::lower_bound(without.judgements, id, {}, &stability::Judgement::block);
    const double factor = judged != without.judgements.end() && judged->block == id ? judged->factor_of_safety : 0;
    if (std::ranges::binary_search(leaning, id)) held.alone_without = std::min(held.alone_without, factor);
    if (std::ranges::binary_search(known, id)) continue;
    ++held.blocks;
    held.volume += complex.complex().blocks()[id].volume;
    if (!(factor < held.least_factor)) continue;
    held.least_factor = factor;
    held.least = id;
  }
  return held.blocks + held.groups > 0 ? std::optional{held} : std::nullopt;
}

void add_crumb_notes(const std::optional<HeldByCrumbs>& held, std::vector<std::string>& notes) {
  if (!held) return;
  const std::string crumbs = fmt::format(
      "{} ({:.3g} m3 in all)", held->crumbs == 1 ? "a micro-block" : fmt::format("{} micro-blocks", held->crumbs),
      held->volume_of_crumbs.si());
  if (held->blocks > 0) {
    notes.push_back(fmt::format(
        "{} ({:.4g} m3) {} only because of {}: without {} the least factor of safety is {:.3g}{}; count on no crumbs: "
        "[micro_blocks] policy = \"exclude\" leaves them out",
        held->blocks == 1 ? "1 block" : fmt::format("{} blocks", held->blocks), held->volume.si(),
        held->blocks == 1 ? "stays" : "stay", crumbs, held->crumbs == 1 ? "it" : "them", held->least_factor,
        held->least ? fmt::format(" (block {})", held->least->value()) : ""));
  }
  if (held->groups > 0) {
    const bool one = held->crumbs == 1;
    notes.push_back(
        fmt::format("{} on {}{}: what {} in {} {:.3g}{}; [micro_blocks] policy = \"exclude\" judges without",
                    held->groups == 1 ? "1 key group leans" : fmt::format("{} key groups lean", held->groups),
                    one ? "" : "some of ", crumbs, one ? "it holds is" : "these hold is",
                    held->groups == 1 ? "the factor of" : "their factors, the least of them", held->least_of_groups,
                    held->alone_without < held->least_of_groups
                        ? fmt::format("; without {} a block of the group has {:.3g} by itself", one ? "it" : "them",
                                      held->alone_without)
                        : ""));
  }
}

}  // namespace cleave::scene
