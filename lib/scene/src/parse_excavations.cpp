#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "cleave/geometry/tunnel.hpp"
#include "context.hpp"
#include "solid_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

Length dimension(const TableReader& section, string_view key) {
  return metres(section.need_number(key, rule::length).value_or(0));
}

/// Height of the walls under an arch that rises `rise`: given as `wall`, or as `height` of the whole section.
Length wall_height(const TableReader& section, Length rise) {
  constexpr std::array<string_view, 2> keys{"wall", "height"};
  const TomlEntry* given = section.one_of(keys);
  if (given == nullptr) return metres(0);
  if (given->key == "wall") return metres(section.number("wall", rule::length_or_zero).value_or(0));
  const auto height = section.number("height", rule::length);
  if (height && *height < rise.si()) {
    section.error("height", fmt::format("is {} m, less than the {} m that the arch rises", *height, rise.si()),
                  "give a greater height or a smaller width");
  }
  return metres(height.value_or(rise.si()) - rise.si());
}

Length circle_diameter(const TableReader& section) {
  constexpr std::array<string_view, 2> keys{"diameter", "radius"};
  const TomlEntry* given = section.one_of(keys);
  if (given == nullptr) return metres(0);
  return metres(section.number(given->key, rule::length).value_or(0) * (given->key == "radius" ? 2 : 1));
}

std::optional<geometry::PolygonSection> parse_outline(const TableReader& section) {
  const TomlEntry* entry = section.find("corners");
  if (entry == nullptr) {
    section.missing("corners", "add corners = [[u, v], [u, v], ...] in metres");
    return std::nullopt;
  }
  geometry::PolygonSection outline;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  bool good = array != nullptr;
  for (std::size_t i = 0; array != nullptr && i < array->items.size(); ++i) {
    const auto* pair = std::get_if<TomlArray>(&array->items[i].value);
    if (pair == nullptr || pair->items.size() != 2) {
      good = false;
      break;
    }
    const std::string path = fmt::format("{}[{}]", section.path_of("corners"), i + 1);
    const auto u = section.number_of(pair->items[0], path, rule::coordinate);
    const auto v = section.number_of(pair->items[1], path, rule::coordinate);
    if (!u || !v) return std::nullopt;
    outline.corners.push_back({*u, *v});
  }
  if (good) return outline;
  section.error("corners", "is not a list of pairs", "write corners = [[u, v], [u, v], ...] in metres");
  return std::nullopt;
}

std::optional<geometry::Section> parse_section(const TableReader& tunnel, geometry::TunnelOptions& options) {
  constexpr std::array<string_view, 8> shapes{"circle",    "ellipse",   "rectangle", "d_shape",
                                              "horseshoe", "trapezoid", "arch",      "polygon"};
  using Keys = std::vector<string_view>;
  const std::array<Keys, 8> keys_of{Keys{"diameter", "radius"},
                                    Keys{"width", "height"},
                                    Keys{"width", "height"},
                                    Keys{"width", "wall", "height"},
                                    Keys{"width", "height"},
                                    Keys{"width", "top_width", "height"},
                                    Keys{"width", "wall", "height", "rise"},
                                    Keys{"corners"}};
  if (!tunnel.has("section")) {
    tunnel.missing("section", "add section = { shape = \"horseshoe\", width = 10, height = 10 }");
    return std::nullopt;
  }
  const TomlTable* found = tunnel.table("section");
  if (found == nullptr) return std::nullopt;
  const std::uint32_t line = tunnel.line_of("section");
  const std::string path = tunnel.path_of("section");
  std::optional<std::size_t> shape;
  {
    // The shape decides which keys are known, so it is looked at first, alone.
    TomlTable only;
    for (const TomlEntry& entry : found->entries) {
      if (entry.key == "shape") only.entries.push_back(entry);
    }
    constexpr std::array<string_view, 1> shape_key{"shape"};
    const TableReader reader{only, line, path, tunnel.problems(), shape_key};
    if (reader.need_text("shape")) shape = reader.choice("shape", shapes);
  }
  if (!shape) return std::nullopt;
  Keys known = keys_of[*shape];
  known.insert(known.end(), {"shape", "segments"});
  const TableReader section{*found, line, path, tunnel.problems(), known};
  if (const auto segments = section.integer("segments", 2, 1024))
    options.segments = static_cast<std::uint32_t>(*segments);
  if (*shape == 7) {
    auto outline = parse_outline(section);
    if (!outline) return std::nullopt;
    return std::move(*outline);
  }
  const std::size_t before = section.problems().errors();
  const auto build = [&]() -> geometry::Section {
    if (*shape == 0) return geometry::CircleSection{circle_diameter(section)};
    const Length width = dimension(section, "width");
    switch (*shape) {
      case 1: return geometry::EllipseSection{width, dimension(section, "height")};
      case 2: return geometry::RectangleSection{width, dimension(section, "height")};
      case 3: return geometry::DShapeSection{width, wall_height(section, width / 2)};
      case 4: return geometry::HorseshoeSection{width, dimension(section, "height")};
      case 5: return geometry::TrapezoidSection{width, dimension(section, "top_width"), dimension(section, "height")};
      default: break;
    }
    const Length rise = dimension(section, "rise");
    return geometry::ArchSection{width, wall_height(section, rise), rise};
  };
  const geometry::Section result = build();
  if (section.problems().errors() != before) return std::nullopt;
  return result;
}

/// The key of a tunnel that an error is about.
string_view key_of(const geometry::TunnelError& error) {
  if (std::holds_alternative<geometry::UpAlongAxis>(error)) return "up";
  const bool axis =
      std::holds_alternative<geometry::AxisTooShort>(error) || std::holds_alternative<geometry::BadAxisPoint>(error) ||
      std::holds_alternative<geometry::ZeroLengthAxis>(error) ||
      std::holds_alternative<geometry::BendTooSharp>(error) || std::holds_alternative<geometry::TunnelNotSolid>(error);
  return axis ? "axis" : "section";
}

std::optional<geometry::Solid> parse_tunnel(const TableReader& tunnel, std::optional<TunnelLine>& line) {
  geometry::TunnelOptions options;
  const auto section = parse_section(tunnel, options);
  if (!tunnel.has("axis")) tunnel.missing("axis", "add axis = [[x, y, z], [x, y, z]]");
  const auto axis = tunnel.points("axis");
  if (tunnel.has("up")) {
    options.up = tunnel.vec3("up", rule::coordinate);
    if (!options.up) return std::nullopt;
  }
  if (!section || !axis) return std::nullopt;
  auto solid = geometry::make_tunnel(*section, *axis, options);
  if (solid) {
    if (auto outline = geometry::outline_of(*section, options.segments)) {
      line = {*axis, options.up.value_or(geometry::Vec3{0, 0, 1}), std::move(outline->corners)};
    }
    return std::move(*solid);
  }
  tunnel.error(key_of(solid.error()), describe(solid.error()), "");
  return std::nullopt;
}

/// vertices = [[x, y, z], ...], faces = [[1, 2, 3], ...] counted from 1, outwards counter-clockwise.
std::optional<geometry::Solid> parse_faces(const TableReader& owner) {
  const auto vertices = owner.points("vertices");
  const TomlEntry* entry = owner.find("faces");
  if (entry == nullptr) {
    owner.missing("faces",
                  "add faces = [[1, 2, 3], ...]: numbers of vertices from 1, counter-clockwise seen from outside");
    return std::nullopt;
  }
  if (!vertices) return std::nullopt;
  const auto bad = [&](std::size_t face) {
    owner.error(
        "faces",
        fmt::format("face {} is not a list of three or more vertex numbers from 1 to {}", face, vertices->size()),
        "write faces = [[1, 2, 3], ...]");
    return std::nullopt;
  };
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  if (array == nullptr) return bad(1);
  std::vector<geometry::SolidFace> faces;
  for (const TomlNode& node : array->items) {
    const auto* numbers = std::get_if<TomlArray>(&node.value);
    if (numbers == nullptr || numbers->items.size() < 3) return bad(faces.size() + 1);
    geometry::SolidFace face;
    for (const TomlNode& item : numbers->items) {
      const auto* number = std::get_if<std::int64_t>(&item.value);
      if (number == nullptr || *number < 1 || static_cast<std::uint64_t>(*number) > vertices->size())
        return bad(faces.size() + 1);
      face.corners.push_back(static_cast<std::uint32_t>(*number - 1));
    }
    faces.push_back(std::move(face));
  }
  auto solid = geometry::Solid::make(*vertices, std::move(faces));
  if (solid) return std::move(*solid);
  owner.error("faces", describe(solid.error()), "");
  return std::nullopt;
}

std::optional<geometry::Solid> parse_polyhedron(const Context& context, const TableReader& owner) {
  constexpr std::array<string_view, 3> kinds{"box", "corners", "vertices"};
  const TomlEntry* kind = owner.one_of(kinds);
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "box") return parse_box(owner);
  if (kind->key == "corners") return parse_corners(context, owner);
  return parse_faces(owner);
}

/// What one [[excavation]] takes out: one solid, or one a bench.
std::vector<Excavation> parse_excavation(Context& context, const TomlTable& table, std::uint32_t line,
                                         std::size_t number, const std::optional<geometry::Solid>& domain) {
  enum Kind : std::size_t { tunnel, slope, benches, mesh, polyhedron };
  constexpr std::array<string_view, 5> kinds{"tunnel", "slope", "benches", "mesh", "polyhedron"};
  using Keys = std::vector<string_view>;
  const std::array<Keys, 5> keys_of{Keys{"section", "axis", "up"}, Keys{"plane", "profile", "surface"},
                                    Keys{"plan", "top", "height", "width", "angle", "count", "stage_each"},
                                    Keys{"file"}, Keys{"box", "corners", "vertices", "faces"}};
  const std::string path = fmt::format("excavation[{}]", number);
  std::optional<std::size_t> kind;
  {
    TomlTable only;
    for (const TomlEntry& entry : table.entries) {
      if (entry.key == "kind") only.entries.push_back(entry);
    }
    constexpr std::array<string_view, 1> kind_key{"kind"};
    const TableReader reader{only, line, path, context.problems, kind_key};
    if (reader.need_text("kind")) kind = reader.choice("kind", kinds);
  }
  if (!kind) return {};
  Keys known = keys_of[*kind];
  known.insert(known.end(), {"name", "kind", "stage"});
  const TableReader reader{table, line, path, context.problems, known};
  const auto name = reader.text("name");
  const auto stage = reader.integer("stage", 1, 10'000);
  std::optional<TunnelLine> tunnel_line;
  const bool each = reader.boolean("stage_each").value_or(false);
  std::vector<geometry::Solid> solids;
  const auto add = [&](std::optional<geometry::Solid> solid) {
    if (solid) solids.push_back(std::move(*solid));
  };
  // A cut from above is as large as the domain, so without a domain there is nothing to say about it.
  switch (static_cast<Kind>(*kind)) {
    case tunnel: add(parse_tunnel(reader, tunnel_line)); break;
    case slope:
      if (domain) add(parse_slope(context, reader, *domain));
      break;
    case benches:
      if (domain) solids = parse_benches(reader, *domain).value_or(std::vector<geometry::Solid>{});
      break;
    case mesh: add(parse_mesh(context, reader, "file")); break;
    case polyhedron: add(parse_polyhedron(context, reader)); break;
  }
  std::vector<Excavation> excavations;
  // The room above the first bench belongs to it.
  const std::size_t above = *kind == benches && !solids.empty() &&
                                    static_cast<std::int64_t>(solids.size()) > *reader.integer("count", 1, 1000)
                                ? 1
                                : 0;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const std::size_t bench = i < above ? 0 : i - above;
    std::string shown = name.value_or(path);
    if (*kind == benches) shown += i < above ? " above" : fmt::format(" bench {}", bench + 1);
    excavations.push_back(
        {.name = std::move(shown),
         .stage = static_cast<std::uint32_t>(stage.value_or(1)) + (each ? static_cast<std::uint32_t>(bench) : 0U),
         .solid = std::move(solids[i]),
         .axis = *kind == tunnel ? reader.points("axis").value_or(std::vector<geometry::Vec3>{})
                                 : std::vector<geometry::Vec3>{},
         .line = line,
         .tunnel = tunnel_line});
  }
  return excavations;
}

}  // namespace

void parse_excavations(Context& context, const TableReader& root, const std::optional<geometry::Solid>& domain,
                       std::vector<Excavation>& excavations) {
  const auto found = root.tables("excavation");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto* table = std::get_if<TomlTable>(&found[i]->value);
    for (Excavation& excavation : parse_excavation(context, *table, found[i]->line, i + 1, domain)) {
      excavations.push_back(std::move(excavation));
    }
  }
}

}  // namespace cleave::scene
