#include "water.hpp"

#include <algorithm>
#include <optional>
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

}  // namespace

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
    if (face.role == topology::Role::free && spec.flow && !face.excavation) {
      const auto still =
          std::ranges::find_if(spec.flow->standing, [&](const auto& side) { return side.tag == face.tag; });
      if (still != spec.flow->standing.end() && g > 0) {
        push(face, over_face(complex, face, {spec.flow->unit_weight.si(), still->level, Vec3{0, 0, 1}}));
      }
    }
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
