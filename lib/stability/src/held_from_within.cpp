#include "cleave/stability/analyse.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;

/// Which blocks one block alone parts from the outside.
class Enclosed final {
 public:
  /// Outlives neither. `state`: what has left before that batch is air.
  Enclosed(const Model& model, std::uint32_t state)
      : model_{&model}, state_{state}, seen_(model.complex().blocks().size(), 0) {}

  /// Blocks from which no way from neighbour to neighbour leads, past `around`, to rock that stays, a free face, the
  /// side of a window, or air. Ascending.
  [[nodiscard]] std::vector<BlockId> in(BlockId around) {
    // Marks of this question: `within` for what was met, `out` for what leads outside.
    const std::uint32_t within = 2 * ++asked_ - 1, out = within + 1;
    seen_[around] = within;
    std::vector<BlockId> found;
    for_each_neighbour(around, [&](BlockId start) {
      if (seen_[start] >= within) return;
      std::vector<BlockId> way{start};
      seen_[start] = within;
      bool leads_out = outside(start);
      for (std::size_t i = 0; i < way.size() && !leads_out; ++i) {
        for_each_neighbour(way[i], [&](BlockId next) {
          leads_out = leads_out || seen_[next] == out;
          if (leads_out || seen_[next] >= within) return;
          seen_[next] = within;
          leads_out = outside(next);
          way.push_back(next);
        });
      }
      if (!leads_out) {
        found.insert(found.end(), way.begin(), way.end());
        return;
      }
      for (const BlockId id : way) seen_[id] = out;
    });
    // What counts as gone from the start weighs nothing and holds nothing.
    std::erase_if(found, [&](BlockId id) { return !model_->present(id, state_); });
    std::ranges::sort(found);
    return found;
  }

 private:
  [[nodiscard]] bool outside(BlockId id) const {
    const topology::Block& block = model_->complex().blocks()[id];
    if (block.fixed || block.free || block.truncated) return true;
    return model_->removed_in(id) > 0 && !model_->present(id, state_);  // 0: left out, which needed no way
  }

  template <class Visit>
  void for_each_neighbour(BlockId id, Visit visit) const {
    const topology::BlockComplex& complex = model_->complex();
    for (const topology::FaceId face : complex.blocks()[id].faces) {
      for (const topology::Patch& patch : complex.patches(complex.faces()[face])) {
        if (patch.neighbour) visit(*patch.neighbour);
      }
    }
  }

  const Model* model_;
  std::uint32_t state_;
  IdVector<BlockId, std::uint32_t> seen_;
  std::uint32_t asked_ = 0;
};

}  // namespace

std::vector<InterlockedByInclusion> held_from_within(const topology::AuditedComplex& complex, const Settings& settings,
                                                     const Analysis& analysis) {
  std::vector<InterlockedByInclusion> rows;
  Model model{complex.complex(), settings};
  std::uint32_t state = 1;
  for (const Batch& batch : analysis.batches) {
    for (const BlockId id : batch.blocks) model.remove(id, batch.number);
    state = batch.number + 1;
  }
  Enclosed enclosed{model, state};
  for (const BlockId id : complex.complex().blocks().ids()) {
    const topology::Block& block = complex.complex().blocks()[id];
    // A convex block encloses nothing, and what is inside leaves the block around it no direction.
    if (block.convex || block.fixed || block.truncated || !model.present(id, state)) continue;
    const Model::Held held = model.held(id, state);
    if (!held.exposed || Cone{held.rows}.dimension() > 0) continue;
    InterlockedByInclusion row{.block = id, .inside = enclosed.in(id)};
    if (row.inside.empty()) continue;
    std::vector<BlockId> body = row.inside;
    body.insert(std::ranges::lower_bound(body, id), id);
    const Contacts contacts = model.contacts_of(body, state);
    const std::uint8_t dimension = contacts.cone.dimension();
    if (dimension == 0 || (settings.strict && dimension < 3)) continue;
    Resultant resultant = model.applied_forces(id, state);
    for (const BlockId inside : row.inside) {
      const Resultant own = model.applied_forces(inside, state);
      resultant.add(own.newtons(), own.scale());
    }
    const Verdict verdict = judge(contacts, resultant, settings);
    if (!verdict.key) continue;
    row.mode = verdict.mode;
    row.direction = verdict.direction;
    row.net = newtons(verdict.net);
    row.factor_of_safety = verdict.factor_of_safety;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace cleave::stability
