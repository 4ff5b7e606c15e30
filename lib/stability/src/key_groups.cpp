#include "cleave/stability/key_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "assembly_of.hpp"
#include "contacts.hpp"
#include "domain_held.hpp"
#include "group_search.hpp"
#include "ties.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;

/// Of a bracket of the factor of safety: where it is looked for, by what steps, and how fine.
constexpr double least_factor = 0.1, largest_factor = 10, step_of_factor = 1.25, fine_factor = 1.01;

/// Two factors of the assembly: up to where all is clear, and from where on something moves.
class FactorSearch final {
 public:
  FactorSearch(const topology::BlockComplex& complex, const Settings& settings, const Together& most)
      : complex_{complex}, settings_{settings}, most_{most} {}

  std::optional<FactorTogether> run() {
    double f = 1;
    look(f);
    while (moves_ < infinite && still_ == 0 && f > least_factor) look(f = std::max(least_factor, f / step_of_factor));
    while (moves_ == infinite && f < largest_factor) look(f = std::min(largest_factor, f * step_of_factor));
    while (still_ > 0 && moves_ < infinite && moves_ > fine_factor * still_) look(std::sqrt(still_ * moves_));
    // What is in doubt lies between.
    for (f = std::min(clear_below_, still_); stands_ == 0 && f > least_factor;)
      look(f = std::max(least_factor, f / step_of_factor));
    while (stands_ > 0 && clear_below_ < infinite && clear_below_ > fine_factor * stands_) {
      look(std::sqrt(stands_ * clear_below_));
    }
    if (too_many_) return std::nullopt;
    const double moves = moves_ > least_factor ? moves_ : 0;
    return FactorTogether{
        .stands = stands_, .moves = moves, .blocks = std::move(blocks_), .without_moments = without_moments_};
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void look(double factor) {
    const KeyGroups found = first_groups(complex_, with_strengths_over(settings_, factor), most_);
    too_many_ = too_many_ || found.too_many;
    without_moments_ = without_moments_ || found.without_moments;
    std::vector<BlockId> moving;
    for (const KeyGroup& group : found.groups) {
      if (group.verdict == assembly::Verdict::in_doubt) continue;
      moving.insert(moving.end(), group.blocks.begin(), group.blocks.end());
    }
    if (!found.groups.empty()) {
      clear_below_ = std::min(clear_below_, factor);
      if (stands_ >= clear_below_) stands_ = 0;
    } else if (factor < clear_below_) {
      stands_ = std::max(stands_, factor);
    }
    if (moving.empty()) {
      if (factor < moves_) still_ = std::max(still_, factor);
    } else if (factor < moves_) {
      moves_ = factor;
      if (still_ >= moves_) still_ = 0;
      std::ranges::sort(moving);
      blocks_ = std::move(moving);
    }
  }

  const topology::BlockComplex& complex_;
  const Settings& settings_;
  const Together& most_;
  double stands_ = 0, clear_below_ = infinite;  ///< nothing moves or is in doubt; least where something does
  double still_ = 0, moves_ = infinite;         ///< nothing moves; least where something does
  bool too_many_ = false, without_moments_ = false;
  std::vector<BlockId> blocks_;
};

/// What counts of the joints of groups that move: under support no more of it does.
BondShares bonds_without_support(const topology::BlockComplex& complex, const Settings& settings,
                                 const KeyGroups& below) {
  Model model{complex, settings};
  BondShares out;
  for (std::size_t first = 0; first < below.groups.size();) {
    const std::uint32_t batch = below.groups[first].batch;
    std::size_t end = first;
    for (; end < below.groups.size() && below.groups[end].batch == batch; ++end) {
      const KeyGroup& group = below.groups[end];
      if (group.verdict == assembly::Verdict::in_doubt) continue;
      out.merge(bonds_that_count(model, group.blocks, batch));
    }
    for (; first < end; ++first) {
      if (below.groups[first].verdict == assembly::Verdict::in_doubt) continue;
      for (const BlockId id : below.groups[first].blocks) model.remove(id, batch);
    }
  }
  return out;
}

}  // namespace

KeyGroups find_key_groups(const topology::AuditedComplex& complex, const Settings& settings, const Together& most) {
  return search_groups(complex.complex(), settings, most, assembly::Ask::factors);
}

std::optional<FactorTogether> factor_together(const topology::AuditedComplex& complex, const Settings& settings,
                                              const Together& most) {
  return FactorSearch{complex.complex(), settings, most}.run();
}

KeyGroups groups_below_target(const topology::AuditedComplex& complex, const Settings& settings,
                              const SupportPlan& plan, const Together& most) {
  return search_groups(complex.complex(), with_strengths_over(settings, plan.target_sliding), most,
                       assembly::Ask::verdicts);
}

GroupSupport check_groups(const topology::AuditedComplex& complex, const Settings& settings, const SupportPlan& plan,
                          const SupportResult& support, const Together& most) {
  assembly::UntiedSets untied;
  return check_groups(complex, settings, plan, support, groups_below_target(complex, settings, plan, most), untied,
                      most);
}

namespace {
Volume volume_of(const KeyGroups& groups) {
  Volume sum;
  for (const KeyGroup& group : groups.groups) sum += group.volume;
  return sum;
}
}  // namespace

GroupSupport check_groups(const topology::AuditedComplex& complex, const Settings& settings, const SupportPlan& plan,
                          const SupportResult& support, KeyGroups below, assembly::UntiedSets& untied,
                          const Together& most) {
  GroupSupport out{.below = std::move(below), .left = {}};
  if (out.below.groups.empty()) return out;
  const Settings reduced = with_strengths_over(settings, plan.target_sliding);
  const Ties ties{complex.complex(), reduced, plan, support.bolts, out.below};
  std::vector<BlockId> moving;
  for (const KeyGroup& group : out.below.groups) moving.insert(moving.end(), group.blocks.begin(), group.blocks.end());
  const BondShares bonds = bonds_without_support(complex.complex(), reduced, out.below);
  const std::vector<BlockId> begin = ties.with_tied(std::move(moving));
  out.left = search_groups(complex.complex(), reduced, most, ties, begin, untied, bonds);
  const bool turn = !out.left.groups.empty() && std::ranges::all_of(out.left.groups, &KeyGroup::moments);
  if (turn && ties.slants()) {
    KeyGroups straight = search_groups(complex.complex(), reduced, most, ties.straight_out(), begin, untied, bonds);
    if (volume_of(straight) < volume_of(out.left)) out.left = std::move(straight);
  }
  // What only the search with support could not decide.
  for (const KeyGroup& group : out.left.groups) {
    const auto shares = [&](const KeyGroup& other) {
      return std::ranges::any_of(group.blocks,
                                 [&](BlockId id) { return std::ranges::binary_search(other.blocks, id); });
    };
    if (std::ranges::any_of(out.below.groups, shares)) continue;
    out.below.groups.push_back(group);
    out.below.groups.back().verdict = assembly::Verdict::no_motion_found;
  }
  return out;
}

namespace {
bool is_supported(const SupportResult& support, BlockId block) {
  return std::ranges::find(support.blocks, block, &SupportedBlock::block) != support.blocks.end();
}

bool share_a_block(const KeyGroup& a, const KeyGroup& b) {
  return std::ranges::any_of(a.blocks, [&](BlockId id) { return std::ranges::binary_search(b.blocks, id); });
}
}  // namespace

std::optional<assembly::Verdict> GroupSupport::left_of(const KeyGroup& group) const {
  std::optional<assembly::Verdict> worst;
  for (const KeyGroup& other : left.groups) {
    if (share_a_block(group, other) && (!worst || other.verdict < *worst)) worst = other.verdict;
  }
  return worst;
}

std::optional<Force> GroupSupport::net_left_of(const KeyGroup& group) const {
  std::optional<Force> sum;
  for (const KeyGroup& other : left.groups) {
    if (!share_a_block(group, other)) continue;
    if (!other.net) return std::nullopt;
    sum = sum.value_or(newtons(0)) + *other.net;
  }
  return sum;
}

void mark_bolts_of_groups(const GroupSupport& groups, SupportResult& support) {
  std::vector<BlockId> members;
  for (const KeyGroup& group : groups.below.groups) {
    // A block that misses its target by itself was asked which bolts it needs.
    const bool asked = group.blocks.size() == 1 && is_supported(support, group.blocks.front());
    if (!asked) members.insert(members.end(), group.blocks.begin(), group.blocks.end());
  }
  std::ranges::sort(members);
  const OwnerOf owner = [&](BlockId id) -> std::optional<std::optional<std::uint32_t>> {
    const auto at = std::ranges::lower_bound(members, id);
    if (at == members.end() || *at != id) return std::optional<std::uint32_t>{};
    return static_cast<std::uint32_t>(at - members.begin());
  };
  for (BoltResult& bolt : support.bolts) {
    if (bolt.status == BoltStatus::holds || bolt.status == BoltStatus::off) continue;
    const std::vector<BoltPull> pulls = pulls_of(bolt, owner);
    if (pulls.empty()) continue;
    const BoltPull& most = *std::ranges::max_element(pulls, {}, [](const BoltPull& p) { return p.force.si(); });
    bolt.status = BoltStatus::group;
    bolt.serves = most.body ? most.block : most.behind;
    bolt.capacity = bolt.used = most.force.si();
    bolt.limit = most.limit;
    bolt.angle = 0;  // of its pull
  }
}

void judge_turning(const GroupSupport& groups, SupportResult& support) {
  if (groups.too_many() || groups.below.without_moments || groups.left.without_moments) return;
  for (OnlyTurns& turning : support.turning) {
    for (const KeyGroup& group : groups.below.groups) {
      if (std::ranges::binary_search(group.blocks, turning.block)) turning.held = !groups.left_of(group);
    }
  }
}

bool add_held_together(const topology::AuditedComplex& audited, const Settings& settings, const Analysis& analysis,
                       const KeyGroups& groups, DomainHeld& held, const Together& most) {
  const topology::BlockComplex& complex = audited.complex();
  std::vector<BlockId> gone;
  for (const Batch& batch : analysis.batches) gone.insert(gone.end(), batch.blocks.begin(), batch.blocks.end());
  for (const KeyGroup& group : groups.groups) {
    if (group.verdict != assembly::Verdict::in_doubt) gone.insert(gone.end(), group.blocks.begin(), group.blocks.end());
  }
  const std::optional<std::vector<BlockId>> together = groups_at_border(complex, settings, most, gone);
  if (!together) return false;
  for (const BlockId id : *together) {
    const auto at = std::ranges::lower_bound(held.blocks, id);
    if (at != held.blocks.end() && *at == id) continue;
    held.blocks.insert(at, id);
    held.volume += complex.blocks()[id].volume;
    held.free_area += free_area_of(complex, id);
    ++held.together;
  }
  return true;
}

void decide_by_groups(const topology::AuditedComplex& complex, const Settings& settings, const KeyGroups& groups,
                      Analysis& analysis) {
  const Model model{complex.complex(), settings};
  for (const KeyGroup& group : groups.groups) {
    if (group.verdict == assembly::Verdict::in_doubt) continue;
    Volume largest = {};
    for (const BlockId id : group.blocks) largest = std::max(largest, complex.complex().blocks()[id].volume);
    for (std::size_t k = 0; k < group.blocks.size(); ++k) {
      const BlockId id = group.blocks[k];
      const topology::Block& block = complex.complex().blocks()[id];
      auto it = std::ranges::lower_bound(analysis.judgements, id, {}, &Judgement::block);
      if (it == analysis.judgements.end() || it->block != id) {
        it = analysis.judgements.insert(it, {.block = id, .mode = Mode::tapered});
        it->weight = model.weight(block);
        // Nothing was asked of it alone.
        it->factor_of_safety = std::numeric_limits<double>::infinity();
      }
      if (it->batch) continue;
      const bool is_largest = block.volume.si() >= (1 - 1e-9) * largest.si();
      it->key = true;
      it->batch = group.batch;
      it->factor_of_safety =
          std::min(it->factor_of_safety,
                   is_largest ? group.factor_of_largest.value_or(group.least_factor()) : group.least_factor());
      const geometry::Vec3 velocity = group.rates[k].velocity;
      if (norm(velocity) > 0) it->direction = normalized(velocity);
      // What is out of balance: of a block by itself the same.
      it->net = std::max(it->net, out_of_balance(settings, block, group.rates[k]));
      while (analysis.batches.size() < group.batch) {
        analysis.batches.push_back({.number = static_cast<std::uint32_t>(analysis.batches.size() + 1)});
      }
      Batch& batch = analysis.batches[group.batch - 1];
      batch.blocks.insert(std::ranges::lower_bound(batch.blocks, id), id);
      batch.volume += block.volume;
    }
  }
}

}  // namespace cleave::stability
