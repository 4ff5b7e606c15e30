#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/file_input.hpp"
#include "parse_orientations.hpp"
#include "survey_rows.hpp"
#include "survey_table.hpp"
#include "window_outline.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

constexpr NumberRule truncation_rule{0, false, 1e6, false, " m"};

constexpr NumberRule scale_rule{0, true, 1e9, false, " m"};
constexpr NumberRule kappa_rule{0, true, 1e6, false, ""};
constexpr NumberRule aspect_rule{1, false, 1000, false, ""};
constexpr NumberRule confidence_rule{0.5, false, 0.9999, false, ""};
constexpr NumberRule cap_rule{1, false, 1000, false, ""};

const KeyTable& line_keys() {
  static const KeyTable keys{
      .name = "scanline",
      .keys = {{"name", key::text(), "its number", "in the results"},
               {"trend", key::number(trend_rule), "", "degrees, of a straight line"},
               {"plunge", key::number(plunge_rule), "", "degrees below horizontal"},
               {"length", key::number(rule::length), "", "m"},
               {"points", key::points(), "", "`[[x, y, z], ...]` in m, of a bent line, instead of the three"},
               {"file", key::text(), required,
                "table with `distance` (m along the line) and, where measured, orientations (as above, or `alpha` and "
                "`beta` "
                "of an oriented core), and `length` of the trace with `ends` (0, 1, 2 of them seen; 2 where empty)"},
               {"columns", key::texts(), "[]", "names of the columns of a table without a header"},
               {"wrap", key::flag(), "false", "true: accept angles outside their range"},
               declination_key(),
               core_reference_key(),
               {"truncation", key::number(truncation_rule), "0", "m: shorter traces were not recorded"}}};
  return keys;
}

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

const KeyTable& set_keys() {
  static const KeyTable keys{
      .name = "set",
      .keys = {{"name", key::text(), required, "of the joint set"},
               {"polygon", key::array(key::pair(rule::coordinate), 3), "",
                "`[[trend, plunge], ...]` of poles on the stereonet"},
               {"azimuth", key::pair(rule::turn), "",
                "`[from, to]` of the traces, degrees clockwise, for maps without orientations; vertical faces need "
                "`dip_direction` and "
                "`kappa` instead"},
               {"dip", key::number(rule::dip), "",
                "degrees, stated beside `azimuth`, or beside `dip_direction` and `kappa`"},
               {"dip_direction", key::number(rule::dip_direction), "from the traces",
                "degrees; traces have two: a note names the other"},
               {"kappa", key::number(kappa_rule), "from the traces", "of the Fisher law"},
               {"shape", key::word<survey::JointShape>(), "\"disc\"", "of its joints"},
               {"aspect", key::number(aspect_rule), "", "long over short axis or side"},
               {"rotation", key::number(rule::turn), "0", "degrees from the strike to the long axis or side"}}};
  return keys;
}

/// [[a, b], ...], three at least.
std::optional<std::vector<std::array<double, 2>>> three_pairs(const TableReader& table, string_view key) {
  auto pairs = table.pairs(key);
  if (!pairs || pairs->size() >= 3) return pairs;
  table.error(key, "is not a list of three pairs or more", fmt::format("write {} = [[a, b], [a, b], [a, b]]", key));
  return std::nullopt;
}

class SurveyParser final {
 public:
  SurveyParser(InputContext& context, SurveyScene& scene) : context_{context}, in_{scene.input} {}

  void orientations(const TableReader& table) { parse_orientations(context_, table, in_, empty_); }

  void line(const TableReader& table) {
    survey::LineSurvey line;
    line.name = table.text("name").value_or(table.path());
    RowRules rules{.wrap = table.flag("wrap"), .declination = table.value("declination")};
    if (table.has("points")) {
      const auto points = table.points("points");
      if (!points) return;
      for (std::size_t i = 1; i < points->size(); ++i) {
        const Vec3 d = (*points)[i] - (*points)[i - 1];
        if (norm(d) > 0) line.pieces.emplace_back(normalized(d), norm(d));
      }
    } else {
      const auto trend = table.need_number("trend"), plunge = table.need_number("plunge");
      const auto length = table.need_number("length");
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
    // A line that meets no joint is data: it says how few there are.
    const auto data =
        read_survey_table(context_, *file, table.texts("columns").value_or(std::vector<std::string>{}), true);
    if (!data) return;
    if (!data->column("distance")) {
      context_.problems.error_in(file->shown, 1, "columns", "lacks the column distance", "give metres along the line");
      return;
    }
    if (!check_columns(context_, *file, *data,
                       {"distance", "length", "ends", "dip", "dip_direction", "strike", "trend", "plunge", "alpha",
                        "beta", "set", "quantity"},
                       "spacings follow from the distances") ||
        !check_halves(context_, *file, *data)) {
      return;
    }
    note_radians(context_, *file, *data);
    const bool core = has_core_angles(*data), oriented = core || has_orientation(*data);
    const bool lengths = data->column("length").has_value();
    if (table.has("reference") && !core) {
      table.error("reference", "belongs to a table with the columns alpha and beta", "remove it, or add them");
    }
    line.truncation = metres(table.number("truncation").value_or(0));
    std::size_t wrong = 0;
    lengths_ = {};
    for (const SurveyTable::Row& row : data->rows) {
      const std::size_t before = context_.problems.errors();
      const auto at = distance_of(*file, *data, row);
      if (at && (*at < 0 || *at > line.length() * (1 + 1e-9))) {
        context_.problems.error_in(file->shown, row.line, "distance",
                                   fmt::format("is {} m, outside the line of {} m", *at, line.length()),
                                   "correct it, or the line's length");
      }
      std::optional<Vec3> normal;
      if (at && core) {
        rules.core = parse_core(context_, table, line.direction_at(*at));
        if (!rules.core) return;
      }
      if (at && oriented) normal = normal_of_row(context_, *file, *data, row, rules);
      const std::size_t times = at ? quantity_of(context_, *file, *data, row) : 0;
      const std::string set = set_of_row(context_, *file, *data, row, "");
      const auto length = lengths && times > 0 ? length_of(*file, *data, row, line.truncation) : std::nullopt;
      for (std::size_t i = 0; i < times; ++i) {
        line.positions.push_back(*at);
        line.sets.push_back(set);
        if (lengths) line.lengths.push_back(length);
        // A joint without an orientation is one that the line meets.
        auto& joint = line.joints.emplace_back();
        if (!normal) continue;
        joint = in_.orientations.size();
        in_.orientations.push_back({*normal, set, line.direction_at(*at), std::nullopt});
      }
      if (too_many(context_, *file, std::max(in_.orientations.size(), line.positions.size()))) return;
      if (context_.problems.errors() != before && ++wrong >= 20) return;
    }
    note_lengths(*file, *data, line.truncation);
    in_.lines.push_back(std::move(line));
  }

  /// Its outline in metres: `scale` a unit of the map.
  std::optional<survey::Window> window_shape(const TableReader& table, double scale) {
    const TomlEntry* given = table.one_of();
    if (given == nullptr) return std::nullopt;
    if (given->key == "area") {
      const auto area = map_of(table, "area");
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
  static void take_traces(const TableReader& table, const io::TraceMap& map, double scale, survey::MapPoint origin,
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

  void window(const TableReader& table) {
    survey::WindowSurvey window;
    window.name = table.text("name").value_or(table.path());
    const double dip = table.number("dip").value_or(0);
    const double direction = table.number("dip_direction").value_or(0);
    window.normal = normal_of(context_, dip, direction);
    window.north = context_.north;
    // Maps of level ground: x east, y north. Inclined ones: x along the strike, y up the slope.
    window.x_axis = dip == 0 ? Vec3{1, 0, 0} : -geometry::strike_vector(context_.turned(direction));
    if (dip != 0 && dot(cross(window.normal, window.x_axis), Vec3{0, 0, 1}) < 0) window.x_axis = -window.x_axis;
    const auto scale = table.number("scale");
    window.border = metres(table.number("border").value_or(0));
    window.truncation = metres(table.number("truncation").value_or(0));
    if (!table.has("traces")) table.missing("traces", "add traces = \"traces.geojson\" (or .csv, .txt)");
    const auto traces = map_of(table, "traces");
    if (!traces) return;
    if (!traces->unit_known && !scale) {
      table.missing("scale", "the traces are in pixels: add scale = metres a pixel");
      return;
    }
    const double s = scale.value_or(1);
    std::optional<survey::Window> shape = window_shape(table, s);
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
    in_.windows.push_back(std::move(window));
  }

  void set(const TableReader& table) {
    survey::SetRule rule;
    const auto name = table.need_text("name");
    if (name) rule.name = *name;
    if (table.has("polygon")) {
      if (const auto corners = three_pairs(table, "polygon")) {
        for (const auto& p : *corners) rule.polygon.push_back(line_of(context_, p[0], p[1]));
      }
    }
    if (const auto azimuth = table.pair("azimuth")) rule.azimuth = std::pair{(*azimuth)[0], (*azimuth)[1]};
    if (const auto dip = table.number("dip")) rule.dip = Dip::degrees(*dip);
    if (const auto direction = table.number("dip_direction")) rule.dip_direction = context_.turned(*direction);
    rule.kappa = table.number("kappa");
    shape(table, rule.shape);
    in_.rules.push_back(std::move(rule));
  }

  static void shape(const TableReader& table, survey::ShapeRule& shape) {
    const auto aspect = table.number("aspect");
    const auto rotation = table.number("rotation");
    shape.shape = table.word<survey::JointShape>("shape");
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
  /// Where on the line the joint of a row is; one without a place would be lost.
  std::optional<double> distance_of(const LoadedFile& file, const SurveyTable& table, const SurveyTable::Row& row) {
    if (row.cells[*table.column("distance")].empty()) {
      context_.problems.error_in(file.shown, row.line, "distance", "is empty",
                                 "give metres along the line, or remove the row");
    }
    return cell_number(context_, file, table, row, "distance");
  }

  /// Length of the trace that a row states, and how many of its ends were seen (column `ends`; none: both).
  std::optional<survey::SeenLength> length_of(const LoadedFile& file, const SurveyTable& table,
                                              const SurveyTable::Row& row, Length truncation) {
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
    if (!length) return {};
    ++lengths_.stated;
    if (*length == 0) ++lengths_.zero;
    if (!(*length > 0)) return {};
    if (*length < truncation.si()) ++lengths_.below;
    return survey::SeenLength{*length, static_cast<std::uint32_t>(ends.value_or(2))};
  }

  /// What counts for less than it seems to, of a line's lengths.
  void note_lengths(const LoadedFile& file, const SurveyTable& table, Length truncation) const {
    const auto note = [&](std::string what, std::string remedy) {
      context_.problems.note_in(file.shown, 1, "length", std::move(what), std::move(remedy));
    };
    if (lengths_.stated > 0 && !table.column("ends")) {
      note(fmt::format(
               "there is no column ends: both ends of all {} traces are taken as seen, and the sizes as those of "
               "whole traces",
               lengths_.stated),
           "add it with the number of ends seen, 0, 1 or 2; where all were seen whole, with 2");
    }
    if (lengths_.zero > 0) {
      note(fmt::format("{} of {} are 0 and count as not measured", lengths_.zero, lengths_.stated),
           "give what is seen, or leave them empty");
    }
    if (lengths_.below > 0) {
      note(
          fmt::format("{} of {} are below the truncation, {} m, and count for nothing in the laws of lengths and sizes",
                      lengths_.below, lengths_.stated, truncation.si()),
          "check truncation: the length below which no trace was recorded");
    }
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
    if (!table.has(key)) table.missing(key, fmt::format("write {} = [x, y]", key));
    const auto values = table.pair(key);
    if (!values) return std::nullopt;
    return survey::MapPoint{(*values)[0], (*values)[1]};
  }

  InputContext& context_;
  survey::SurveyInput& in_;
  std::size_t empty_ = 0;
  /// Rows of the line that is read.
  struct Lengths {
    std::size_t stated = 0, zero = 0, below = 0;
  } lengths_;
};

}  // namespace

const KeyTable& survey_keys() {
  static const KeyTable keys{
      .name = "survey",
      .keys = {{"schema", key::whole(1, 1), "1", "version of this format"},
               {"title", key::text(), "the file's name", "shown in the results"},
               {"seed", key::whole(0, INT64_MAX), "1", "whole number from 0"},
               {"north", key::number(rule::turn), "0",
                "degrees from y to true north, clockwise; directions that are stated and those of all results are from "
                "true north; scenes that take sets.toml need the same"},
               {"confidence", key::number(confidence_rule), "0.95", "of all intervals"},
               {"weight_cap", key::number(cap_rule), "10",
                "largest weight of its own against orientation bias: joints within 5.7 degrees of the line or outcrop "
                "share the mean of theirs"},
               {"clusters", key::whole(0, 20), "0",
                "sets for axial K-means; silhouettes of 2 to 8 sets are reported in any case, the choice is yours"},
               {"orientations", key::tables(&orientations_keys), "[]", "tables of orientations"},
               {"scanline", key::tables(&line_keys), "[]", "joints met by a line"},
               {"borehole", key::tables(&line_keys), "[]", "joints met by a borehole"},
               {"window", key::tables(&window_keys), "[]", "maps of traces"},
               {"set", key::tables(&set_keys), "[]", "joint sets"}}};
  return keys;
}

std::expected<SurveyScene, std::vector<Problem>> parse_survey(string_view text, const std::string& shown,
                                                              const ReadFile& read_file) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, tree.error().remedy);
    return std::unexpected(std::move(problems).take_errors());
  }
  const TableReader root{*tree, 1, "", problems, survey_keys()};
  InputContext context{.problems = problems, .read_file = read_file};
  SurveyScene scene;
  scene.input.title = root.text("title").value_or(shown);
  scene.input.seed = static_cast<std::uint64_t>(root.count("seed"));
  scene.input.confidence = root.value("confidence");
  scene.input.weight_cap = root.value("weight_cap");
  if (const std::int64_t clusters = root.count("clusters"); clusters > 0) {
    scene.input.clusters = static_cast<std::size_t>(clusters);
  }
  context.north = root.value("north");
  scene.input.north = geometry::North::degrees(context.north);

  SurveyParser parser{context, scene};
  for (const TableReader& table : root.each("orientations")) parser.orientations(table);
  for (const TableReader& table : root.each("scanline")) parser.line(table);
  for (const TableReader& table : root.each("borehole")) parser.line(table);
  for (const TableReader& table : root.each("window")) parser.window(table);
  for (const TableReader& table : root.each("set")) parser.set(table);
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
