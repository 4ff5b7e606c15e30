#include "contacts.hpp"

#include <algorithm>
#include <limits>

#include "parallel_planes.hpp"
#include "water.hpp"

namespace cleave::stability {

using geometry::Vec3;

Model::Model(const topology::BlockComplex& complex, const Settings& settings)
    : complex_{&complex},
      settings_{&settings},
      removed_in_(complex.blocks().size(), stays),
      parallel_{parallel_planes(complex, settings.taper_ignored)},
      rounding_{rounding_of_corners(complex)},
      directions_(complex.planes().size(), std::nullopt),
      on_surfaces_{surface_forces(complex, settings.actions)} {
  for (const topology::BlockId id : settings.left_out) removed_in_[id] = 0;
}

double Contact::tan_at(double reaction) const {
  if (curved.empty()) return tan_friction;
  const double stress = area > 0 ? reaction / area : 0;
  double weighted = tan_friction * straight_area;
  double least = straight_area > 0 ? tan_friction : std::numeric_limits<double>::infinity();
  for (const Curved& part : curved) {
    const double t = part.strength.tan_friction(pascals(stress)) / divisor;
    weighted += t * part.area;
    least = std::min(least, t);
  }
  return smallest || !(area > 0) ? least : weighted / area;
}

Direction Model::inward(const topology::Face& face) {
  auto& known = directions_[face.plane];
  if (!known) {
    const auto& planes = complex_->planes();
    known = Direction::normal_of(planes[parallel_[face.plane]]).turned_by(turn_by(rounding_, face.area));
    const auto own = planes[face.plane].unit_normal();
    if (dot(known->unit(), Vec3{own[0], own[1], own[2]}) < 0) known = known->opposite();
  }
  return face.block_on_positive_side ? *known : known->opposite();
}

Model::Held Model::held(topology::BlockId id, std::uint32_t batch) { return rows_of({&id, 1}, batch); }

Model::Held Model::rows_of(std::span<const topology::BlockId> members, std::uint32_t batch) {
  rows_.clear();
  by_.clear();
  bool exposed = false;
  for (const topology::BlockId id : members) {
    for (const topology::FaceId face_id : complex_->blocks()[id].faces) {
      const topology::Face& face = complex_->faces()[face_id];
      exposed = exposed || face.role == topology::Role::free;
      if (face.role != topology::Role::joint) continue;
      const std::size_t before = by_.size();
      for (const topology::Patch& patch : complex_->patches(face)) {
        if (!patch.neighbour) continue;
        if (!present(*patch.neighbour, batch)) {
          exposed = true;
          continue;
        }
        if (members.size() > 1 && std::ranges::binary_search(members, *patch.neighbour)) continue;
        by_.push_back(*patch.neighbour);
      }
      if (by_.size() > before) rows_.push_back(inward(face));
    }
  }
  return {rows_, by_, exposed};
}

Contacts Model::contacts(topology::BlockId id, std::uint32_t batch) { return contacts_of({&id, 1}, batch); }

Contacts Model::contacts_of(std::span<const topology::BlockId> members, std::uint32_t batch) {
  const Held held = rows_of(members, batch);
  return strengths(members, batch, Cone{held.rows}, held.exposed);
}

Contacts Model::strengths(std::span<const topology::BlockId> members, std::uint32_t batch, Cone cone,
                          bool exposed) const {
  const Settings& settings = *settings_;
  Contacts result{.cone = std::move(cone), .groups = {}, .exposed = exposed};
  result.groups.reserve(result.cone.groups().size());
  std::size_t row = 0;
  const auto add_face = [&](topology::FaceId face_id) {
    const topology::Face& face = complex_->faces()[face_id];
    if (face.role != topology::Role::joint) return;
    Contact contact{.face = face_id};
    contact.smallest = settings.group_friction == GroupFriction::smallest;
    contact.divisor = settings.partial.friction();
    bool held = false;
    for (const topology::Patch& patch : complex_->patches(face)) {
      if (!patch.neighbour || !present(*patch.neighbour, batch)) continue;
      if (members.size() > 1 && std::ranges::binary_search(members, *patch.neighbour)) continue;
      held = true;
      const JointStrength& strength = settings.strengths.of(patch.joint);
      const double area = patch.area.si();
      contact.area += area;
      contact.cohesion += strength.cohesion().si() * area;
      contact.tension += strength.tension().si() * area;
      if (strength.curved()) {
        contact.curved.push_back({area, strength});
        continue;
      }
      contact.straight_area += area;
      contact.tan_sum += strength.tan_friction() * area;
      contact.tan_least = std::min(contact.tan_least, strength.tan_friction());
    }
    if (!held) return;
    const std::uint32_t group = result.cone.group_of_row()[row++];
    if (group == result.groups.size()) {  // groups come in the order of their first row
      result.groups.push_back(std::move(contact));
      return;
    }
    Contact& sum = result.groups[group];
    sum.straight_area += contact.straight_area;
    sum.tan_sum += contact.tan_sum;
    sum.tan_least = std::min(sum.tan_least, contact.tan_least);
    sum.curved.insert(sum.curved.end(), contact.curved.begin(), contact.curved.end());
    sum.area += contact.area;
    sum.cohesion += contact.cohesion;
    sum.tension += contact.tension;
  };
  for (const topology::BlockId id : members) {
    for (const topology::FaceId face_id : complex_->blocks()[id].faces) add_face(face_id);
  }
  for (Contact& group : result.groups) {
    if (group.straight_area > 0 || group.curved.empty()) {
      const bool least = group.smallest || !(group.straight_area > 0);
      group.tan_friction =
          (least ? group.tan_least : group.tan_sum / group.straight_area) / settings.partial.friction();
    }
    group.cohesion /= settings.partial.cohesion();
    group.tension /= settings.partial.cohesion();
  }
  return result;
}

Force Model::weight(const topology::Block& block) const {
  const Acceleration g = metres_per_second_squared(geometry::norm(settings_->loads.gravity()));
  return settings_->rock.density() * block.volume * g * settings_->partial.weight();
}

ForceSum Model::other_forces(topology::BlockId id, std::uint32_t batch) const {
  ForceSum sum;
  if (!on_surfaces_.empty()) sum = on_surfaces_[id];
  if (settings_->actions.dry()) return sum;
  const ForceSum water = water_forces(*complex_, settings_->actions, settings_->loads.gravity(), id,
                                      [&](topology::BlockId other) { return present(other, batch); });
  sum.force += water.force;
  sum.moment += water.moment;
  sum.scale += water.scale;
  return sum;
}

Resultant Model::applied_forces(topology::BlockId id, std::uint32_t batch) const {
  const Force w = weight(complex_->blocks()[id]);
  Resultant r = Resultant::along(settings_->loads.gravity(), w);
  const Vec3 seismic = w.si() * settings_->loads.seismic();
  r.add(seismic, geometry::norm(seismic));
  const ForceSum other = other_forces(id, batch);
  r.add(other.force, other.scale);
  return r;
}

}  // namespace cleave::stability
