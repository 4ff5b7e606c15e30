#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "bounds.hpp"
#include "cleave/geometry/slope.hpp"
#include "cleave/geometry/terrain.hpp"
#include "cleave/io/height_grid.hpp"
#include "file_input.hpp"
#include "solid_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;
using Pairs = std::vector<std::array<double, 2>>;

/// [[a, b], [a, b], ...]; reports what is not.
std::optional<Pairs> pairs_of(const TableReader& table, string_view key, string_view form) {
  const TomlEntry* entry = table.find(key);
  if (entry == nullptr) {
    table.missing(key, fmt::format("add {} = {} in metres", key, form));
    return std::nullopt;
  }
  Pairs pairs;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  bool good = array != nullptr;
  for (std::size_t i = 0; good && i < array->items.size(); ++i) {
    const auto* pair = std::get_if<TomlArray>(&array->items[i].value);
    good = pair != nullptr && pair->items.size() == 2;
    if (!good) break;
    const std::string path = fmt::format("{}[{}]", table.path_of(key), i + 1);
    const auto a = table.number_of(pair->items[0], path, rule::coordinate);
    const auto b = table.number_of(pair->items[1], path, rule::coordinate);
    if (!a || !b) return std::nullopt;
    pairs.push_back({*a, *b});
  }
  if (good) return pairs;
  table.error(key, "is not a list of pairs", fmt::format("write {} = {} in metres", key, form));
  return std::nullopt;
}

geometry::Reach reach_of(const geometry::Solid& domain) {
  const Box box = box_of(domain);
  return {box.min, box.max};
}

std::optional<geometry::Solid> parse_plane_cut(const Context& context, const TableReader& slope,
                                               const geometry::Solid& domain) {
  constexpr std::array<string_view, 3> keys{"through", "dip", "dip_direction"};
  const TomlTable* found = slope.table("plane");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, slope.line_of("plane"), slope.path_of("plane"), slope.problems(), keys};
  const auto through = table.need_vec3("through", rule::coordinate);
  const auto dip = table.need_number("dip", rule::dip);
  const auto direction = table.need_number("dip_direction", rule::dip_direction);
  if (!through || !dip || !direction) return std::nullopt;
  auto solid = geometry::make_plane_cut({*through, {Dip::degrees(*dip), context.turned(*direction)}}, reach_of(domain));
  if (solid) return std::move(*solid);
  slope.error("plane", describe(solid.error()), "");
  return std::nullopt;
}

std::optional<geometry::Solid> parse_profile_cut(const Context& context, const TableReader& slope,
                                                 const geometry::Solid& domain) {
  constexpr std::array<string_view, 3> keys{"origin", "direction", "points"};
  const TomlTable* found = slope.table("profile");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, slope.line_of("profile"), slope.path_of("profile"), slope.problems(), keys};
  const auto direction = table.need_number("direction", rule::dip_direction);
  const auto points = pairs_of(table, "points", "[[s, z], [s, z], ...]");
  std::array<double, 2> origin{};
  if (const TomlEntry* entry = table.find("origin")) {
    const auto* pair = std::get_if<TomlArray>(&entry->node.value);
    if (pair == nullptr || pair->items.size() != 2) {
      table.error("origin", "is not a pair", "write origin = [x, y] in metres");
      return std::nullopt;
    }
    const auto x = table.number_of(pair->items[0], table.path_of("origin"), rule::coordinate);
    const auto y = table.number_of(pair->items[1], table.path_of("origin"), rule::coordinate);
    if (!x || !y) return std::nullopt;
    origin = {*x, *y};
  }
  if (!direction || !points) return std::nullopt;
  auto solid = geometry::make_profile_cut({origin, context.turned(*direction), *points}, reach_of(domain));
  if (solid) return std::move(*solid);
  table.error("points", describe(solid.error()), "");
  return std::nullopt;
}

/// Heights of a grid file, thinned and cut to a window where the scene asks for it.
std::optional<geometry::Ground> ground_of_grid(Context& context, const TableReader& owner, const LoadedFile& loaded) {
  auto grid = io::parse_height_grid(loaded.bytes, loaded.shown);
  if (!grid) {
    report_read_error(context.problems, grid.error());
    return std::nullopt;
  }
  for (const std::string& note : grid->notes) context.problems.note_in(loaded.shown, 1, "file", note, "");
  const auto every = static_cast<std::uint32_t>(owner.integer("every", 1, 10'000).value_or(1));
  std::uint32_t first_column = 0, last_column = grid->columns - 1, first_row = 0, last_row = grid->rows - 1;
  if (owner.has("window")) {
    const auto window = pairs_of(owner, "window", "[[x, y], [x, y]]");
    if (!window) return std::nullopt;
    if (window->size() != 2 || !((*window)[0][0] < (*window)[1][0]) || !((*window)[0][1] < (*window)[1][1])) {
      owner.error("window", "is no south-west and north-east corner", "write window = [[x, y], [x, y]]");
      return std::nullopt;
    }
    const auto [low, high] = std::pair{(*window)[0], (*window)[1]};
    while (first_column < last_column && grid->x_of(first_column) < low[0]) ++first_column;
    while (last_column > first_column && grid->x_of(last_column) > high[0]) --last_column;
    while (last_row > first_row && grid->y_of(last_row) < low[1]) --last_row;
    while (first_row < last_row && grid->y_of(first_row) > high[1]) ++first_row;
  }
  // Thinned from the south-west corner.
  const std::uint32_t columns = (last_column - first_column) / every + 1, rows = (last_row - first_row) / every + 1;
  std::vector<double> values;
  values.reserve(std::size_t{columns} * rows);
  for (std::uint32_t r = rows; r-- > 0;) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      values.push_back(grid->heights[std::size_t{last_row - r * every} * grid->columns + first_column + c * every]);
    }
  }
  return geometry::ground_of({.columns = columns,
                              .rows = rows,
                              .x = grid->x_of(first_column),
                              .y = grid->y_of(last_row),
                              .step_x = grid->step_x * every,
                              .step_y = grid->step_y * every,
                              .values = values});
}

std::optional<geometry::Ground> ground_of_mesh(Context& context, const TableReader& owner, const LoadedFile& loaded) {
  for (const string_view key : {"every", "window"}) {
    if (owner.has(key)) owner.error(key, "has a meaning for height grids only", "remove it");
  }
  const auto mesh = mesh_of(context, owner, "file", loaded);
  if (!mesh) return std::nullopt;
  const io::MeshData joined = io::welded(*mesh);
  geometry::Ground ground{.vertices = joined.vertices, .triangles = {}};
  for (std::size_t f = 0; f < joined.faces(); ++f) {
    const auto corners = joined.face(f);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      ground.triangles.push_back({corners[0], corners[k], corners[k + 1]});
    }
  }
  return ground;
}

std::optional<geometry::Ground> parse_ground(Context& context, const TableReader& owner) {
  const auto loaded = context.file(owner, "file");
  if (!loaded) return std::nullopt;
  const std::string ending = ending_of(loaded->shown);
  const bool grid = ending == "asc" || ending == "grd" || ending == "xyz" || ending == "txt" || ending == "csv";
  return grid ? ground_of_grid(context, owner, *loaded) : ground_of_mesh(context, owner, *loaded);
}

std::optional<geometry::Solid> parse_surface_cut(Context& context, const TableReader& slope,
                                                 const geometry::Solid& domain) {
  constexpr std::array<string_view, 3> keys{"file", "every", "window"};
  const TomlTable* found = slope.table("surface");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, slope.line_of("surface"), slope.path_of("surface"), slope.problems(), keys};
  const auto ground = parse_ground(context, table);
  if (!ground) return std::nullopt;
  double level = box_of(domain).max.z;
  for (const auto& v : ground->vertices) level = std::max(level, v.z);
  const auto reach = reach_of(domain);
  level += 0.01 * geometry::norm(reach.max - reach.min);
  auto solid = geometry::close_ground(*ground, level);
  if (solid) return std::move(*solid);
  table.error("file", describe(solid.error()), "");
  return std::nullopt;
}

}  // namespace

std::optional<geometry::Solid> parse_terrain(Context& context, const TableReader& owner) {
  constexpr std::array<string_view, 4> keys{"file", "base", "every", "window"};
  const TomlTable* found = owner.table("terrain");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, owner.line_of("terrain"), owner.path_of("terrain"), owner.problems(), keys};
  const auto base = table.need_number("base", rule::coordinate);
  const auto ground = parse_ground(context, table);
  if (!base || !ground) return std::nullopt;
  auto solid = geometry::close_ground(*ground, *base);
  if (solid) {
    double highest = *base;
    for (const auto& v : solid->vertices()) highest = std::max(highest, v.z);
    if (highest > *base) return std::move(*solid);
    table.error("base", "lies above the ground", "give a level below all of it");
    return std::nullopt;
  }
  table.error(std::holds_alternative<geometry::LevelWithin>(solid.error()) ? "base" : "file", describe(solid.error()),
              "");
  return std::nullopt;
}

std::optional<geometry::Solid> parse_slope(Context& context, const TableReader& slope, const geometry::Solid& domain) {
  constexpr std::array<string_view, 3> kinds{"plane", "profile", "surface"};
  const TomlEntry* kind = slope.one_of(kinds);
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "plane") return parse_plane_cut(context, slope, domain);
  if (kind->key == "profile") return parse_profile_cut(context, slope, domain);
  return parse_surface_cut(context, slope, domain);
}

std::optional<std::vector<geometry::Solid>> parse_benches(const TableReader& table, const geometry::Solid& domain) {
  constexpr NumberRule angle_rule{0, true, 90, false, " degrees"};
  const auto plan = pairs_of(table, "plan", "[[x, y], [x, y], ...]");
  const Box box = box_of(domain);
  const double top = table.has("top") ? table.number("top", rule::coordinate).value_or(0) : box.max.z;
  const auto height = table.need_number("height", rule::length);
  const auto width = table.need_number("width", rule::length_or_zero);
  const auto angle = table.need_number("angle", angle_rule);
  const auto count = table.integer("count", 1, 1000);
  if (!table.has("count")) table.missing("count", "add count = 4, the number of benches");
  if (!plan || !height || !width || !angle || !count) return std::nullopt;
  const double reach = geometry::norm(box.max - box.min);
  auto solids = geometry::make_benches({.plan = *plan,
                                        .top = top,
                                        .count = static_cast<std::uint32_t>(*count),
                                        .height = metres(*height),
                                        .width = metres(*width),
                                        .angle = *angle},
                                       box.max.z + (top < box.max.z ? 0.01 * reach : 0.0));
  if (solids) return std::move(*solids);
  table.error("plan", describe(solids.error()), "");
  return std::nullopt;
}

}  // namespace cleave::scene
