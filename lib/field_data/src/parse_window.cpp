#include "parse_window.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "cleave/geometry/orientation.hpp"
#include "cleave/io/joint_csv.hpp"
#include "parse_line.hpp"
#include "survey_rows.hpp"
#include "window_outline.hpp"

namespace cleave::scene {

using geometry::Vec3;
using std::string_view;

namespace {

constexpr NumberRule scale_rule{0, true, 1e9, false, " m"};

const KeyTable& map_circle_keys() {
  static const KeyTable keys{.name = "window.circle",
                             .keys = {{"centre", key::pair(rule::coordinate), required, "`[x, y]` of the map"},
                                      {"radius", key::number(rule::length), required, "in units of the map"}}};
  return keys;
}

const KeyTable& map_rectangle_keys() {
  static const KeyTable keys{.name = "window.rectangle",
                             .keys = {{"min", key::pair(rule::coordinate), required, "`[x, y]` of the map"},
                                      {"max", key::pair(rule::coordinate), required, "`[x, y]` of the map"}}};
  return keys;
}

}  // namespace

const KeyTable& window_keys() {
  static const KeyTable keys{
      .name = "window",
      .keys =
          {{"name", key::text(), "its number", "in the results"},
           {"traces", key::text(), required,
            "`.geojson` in a metric projection (degrees are refused), `.csv` with x1,y1,x2,y2 or trace,x,y, or "
            "FracPaQ's `.txt` with `scale`"},
           {"scale", key::number(scale_rule), "1",
            "m a unit of the map (a pixel), of the traces and of the window's outline"},
           {"area", key::text(), "", "`.geojson` of the window"},
           {"circle", key::table(&map_circle_keys), "", "`{ centre, radius }`"},
           {"rectangle", key::table(&map_rectangle_keys), "", "`{ min, max }`"},
           {"polygon", key::array(key::pair(rule::coordinate), 3), "", "`[[x, y], ...]`"},
           {"dip", key::number(rule::dip), "0",
            "degrees, of an inclined face (map x along the strike, y up the slope)"},
           {"dip_direction", key::number(rule::dip_direction), "0", "degrees, of an inclined face"},
           {"border", key::number(truncation_rule), "0",
            "m: ends so near to the window's border count as cut off by it; a note says where more lie there than by "
            "chance, and the distance that takes them"},
           {"truncation", key::number(truncation_rule), "0", "m: shorter traces were not mapped"}},
      .one_of = {{"area", "circle", "rectangle", "polygon"}}};
  return keys;
}

std::optional<std::vector<std::array<double, 2>>> three_pairs(const TableReader& table, string_view key) {
  auto pairs = table.pairs(key);
  if (!pairs || pairs->size() >= 3) return pairs;
  table.error(key, "is not a list of three pairs or more", fmt::format("write {} = [[a, b], [a, b], [a, b]]", key));
  return std::nullopt;
}

namespace {

std::optional<io::TraceMap> map_of(InputContext& context, const TableReader& table, string_view key) {
  const auto file = context.file(table, key);
  if (!file) return std::nullopt;
  auto map = io::parse_trace_map(file->bytes, file->shown);
  if (!map) {
    report_read_error(context.problems, map.error());
    return std::nullopt;
  }
  for (const std::string& note : map->notes) table.note(key, note, "");
  return *std::move(map);
}

std::optional<survey::MapPoint> point(const TableReader& table, string_view key) {
  if (!table.has(key)) table.missing(key, fmt::format("write {} = [x, y]", key));
  const auto values = table.pair(key);
  if (!values) return std::nullopt;
  return survey::MapPoint{(*values)[0], (*values)[1]};
}

/// Its outline in metres: `scale` a unit of the map.
std::optional<survey::Window> window_shape(InputContext& context, const TableReader& table, double scale) {
  const TomlEntry* given = table.one_of();
  if (given == nullptr) return std::nullopt;
  if (given->key == "area") {
    const auto area = map_of(context, table, "area");
    if (!area) return std::nullopt;
    if (area->polygons.size() != 1) {
      table.error("area", fmt::format("holds {} polygons", area->polygons.size()), "give exactly one");
      return std::nullopt;
    }
    survey::PolygonWindow polygon;
    for (const auto& p : area->polygons[0]) polygon.corners.push_back({scale * p[0], scale * p[1]});
    return polygon;
  }
  if (given->key == "circle") {
    const auto reader = table.sub("circle");
    if (!reader) return std::nullopt;
    const auto centre = point(*reader, "centre");
    const auto radius = reader->need_number("radius");
    if (centre && radius) return survey::CircleWindow{{scale * centre->x, scale * centre->y}, scale * *radius};
  }
  if (given->key == "rectangle") {
    const auto reader = table.sub("rectangle");
    if (!reader) return std::nullopt;
    const auto a = point(*reader, "min"), b = point(*reader, "max");
    if (a && b && (a->x >= b->x || a->y >= b->y)) reader->error("max", "is not above min", "swap them");
    if (a && b) {
      return survey::PolygonWindow{{{scale * a->x, scale * a->y},
                                    {scale * b->x, scale * a->y},
                                    {scale * b->x, scale * b->y},
                                    {scale * a->x, scale * b->y}}};
    }
  }
  if (given->key != "polygon") return std::nullopt;
  if (const auto corners = three_pairs(table, "polygon")) {
    survey::PolygonWindow polygon;
    for (const auto& p : *corners) polygon.corners.push_back({scale * p[0], scale * p[1]});
    return polygon;
  }
  return std::nullopt;
}

/// The traces of a map, `scale` metres a unit, about `origin`; those without length are left out.
void take_traces(const TableReader& table, const io::TraceMap& map, double scale, survey::MapPoint origin,
                 survey::WindowSurvey& window) {
  std::size_t without_length = 0;
  for (const auto& line : map.lines) {
    survey::Polyline polyline;
    for (const auto& p : line) polyline.push_back({scale * p[0] - origin.x, scale * p[1] - origin.y});
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
}

}  // namespace

void parse_window(InputContext& context, const TableReader& table, survey::SurveyInput& input) {
  survey::WindowSurvey window;
  window.name = table.text("name").value_or(table.path());
  const double dip = table.number("dip").value_or(0);
  const double direction = table.number("dip_direction").value_or(0);
  window.normal = normal_of(context, dip, direction);
  window.north = context.north;
  // Maps of level ground: x east, y north. Inclined ones: x along the strike, y up the slope.
  window.x_axis = dip == 0 ? Vec3{1, 0, 0} : -geometry::strike_vector(context.turned(direction));
  if (dip != 0 && dot(cross(window.normal, window.x_axis), Vec3{0, 0, 1}) < 0) window.x_axis = -window.x_axis;
  const auto scale = table.number("scale");
  window.border = metres(table.number("border").value_or(0));
  window.truncation = metres(table.number("truncation").value_or(0));
  if (!table.has("traces")) table.missing("traces", "add traces = \"traces.geojson\" (or .csv, .txt)");
  const auto traces = map_of(context, table, "traces");
  if (!traces) return;
  if (!traces->unit_known && !scale) {
    table.missing("scale", "the traces are in pixels: add scale = metres a pixel");
    return;
  }
  const double s = scale.value_or(1);
  std::optional<survey::Window> shape = window_shape(context, table, s);
  if (!shape) return;
  if (!(area_of(*shape) > 0)) {
    table.error(table.one_of()->key, "has no area", "give a window with an area");
    return;
  }
  if (const auto crossing = sides_that_cross(*shape)) {
    table.error(table.one_of()->key,
                fmt::format("is an outline that crosses itself: side {} crosses side {}", crossing->first + 1,
                            crossing->second + 1),
                "give the corners in their order round the window");
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
  take_traces(table, *traces, s, origin, window);
  if (auto* circle = std::get_if<survey::CircleWindow>(&*shape)) circle->centre = {0, 0};
  if (auto* polygon = std::get_if<survey::PolygonWindow>(&*shape)) {
    for (survey::MapPoint& p : polygon->corners) p = {p.x - origin.x, p.y - origin.y};
  }
  window.window = *std::move(shape);
  input.windows.push_back(std::move(window));
}

}  // namespace cleave::scene
