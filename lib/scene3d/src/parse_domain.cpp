#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "cleave/io/bodies.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "solid_input.hpp"

namespace cleave::scene {

using std::string_view;

const KeyTable& box_keys() {
  static const KeyTable keys{.name = "box",
                             .keys = {{"min", key::vector(rule::coordinate), required, "m, the lowest corner"},
                                      {"max", key::vector(rule::coordinate), required, "m, the highest corner"}}};
  return keys;
}

const KeyTable& domain_keys() {
  static const KeyTable keys{
      .name = "domain",
      .keys = {{"box", key::table(&box_keys), "",
                "`{ min = [x, y, z], max = [x, y, z] }`: faces `west east south north bottom top` (x-, x+, y-, y+, z-, "
                "z+)"},
               {"corners", key::points(), "",
                "8 points: convex hexahedron; bit 0, 1, 2 of a corner's number is its x, y, z side, which also names "
                "the faces"},
               {"mesh", key::text(), "",
                "closed surface in a file, faces outwards: `.stl`, `.obj`, `.ply`, `.dxf`, `.ts`"},
               {"terrain", key::table(&terrain_keys), "",
                "`{ file = \"FILE\", base = z }`: the rock between a ground surface and the level `base` below it; "
                "faces as for a box, the ground is `top`"}},
      .one_of = {{"box", "corners", "mesh", "terrain"}}};
  return keys;
}

std::optional<geometry::Solid> parse_box(const TableReader& owner) {
  const auto box = owner.sub("box");
  if (!box) return std::nullopt;
  const auto low = box->need_vec3("min"), high = box->need_vec3("max");
  if (!low || !high) return std::nullopt;
  const std::array<std::pair<double, double>, 3> sides{{{low->x, high->x}, {low->y, high->y}, {low->z, high->z}}};
  constexpr std::array<string_view, 3> names{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [from, to] = sides[axis];
    if (from < to) continue;
    owner.error("box",
                fmt::format("has {} volume: min {} = {}, max {} = {}", from == to ? "zero" : "negative", names[axis],
                            from, names[axis], to),
                "make every number of min smaller than that of max");
    return std::nullopt;
  }
  auto solid = geometry::make_box(*low, *high);
  if (!solid) {
    owner.error("box", describe(solid.error()), "");
    return std::nullopt;
  }
  return std::move(*solid);
}

std::optional<geometry::Solid> parse_corners(const Context& context, const TableReader& owner) {
  const auto points = owner.points("corners");
  if (!points) return std::nullopt;
  if (points->size() != 8) {
    owner.error(
        "corners", fmt::format("has {} points but must have 8", points->size()),
        "list the corners by the bits x, y, z of their number: [min, min, min], [max, min, min], [min, max, min], ...");
    return std::nullopt;
  }
  std::array<geometry::Vec3, 8> corners;
  std::ranges::copy(*points, corners.begin());
  auto solid = geometry::make_hexahedron(
      corners, context.triangulate ? geometry::BentFaces::triangulate : geometry::BentFaces::refuse);
  if (!solid) {
    owner.error("corners", describe(solid.error()), "");
    return std::nullopt;
  }
  return std::move(*solid);
}

std::optional<geometry::Solid> parse_domain(Context& context, const TableReader& root) {
  if (!root.has("domain")) {
    root.missing("domain", "add [domain] with box = { min = [0, 0, 0], max = [80, 80, 60] }, corners, mesh or terrain");
    return std::nullopt;
  }
  const auto found = root.sub("domain");
  if (!found) return std::nullopt;
  const TableReader& domain = *found;
  const TomlEntry* kind = domain.one_of();
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "box") return parse_box(domain);
  if (kind->key == "corners") return parse_corners(context, domain);
  if (kind->key == "terrain") return parse_terrain(context, domain);
  return parse_mesh(context, domain, "mesh");
}

std::optional<geometry::Solid> parse_mesh(Context& context, const TableReader& owner, std::string_view key) {
  const auto loaded = context.file(owner, key);
  if (!loaded) return std::nullopt;
  auto mesh = mesh_of(context, owner, key, *loaded);
  if (!mesh) return std::nullopt;
  const io::Unbent unbent = io::without_bent_faces(std::move(*mesh));
  if (unbent.note) context.problems.note_in(loaded->shown, 1, "file", *unbent.note, "");
  auto solid = io::solid_of(unbent.mesh);
  if (solid) return std::move(*solid);
  owner.error(key, fmt::format("{}: {}", loaded->shown, describe(solid.error())), "");
  return std::nullopt;
}

}  // namespace cleave::scene
