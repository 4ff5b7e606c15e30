#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/stability/analyse.hpp"
#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;

class Barring final {
 public:
  Barring(const topology::BlockComplex& complex, const Settings& settings, const Analysis& analysis)
      : model_{complex, settings}, analysis_{&analysis}, laid_bare_{complex.blocks().size(), 0} {
    for (const Batch& batch : analysis.batches) {
      for (const BlockId id : batch.blocks) {
        model_.remove(id, batch.number);
        for (const topology::FaceId face : complex.blocks()[id].faces) {
          for (const topology::Patch& patch : complex.patches(complex.faces()[face])) {
            if (patch.neighbour) laid_bare_[*patch.neighbour] = 1;
          }
        }
      }
      state_ = batch.number + 1;
    }
  }

  std::vector<Barred> by_lesser() {
    std::vector<Barred> out;
    for (const BlockId id : complex().blocks().ids()) {
      if (!may_move(id) || !exposed(id)) continue;
      const std::vector<BlockId> lesser = lesser_beside(id);
      if (lesser.empty()) continue;
      if (const auto factor = factor_without(id, lesser)) {
        out.push_back({.block = id, .volume = complex().blocks()[id].volume, .factor_of_safety = *factor});
      }
    }
    return out;
  }

  std::vector<Barred> by_taper() {
    std::vector<Barred> out;
    for (const BlockId id : complex().blocks().ids()) {
      if (!may_move(id)) continue;
      const Model::Held held = model_.held(id, state_);
      if (!held.exposed) continue;
      Contacts contacts = model_.contacts(id, state_, Cone{about_parallel(held.rows)}, true);
      const Verdict verdict = without_taper(contacts, model_.applied_forces(id, state_));
      if (!verdict.key) continue;
      out.push_back(
          {.block = id, .volume = complex().blocks()[id].volume, .factor_of_safety = verdict.factor_of_safety});
    }
    return out;
  }

 private:
  /// Normals that are parallel but for a taper are one; signs that it could turn are zero.
  [[nodiscard]] static std::vector<Direction> about_parallel(std::span<const Direction> rows) {
    std::vector<Direction> out;
    for (const Direction& row : rows) {
      const auto like = std::ranges::find_if(out, [&](const Direction& other) {
        return norm(cross(row.unit(), other.unit())) < slight_taper;  // of either sense
      });
      const bool opposite = like != out.end() && dot(row.unit(), like->unit()) < 0;
      out.push_back(like == out.end() ? row.turned_by(slight_taper) : opposite ? like->opposite() : *like);
    }
    return out;
  }
  [[nodiscard]] Verdict without_taper(const Contacts& contacts, const Resultant& forces) const {
    if (model_.settings().strict && contacts.cone.dimension() < 3) return {};
    return judge(contacts, forces, model_.settings());
  }

  [[nodiscard]] const topology::BlockComplex& complex() const noexcept { return model_.complex(); }
  /// Stays, and might not: what is known in part only is taken to stay.
  [[nodiscard]] bool may_move(BlockId id) const {
    const topology::Block& block = complex().blocks()[id];
    if (!block.free && laid_bare_[id] == 0) return false;  // nothing is open
    const Judgement* own = judgement(id);
    return !block.fixed && !block.truncated && model_.present(id, state_) && !(own != nullptr && own->key);
  }
  [[nodiscard]] bool exposed(BlockId id) { return model_.held(id, state_).exposed; }

  [[nodiscard]] const Judgement* judgement(BlockId id) const {
    const auto it = std::ranges::lower_bound(analysis_->judgements, id, {}, &Judgement::block);
    return it != analysis_->judgements.end() && it->block == id ? &*it : nullptr;
  }

  /// Neighbours that stay and are smaller or removable; ascending.
  [[nodiscard]] std::vector<BlockId> lesser_beside(BlockId id) {
    const Model::Held held = model_.held(id, state_);
    std::vector<BlockId> out{held.by.begin(), held.by.end()};
    std::ranges::sort(out);
    out.erase(std::ranges::unique(out).begin(), out.end());
    const Volume own = complex().blocks()[id].volume;
    std::erase_if(out, [&](BlockId other) {
      const topology::Block& block = complex().blocks()[other];
      if (block.fixed || block.truncated) return true;
      return !(block.volume < own) && judgement(other) == nullptr;
    });
    return out;
  }

  /// Were they not there, the forces on the block as they are; empty when it stays without them as well.
  std::optional<double> factor_without(BlockId id, const std::vector<BlockId>& gone) {
    const Resultant forces = model_.applied_forces(id, state_);
    for (const BlockId other : gone) model_.remove(other, state_ - 1);
    const Contacts contacts = model_.contacts(id, state_);
    for (const BlockId other : gone) model_.remove(other, Model::stays);
    const std::uint8_t dimension = contacts.cone.dimension();
    if (dimension == 0 || (model_.settings().strict && dimension < 3)) return std::nullopt;
    const Verdict verdict = judge(contacts, forces, model_.settings());
    return verdict.key ? std::optional{verdict.factor_of_safety} : std::nullopt;
  }

  Model model_;
  const Analysis* analysis_;
  IdVector<BlockId, std::uint8_t> laid_bare_;  // beside blocks that left
  std::uint32_t state_ = 1;
};

}  // namespace

std::vector<Barred> barred_by_lesser(const topology::AuditedComplex& complex, const Settings& settings,
                                     const Analysis& analysis) {
  return Barring{complex.complex(), settings, analysis}.by_lesser();
}

std::vector<Barred> held_by_taper(const topology::AuditedComplex& complex, const Settings& settings,
                                  const Analysis& analysis) {
  return Barring{complex.complex(), settings, analysis}.by_taper();
}

}  // namespace cleave::stability
