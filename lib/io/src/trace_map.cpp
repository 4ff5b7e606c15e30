#include "cleave/io/trace_map.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "cleave/core/units.hpp"
#include "csv_table.hpp"

namespace cleave::io {
namespace {

using Json = nlohmann::json;
using Line = std::vector<std::array<double, 2>>;

ReadError error(std::string_view name, ReadFault fault, std::optional<std::uint32_t> line, std::string what,
                std::string remedy) {
  return {fault, std::string{name}, line, {}, std::move(what), std::move(remedy)};
}

std::optional<double> number_of(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '+')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  double value = 0;
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<Line> points_of(const Json& array) {
  if (!array.is_array()) return std::nullopt;
  Line line;
  for (const Json& point : array) {
    if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number()) return std::nullopt;
    line.push_back({point[0].get<double>(), point[1].get<double>()});
  }
  return line;
}

/// Adds one geometry; false when it is not what GeoJSON says.
bool add_geometry(const Json& geometry, TraceMap& map, std::size_t& skipped) {
  if (!geometry.is_object() || !geometry.contains("type") || !geometry["type"].is_string()) {
    ++skipped;
    return geometry.is_null();
  }
  const auto type = geometry["type"].get<std::string>();
  if (!geometry.contains("coordinates") || !geometry["coordinates"].is_array()) return false;
  const Json& c = geometry["coordinates"];
  const auto add_line = [&](const Json& one) {
    auto line = points_of(one);
    if (!line || line->size() < 2) return false;
    map.lines.push_back(*std::move(line));
    return true;
  };
  const auto add_polygon = [&](const Json& rings) {
    if (!rings.is_array() || rings.empty()) return false;
    auto ring = points_of(rings[0]);
    if (!ring) return false;
    if (ring->size() > 1 && ring->front() == ring->back()) ring->pop_back();
    if (ring->size() < 3) return false;
    if (rings.size() > 1) map.notes.emplace_back("holes of a polygon are left out");
    map.polygons.push_back(*std::move(ring));
    return true;
  };
  if (type == "LineString") return add_line(c);
  if (type == "MultiLineString") return std::ranges::all_of(c, add_line);
  if (type == "Polygon") return add_polygon(c);
  if (type == "MultiPolygon") return std::ranges::all_of(c, add_polygon);
  ++skipped;
  return true;
}

std::expected<TraceMap, ReadError> parse_geojson(std::string_view bytes, std::string_view name) {
  const Json root = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (root.is_discarded() || !root.is_object()) {
    return std::unexpected(error(name, ReadFault::syntax, 1, "is not GeoJSON", "export it as GeoJSON again"));
  }
  TraceMap map;
  std::size_t skipped = 0;
  bool good = true;
  if (root.contains("features") && root["features"].is_array()) {
    for (const Json& feature : root["features"]) {
      good = good && feature.is_object() && feature.contains("geometry") &&
             add_geometry(feature["geometry"], map, skipped);
    }
  } else {
    good = add_geometry(root.contains("geometry") ? root["geometry"] : root, map, skipped);
  }
  if (!good) {
    return std::unexpected(
        error(name, ReadFault::syntax, 1, "holds a geometry without proper coordinates", "export it again"));
  }
  bool degrees = !root.contains("crs");
  for (const auto* group : {&map.lines, &map.polygons}) {
    for (const Line& line : *group) {
      for (const auto& p : line) degrees = degrees && std::abs(p[0]) <= 180 && std::abs(p[1]) <= 90;
    }
  }
  if (degrees && (!map.lines.empty() || !map.polygons.empty())) {
    return std::unexpected(error(name, ReadFault::out_of_range, 1,
                                 "seems to be in degrees (no crs, all within 180 x 90)",
                                 "export it in a metric projection, and keep its crs member"));
  }
  if (skipped > 0) {
    std::string note = std::to_string(skipped);
    note += " features are neither lines nor polygons";
    map.notes.push_back(std::move(note));
  }
  return map;
}

std::expected<TraceMap, ReadError> parse_fracpaq(std::string_view bytes, std::string_view name) {
  TraceMap map;
  map.unit_known = false;
  std::uint32_t number = 0;
  while (!bytes.empty()) {
    ++number;
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view text = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    std::vector<double> values;
    while (!text.empty()) {
      const std::size_t tab = std::min(text.find_first_of("\t ,"), text.size());
      const std::string_view field = text.substr(0, tab);
      text.remove_prefix(std::min(tab + 1, text.size()));
      if (field.empty() || field == "\r") continue;
      const auto value = number_of(field);
      if (!value) {
        std::string what{field.substr(0, 40)};
        what += " is not a number";
        return std::unexpected(
            error(name, ReadFault::bad_number, number, std::move(what), "one trace a line: x1 y1 x2 y2 ... with tabs"));
      }
      values.push_back(*value);
    }
    if (values.empty()) continue;
    if (values.size() % 2 != 0 || values.size() < 4) {
      return std::unexpected(error(name, ReadFault::syntax, number, "has an odd number of coordinates, or one point",
                                   "one trace a line: x1 y1 x2 y2 ... with tabs"));
    }
    Line line;
    for (std::size_t i = 0; i < values.size(); i += 2) line.push_back({values[i], values[i + 1]});
    map.lines.push_back(std::move(line));
  }
  return map;
}

std::expected<TraceMap, ReadError> parse_table(std::string_view bytes, std::string_view name) {
  auto table = parse_csv(bytes, name);
  if (!table) return std::unexpected(std::move(table).error());
  const auto column = [&](std::string_view word) -> std::optional<std::size_t> {
    const auto it = std::ranges::find(table->header, word);
    if (it == table->header.end()) return std::nullopt;
    return static_cast<std::size_t>(it - table->header.begin());
  };
  TraceMap map;
  const auto x1 = column("x1"), y1 = column("y1"), x2 = column("x2"), y2 = column("y2");
  const auto trace = column("trace"), x = column("x"), y = column("y");
  const bool segments = x1 && y1 && x2 && y2;
  if (!segments && !(trace && x && y)) {
    return std::unexpected(error(name, ReadFault::bad_columns, table->header_line, "lacks the columns of a trace map",
                                 "give x1, y1, x2, y2, or trace, x, y"));
  }
  double scale = 1;
  for (std::size_t c = 0; c < table->header.size(); ++c) {
    const bool coordinate = segments ? c == *x1 || c == *y1 || c == *x2 || c == *y2 : c == *x || c == *y;
    if (!coordinate || table->units[c].empty()) continue;
    const Unit* unit = find_unit("m", table->units[c]);
    if (unit == nullptr || table->units[c] != table->units[segments ? *x1 : *x]) {
      return std::unexpected(error(name, ReadFault::bad_columns, table->header_line,
                                   "states a unit of coordinates that is not understood, or several",
                                   "state one unit of length for all coordinates, such as (m) or (cm)"));
    }
    scale = to_unit(1, *unit);
  }
  std::string last;
  std::uint32_t begun = 0;  // line of the file
  const auto one_point = [&] {
    return std::unexpected(error(name, ReadFault::syntax, begun, "holds a trace of one point",
                                 "give every trace two rows or more, one behind the other, or remove it"));
  };
  for (const CsvTable::Row& row : table->rows) {
    const auto value = [&](std::size_t at) { return at < row.cells.size() ? number_of(row.cells[at]) : std::nullopt; };
    const auto a = value(segments ? *x1 : *x), b = value(segments ? *y1 : *y);
    const auto c = segments ? value(*x2) : a, d = segments ? value(*y2) : b;
    if (!a || !b || !c || !d) {
      return std::unexpected(error(name, ReadFault::bad_number, row.line, "holds a coordinate that is no number",
                                   "correct or remove the line"));
    }
    if (segments) {
      map.lines.push_back({{scale * *a, scale * *b}, {scale * *c, scale * *d}});
      continue;
    }
    const std::string id = *trace < row.cells.size() ? row.cells[*trace] : std::string{};
    if (map.lines.empty() || id != last) {
      if (!map.lines.empty() && map.lines.back().size() < 2) return one_point();
      map.lines.emplace_back();
      begun = row.line;
    }
    last = id;
    map.lines.back().push_back({scale * *a, scale * *b});
  }
  if (!map.lines.empty() && map.lines.back().size() < 2) return one_point();
  return map;
}

}  // namespace

std::expected<TraceMap, ReadError> parse_trace_map(std::string_view bytes, std::string_view name) {
  const auto ends = [&](std::string_view ending) { return name.ends_with(ending); };
  auto map = ends(".geojson") || ends(".json") ? parse_geojson(bytes, name)
             : ends(".csv")                    ? parse_table(bytes, name)
             : ends(".txt")                    ? parse_fracpaq(bytes, name)
                                               : std::expected<TraceMap, ReadError>{std::unexpected(error(
                                  name, ReadFault::unknown_format, {}, "has an ending that is not known for trace maps",
                                  "give .geojson, .csv or .txt (FracPaQ)"))};
  if (map && map->lines.empty() && map->polygons.empty()) {
    return std::unexpected(error(name, ReadFault::empty, 1, "holds no traces", "give at least one line"));
  }
  return map;
}

}  // namespace cleave::io
