#include "truncated_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::stability {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;

namespace {

bool contains(std::span<const BlockId> parts, BlockId id) { return std::ranges::find(parts, id) != parts.end(); }

std::vector<BlockId> with(std::vector<BlockId> parts, BlockId more) {
  parts.push_back(more);
  return parts;
}

}  // namespace

TruncatedBlocks::TruncatedBlocks(Model& model) : model_{&model} {
  const Settings& settings = model.settings();
  const ActionSpec& loads = settings.actions.spec();
  only_weight_ = settings.actions.dry() && loads.surcharges.empty() && loads.points.empty() && loads.lines.empty();
  stated_water_ = std::ranges::any_of(loads.joint_pressure, [](const auto& p) { return p.has_value(); });
  least_tan_ = settings.strengths.least_tan_friction() / settings.partial.friction();
  if (only_weight_) return;
  const topology::BlockComplex& complex = model.complex();
  for (const BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    if (block.truncated && !block.fixed) open_parts_.push_back(id);
  }
}

bool TruncatedBlocks::stays(BlockId part, std::uint32_t batch, double factor) {
  // Each question about a neighbour has two answers, and both must do.
  budget_ = 100;
  return stays(Parts{part}, Parts{}, batch, factor);
}

/// `same` are parts of one block, `apart` are not of it.
bool TruncatedBlocks::stays(const Parts& same, const Parts& apart, std::uint32_t batch, double factor) {
  if (--budget_ < 0) return false;
  const topology::BlockComplex& complex = model_->complex();
  std::vector<Direction> rows;
  std::vector<std::pair<BlockId, Direction>> doubtful;
  for (const BlockId id : same) {
    for (const topology::FaceId face_id : complex.blocks()[id].faces) {
      const topology::Face& face = complex.faces()[face_id];
      if (face.role != topology::Role::joint) continue;
      bool touches = false;
      std::optional<BlockId> part;
      for (const topology::Patch& patch : complex.patches(face)) {
        if (!patch.neighbour || !model_->present(*patch.neighbour, batch)) continue;
        if (contains(same, *patch.neighbour)) continue;
        const topology::Block& other = complex.blocks()[*patch.neighbour];
        // A fixed part is either another block, or this one is fixed and stays.
        if (!other.truncated || other.fixed || contains(apart, *patch.neighbour)) {
          touches = true;
        } else {
          part = *patch.neighbour;
        }
      }
      if (touches) {
        rows.push_back(model_->inward(face));
      } else if (part) {
        doubtful.emplace_back(*part, model_->inward(face));
      }
    }
  }
  // Faces that are not known can only take directions away.
  const auto decided = [&](const Cone& cone) {
    const std::uint8_t dimension = cone.dimension();
    return dimension == 0 || (model_->settings().strict && dimension < 3) || held(cone, same, apart, batch, factor);
  };
  const Cone cone{rows};
  if (decided(cone)) return true;
  if (doubtful.empty()) return false;
  std::vector<Direction> all = rows;
  for (const auto& [part, inward] : doubtful) all.push_back(inward);
  if (!decided(Cone{all})) return false;  // nor would it be if all of them were other blocks
  // Ask first of the face that bars the way most.
  const Vec3 motion = project(cone, model_->applied_forces(same.front(), batch)).s;
  const BlockId asked = std::ranges::min_element(doubtful, {}, [&](const auto& entry) {
                          return dot(entry.second.unit(), motion);
                        })->first;
  return stays(with(same, asked), apart, batch, factor) && stays(same, with(apart, asked), batch, factor);
}

/// What acts on the parts that are known, and on what may lie outside the window: rock, dry or below the table. Water
/// at rest pushes on all of a block's boundary but the faces that are drained, and those are known; so outside it lifts
/// by the weight of the water displaced.
std::vector<Resultant> TruncatedBlocks::own_loads(const Parts& same, std::uint32_t batch) {
  std::vector<Resultant> loads{model_->applied_forces(same.front(), batch)};
  if (only_weight_) return loads;
  for (std::size_t i = 1; i < same.size(); ++i) {
    const Resultant r = model_->applied_forces(same[i], batch);
    loads.front().add(r.newtons(), r.scale());
  }
  const Settings& settings = model_->settings();
  const Vec3 gravity = settings.loads.gravity();
  const double g = norm(gravity), weight = settings.rock.density().si() * g * settings.partial.weight();
  Resultant rock = Resultant::along(gravity, newtons(weight));
  rock.add(weight * settings.loads.seismic(), weight * norm(settings.loads.seismic()));
  loads.push_back(rock);
  if (const auto& table = settings.actions.spec().water; table && g > 0) {
    const double of_water = table->unit_weight.si();
    rock.add(-of_water / g * gravity, of_water);
    loads.push_back(rock);
  }
  return loads;
}

/// Parts with a free or drained face, which may all belong to one block, and what acts on them.
const std::vector<std::pair<BlockId, Resultant>>& TruncatedBlocks::exposed(std::uint32_t batch) {
  if (exposed_in_ == batch) return exposed_;
  exposed_in_ = batch;
  exposed_.clear();
  for (const BlockId id : open_parts_) {
    if (model_->held(id, batch).exposed) exposed_.emplace_back(id, model_->applied_forces(id, batch));
  }
  return exposed_;
}

/// More faces make the cone K smaller, so the projection s of a load r on it shorter and the reactions, p = r - s in
/// sum, larger. What acts on the block is a sum of loads, each taken some number of times >= 0. |s| of a sum is at most
/// the sum of |s|, and |p| is at least r.d for every unit d in the polar cone of K. So friction holds every such sum
/// when |s| <= tan(least friction) r.d for each of the loads.
bool TruncatedBlocks::held(const Cone& cone, const Parts& same, const Parts& apart, std::uint32_t batch,
                           double factor) {
  const Settings& settings = model_->settings();
  if (stated_water_ || settings.rotation == RotationCheck::decide) return false;
  const double tan = settings.only_key_blocks ? 0.999999 * least_tan_ / factor : 0;
  std::vector<Vec3> directions;  // of reactions: the candidates for d
  std::vector<std::pair<Vec3, double>> loads;
  Vec3 all;
  const auto add = [&](const Resultant& r) {  // false: not held
    const Motion motion = project(cone, r);
    const Vec3 p = r.newtons() - motion.s;
    if (motion.tie || motion.kind == MotionKind::free) return false;
    const double driving = norm(motion.s);
    if (driving > 0 && !(driving < tan * norm(p))) return false;
    loads.emplace_back(r.newtons(), driving);
    if (norm(p) > 0) directions.push_back(p / norm(p));
    all += p;
    return true;
  };
  const auto holds = [&](Vec3 d) {
    return std::ranges::all_of(loads, [&](const auto& load) {
      const double against = dot(load.first, d);
      return load.second == 0 ? against >= 0 : load.second < tan * against;
    });
  };
  for (const Resultant& r : own_loads(same, batch)) {
    if (!add(r)) return false;
  }
  if (!only_weight_) {
    for (const auto& [id, r] : exposed(batch)) {
      if (contains(same, id) || contains(apart, id)) continue;
      if (std::ranges::none_of(directions, [&](Vec3 d) { return dot(r.newtons(), d) >= 0; })) return false;
      if (!add(r)) return false;
    }
  }
  if (std::ranges::all_of(loads, [](const auto& load) { return load.second == 0; })) return true;
  if (norm(all) > 0 && holds(all / norm(all))) return true;
  return std::ranges::any_of(directions, holds);
}

}  // namespace cleave::stability
