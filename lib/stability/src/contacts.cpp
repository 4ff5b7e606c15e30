#include "contacts.hpp"

#include <algorithm>

namespace cleave::stability {

using geometry::Vec3;

Model::Model(const topology::BlockComplex& complex, const Settings& settings)
    : complex_{&complex},
      settings_{&settings},
      removed_in_(complex.blocks().size(), stays),
      directions_(complex.planes().size(), std::nullopt) {}

Direction Model::inward(const topology::Face& face) {
  auto& known = directions_[face.plane];
  if (!known) known = Direction::normal_of(complex_->planes()[face.plane]);
  return face.block_on_positive_side ? *known : known->opposite();
}

Contacts Model::contacts(topology::BlockId id, std::uint32_t batch) {
  const Settings& settings = *settings_;
  std::vector<Direction> rows;
  std::vector<Contact> faces;
  bool exposed = false;
  for (const topology::FaceId face_id : complex_->blocks()[id].faces) {
    const topology::Face& face = complex_->faces()[face_id];
    exposed = exposed || face.role == topology::Role::free;
    if (face.role != topology::Role::joint) continue;
    Contact contact{.face = face_id};
    double weighted = 0;
    double smallest = std::numeric_limits<double>::infinity();
    bool held = false;
    for (const topology::Patch& patch : complex_->patches(face)) {
      if (!patch.neighbour) continue;
      if (!present(*patch.neighbour, batch)) {
        exposed = true;
        continue;
      }
      held = true;
      const JointStrength& strength = settings.strengths.of(patch.joint);
      const double area = patch.area.si();
      contact.area += area;
      contact.cohesion += strength.cohesion().si() * area;
      contact.tension += strength.tension().si() * area;
      weighted += strength.tan_friction() * area;
      smallest = std::min(smallest, strength.tan_friction());
    }
    if (!held) continue;
    const bool mean = contact.area > 0 && settings.group_friction == GroupFriction::area_mean;
    contact.tan_friction = mean ? weighted / contact.area : smallest;
    rows.push_back(inward(face));
    faces.push_back(contact);
  }

  Contacts result{.cone = Cone{rows}, .groups = {}, .exposed = exposed};
  std::vector<bool> seen(result.cone.groups().size(), false);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::uint32_t group = result.cone.group_of_row()[row];
    const Contact& face = faces[row];
    if (!seen[group]) {  // groups come in the order of their first row
      seen[group] = true;
      result.groups.push_back(face);
      continue;
    }
    Contact& sum = result.groups[group];
    const double area = sum.area + face.area;
    const bool mean = area > 0 && settings.group_friction == GroupFriction::area_mean;
    sum.tan_friction = mean ? (sum.tan_friction * sum.area + face.tan_friction * face.area) / area
                            : std::min(sum.tan_friction, face.tan_friction);
    sum.area = area;
    sum.cohesion += face.cohesion;
    sum.tension += face.tension;
  }
  for (Contact& group : result.groups) {
    group.tan_friction /= settings.partial.friction();
    group.cohesion /= settings.partial.cohesion();
    group.tension /= settings.partial.cohesion();
  }
  return result;
}

Force Model::weight(const topology::Block& block) const {
  const Acceleration g = metres_per_second_squared(geometry::norm(settings_->loads.gravity()));
  return settings_->rock.density() * block.volume * g * settings_->partial.weight();
}

Resultant Model::applied_forces(const topology::Block& block) const {
  const Force w = weight(block);
  Resultant r = Resultant::along(settings_->loads.gravity(), w);
  const Vec3 seismic = w.si() * settings_->loads.seismic();
  r.add(seismic, geometry::norm(seismic));
  return r;
}

}  // namespace cleave::stability
