#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/realize/figures.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/sequence.hpp"

namespace cleave::scene {

/// Blocks that only a side of the domain holds and that support is held at (`SupportResult::held_by_border`,
/// `sprayed_at_border`).
struct HoldsAtBorder {
  std::vector<topology::BlockId> bolts, shotcrete;
};

/// The support in the rock after one stage: before and after the bolts of that stage are in.
struct StageSupport {
  std::uint64_t blocks = 0;  ///< below their target without support
  std::uint64_t bolts_before = 0, not_held_before = 0;
  std::uint64_t bolts = 0, spot_bolts = 0, not_held = 0, combined_failing = 0;
  std::optional<SupportedGroupFigures> groups = {};  ///< where blocks are judged together, and not too many
  bool too_many = false;                             ///< to be judged together
  bool fails_under_load = false;                     ///< in a load case, see StageCase
  HoldsAtBorder at_border = {};
  [[nodiscard]] bool passes() const noexcept {
    return not_held == 0 && combined_failing == 0 && !too_many && !fails_under_load && (!groups || groups->all_held());
  }
};
template <class V>
void fields(V& v, const StageSupport& x) {
  v("passes", x.passes(),
    "with what is installed by then, all blocks, bodies and groups, under each [[load]], too; false where there are "
    "too "
    "many to judge groups");
  v("blocks", x.blocks, "below their target without support");
  v("bolts_before", x.bolts_before, "installed after earlier stages");
  v("not_held_before", x.not_held_before, "with these alone, without spot bolts and shotcrete");
  v("bolts", x.bolts, "with those installed after this stage, spot bolts too");
  v("spot_bolts", x.spot_bolts, "of them, put in after this stage where all else fails");
  v("not_held", x.not_held, "with all of them and shotcrete");
  v("combined_failing", x.combined_failing, "bodies that these bolts stitch together");
  supported_groups_field(v, x.groups);
}

/// The rock after one stage under a [[load]].
struct StageCase {
  std::string name;
  stability::Analysis analysis;
  KeyBlockFigures key_blocks = {};
  std::optional<stability::KeyGroups> groups = {};  ///< blocks judged together, where the scene asks for it
  std::optional<std::uint64_t> not_held = {}, combined_failing = {};  ///< with what is installed by then
  std::optional<SupportedGroupFigures> supported_groups = {};  ///< the same, where there are not too many to be judged
  bool too_many = false;                                       ///< to be judged together with the support
  HoldsAtBorder at_border = {};
  [[nodiscard]] bool fails() const noexcept {
    return not_held.value_or(0) > 0 || combined_failing.value_or(0) > 0 || too_many ||
           (supported_groups && !supported_groups->all_held());
  }
};
template <class V>
void fields(V& v, const StageCase& x) {
  v("name", x.name);
  v("key_block_count", x.key_blocks.count);
  v("key_block_volume_m3", x.key_blocks.volume_m3);
  v("not_held", x.not_held, "with the support installed by then; absent without [support]");
  v("combined_failing", x.combined_failing);
  supported_groups_field(v, x.supported_groups);
}

/// The rock after one stage.
struct StageResult {
  std::uint32_t stage = 1;
  std::vector<std::string> excavations;  ///< those of this stage
  /// Empty when all rock has fallen; the certificate where it did not pass.
  std::optional<std::expected<topology::AuditedComplex, topology::Certificate>> complex;
  std::string block_hash;
  std::optional<stability::Analysis> analysis;
  std::uint64_t new_key_blocks = 0;  ///< of the blocks that leave, those without a part that left in an earlier stage
  Volume new_key_volume;
  BlockFigures blocks = {};  ///< of `complex`
  KeyBlockFigures key_blocks = {};
  std::optional<StageSupport> support = {};         ///< with [support]
  std::optional<stability::KeyGroups> groups = {};  ///< blocks judged together, where the scene asks for it
  std::vector<stability::Barred> tapered = {};      ///< held by next to nothing
  std::vector<StageCase> cases = {};                ///< of [[load]], in scene order
  [[nodiscard]] bool passed() const noexcept { return !complex || complex->has_value(); }
};
template <class V>
void fields(V& v, const StageResult& x) {
  v("stage", x.stage);
  v("excavations", x.excavations);
  v("certificate_passed", x.passed());
  v("block_count", x.blocks.count);
  v("block_volume_m3", x.blocks.volume_m3);
  v("hash", x.block_hash);
  v("key_blocks", group([&](auto& w) {
      fields(w, x.key_blocks);
      w("hash", "");
    }),
    "as the section key_blocks of the whole result");
  v("new_key_block_count", x.new_key_blocks, "without blocks of which a part left in an earlier stage");
  v("new_key_block_volume_m3", x.new_key_volume);
  v("support", x.support, "[support] in the rock after this stage");
  v("load_cases", when_any(x.cases), "the rock after this stage under each [[load]]");
}

struct OrderResult {
  std::vector<std::uint32_t> stages;
  std::vector<std::uint64_t> new_key_blocks;  ///< one a stage, in this order
  std::vector<Volume> new_key_volume;
  std::uint64_t key_blocks = 0;  ///< sums over the stages
  Volume key_volume;
};
template <class V>
void fields(V& v, const OrderResult& x) {
  v("stages", x.stages);
  v("key_block_count", x.key_blocks);
  v("key_block_volume_m3", x.key_volume);
  v("new_count", x.new_key_blocks, "one a stage, in this order");
  v("new_volume_m3", x.new_key_volume);
}

struct SequenceResult {
  Fallen fallen = Fallen::stay_out;
  std::vector<StageResult> stages;
  std::vector<OrderResult> orders;  ///< the scene's own first; only that one when no orders are to be compared
  std::size_t best = 0;             ///< the order with the smallest volume of key blocks; the first of equal ones
  /// By block of the final state: the first stage in which a part of it left; empty for a block that stays.
  std::vector<std::optional<std::uint32_t>> stage_of_block;
};
template <class V>
void fields(V& v, const SequenceResult& x) {
  v("fallen", one_of(x.fallen));
  v("stages", x.stages);
  v("orders", x.orders, "the scene's own order first");
  v("best_order", x.best, "from 0: the order with the smallest volume of key blocks");
}

/// Judges an audited complex.
using Judge = std::function<stability::Analysis(const topology::AuditedComplex&)>;

/// Takes the excavations out in the order of their stages and judges the rock after each; then in every order to be
/// compared. `stage_of_excavation` has an entry an excavation of the cut, `final_state` are the blocks when all are
/// out.
[[nodiscard]] SequenceResult run_sequence(const topology::SequentialCut& cut, const topology::StageBlocks& final_state,
                                          const SequenceSettings& settings,
                                          const std::vector<std::uint32_t>& stage_of_excavation,
                                          const std::vector<std::string>& names, const Judge& judge);

}  // namespace cleave::scene
