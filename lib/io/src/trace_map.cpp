#include "cleave/io/joint_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/units.hpp"
#include "cleave/io/field_tables.hpp"
#include "csv_table.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using Json = nlohmann::json;
using Line = std::vector<std::array<double, 2>>;

ReadError error(std::string_view name, ReadFault fault, std::optional<std::uint32_t> line, std::string what,
                std::string remedy) {
  return {fault, std::string{name}, line, {}, std::move(what), std::move(remedy)};
}

std::optional<double> plain_number(std::string_view text) {
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

/// The name of its coordinate system: "urn:ogc:def:crs:EPSG::25832", "EPSG:4326".
std::string crs_of(const Json& root) {
  if (!root.contains("crs") || !root["crs"].is_object()) return {};
  const Json& crs = root["crs"];
  if (!crs.contains("properties") || !crs["properties"].is_object()) return {};
  const Json& properties = crs["properties"];
  for (const char* key : {"name", "code", "href"}) {
    if (!properties.contains(key)) continue;
    if (properties[key].is_string()) return properties[key].get<std::string>();
    if (properties[key].is_number_integer()) return "EPSG:" + std::to_string(properties[key].get<std::int64_t>());
  }
  return {};
}

/// Whether a system counts in degrees, by its name or its number. Numbers from 4000 to 4999 are geographic systems but
/// for a few; with coordinates of hundreds and more these few are not taken for degrees.
bool is_geographic(std::string_view crs) {
  constexpr std::array<std::string_view, 3> longitudes{"crs84", "crs83", "crs27"};
  if (std::ranges::any_of(longitudes, [&](std::string_view word) { return crs.contains(word); })) return true;
  constexpr std::array<std::string_view, 7> names{"wgs 84", "wgs84", "wgs_84", "gcs_", "etrs89", "nad83", "nad27"};
  const bool projected = crs.find_first_of("/+") != std::string_view::npos || crs.contains("utm");
  if (!projected && std::ranges::any_of(names, [&](std::string_view word) { return crs.starts_with(word); }))
    return true;
  const std::size_t first = crs.find_last_not_of("0123456789");
  const std::string_view digits = crs.substr(first == std::string_view::npos ? 0 : first + 1);
  const auto code = plain_number(digits);
  constexpr std::array<double, 9> others{5498, 6318, 6319, 6668, 6706, 7844, 8997, 9057, 9777};
  return code && ((*code >= 4000 && *code < 5000) || std::ranges::find(others, *code) != others.end());
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
  const std::string crs = crs_of(root);
  bool degrees = !root.contains("crs") || is_geographic(lower(crs));
  for (const auto* group : {&map.lines, &map.polygons}) {
    for (const Line& line : *group) {
      for (const auto& p : line) degrees = degrees && std::abs(p[0]) <= 180 && std::abs(p[1]) <= 90;
    }
  }
  if (degrees && (!map.lines.empty() || !map.polygons.empty())) {
    return std::unexpected(error(name, ReadFault::out_of_range, 1,
                                 crs.empty() ? "seems to be in degrees (no crs, all within 180 x 90)"
                                             : "is in degrees: its crs is " + shown(crs),
                                 "project it to metres (the UTM zone, say) and export it with its crs member"));
  }
  if (skipped > 0) {
    std::string note = std::to_string(skipped);
    note += " features are neither lines nor polygons";
    map.notes.push_back(std::move(note));
  }
  return map;
}

/// A comma right before a digit, where blanks or tabs part the numbers: it may be a decimal comma.
bool has_decimal_commas(std::string_view line) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  bool comma = false, blank = false;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const bool after_digit = i > 0 && is_digit(line[i - 1]);
    comma = comma || (line[i] == ',' && is_digit(line[i + 1]));
    blank = blank || ((line[i] == ' ' || line[i] == '\t') && after_digit);
  }
  return comma && blank;
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
    if (has_decimal_commas(text)) {
      return std::unexpected(error(name, ReadFault::bad_number, number,
                                   "holds both commas and blanks or tabs between digits",
                                   "write decimal points, and separate coordinates by tabs"));
    }
    std::vector<double> values;
    while (!text.empty()) {
      const std::size_t tab = std::min(text.find_first_of("\t ,"), text.size());
      const std::string_view field = text.substr(0, tab);
      text.remove_prefix(std::min(tab + 1, text.size()));
      if (field.empty() || field == "\r") continue;
      const auto value = plain_number(field);
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

/// A table of segments (x1, y1, x2, y2) or of points (trace, x, y).
class TableOfTraces final {
 public:
  TableOfTraces(CsvTable table, std::string_view name) : table_{std::move(table)}, name_{name} {}

  std::expected<TraceMap, ReadError> run() {
    CLEAVE_CHECK(read_header());
    for (CsvTable::Row& row : table_.rows) CLEAVE_CHECK(read_row(row));
    if (begun_ != 0 && map_.lines.back().size() < 2) return std::unexpected(one_point());
    return std::move(map_);
  }

 private:
  [[nodiscard]] std::unexpected<ReadError> bad_header(std::string what, std::string remedy) const {
    return std::unexpected(
        error(name_, ReadFault::bad_columns, table_.header_line, std::move(what), std::move(remedy)));
  }
  [[nodiscard]] std::optional<std::size_t> column(std::string_view word) const {
    const auto it = std::ranges::find(table_.header, word);
    if (it == table_.header.end()) return std::nullopt;
    return static_cast<std::size_t>(it - table_.header.begin());
  }

  [[nodiscard]] bool is_read(std::size_t at) const {
    return at == trace_ || std::ranges::find(coordinates_, at) != coordinates_.end();
  }

  std::expected<void, ReadError> read_header() {
    for (const std::string_view word : {"x1", "y1", "x2", "y2"}) {
      if (const auto at = column(word)) coordinates_.push_back(*at);
    }
    if (coordinates_.size() < 4) {
      trace_ = column("trace");
      const auto x = column("x"), y = column("y");
      if (!trace_ || !x || !y)
        return bad_header("lacks the columns of a trace map", "give x1, y1, x2, y2, or trace, x, y");
      coordinates_ = {*x, *y};
    }
    std::string others;
    for (std::size_t c = 0; c < table_.header.size(); ++c) {
      const std::string& head = table_.header[c];
      if (is_read(c)) continue;
      if (is_read(*column(head))) {
        return bad_header("column " + shown(head) + " comes twice", "remove one");
      }
      if (!head.empty()) others += (others.empty() ? "" : ", ") + shown(head);
    }
    if (!others.empty()) {
      map_.notes.push_back("columns not read: " + others +
                           "; traces have no orientation of their own and fall into sets by [[set]]");
    }
    for (const std::size_t c : coordinates_) {
      const std::string& stated = table_.units[c];
      if (stated.empty()) continue;
      const Unit* unit = find_unit("m", stated);
      if (unit == nullptr || stated != table_.units[coordinates_.front()]) {
        return bad_header("states a unit of coordinates that is not understood, or several",
                          "state one unit of length for all coordinates, such as (m) or (cm)");
      }
      scale_ = to_unit(1, *unit);
    }
    return {};
  }

  /// Of a point or segment; a decimal comma where semicolons part the cells and no number of the table has a point.
  std::expected<double, ReadError> coordinate(const CsvTable::Row& row, std::size_t at) {
    std::string cell = row.cells[at];
    const auto fault = [&](std::string what, std::string remedy) {
      ReadError wrong = error(name_, ReadFault::bad_number, row.line, std::move(what), std::move(remedy));
      wrong.column = static_cast<std::uint32_t>(at) + 1;
      return std::unexpected(std::move(wrong));
    };
    const bool point = cell.contains('.'), comma = table_.separator == ';' && take_decimal_comma(cell);
    const auto value = plain_number(cell);
    if (!value) {
      return fault(table_.header[at] + ": " + shown(row.cells[at]) + " is not a number",
                   row.cells[at].contains(',') ? remedy_of_number(row.cells[at], table_.separator)
                                               : "correct or remove the line");
    }
    if ((comma && seen_point_) || (point && seen_comma_)) {
      return fault(
          table_.header[at] + ": " + shown(row.cells[at]) + ": some numbers have a decimal comma, others a point",
          "use one of them throughout");
    }
    seen_comma_ = seen_comma_ || comma;
    seen_point_ = seen_point_ || point;
    return scale_ * *value;
  }

  std::expected<void, ReadError> read_row(const CsvTable::Row& row) {
    if (auto fault = fault_of_row(row.cells, table_.header.size(), table_.separator)) {
      return std::unexpected(
          error(name_, ReadFault::syntax, row.line, std::move(fault->what), std::move(fault->remedy)));
    }
    Line points;
    for (std::size_t k = 0; k < coordinates_.size(); k += 2) {
      CLEAVE_TRY(const double x, coordinate(row, coordinates_[k]));
      CLEAVE_TRY(const double y, coordinate(row, coordinates_[k + 1]));
      points.push_back({x, y});
    }
    if (!trace_) {
      map_.lines.push_back(std::move(points));
      return {};
    }
    const std::string& id = row.cells[*trace_];
    if (begun_ == 0 || id != last_) {
      if (begun_ != 0 && map_.lines.back().size() < 2) return std::unexpected(one_point());
      map_.lines.emplace_back();
      begun_ = row.line;
    }
    last_ = id;
    map_.lines.back().push_back(points.front());
    return {};
  }

  [[nodiscard]] ReadError one_point() const {
    return error(name_, ReadFault::syntax, begun_, "holds a trace of one point",
                 "give every trace two rows or more, one behind the other, or remove it");
  }

  CsvTable table_;
  std::string_view name_;
  std::vector<std::size_t> coordinates_;  ///< columns, x and y in turn
  std::optional<std::size_t> trace_;
  double scale_ = 1;  ///< m a unit of the header
  std::string last_;
  std::uint32_t begun_ = 0;  ///< line of the file on which the last trace of points begins
  bool seen_comma_ = false, seen_point_ = false;
  TraceMap map_;
};

std::expected<TraceMap, ReadError> parse_table(std::string_view bytes, std::string_view name) {
  CLEAVE_TRY(CsvTable table, parse_csv(bytes, name));
  return TableOfTraces{std::move(table), name}.run();
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
