#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
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

// A room of 10 m that another program wrote in millimetres is 10 km long; boxes may be whole regions.
constexpr double longest_mesh = 5e3, longest_region = 5e4;

/// Lengths that are likely not in metres.
void note_extent(Problems& problems, const geometry::Solid& solid, double largest, std::uint32_t line,
                 std::string key) {
  constexpr double smallest = 0.1;
  const Box box = box_of(solid);
  const geometry::Vec3 sides = box.max - box.min;
  const double extent = std::max({sides.x, sides.y, sides.z});
  if (extent >= smallest && extent <= largest) return;
  problems.note(line, std::move(key),
                fmt::format("is {:.4g} m long, which is far from usual ({:g} to {:g})", extent, smallest, largest),
                extent > largest ? "if its lengths are millimetres or feet, write them in metres"
                                 : "if its lengths are kilometres, write them in metres");
}

/// Sets with joints whose friction nobody states, though [joints] is there.
void note_sets_without_friction(const Scene& scene, const TableReader& root) {
  const TomlTable* strengths = root.table("joints");
  if (strengths == nullptr) return;
  const auto states = [&](std::string_view set, std::string_view key) {
    return std::ranges::any_of(strengths->entries, [&](const TomlEntry& entry) {
      const auto* table = std::get_if<TomlTable>(&entry.node.value);
      return (entry.key == set || entry.key == "default") && table != nullptr &&
             std::ranges::find(table->entries, key, &TomlEntry::key) != table->entries.end();
    });
  };
  std::string sets, without_cohesion;
  for (const SetId set : scene.sets.ids()) {
    const std::string& name = scene.sets[set].name;
    const bool used =
        std::ranges::any_of(scene.joint_sets, [&](const RandomSet& s) { return s.set == set; }) ||
        std::ranges::any_of(scene.joints, [&](const MeasuredJoint& j) { return j.set == set && !j.own.friction; });
    if (!used || states(name, "friction")) continue;
    sets += (sets.empty() ? "" : ", ") + name;
    if (!states(name, "cohesion") && !states(name, "jrc")) {
      without_cohesion += (without_cohesion.empty() ? "" : ", ") + name;
    }
  }
  if (sets.empty()) return;
  root.note("joints",
            fmt::format("no friction is given for {}: 30 degrees are taken{}", sets,
                        without_cohesion.empty()   ? std::string{}
                        : without_cohesion == sets ? std::string{", and cohesion 0"}
                                                   : fmt::format(", and cohesion 0 for {}", without_cohesion)),
            "add [joints.default] with friction, or a table for each of them");
}

/// Names that a reader takes for one.
void note_sets_alike(const Scene& scene, const TableReader& root) {
  const auto lower = [](std::string name) {
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return name;
  };
  std::map<std::string, SetId> seen;
  for (const SetId set : scene.sets.ids()) {
    const auto [first, added] = seen.try_emplace(lower(scene.sets[set].name), set);
    if (added) continue;
    root.note("joints",
              fmt::format("the sets \"{}\" and \"{}\" differ in case alone: they are two sets",
                          scene.sets[first->second].name, scene.sets[set].name),
              "write one name where one set is meant");
  }
}

/// From the corners of a face: within a degree of vertical it looks sideways.
bool looks_up(const geometry::Solid& solid, const geometry::SolidFace& face, geometry::Vec3 down) {
  const auto vertices = solid.vertices();
  geometry::Vec3 area;
  for (std::size_t k = 2; k < face.corners.size(); ++k) {
    const geometry::Vec3 first = vertices[face.corners[0]];
    area += geometry::cross(vertices[face.corners[k - 1]] - first, vertices[face.corners[k]] - first);
  }
  return -geometry::dot(area, down) > 0.0175 * geometry::norm(area) * geometry::norm(down);
}

/// Tables below all of the rock, or above all of its ground: a depth where a level is asked for, or another datum.
void note_tables(const Scene& scene, const TableReader& root) {
  const geometry::Vec3 down = scene.stability->loads.body.gravity();
  if (down == geometry::Vec3{}) return;
  const auto level_of = [&](geometry::Vec3 v) { return 0 - geometry::dot(v, down) / geometry::norm(down); };
  const auto vertices = scene.domain.vertices();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  double lowest = infinite, highest = -infinite, ground = -infinite;
  for (const geometry::Vec3 v : vertices) {
    lowest = std::min(lowest, level_of(v));
    highest = std::max(highest, level_of(v));
  }
  for (const geometry::SolidFace& face : scene.domain.faces()) {
    if (std::ranges::find(scene.free_domain_tags, face.tag) == scene.free_domain_tags.end()) continue;
    if (!looks_up(scene.domain, face, down)) continue;
    for (const std::uint32_t corner : face.corners) ground = std::max(ground, level_of(vertices[corner]));
  }
  const auto look = [&](const LoadSet& loads) {
    const auto& water = loads.actions.spec().water;
    if (!water || loads.water_level) return;
    if (water->level <= lowest) {
      root.problems().note(
          loads.line, "water.table",
          fmt::format("is {:g}, below all of the rock (from {:g} on), so that nothing is wet", water->level, lowest),
          "give the level of the table in the coordinates of the scene, not its depth");
    }
    // A box deep in the rock has no ground of its own.
    if (ground == highest && water->level > ground) {
      root.problems().note(
          loads.line, "water.table",
          fmt::format("is {:g}, above all of the ground (up to {:g}): the rock stands under a lake", water->level,
                      ground),
          "where it does, state free_faces = true as well; else give the level in the coordinates of the scene");
    }
  };
  look(scene.stability->loads);
  const auto& base = scene.stability->loads.actions.spec().water;
  for (const LoadCase& load : scene.stability->cases) {
    const auto& own = load.loads.actions.spec().water;
    if (!base || !own || base->level != own->level) look(load.loads);
  }
}

/// Levels of [flow] that leave all rock or all openings dry, or press as water nowhere does.
void note_levels(const Scene& scene, const TableReader& root) {
  if (!scene.flow || !scene.flow->flows()) return;
  constexpr double infinite = std::numeric_limits<double>::infinity(), deepest = 5000;
  double level = scene.flow->level ? scene.flow->level->si() : -infinite, lowest = infinite, drained = infinite;
  for (const FlowSide& side : scene.flow->sides) level = std::max(level, side.level ? side.level->si() : -infinite);
  for (const geometry::Vec3 v : scene.domain.vertices()) lowest = std::min(lowest, v.z);
  for (const Excavation& e : scene.excavations) drained = std::min(drained, std::max(lowest, box_of(e.solid).min.z));
  for (const geometry::SolidFace& face : scene.domain.faces()) {
    if (std::ranges::find(scene.free_domain_tags, face.tag) == scene.free_domain_tags.end()) continue;
    for (const std::uint32_t corner : face.corners) drained = std::min(drained, scene.domain.vertices()[corner].z);
  }
  const auto note = [&](std::string what, std::string remedy) {
    root.problems().note(scene.flow->line, "flow.level", std::move(what), std::move(remedy));
  };
  if (level <= lowest) {
    note(fmt::format("is {:g} at most, below all of the rock (from {:g} on), so that nothing is wet", level, lowest),
         "give levels in the coordinates of the scene, not depths");
  } else if (level <= drained && drained < infinite) {
    note(fmt::format("is {:g} at most, no higher than the lowest opening or free face ({:g}): no water comes out",
                     level, drained),
         "give levels in the coordinates of the scene, not depths");
  } else if (level - lowest > deepest) {
    note(fmt::format("is {:g}, {:g} m above the lowest rock: the water there has {:.3g} MPa", level, level - lowest,
                     9.81e-3 * (level - lowest)),
         "if it is in millimetres or feet, write it in metres; a head of pressure is not a level");
  }
}

/// Ensembles in which nothing is drawn: copies of one run, of which an interval says nothing.
void note_nothing_drawn(const Scene& scene, const TableReader& root) {
  if (!scene.monte_carlo || !scene.joint_sets.empty()) return;
  const auto is_law = [](FrictionLaw::Kind kind) { return kind != FrictionLaw::Kind::constant; };
  if (is_law(scene.monte_carlo->seismic_factor.kind)) return;
  const auto drawn = [&](const NamedSet& set) {
    const JointProperties& p = set.properties;
    return is_law(p.friction.kind) || is_law(p.cohesion.kind) || is_law(p.tension.kind) ||
           (scene.flow && p.aperture && is_law(p.aperture->kind));
  };
  if (std::ranges::any_of(scene.sets, drawn)) return;
  if (scene.stability) {
    const auto level = [](const LoadSet& loads) { return loads.water_level.has_value(); };
    if (level(scene.stability->loads) ||
        std::ranges::any_of(scene.stability->cases, [&](const LoadCase& load) { return level(load.loads); })) {
      return;
    }
  }
  root.note("monte_carlo", "draws nothing: there is no [[joint_set]] and no law, so that all realizations are one",
            "give friction, cohesion or aperture a law, add a [[joint_set]], or remove the section: its intervals say "
            "nothing");
}

void note_motion_in_ensemble(const Scene& scene, const TableReader& root) {
  if (!scene.motion || !scene.monte_carlo) return;
  root.note("motion", "is not run in an ensemble: [monte_carlo] judges its realizations, and moves none",
            "see one of them move by cleave replay OUT --realization K, or remove one of the two sections");
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
  const TomlTable* domain = root.table("domain");
  const bool mesh =
      domain != nullptr && std::ranges::find(domain->entries, "mesh", &TomlEntry::key) != domain->entries.end();
  note_extent(problems, scene.domain, mesh ? longest_mesh : longest_region, root.line_of("domain"), "domain");
  for (const Excavation& e : scene.excavations) {
    if (e.own_shape() && !e.tunnel) note_extent(problems, e.solid, longest_mesh, e.line, "excavation." + e.name);
  }
  if (scene.joints.empty() && scene.joint_sets.empty()) {
    problems.note(1, "joint", "there are no joints", "the rock stays one block unless excavations part it");
  }
  note_sets_alike(scene, root);
  note_nothing_drawn(scene, root);
  note_motion_in_ensemble(scene, root);
  note_levels(scene, root);
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
  note_sets_without_friction(scene, root);
  note_tables(scene, root);
  const bool stiff =
      std::ranges::any_of(scene.sets, [](const NamedSet& set) { return set.properties.stiffness.has_value(); });
  if (stiff && !scene.field_stress) {
    problems.note(root.line_of("joints"), "joints",
                  "normal_stiffness and shear_stiffness are read by [field_stress] alone",
                  "add [field_stress]: without it joints are as stiff as blocks");
  }
  if (const auto rock = root.table("rock");
      rock == nullptr || std::ranges::find(rock->entries, "density", &TomlEntry::key) == rock->entries.end()) {
    problems.note(root.line_of("rock"), "rock", "no density is given: 2700 kg/m3 is taken",
                  rock == nullptr ? "add [rock] with density" : "add density to [rock]");
  }
}

}  // namespace cleave::scene
