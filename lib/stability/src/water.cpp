#include "water.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "flat.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;
using topology::Patch;

struct Stated {
  double mean;
  bool or_table;
};
std::optional<Stated> stated(const Actions& actions, const Patch& patch) {
  const ActionSpec& spec = actions.spec();
  if (!patch.joint || patch.joint->index() >= spec.joint_pressure.size()) return std::nullopt;
  const std::size_t joint = patch.joint->index();
  if (!spec.joint_pressure[joint]) return std::nullopt;
  return Stated{*spec.joint_pressure[joint], joint < spec.or_table.size() && spec.or_table[joint] != 0};
}

Moments over_face(const BlockComplex& complex, const Face& face, const LinearPressure& pressure) {
  Moments sum;
  for (const SignedTriangle& t : fan(complex, face)) {
    sum += t.sign * integrate({t.corners.begin(), t.corners.end()}, pressure);
  }
  return sum;
}

/// Over the common area of a face and one neighbour: a patch carries no outline, but it is where both blocks' faces on
/// the plane overlap.
Moments over_contact(const BlockComplex& complex, const Face& face, BlockId neighbour, const LinearPressure& pressure) {
  Moments sum;
  for_each_shared(complex, face, neighbour,
                  [&](const Convex& part, double sign) { sum += sign * integrate(part, pressure); });
  return sum;
}

/// N on a patch; patches of one contact with joints of their own share it by area.
double over_patch(const BlockComplex& complex, const Face& face, const Patch& patch, const LinearPressure& pressure) {
  double all = 0;
  for (const Patch& other : complex.patches(face)) {
    if (other.neighbour == patch.neighbour) all += other.area.si();
  }
  return all > 0 ? patch.area.si() / all * over_contact(complex, face, *patch.neighbour, pressure).total : 0;
}

/// Water at rest before a free side of the domain; none of other faces.
std::optional<LinearPressure> standing_before(const Actions& actions, const Face& face) {
  const ActionSpec& spec = actions.spec();
  if (!spec.flow || face.role != topology::Role::free || face.excavation) return std::nullopt;
  const auto still = std::ranges::find(spec.flow->standing, face.tag, &FlowWater::Standing::tag);
  if (still == spec.flow->standing.end()) return std::nullopt;
  return LinearPressure{spec.flow->unit_weight.si(), still->level, Vec3{0, 0, 1}};
}

/// The loads of water on one block, contact by contact.
class WaterOnContacts {
 public:
  WaterOnContacts(const BlockComplex& complex, const Actions& actions, Vec3 gravity, std::vector<LoadOnBlock>& out)
      : complex_{complex}, actions_{actions}, out_{out} {
    const auto& water = actions.spec().water;
    if (const double g = geometry::norm(gravity); water && g > 0) {
      table_ = {water->unit_weight.si(), water->level, -gravity / g};
      lake_ = water->on_free_faces;
    }
  }

  void add(BlockId id) {
    const ActionSpec& spec = actions_.spec();
    if (spec.flow) {
      for (const auto& [own, neighbour, heads, at] :
           std::ranges::equal_range(spec.flow->contacts, id, {}, &FlowWater::Contact::block)) {
        add(id, neighbour, spec.flow->unit_weight.si() * heads, at, area_of(id, neighbour));
      }
    }
    for (const topology::FaceId face_id : complex_.blocks()[id].faces) {
      const Face& face = complex_.faces()[face_id];
      if (const auto still = standing_before(actions_, face))
        push(face, std::nullopt, over_face(complex_, face, *still), {});
      if (face.role != topology::Role::joint) continue;
      std::vector<BlockId> neighbours;
      for (const Patch& patch : complex_.patches(face)) {
        if (patch.neighbour) neighbours.push_back(*patch.neighbour);
      }
      std::ranges::sort(neighbours);
      neighbours.erase(std::ranges::unique(neighbours).begin(), neighbours.end());
      for (const BlockId neighbour : neighbours) add(face, neighbour);
    }
  }

 private:
  void add(const Face& face, BlockId neighbour) {
    double all = 0, by_table = 0;
    for (const Patch& patch : complex_.patches(face)) {
      if (patch.neighbour == neighbour) all += patch.area.si();
    }
    for (const Patch& patch : complex_.patches(face)) {
      if (patch.neighbour != neighbour) continue;
      const double area = patch.area.si();
      const auto p = stated(actions_, patch);
      if (p && !(p->or_table && table_ && over_patch(complex_, face, patch, *table_) > p->mean * area)) {
        push(face, neighbour, {p->mean * area, p->mean * area * patch.centroid}, square_metres(all));
        // A lake about the block presses there as well.
        by_table -= lake_ ? area : 0;
      } else {
        by_table += lake_ ? 0 : area;
      }
    }
    if (!table_ || by_table == 0 || !(all > 0)) return;
    push(face, neighbour, (by_table / all) * over_contact(complex_, face, neighbour, *table_), square_metres(all));
  }
  void push(const Face& face, std::optional<BlockId> neighbour, const Moments& m, Area contact) {
    if (m.total != 0) add(face.block, neighbour, -m.total * face.outward, m.first / m.total, contact);
  }
  void add(BlockId block, std::optional<BlockId> neighbour, Vec3 force, Vec3 at, Area contact) {
    if (geometry::norm(force) > 0) out_.push_back({block, neighbour, force, at, contact});
  }
  [[nodiscard]] Area area_of(BlockId block, BlockId neighbour) const {
    Area area;
    for (const topology::FaceId face : complex_.blocks()[block].faces) {
      for (const Patch& patch : complex_.patches(complex_.faces()[face])) {
        if (patch.neighbour == neighbour) area += patch.area;
      }
    }
    return area;
  }

  const BlockComplex& complex_;
  const Actions& actions_;
  std::vector<LoadOnBlock>& out_;
  std::optional<LinearPressure> table_;
  bool lake_ = false;
};

}  // namespace

std::vector<LoadOnBlock> loads_on(const BlockComplex& complex, const Actions& actions, Vec3 gravity,
                                  std::span<const BlockId> blocks) {
  std::vector<LoadOnBlock> out;
  WaterOnContacts water{complex, actions, gravity, out};
  for (const BlockId block : blocks) water.add(block);
  for_each_surface_load(complex, actions, [&](BlockId block, Vec3 force, Vec3 at) {
    if (std::ranges::binary_search(blocks, block)) out.push_back({.block = block, .force = force, .at = at});
  });
  return out;
}

ForceSum water_forces(const BlockComplex& complex, const Actions& actions, Vec3 gravity, BlockId id,
                      const std::function<bool(BlockId)>& there) {
  ForceSum sum;
  const ActionSpec& spec = actions.spec();
  const topology::Block& block = complex.blocks()[id];
  const double g = geometry::norm(gravity);
  std::optional<LinearPressure> table;
  if (spec.water && g > 0) table = {spec.water->unit_weight.si(), spec.water->level, -gravity / g};
  const auto push = [&](const Face& face, const Moments& m) {
    if (!(m.total > 0)) return;
    sum.add(-m.total * face.outward, m.first / m.total - block.centroid);
  };
  if (spec.flow) {
    const FlowWater& flow = *spec.flow;
    for (const auto& [own, neighbour, heads, at] :
         std::ranges::equal_range(flow.contacts, id, {}, &FlowWater::Contact::block)) {
      if (there(neighbour)) sum.add(flow.unit_weight.si() * heads, at - block.centroid);
    }
  }
  for (const topology::FaceId face_id : block.faces) {
    const Face& face = complex.faces()[face_id];
    if (const auto still = standing_before(actions, face); still && g > 0) push(face, over_face(complex, face, *still));
    if (face.role == topology::Role::free) {
      if (table && spec.water->on_free_faces) push(face, over_face(complex, face, *table));
      continue;
    }
    if (face.role == topology::Role::window && table) push(face, over_face(complex, face, *table));  // rock goes on
    if (face.role != topology::Role::joint) continue;
    std::vector<const Patch*> hydrostatic;
    const topology::PatchRange patches = complex.patches(face);
    for (const Patch& patch : patches) {
      if (!patch.neighbour) continue;
      if (!there(*patch.neighbour)) {
        if (table && spec.water->on_free_faces) hydrostatic.push_back(&patch);
        continue;
      }
      const auto p = stated(actions, patch);
      const bool table_presses_more =
          p && p->or_table && table && over_patch(complex, face, patch, *table) > p->mean * patch.area.si();
      if (p && !table_presses_more) {
        push(face, {p->mean * patch.area.si(), p->mean * patch.area.si() * patch.centroid});
      } else if (table) {
        hydrostatic.push_back(&patch);
      }
    }
    if (!table || hydrostatic.empty()) continue;
    if (hydrostatic.size() == patches.size()) {
      push(face, over_face(complex, face, *table));
      continue;
    }
    // Part of the face: contact by contact. Patches of one contact with joints of their own share it by area.
    std::vector<BlockId> neighbours;
    for (const Patch* patch : hydrostatic) neighbours.push_back(*patch->neighbour);
    std::ranges::sort(neighbours);
    neighbours.erase(std::ranges::unique(neighbours).begin(), neighbours.end());
    for (const BlockId neighbour : neighbours) {
      double wanted = 0, all = 0;
      for (const Patch* patch : hydrostatic) {
        if (patch->neighbour == neighbour) wanted += patch->area.si();
      }
      for (const Patch& patch : patches) {
        if (patch.neighbour == neighbour) all += patch.area.si();
      }
      if (all > 0) push(face, (wanted / all) * over_contact(complex, face, neighbour, *table));
    }
  }
  return sum;
}

}  // namespace cleave::stability
