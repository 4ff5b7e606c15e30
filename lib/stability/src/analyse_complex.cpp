#include "analyse_complex.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "contacts.hpp"
#include "prefetch.hpp"
#include "rotation_check.hpp"
#include "transfer.hpp"
#include "truncated_blocks.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;

class Batches final {
 public:
  /// `held` keep their place whatever drives them: ascending.
  Batches(const topology::BlockComplex& complex, const Settings& settings, std::span<const BlockId> held)
      : model_{complex, settings},
        truncated_blocks_{model_},
        held_{held},
        slot_(complex.blocks().size(), none),
        noted_in_(complex.blocks().size(), 0) {}

  Analysis run() {
    std::vector<BlockId> changed;
    for (const BlockId id : complex().blocks().ids()) {
      const topology::Block& block = complex().blocks()[id];
      if (block.fixed) noted_in_[id] = never;
      if (block.free && !block.fixed) changed.push_back(id);
    }
    if (!model_.settings().left_out.empty()) changed = without_left_out(std::move(changed));
    for (std::uint32_t batch = 1; !changed.empty(); ++batch) {
      std::vector<BlockId> leaving;
      beside_.clear();
      for (std::size_t i = 0; i < changed.size(); ++i) {
        prefetch(complex(), changed, i);
        if (judge_block(changed[i], batch)) leaving.push_back(changed[i]);
      }
      if (leaving.empty()) break;
      if (batch > model_.settings().max_batches) {
        analysis_.stopped_at_max_batches = true;
        break;
      }
      changed = remove(std::move(leaving), batch);
    }
    // An undecided block was taken to stay, to see at once which others are undecided.
    std::ranges::sort(analysis_.undecided);
    analysis_.undecided.erase(std::ranges::unique(analysis_.undecided).begin(), analysis_.undecided.end());
    std::ranges::sort(analysis_.tapered);
    analysis_.tapered.erase(std::ranges::unique(analysis_.tapered).begin(), analysis_.tapered.end());
    std::erase_if(analysis_.tapered, [&](BlockId id) { return slot_[id] != none; });  // let go later
    if (model_.settings().rotation == RotationCheck::flag) flag_those_that_turn();
    analysis_.judgements.reserve(judgements_.size() * chunk);
    for (const std::uint32_t slot : slot_) {
      if (slot != none) analysis_.judgements.push_back(std::move(judgement_at(slot)));
    }
    analysis_.rotation = model_.settings().rotation;
    if (model_.settings().force_transfer && analysis_.undecided.empty()) transfer_forces(model_, analysis_);
    return std::move(analysis_);
  }

 private:
  [[nodiscard]] const topology::BlockComplex& complex() const noexcept { return model_.complex(); }

  /// Judges one block in state batch - 1; true when it is a key block there.
  bool judge_block(BlockId id, std::uint32_t batch) {
    const std::uint32_t slot = std::exchange(slot_[id], none);
    const Model::Held held = model_.held(id, batch);
    if (!held.exposed) return false;  // face-vector closure: all its joint faces together leave no direction
    const topology::Block& block = complex().blocks()[id];
    if (block.truncated) {
      if (std::ranges::find(analysis_.undecided, id) != analysis_.undecided.end()) return false;  // for good
      if (!truncated_blocks_.stays(id, batch, model_.settings().least_factor)) analysis_.undecided.push_back(id);
      return false;
    }
    Cone cone{held.rows};
    const std::uint8_t dimension = cone.dimension();
    if (dimension == 0 || (model_.settings().strict && dimension < 3)) {
      analysis_.tapered.push_back(id);
      return false;
    }
    const std::size_t beside_before = beside_.size();
    beside_.insert(beside_.end(), held.by.begin(), held.by.end());
    const Contacts contacts = model_.contacts(id, batch, std::move(cone), held.exposed);
    const Verdict verdict = judge(contacts, model_.applied_forces(id, batch), model_.settings());
    analysis_.equilibrium_residual = std::max(analysis_.equilibrium_residual, verdict.residual);

    slot_[id] = slot != none ? slot : new_slot(id);
    Judgement& judgement = judgement_at(slot_[id]);
    judgement = {.block = id};
    judgement.mode = verdict.mode;
    judgement.key = verdict.key;
    judgement.direction = verdict.direction;
    judgement.weight = model_.weight(block);
    judgement.driving = newtons(verdict.driving);
    judgement.resistance = newtons(verdict.resistance.least);
    judgement.cohesion_left_out = newtons(verdict.resistance.cohesion_left_out);
    if (verdict.resistance.greatest - verdict.resistance.least > 1e-9 * verdict.driving) {
      judgement.resistance_max = newtons(verdict.resistance.greatest);
    }
    judgement.net = newtons(verdict.net);
    judgement.factor_of_safety = verdict.factor_of_safety;
    judgement.pressing = pressing_of(contacts, verdict);
    judgement.cone_dimension = dimension;
    judgement.tie = verdict.tie;
    judged_in_[slot_[id]] = batch;
    if (model_.settings().rotation == RotationCheck::decide && !verdict.key) {
      judgement.rotation = rotation_from_rest(model_, id, batch, contacts, verdict);
      if (judgement.rotation->turns) judgement.key = true;
    }
    const bool leaves = judgement.key && !std::ranges::binary_search(held_, id);
    if (!leaves) beside_.resize(beside_before, id);
    return leaves;
  }

  /// Where turning decides nothing it is asked once, at the end, of what stays: in the state that each was judged in
  /// last, since which nothing beside it has left.
  void flag_those_that_turn() {
    for (const BlockId id : complex().blocks().ids()) {
      if (slot_[id] == none || judgement_at(slot_[id]).key) continue;
      const std::uint32_t batch = judged_in_[slot_[id]];
      const Contacts contacts = model_.contacts(id, batch);
      const Verdict verdict = judge(contacts, model_.applied_forces(id, batch), model_.settings());
      judgement_at(slot_[id]).rotation = rotation_of(model_, id, batch, contacts, verdict);
    }
  }

  /// Takes out what is left out, before the first batch: what it leaned on is exposed there.
  std::vector<BlockId> without_left_out(std::vector<BlockId> judged) {
    for (const BlockId id : model_.settings().left_out) model_.remove(id, 0);
    for (const BlockId id : model_.settings().left_out) {
      for (const topology::FaceId face : complex().blocks()[id].faces) {
        for (const topology::Patch& patch : complex().patches(complex().faces()[face])) {
          if (patch.neighbour && !complex().blocks()[*patch.neighbour].fixed) judged.push_back(*patch.neighbour);
        }
      }
    }
    std::erase_if(judged, [&](BlockId id) { return model_.removed_in(id) != Model::stays; });
    std::ranges::sort(judged);
    judged.erase(std::ranges::unique(judged).begin(), judged.end());
    return judged;
  }

  /// Takes a batch out; returns the blocks whose contacts changed, in order of id.
  std::vector<BlockId> remove(std::vector<BlockId> leaving, std::uint32_t batch) {
    Volume volume;
    for (const BlockId id : leaving) {
      model_.remove(id, batch);
      noted_in_[id] = never;
      judgement_at(slot_[id]).batch = batch;
      volume += complex().blocks()[id].volume;
    }
    std::vector<BlockId> changed;
    for (const BlockId id : beside_) {
      std::uint32_t& noted = noted_in_[id];
      if (noted >= batch) continue;
      noted = batch;
      changed.push_back(id);
    }
    std::ranges::sort(changed);
    analysis_.batches.push_back({.number = batch, .blocks = std::move(leaving), .volume = volume});
    return changed;
  }

  /// Place for one more judgement; nothing that was judged before is moved.
  std::uint32_t new_slot(BlockId id) {
    if (judgements_.empty() || judgements_.back().size() == chunk) judgements_.emplace_back().reserve(chunk);
    judgements_.back().push_back({.block = id});
    judged_in_.push_back(0);
    return static_cast<std::uint32_t>((judgements_.size() - 1) * chunk + judgements_.back().size() - 1);
  }
  [[nodiscard]] Judgement& judgement_at(std::uint32_t slot) { return judgements_[slot / chunk][slot % chunk]; }

  Model model_;
  TruncatedBlocks truncated_blocks_;
  std::span<const BlockId> held_;
  /// Judgements are large and few blocks are judged: the block's place among them, or none.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  IdVector<BlockId, std::uint32_t> slot_;
  static constexpr std::size_t chunk = 128;
  std::vector<std::vector<Judgement>> judgements_;
  std::vector<std::uint32_t> judged_in_;  ///< by slot: the batch in whose state the judgement was found last
  static constexpr std::uint32_t never = std::numeric_limits<std::uint32_t>::max();
  /// The last batch in which the block was found to be a neighbour; `never` for what is fixed or gone.
  IdVector<BlockId, std::uint32_t> noted_in_;
  std::vector<BlockId> beside_;  ///< the neighbours of the blocks found so far to leave in this batch
  Analysis analysis_;
};

}  // namespace

Analysis analyse_complex(const topology::BlockComplex& complex, const Settings& settings) {
  std::vector<BlockId> held;
  std::vector<std::pair<BlockId, Transferred>> why;  // what held them, in order of id
  for (;;) {
    Analysis analysis = Batches{complex, settings, held}.run();
    const auto judgement_of = [&](BlockId id) {
      const auto it = std::ranges::lower_bound(analysis.judgements, id, {}, &Judgement::block);
      return it != analysis.judgements.end() && it->block == id ? &*it : nullptr;
    };
    const std::size_t known = held.size();
    if (settings.force_transfer && settings.transfer.stabilised == TransferReadings::Stabilised::batches_anew) {
      for (const Judgement& j : analysis.judgements) {
        if (!j.transferred || j.transferred->key) continue;
        held.push_back(j.block);
        why.emplace_back(j.block, *j.transferred);
      }
    }
    if (held.size() == known) {  // what is held only grows, so this comes to an end
      for (const auto& [id, transferred] : why) {
        if (Judgement* j = judgement_of(id)) j->transferred = transferred;
      }
      return analysis;
    }
    std::ranges::sort(held);
    std::ranges::sort(why, {}, [](const auto& entry) { return entry.first; });
  }
}

}  // namespace cleave::stability
