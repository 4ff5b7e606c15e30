#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "context.hpp"
#include "solid_input.hpp"

namespace cleave::scene {

using std::string_view;

std::optional<geometry::Solid> parse_box(const TableReader& owner) {
  constexpr std::array<string_view, 2> keys{"min", "max"};
  const TomlTable* found = owner.table("box");
  if (found == nullptr) return std::nullopt;
  const TableReader box{*found, owner.line_of("box"), owner.path_of("box"), owner.problems(), keys};
  const auto low = box.need_vec3("min", rule::coordinate);
  const auto high = box.need_vec3("max", rule::coordinate);
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
  constexpr std::array<string_view, 4> keys{"box", "corners", "mesh", "terrain"};
  if (!root.has("domain")) {
    root.missing("domain", "add [domain] with box = { min = [0, 0, 0], max = [80, 80, 60] }, corners, mesh or terrain");
    return std::nullopt;
  }
  const TomlTable* found = root.table("domain");
  if (found == nullptr) return std::nullopt;
  const TableReader domain{*found, root.line_of("domain"), "domain", root.problems(), keys};
  const TomlEntry* kind = domain.one_of(keys);
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "box") return parse_box(domain);
  if (kind->key == "corners") return parse_corners(context, domain);
  if (kind->key == "terrain") return parse_terrain(context, domain);
  return parse_mesh(context, domain, "mesh");
}

}  // namespace cleave::scene
