#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "cleave/geometry/tunnel.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "solid_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::array<string_view, 8> shapes{"circle",    "ellipse",   "rectangle", "d_shape",
                                            "horseshoe", "trapezoid", "arch",      "polygon"};
enum Kind : std::size_t { tunnel, slope, benches, mesh, polyhedron };
constexpr std::array<string_view, 5> kinds{"tunnel", "slope", "benches", "mesh", "polyhedron"};

const KeyTable& profile_shape_keys() {
  const Key width{"width", key::number(rule::length), required, "m"},
      height{"height", key::number(rule::length), required, "m"};
  const Key wall{"wall", key::number(rule::length_or_zero), "", "m, height of the walls; or the whole `height`"};
  const Key whole{"height", key::number(rule::length), "", "m, of the whole; or that of the walls, `wall`"};
  static const KeyTable keys{
      .name = "excavation.section",
      .keys = {{"shape", key::word(shapes), required, "of the opening"},
               {"segments", key::whole(2, 1024), "16", "chords of a half circle"}},
      .select = "shape",
      .variants = {
          {"circle",
           {{"diameter", key::number(rule::length), "", "m, or `radius`; polygon of the circle's area"},
            {"radius", key::number(rule::length), "", "m"}}},
          {"ellipse", {width, height}},
          {"rectangle", {width, height}},
          {"d_shape", {width, wall, whole}},
          {"horseshoe", {width, height}},
          {"trapezoid",
           {width,
            {"top_width", key::number(rule::length), required, "m, of the roof; `width` is that of the floor"},
            height}},
          {"arch",
           {width,
            wall,
            whole,
            {"rise", key::number(rule::length), required, "m, of the circular arc over the walls"}}},
          {"polygon",
           {{"corners", key::pairs(), required,
             "`[[u, v], ...]` in m, u to the right and v up, looking along the axis, which goes through the centre "
             "of their bounding box, wherever (0, 0) is"}}}}};
  return keys;
}

Length dimension(const TableReader& section, string_view key) { return metres(section.need_number(key).value_or(0)); }

/// Height of the walls under an arch that rises `rise`: given as `wall`, or as `height` of the whole section.
Length wall_height(const TableReader& section, Length rise) {
  constexpr std::array<string_view, 2> keys{"wall", "height"};
  const TomlEntry* given = section.one_of(keys);
  if (given == nullptr) return metres(0);
  if (given->key == "wall") return metres(section.number("wall").value_or(0));
  const auto height = section.number("height");
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
  return metres(section.number(given->key).value_or(0) * (given->key == "radius" ? 2 : 1));
}

/// Sections are drawn about a point of the floor or of the springline: the axis does not go through that.
void note_off_axis(const TableReader& section, const std::vector<std::array<double, 2>>& corners) {
  if (corners.empty()) return;
  std::array<double, 2> centre{}, size{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto along = [&](const std::array<double, 2>& corner) { return corner.at(k); };
    const auto [least, most] = std::ranges::minmax_element(corners, {}, along);
    centre.at(k) = (along(*least) + along(*most)) / 2;
    size.at(k) = along(*most) - along(*least);
  }
  constexpr double slight = 0.01;
  if (std::max(std::abs(centre[0]), std::abs(centre[1])) <= slight * std::max(size[0], size[1])) return;
  section.note(
      "corners",
      fmt::format("lie about ({:.4g}, {:.4g}), where the axis goes through them: not through their (0, 0)", centre[0],
                  centre[1]),
      fmt::format("to have (0, 0) on the axis as it is now, move the axis by {:.4g} m to the right and {:.4g} m "
                  "up",
                  centre[0], centre[1]));
}

std::optional<geometry::PolygonSection> parse_outline(const TableReader& section) {
  if (!section.has("corners")) section.missing("corners", "add corners = [[u, v], [u, v], ...] in metres");
  const auto corners = section.pairs("corners");
  if (!corners) return std::nullopt;
  geometry::PolygonSection outline;
  for (const auto& [u, v] : *corners) outline.corners.push_back({u, v});
  note_off_axis(section, outline.corners);
  return outline;
}

std::optional<geometry::Section> parse_section(const TableReader& tunnel, geometry::TunnelOptions& options) {
  if (!tunnel.has("section")) {
    tunnel.missing("section", "add section = { shape = \"horseshoe\", width = 10, height = 10 }");
    return std::nullopt;
  }
  const auto found = tunnel.sub("section");
  const auto shape = found ? found->variant() : std::nullopt;
  if (!shape) return std::nullopt;
  const TableReader& section = *found;
  options.segments = static_cast<std::uint32_t>(section.count("segments"));
  if (*shape == 7) {
    auto outline = parse_outline(section);
    if (!outline) return std::nullopt;
    return std::move(*outline);
  }
  const std::size_t before = section.problems().errors();
  const auto build = [&]() -> geometry::Section {
    if (*shape == 0) return geometry::CircleSection{circle_diameter(section)};
    const Length width = dimension(section, "width");
    static_assert(shapes.size() == 8, "each shape has its case; circle, arch and polygon stand before and below");
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
      std::holds_alternative<geometry::BendTooSharp>(error) || std::holds_alternative<geometry::SectionTurns>(error) ||
      std::holds_alternative<geometry::TunnelNotSolid>(error);
  return axis ? "axis" : "section";
}

std::optional<geometry::Solid> parse_tunnel(const TableReader& tunnel, std::optional<TunnelLine>& line) {
  geometry::TunnelOptions options;
  const auto section = parse_section(tunnel, options);
  if (!tunnel.has("axis")) tunnel.missing("axis", "add axis = [[x, y, z], [x, y, z]]");
  const auto axis = tunnel.points("axis");
  if (tunnel.has("up")) {
    options.up = tunnel.vec3("up");
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
  constexpr std::array<string_view, 3> forms{"box", "corners", "vertices"};
  const TomlEntry* kind = owner.one_of(forms);
  if (kind == nullptr) return std::nullopt;
  if (kind->key == "box") return parse_box(owner);
  if (kind->key == "corners") return parse_corners(context, owner);
  return parse_faces(owner);
}

/// What one [[excavation]] takes out: one solid, or one a bench.
std::vector<Excavation> parse_excavation(Context& context, const TableReader& reader,
                                         const std::optional<geometry::Solid>& domain) {
  const auto kind = reader.variant();
  if (!kind) return {};
  const auto name = reader.text("name");
  const auto stage = static_cast<std::uint32_t>(reader.count("stage"));
  std::optional<TunnelLine> tunnel_line;
  const bool each = *kind == benches && reader.flag("stage_each");
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
  const std::size_t above =
      *kind == benches && !solids.empty() && static_cast<std::int64_t>(solids.size()) > reader.count("count") ? 1 : 0;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const std::size_t bench = i < above ? 0 : i - above;
    std::string shown = name.value_or(reader.path());
    if (*kind == benches) shown += i < above ? " above" : fmt::format(" bench {}", bench + 1);
    excavations.push_back({.name = std::move(shown),
                           .stage = stage + (each ? static_cast<std::uint32_t>(bench) : 0U),
                           .solid = std::move(solids[i]),
                           .axis = *kind == tunnel ? reader.points("axis").value_or(std::vector<geometry::Vec3>{})
                                                   : std::vector<geometry::Vec3>{},
                           .line = reader.line(),
                           .tunnel = tunnel_line,
                           .wall = *kind == slope     ? "slope"
                                   : *kind == benches ? "bench"
                                                      : "face"});
  }
  return excavations;
}

std::string name_of(const TableReader& excavation) {
  const TomlEntry* entry = excavation.find("name");
  const auto* name = entry == nullptr ? nullptr : std::get_if<std::string>(&entry->node.value);
  return name == nullptr ? excavation.path() : *name;
}

/// What a name stands for (bolts, a load, a target) would be the first of the excavations alone.
void refuse_repeated(const TableReader& excavation, std::map<std::string, std::uint32_t>& names) {
  const auto [known, fresh] = names.try_emplace(name_of(excavation), excavation.line_of("name"));
  if (fresh) return;
  excavation.error(
      "name",
      fmt::format("\"{}\" is the name of another excavation, in line {}", known->first.substr(0, 60), known->second),
      "give each a name of its own");
}

}  // namespace

std::vector<Key> tunnel_keys() {
  return {{"section", key::table(&profile_shape_keys), required,
           "`{ shape = \"horseshoe\", width = 10, height = 10 }`, below"},
          {"axis", key::points(), required,
           "two points or more, through the centre of the section's bounding box: straight, bent or curved"},
          {"up", key::vector(rule::coordinate), "[0, 0, 1]",
           "upwards in the section, all along the axis; needed where it starts vertical"}};
}

const KeyTable& excavation_keys() {
  static const KeyTable keys{
      .name = "excavation",
      .keys = {{"name", key::text(), "`excavation[N]`", "of the opening"},
               {"kind", key::word(kinds), required, "what is taken out"},
               {"stage", key::whole(1, 10'000), "1", "see `[sequence]`"}},
      .select = "kind",
      .variants = {{"tunnel", tunnel_keys()},
                   {"slope", slope_keys()},
                   {"benches", bench_keys()},
                   {"mesh", {{"file", key::text(), required, "a closed surface as for the domain"}}},
                   {"polyhedron",
                    {{"box", key::table(&box_keys), "", "as for the domain"},
                     {"corners", key::points(), "", "as for the domain"},
                     {"vertices", key::points(), "", "with `faces`"},
                     {"faces", key::array(key::array(key::whole(1, 1'000'000'000), 3)), "",
                      "`[[1, 2, 3], ...]`: numbers of vertices from 1, counter-clockwise seen from outside"}}}}};
  return keys;
}

void parse_excavations(Context& context, const TableReader& root, const std::optional<geometry::Solid>& domain,
                       std::vector<Excavation>& excavations) {
  std::map<std::string, std::uint32_t> names;
  for (const TableReader& table : root.each("excavation")) {
    refuse_repeated(table, names);
    std::vector<Excavation> made = parse_excavation(context, table, domain);
    if (made.empty()) context.problems.unread(name_of(table));
    const bool outside = domain && !made.empty() && std::ranges::all_of(made, [&](const Excavation& excavation) {
                           return parted(excavation.solid, *domain);
                         });
    if (outside) {
      context.problems.error(table.line(), table.path(), "removes no rock: it lies wholly outside the domain",
                             "move it into the domain, or enlarge the domain");
    }
    std::ranges::move(made, std::back_inserter(excavations));
  }
}

}  // namespace cleave::scene
