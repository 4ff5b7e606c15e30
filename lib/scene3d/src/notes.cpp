#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

/// Certainly outside: apart in the axes, or the whole domain on one side of a plane. (The cutter decides exactly; this
/// is for `check`.)
bool outside(const MeasuredJoint& joint, const geometry::Solid& domain, const Box& box) {
  return std::visit(overloaded{[&](const topology::Joint& polygons) {
                                 return std::ranges::all_of(polygons.polygons, [&](const geometry::Polygon& polygon) {
                                   return !box_of(polygon.corners()).overlaps(box);
                                 });
                               },
                               [&](const topology::PersistentJoint& plane) {
                                 const auto above = [&](geometry::Vec3 v) {
                                   return geometry::dot(plane.normal, v - plane.through) > 0;
                                 };
                                 const auto vertices = domain.vertices();
                                 return std::ranges::all_of(vertices, above) || std::ranges::none_of(vertices, above);
                               }},
                    joint.geometry);
}

}  // namespace

void find_notes(const Scene& scene, const TableReader& root) {
  Problems& problems = root.problems();
  const Box box = box_of(scene.domain);
  for (const MeasuredJoint& joint : scene.joints) {
    if (outside(joint, scene.domain, box)) {
      problems.note_in(joint.file, joint.line, "joint", "lies wholly outside the domain",
                       "it cuts nothing and is left out");
    }
  }
  if (scene.joints.empty() && scene.joint_sets.empty()) {
    problems.note(1, "joint", "there are no joints", "the rock stays one block unless excavations part it");
  }
  if (!scene.stability) {
    if (root.has("stability")) {
      problems.note(root.line_of("stability"), "stability", "nothing is free: no excavation and no free face",
                    "add an [[excavation]] or free = [\"top\"], or remove the section");
    }
    return;
  }
  const bool without = !scene.joint_sets.empty() ||
                       std::ranges::any_of(scene.joints, [](const MeasuredJoint& j) { return !j.own.friction; });
  if (!root.has("joints") && without) {
    problems.note(1, "joints", "no strength is given: friction 30 degrees, cohesion 0 and tension 0 are taken",
                  "add [joints.default] with friction");
  }
  const bool stiff =
      std::ranges::any_of(scene.sets, [](const NamedSet& set) { return set.properties.stiffness.has_value(); });
  if (stiff && !scene.field_stress) {
    problems.note(root.line_of("joints"), "joints",
                  "normal_stiffness and shear_stiffness are read by [field_stress] alone",
                  "add [field_stress]: without it joints are as stiff as blocks");
  }
  if (!root.has("rock")) {
    problems.note(1, "rock", "no density is given: 2700 kg/m3 is taken", "add [rock] with density");
  }
}

}  // namespace cleave::scene
