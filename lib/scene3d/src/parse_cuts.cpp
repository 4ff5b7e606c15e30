#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "cleave/geometry/terrain.hpp"
#include "cleave/io/height_grid.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "solid_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;
using Pairs = std::vector<std::array<double, 2>>;

constexpr NumberRule bench_angle_rule{0, true, 90, false, " degrees"};

const KeyTable& profile_keys() {
  static const KeyTable keys{
      .name = "profile",
      .keys = {{"origin", key::pair(rule::coordinate), "[0, 0]", "m, where s = 0"},
               {"direction", key::number(rule::dip_direction), required, "degrees, the azimuth in which s grows"},
               {"points", key::pairs(), required,
                "`[[s, z], ...]` in m, s growing; the same all along the strike; level beyond its ends"}}};
  return keys;
}

std::vector<Key> grid_file_keys() {
  return {
      {"file", key::text(), required,
       "height grid (`.asc`, `.grd`, `.xyz`, `.txt`, `.csv`) or mesh (`.stl`, `.obj`, `.ply`)"},
      {"every", key::whole(1, 10'000), "1", "of grids: takes each n-th row and column, counted from the south-west"},
      {"window", key::pairs(), "", "of grids: the part between two corners, `[[x, y], [x, y]]` in m"}};
}

/// Pairs that have to be there.
std::optional<Pairs> need_pairs(const TableReader& table, string_view key, string_view form) {
  if (!table.has(key)) table.missing(key, fmt::format("add {} = {} in metres", key, form));
  return table.pairs(key);
}

geometry::Reach reach_of(const geometry::Solid& domain) {
  const Box box = box_of(domain);
  return {box.min, box.max};
}

std::optional<geometry::Solid> parse_plane_cut(const Context& context, const TableReader& slope,
                                               const geometry::Solid& domain) {
  const auto table = slope.sub("plane");
  if (!table) return std::nullopt;
  const auto through = table->need_vec3("through");
  const auto dip = table->need_number("dip"), direction = table->need_number("dip_direction");
  if (!through || !dip || !direction) return std::nullopt;
  auto solid = geometry::make_plane_cut({*through, {Dip::degrees(*dip), context.turned(*direction)}}, reach_of(domain));
  if (solid) return std::move(*solid);
  slope.error("plane", describe(solid.error()), "");
  return std::nullopt;
}

std::optional<geometry::Solid> parse_profile_cut(const Context& context, const TableReader& slope,
                                                 const geometry::Solid& domain) {
  const auto found = slope.sub("profile");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  const auto direction = table.need_number("direction");
  const auto points = need_pairs(table, "points", "[[s, z], [s, z], ...]");
  std::array<double, 2> origin{};
  if (table.has("origin")) {
    const auto given = table.pair("origin");
    if (!given) return std::nullopt;
    origin = *given;
  }
  if (!direction || !points) return std::nullopt;
  auto solid = geometry::make_profile_cut({origin, context.turned(*direction), *points}, reach_of(domain));
  if (solid) return std::move(*solid);
  table.error("points", describe(solid.error()), "");
  return std::nullopt;
}

/// Cells of a grid that lack a height at a corner are no ground: how many they are, and what share of the plan.
void note_missing_heights(Context& context, const std::string& shown, const std::vector<double>& values,
                          std::uint32_t columns, std::uint32_t rows) {
  std::uint64_t left_out = 0, cells = 0;
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const std::size_t at = r * columns + c;
      const bool whole = !std::isnan(values[at] + values[at + 1] + values[at + columns] + values[at + columns + 1]);
      ++cells;
      left_out += whole ? 0U : 1U;
    }
  }
  if (left_out == 0) return;
  const auto missing = std::ranges::count_if(values, [](double z) { return std::isnan(z); });
  context.problems.note_in(
      shown, 1, "file",
      fmt::format(
          "{} of {} heights are missing: {} of {} cells, {:.3g} % of the plan area, are left out; terrain has no "
          "rock below them, a slope's surface cuts nothing there",
          missing, values.size(), left_out, cells, 100 * static_cast<double>(left_out) / static_cast<double>(cells)),
      "");
}

/// Heights of a grid file, thinned and cut to a window where the scene asks for it.
std::optional<geometry::Ground> ground_of_grid(Context& context, const TableReader& owner, const LoadedFile& loaded) {
  auto grid = io::parse_height_grid(loaded.bytes, loaded.shown);
  if (!grid) {
    report_read_error(context.problems, grid.error());
    return std::nullopt;
  }
  for (const std::string& note : grid->notes) context.problems.note_in(loaded.shown, 1, "file", note, "");
  const auto every = static_cast<std::uint32_t>(owner.count("every"));
  std::uint32_t first_column = 0, last_column = grid->columns - 1, first_row = 0, last_row = grid->rows - 1;
  if (owner.has("window")) {
    const auto window = need_pairs(owner, "window", "[[x, y], [x, y]]");
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
  note_missing_heights(context, loaded.shown, values, columns, rows);
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
  const std::string extension = extension_of(loaded->shown);
  const bool grid =
      extension == "asc" || extension == "grd" || extension == "xyz" || extension == "txt" || extension == "csv";
  return grid ? ground_of_grid(context, owner, *loaded) : ground_of_mesh(context, owner, *loaded);
}

std::optional<geometry::Solid> parse_surface_cut(Context& context, const TableReader& slope,
                                                 const geometry::Solid& domain) {
  const auto found = slope.sub("surface");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
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

constexpr std::array<string_view, 3> slope_kinds{"plane", "profile", "surface"};

}  // namespace

const KeyTable& ground_keys() {
  static const KeyTable keys{.name = "surface", .keys = grid_file_keys()};
  return keys;
}

const KeyTable& terrain_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "terrain", .keys = grid_file_keys()};
    table.keys.push_back({"base", key::number(rule::coordinate), required, "m, a level below all of the ground"});
    return table;
  }();
  return keys;
}

std::vector<Key> slope_keys() {
  return {{"plane", key::table(&plane_keys), "",
           "`{ through, dip, dip_direction }`: half-space; a vertical plane takes the side to which it dips"},
          {"profile", key::table(&profile_keys), "",
           "`{ origin = [x, y], direction, points = [[s, z], ...] }`: s in m from `origin` towards the azimuth "
           "`direction`, growing; the same all along the strike; level beyond its ends"},
          {"surface", key::table(&ground_keys), "",
           "`{ file = \"FILE\" }`: a ground surface as for the domain's `terrain`, with `every` and `window`; what "
           "lies beside it stays"}};
}

std::vector<Key> bench_keys() {
  return {
      {"plan", key::pairs(), required,
       "`[[x, y], ...]` in m: the crest of the uppermost bench as a closed outline, three corners or more, in either "
       "sense; what is inside is dug. It may leave the domain: of a crest line across the rock, go round outside of "
       "the domain on the side that is dug"},
      {"top", key::number(rule::coordinate), "the top of the domain", "m, level of the crest"},
      {"height", key::number(rule::length), required, "m, of a bench"},
      {"width", key::number(rule::length_or_zero), required, "m, of the berms between benches"},
      {"angle", key::number(bench_angle_rule), required, "degrees from horizontal, of a bench's face"},
      {"count", key::whole(1, 1000), required, "benches"},
      {"stage_each", key::flag(), "false", "true: each bench has its own stage, from `stage` on"}};
}

std::optional<geometry::Solid> parse_terrain(Context& context, const TableReader& owner) {
  const auto found = owner.sub("terrain");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  const auto base = table.need_number("base");
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
  const TomlEntry* kind = slope.one_of(slope_kinds);
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "plane") return parse_plane_cut(context, slope, domain);
  if (kind->key == "profile") return parse_profile_cut(context, slope, domain);
  return parse_surface_cut(context, slope, domain);
}

std::optional<std::vector<geometry::Solid>> parse_benches(const TableReader& table, const geometry::Solid& domain) {
  const auto plan = need_pairs(table, "plan", "[[x, y], [x, y], ...]");
  const Box box = box_of(domain);
  const double top = table.has("top") ? table.number("top").value_or(0) : box.max.z;
  const auto height = table.need_number("height");
  const auto width = table.need_number("width");
  const auto angle = table.need_number("angle");
  const auto count = table.integer("count");
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
