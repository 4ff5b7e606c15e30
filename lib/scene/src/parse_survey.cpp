#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/trace_map.hpp"
#include "cleave/scene/survey_file.hpp"
#include "context.hpp"
#include "file_input.hpp"
#include "survey_rows.hpp"
#include "survey_table.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

constexpr NumberRule trend_rule{0, false, 360, false, " degrees"};
constexpr NumberRule plunge_rule{-90, false, 90, false, " degrees"};
constexpr NumberRule truncation_rule{0, false, 1e6, false, " m"};

std::optional<std::vector<std::array<double, 2>>> pairs(const TableReader& table, string_view key) {
  const TomlEntry* entry = table.find(key);
  if (entry == nullptr) return std::nullopt;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  std::vector<std::array<double, 2>> result;
  for (std::size_t i = 0; array != nullptr && i < array->items.size(); ++i) {
    const auto* pair = std::get_if<TomlArray>(&array->items[i].value);
    if (pair == nullptr || pair->items.size() != 2) {
      result.clear();
      break;
    }
    const std::string path = fmt::format("{}[{}]", table.path_of(key), i + 1);
    const auto a = table.number_of(pair->items[0], path, rule::coordinate);
    const auto b = table.number_of(pair->items[1], path, rule::coordinate);
    if (!a || !b) return std::nullopt;
    result.push_back({*a, *b});
  }
  if (result.size() >= 3) return result;
  table.error(key, "is not a list of three pairs or more", fmt::format("write {} = [[a, b], [a, b], [a, b]]", key));
  return std::nullopt;
}

class SurveyParser final {
 public:
  SurveyParser(Context& context, SurveyScene& scene) : context_{context}, in_{scene.input} {}

  void orientations(const TableReader& table) {
    const auto file = context_.file(table, "file");
    const auto set = table.text("set");
    const bool wrap = table.boolean("wrap").value_or(false);
    std::optional<Vec3> line, window;
    constexpr std::array<string_view, 2> line_keys{"trend", "plunge"}, window_keys{"dip", "dip_direction"};
    if (const TomlTable* found = table.table("line")) {
      const TableReader reader{*found, table.line_of("line"), table.path_of("line"), table.problems(), line_keys};
      const auto trend = reader.need_number("trend", trend_rule), plunge = reader.need_number("plunge", plunge_rule);
      if (trend && plunge) line = line_of(context_, *trend, *plunge);
    }
    if (const TomlTable* found = table.table("outcrop")) {
      const TableReader reader{*found, table.line_of("outcrop"), table.path_of("outcrop"), table.problems(),
                               window_keys};
      const auto dip = reader.need_number("dip", rule::dip);
      const auto direction = reader.need_number("dip_direction", rule::dip_direction);
      if (dip && direction) window = normal_of(context_, *dip, *direction);
    }
    if (!file) {
      if (!table.has("file")) table.missing("file", "add file = \"poles.csv\"");
      return;
    }
    const auto data = read_survey_table(context_, *file, table.texts("columns").value_or(std::vector<std::string>{}));
    if (!data) return;
    if (!has_orientation(*data)) {
      context_.problems.error_in(
          file->shown, 1, "columns", "lacks the columns of an orientation",
          "give dip with dip_direction or strike (right-hand rule), or trend and plunge of the pole");
      return;
    }
    std::size_t wrong = 0;
    for (const SurveyTable::Row& row : data->rows) {
      const std::size_t before = context_.problems.errors();
      const auto normal = normal_of_row(context_, *file, *data, row, wrap);
      if (normal) {
        in_.orientations.push_back({*normal, set_of_row(*data, row, set.value_or("")), line, window});
      } else if (context_.problems.errors() == before) {
        ++empty_;  // a row without an orientation
      } else if (++wrong >= 20) {
        return;
      }
    }
  }

  void line(const TableReader& table) {
    survey::LineSurvey line;
    line.name = table.text("name").value_or(table.path());
    const bool wrap = table.boolean("wrap").value_or(false);
    if (table.has("points")) {
      const auto points = table.points("points");
      if (!points) return;
      for (std::size_t i = 1; i < points->size(); ++i) {
        const Vec3 d = (*points)[i] - (*points)[i - 1];
        if (norm(d) > 0) line.pieces.emplace_back(normalized(d), norm(d));
      }
    } else {
      const auto trend = table.need_number("trend", trend_rule), plunge = table.need_number("plunge", plunge_rule);
      const auto length = table.need_number("length", rule::length);
      if (!trend || !plunge || !length) return;
      line.pieces.emplace_back(line_of(context_, *trend, *plunge), *length);
    }
    if (line.pieces.empty()) {
      table.error("points", "make a line without length", "give two different points or more");
      return;
    }
    if (!table.has("file")) table.missing("file", "add file = \"line.csv\" with a column distance");
    const auto file = context_.file(table, "file");
    if (!file) return;
    const auto data = read_survey_table(context_, *file, table.texts("columns").value_or(std::vector<std::string>{}));
    if (!data) return;
    if (!data->column("distance")) {
      context_.problems.error_in(file->shown, 1, "columns", "lacks the column distance", "give metres along the line");
      return;
    }
    const bool oriented = has_orientation(*data), lengths = data->column("length").has_value();
    line.truncation = table.number("truncation", truncation_rule).value_or(0);
    std::size_t wrong = 0;
    for (const SurveyTable::Row& row : data->rows) {
      const std::size_t before = context_.problems.errors();
      const auto at = cell_number(context_, *file, *data, row, "distance");
      if (at && (*at < 0 || *at > line.length() * (1 + 1e-9))) {
        context_.problems.error_in(file->shown, row.line, "distance",
                                   fmt::format("is {} m, outside the line of {} m", *at, line.length()),
                                   "correct it, or the line's length");
      }
      if (at && oriented) {
        if (const auto normal = normal_of_row(context_, *file, *data, row, wrap)) {
          line.joints.push_back(in_.orientations.size());
          line.positions.push_back(*at);
          if (lengths) line.lengths.push_back(length_of(*file, *data, row));
          in_.orientations.push_back({*normal, set_of_row(*data, row, ""), direction_at(line, *at), std::nullopt});
        }
      } else if (at) {
        line.positions.push_back(*at);
        if (lengths) line.lengths.push_back(length_of(*file, *data, row));
      }
      if (context_.problems.errors() != before && ++wrong >= 20) return;
    }
    in_.lines.push_back(std::move(line));
  }

  void window(const TableReader& table) {
    survey::WindowSurvey window;
    window.name = table.text("name").value_or(table.path());
    const double dip = table.number("dip", rule::dip).value_or(0);
    const double direction = table.number("dip_direction", rule::dip_direction).value_or(0);
    window.normal = normal_of(context_, dip, direction);
    // Maps of level ground: x east, y north. Inclined ones: x along the strike, y up the slope.
    window.x_axis = dip == 0 ? Vec3{1, 0, 0} : -geometry::strike_vector(context_.turned(direction));
    if (dip != 0 && dot(cross(window.normal, window.x_axis), Vec3{0, 0, 1}) < 0) window.x_axis = -window.x_axis;
    constexpr NumberRule scale_rule{0, true, 1e9, false, " m"};
    const auto scale = table.number("scale", scale_rule);
    constexpr NumberRule border_rule{0, false, 1e6, false, " m"};
    window.border = table.number("border", border_rule).value_or(0);
    window.truncation = table.number("truncation", border_rule).value_or(0);
    if (!table.has("traces")) table.missing("traces", "add traces = \"traces.geojson\" (or .csv, .txt)");
    const auto traces = map_of(table, "traces");
    if (!traces) return;
    if (!traces->unit_known && !scale) {
      table.missing("scale", "the traces are in pixels: add scale = metres a pixel");
      return;
    }
    const double s = scale.value_or(1);
    std::optional<survey::Window> shape;
    constexpr std::array<string_view, 4> shapes{"area", "circle", "rectangle", "polygon"};
    const TomlEntry* given = table.one_of(shapes);
    if (given == nullptr) return;
    if (given->key == "area") {
      const auto area = map_of(table, "area");
      if (!area) return;
      if (area->polygons.size() != 1) {
        table.error("area", fmt::format("holds {} polygons", area->polygons.size()), "give exactly one");
        return;
      }
      survey::PolygonWindow polygon;
      for (const auto& p : area->polygons[0]) polygon.corners.push_back({s * p[0], s * p[1]});
      shape = std::move(polygon);
    } else if (given->key == "circle") {
      constexpr std::array<string_view, 2> keys{"centre", "radius"};
      const TomlTable* found = table.table("circle");
      if (found == nullptr) return;
      const TableReader reader{*found, given->line, table.path_of("circle"), table.problems(), keys};
      const auto centre = point(reader, "centre");
      const auto radius = reader.need_number("radius", rule::length);
      if (centre && radius) shape = survey::CircleWindow{{s * centre->x, s * centre->y}, s * *radius};
    } else if (given->key == "rectangle") {
      constexpr std::array<string_view, 2> keys{"min", "max"};
      const TomlTable* found = table.table("rectangle");
      if (found == nullptr) return;
      const TableReader reader{*found, given->line, table.path_of("rectangle"), table.problems(), keys};
      const auto a = point(reader, "min"), b = point(reader, "max");
      if (a && b && (a->x >= b->x || a->y >= b->y)) reader.error("max", "is not above min", "swap them");
      if (a && b) {
        shape = survey::PolygonWindow{
            {{s * a->x, s * a->y}, {s * b->x, s * a->y}, {s * b->x, s * b->y}, {s * a->x, s * b->y}}};
      }
    } else if (const auto corners = pairs(table, "polygon")) {
      survey::PolygonWindow polygon;
      for (const auto& p : *corners) polygon.corners.push_back({s * p[0], s * p[1]});
      shape = std::move(polygon);
    }
    if (!shape) return;
    if (!(area_of(*shape) > 0)) {
      table.error(given->key, "has no area", "give a window with an area");
      return;
    }
    // Map coordinates of millions of metres lose digits in products: everything is taken about the window.
    const survey::MapPoint origin = std::visit(
        [](const auto& w) {
          if constexpr (requires { w.centre; }) {
            return w.centre;
          } else {
            return w.corners.front();
          }
        },
        *shape);
    std::size_t without_length = 0;
    for (const auto& line : traces->lines) {
      survey::Polyline polyline;
      for (const auto& p : line) polyline.push_back({s * p[0] - origin.x, s * p[1] - origin.y});
      double length = 0;
      for (std::size_t i = 1; i < polyline.size(); ++i) {
        length += std::hypot(polyline[i].x - polyline[i - 1].x, polyline[i].y - polyline[i - 1].y);
      }
      if (!(length > 0)) {
        ++without_length;
        continue;
      }
      window.traces.push_back(std::move(polyline));
    }
    if (without_length > 0) {
      table.note("traces", fmt::format("{} traces have no length and are left out", without_length), "remove them");
    }
    if (auto* circle = std::get_if<survey::CircleWindow>(&*shape)) circle->centre = {0, 0};
    if (auto* polygon = std::get_if<survey::PolygonWindow>(&*shape)) {
      for (survey::MapPoint& p : polygon->corners) p = {p.x - origin.x, p.y - origin.y};
    }
    window.window = *std::move(shape);
    in_.windows.push_back(std::move(window));
  }

  void set(const TableReader& table) {
    survey::SetRule rule;
    const auto name = table.need_text("name");
    if (name) rule.name = *name;
    if (table.has("polygon")) {
      if (const auto corners = pairs(table, "polygon")) {
        for (const auto& p : *corners) rule.polygon.push_back(line_of(context_, p[0], p[1]));
      }
    }
    if (const TomlEntry* entry = table.find("azimuth")) {
      const auto* array = std::get_if<TomlArray>(&entry->node.value);
      if (array == nullptr || array->items.size() != 2) {
        table.error("azimuth", "is not a pair", "write azimuth = [from, to] in degrees, clockwise");
      } else {
        const auto from = table.number_of(array->items[0], table.path_of("azimuth"), rule::turn);
        const auto to = table.number_of(array->items[1], table.path_of("azimuth"), rule::turn);
        if (from && to) rule.azimuth = std::pair{*from, *to};
      }
    }
    constexpr NumberRule kappa{0, true, 1e6, false, ""};
    rule.dip = table.number("dip", rule::dip);
    rule.dip_direction = table.number("dip_direction", rule::dip_direction);
    rule.kappa = table.number("kappa", kappa);
    shape(table, rule.shape);
    in_.rules.push_back(std::move(rule));
  }

  static void shape(const TableReader& table, survey::ShapeRule& shape) {
    constexpr NumberRule aspect_rule{1, false, 1000, false, ""};
    const auto aspect = table.number("aspect", aspect_rule);
    const auto rotation = table.number("rotation", rule::turn);
    const auto name = table.text("shape");
    if (name == "ellipse") {
      shape.shape = survey::JointShape::ellipse;
    } else if (name == "rectangle") {
      shape.shape = survey::JointShape::rectangle;
    } else if (name && name != "disc") {
      table.error("shape", fmt::format("\"{}\" is not known", *name), "choose one of: disc, ellipse, rectangle");
      return;
    }
    if (shape.shape == survey::JointShape::disc && (aspect || rotation)) {
      table.error(aspect ? "aspect" : "rotation", "belongs to ellipses and rectangles", "add shape = \"ellipse\"");
      return;
    }
    if (shape.shape != survey::JointShape::disc && !aspect) {
      table.missing("aspect", "add aspect = long over short axis or side");
    }
    shape.aspect = aspect.value_or(1);
    shape.rotation = rotation.value_or(0);
  }

  void finish(const TableReader& root) {
    if (in_.orientations.empty() && in_.windows.empty() && in_.lines.empty() && context_.problems.errors() == 0) {
      root.problems().error(1, "survey", "holds no data",
                            "add [[orientations]], [[scanline]], [[borehole]] or [[window]]");
    }
    if (empty_ > 0) {
      root.problems().note(1, "orientations", fmt::format("{} rows hold no orientation and are left out", empty_),
                           "fill or remove them");
    }
  }

 private:
  static Vec3 direction_at(const survey::LineSurvey& line, double position) {
    for (const auto& [direction, length] : line.pieces) {
      if (position <= length) return direction;
      position -= length;
    }
    return line.pieces.back().first;
  }

  /// Length of the trace that a row states, and how many of its ends were seen (column `ends`; none: both). No length:
  /// 0.
  survey::SeenLength length_of(const LoadedFile& file, const SurveyTable& table, const SurveyTable::Row& row) {
    const auto length = cell_number(context_, file, table, row, "length");
    const auto ends = cell_number(context_, file, table, row, "ends");
    if (length && *length < 0) {
      context_.problems.error_in(file.shown, row.line, "length", fmt::format("is {} m", *length),
                                 "give the length that is seen, or leave it empty");
    }
    if (ends && *ends != 0 && *ends != 1 && *ends != 2) {
      context_.problems.error_in(file.shown, row.line, "ends", fmt::format("is {}", *ends),
                                 "give how many ends of the trace are seen: 0, 1 or 2");
      return {};
    }
    return {length.value_or(0), static_cast<std::uint32_t>(ends.value_or(2))};
  }

  std::optional<io::TraceMap> map_of(const TableReader& table, string_view key) {
    const auto file = context_.file(table, key);
    if (!file) return std::nullopt;
    auto map = io::parse_trace_map(file->bytes, file->shown);
    if (!map) {
      report_read_error(context_.problems, map.error());
      return std::nullopt;
    }
    for (const std::string& note : map->notes) table.note(key, note, "");
    return *std::move(map);
  }

  static std::optional<survey::MapPoint> point(const TableReader& table, string_view key) {
    const TomlEntry* entry = table.find(key);
    const auto* array = entry != nullptr ? std::get_if<TomlArray>(&entry->node.value) : nullptr;
    if (array == nullptr || array->items.size() != 2) {
      table.error(key, "is not a point of the map", fmt::format("write {} = [x, y]", key));
      return std::nullopt;
    }
    const auto x = table.number_of(array->items[0], table.path_of(key), rule::coordinate);
    const auto y = table.number_of(array->items[1], table.path_of(key), rule::coordinate);
    if (!x || !y) return std::nullopt;
    return survey::MapPoint{*x, *y};
  }

  Context& context_;
  survey::SurveyInput& in_;
  std::size_t empty_ = 0;
};

}  // namespace

std::expected<SurveyScene, std::vector<Problem>> parse_survey(string_view text, const std::string& shown,
                                                              const ReadFile& read_file) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, "mend the syntax: see https://toml.io");
    return std::unexpected(std::move(problems).take_errors());
  }
  constexpr std::array<string_view, 11> keys{"schema",     "title",      "seed",         "north",
                                             "confidence", "weight_cap", "orientations", "scanline",
                                             "borehole",   "window",     "set"};
  std::vector<string_view> known{keys.begin(), keys.end()};
  known.emplace_back("clusters");
  const TableReader root{*tree, 1, "", problems, known};
  Context context{.problems = problems, .read_file = read_file};
  SurveyScene scene;
  constexpr NumberRule confidence{0.5, false, 0.9999, false, ""}, cap{1, false, 1000, false, ""};
  scene.input.title = root.text("title").value_or(shown);
  scene.input.seed = static_cast<std::uint64_t>(root.integer("seed", 0, INT64_MAX).value_or(1));
  scene.input.confidence = root.number("confidence", confidence).value_or(0.95);
  scene.input.weight_cap = root.number("weight_cap", cap).value_or(10);
  scene.input.clusters = static_cast<std::size_t>(root.integer("clusters", 0, 20).value_or(0));
  context.north = root.number("north", rule::turn).value_or(0);

  SurveyParser parser{context, scene};
  const auto each = [&](string_view name, auto known_keys, auto&& use) {
    const auto found = root.tables(name);
    for (std::size_t i = 0; i < found.size(); ++i) {
      use(TableReader{std::get<TomlTable>(found[i]->value), found[i]->line, fmt::format("{}[{}]", name, i + 1),
                      problems, known_keys});
    }
  };
  using Keys = std::vector<string_view>;
  each("orientations", Keys{"file", "set", "columns", "wrap", "line", "outcrop"},
       [&](const TableReader& t) { parser.orientations(t); });
  const Keys line_keys{"name", "trend", "plunge", "length", "points", "file", "columns", "wrap", "truncation"};
  each("scanline", line_keys, [&](const TableReader& t) { parser.line(t); });
  each("borehole", line_keys, [&](const TableReader& t) { parser.line(t); });
  each("window",
       Keys{"name", "traces", "area", "circle", "rectangle", "polygon", "scale", "dip", "dip_direction", "border",
            "truncation"},
       [&](const TableReader& t) { parser.window(t); });
  each("set", Keys{"name", "polygon", "azimuth", "dip", "dip_direction", "kappa", "shape", "aspect", "rotation"},
       [&](const TableReader& t) { parser.set(t); });
  parser.finish(root);
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  const std::size_t slash = shown.find_last_of('/');
  scene.file_name = slash == std::string::npos ? shown : shown.substr(slash + 1);
  scene.sha256 = sha256_hex(text);
  scene.files = std::move(context.files);
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
