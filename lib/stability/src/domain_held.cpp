#include <algorithm>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "cleave/stability/analyse.hpp"
#include "contacts.hpp"
#include "domain_held.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using topology::BlockId;
using topology::FaceId;

/// Sides of the domain that are not free, of one block.
std::vector<FaceId> fixed_faces(const topology::BlockComplex& complex, BlockId id) {
  std::vector<FaceId> found;
  for (const FaceId face : complex.blocks()[id].faces) {
    if (complex.faces()[face].role == topology::Role::fixed) found.push_back(face);
  }
  return found;
}

}  // namespace

bool stands_on_border(Model& model, BlockId id) {
  const geometry::Vec3 gravity = model.settings().loads.gravity();
  return std::ranges::any_of(fixed_faces(model.complex(), id), [&](FaceId face) {
    const double up = -dot(model.inward(model.complex().faces()[face]).unit(), gravity);
    return up > norm(gravity) / std::numbers::sqrt2;
  });
}

Area free_area_of(const topology::BlockComplex& complex, BlockId id) {
  Area area;
  for (const FaceId face : complex.blocks()[id].faces) {
    if (complex.faces()[face].role == topology::Role::free) area += complex.faces()[face].area;
  }
  return area;
}

std::optional<Verdict> motion_off_border(Model& model, BlockId id, std::uint32_t state) {
  const topology::BlockComplex& complex = model.complex();
  const Model::Held held = model.held(id, state);
  if (!held.exposed) return std::nullopt;
  std::vector<Direction> rows{held.rows.begin(), held.rows.end()};
  const std::vector<FaceId> fixed = fixed_faces(complex, id);
  for (const FaceId face : fixed) rows.push_back(model.inward(complex.faces()[face]));
  Cone cone{rows};
  const std::uint8_t dimension = cone.dimension();
  if (dimension == 0 || (model.settings().strict && dimension < 3)) return std::nullopt;
  const std::size_t joints = rows.size() - fixed.size();
  Contacts contacts = model.contacts(id, state, std::move(cone), held.exposed);
  for (std::size_t i = 0; i < fixed.size(); ++i) {  // sides that look the way of no joint come last, with no strength
    if (contacts.cone.group_of_row()[joints + i] == contacts.groups.size()) {
      contacts.groups.push_back({.face = fixed[i], .area = complex.faces()[fixed[i]].area.si()});
    }
  }
  Verdict verdict = judge(contacts, model.applied_forces(id, state), model.settings());
  if (!verdict.key) return std::nullopt;
  const geometry::Vec3 gravity = model.settings().loads.gravity();
  const bool stands = std::ranges::any_of(verdict.resistance.pressing, [&](const auto& pressing) {
    const std::uint32_t group = pressing.first;
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      if (contacts.cone.group_of_row()[joints + i] != group) continue;
      const double up = -dot(rows[joints + i].unit(), gravity);
      if (up > norm(gravity) / std::numbers::sqrt2) return true;
    }
    return false;
  });
  if (stands) return std::nullopt;
  return verdict;
}

DomainHeld domain_held(const topology::AuditedComplex& audited, const Settings& settings, const Analysis& analysis) {
  const topology::BlockComplex& complex = audited.complex();
  DomainHeld found;
  Model model{complex, settings};
  std::uint32_t state = 1;
  for (const Batch& batch : analysis.batches) {
    for (const BlockId id : batch.blocks) model.remove(id, batch.number);
    state = batch.number + 1;
  }
  for (const BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    const Area free_area = free_area_of(complex, id);
    found.all_free += free_area;
    if (!block.fixed || block.truncated || !model.present(id, state)) continue;
    const std::optional<Verdict> moves = motion_off_border(model, id, state);
    if (!moves) continue;
    found.blocks.push_back(id);
    found.alone.push_back({id, moves->mode, moves->direction, newtons(moves->net), moves->factor_of_safety});
    found.volume += block.volume;
    found.free_area += free_area;
  }
  return found;
}

}  // namespace cleave::stability
