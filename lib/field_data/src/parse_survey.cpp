#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "parse_line.hpp"
#include "parse_orientations.hpp"
#include "parse_window.hpp"
#include "survey_rows.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule kappa_rule{0, true, 1e6, false, ""};
constexpr NumberRule aspect_rule{1, false, 1000, false, ""};
constexpr NumberRule confidence_rule{0.5, false, 0.9999, false, ""};
constexpr NumberRule cap_rule{1, false, 1000, false, ""};

const KeyTable& set_keys() {
  static const KeyTable keys{
      .name = "set",
      .keys = {{"name", key::text(), required, "of the joint set, of no other"},
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

void parse_shape(const TableReader& table, survey::ShapeRule& shape) {
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

void parse_set(InputContext& context, const TableReader& table, survey::SurveyInput& input) {
  survey::SetRule rule;
  const auto name = table.need_text("name");
  if (name) rule.name = *name;
  if (name && std::ranges::find(input.rules, *name, &survey::SetRule::name) != input.rules.end()) {
    table.error("name", fmt::format("\"{}\" is the name of another [[set]]", name->substr(0, 60)),
                "give each set a name of its own; a set has one polygon");
  }
  if (table.has("polygon")) {
    if (const auto corners = three_pairs(table, "polygon")) {
      for (const auto& p : *corners) rule.polygon.push_back(line_of(context, p[0], p[1]));
    }
  }
  if (const auto azimuth = table.pair("azimuth")) rule.azimuth = std::pair{(*azimuth)[0], (*azimuth)[1]};
  if (const auto dip = table.number("dip")) rule.dip = Dip::degrees(*dip);
  if (const auto direction = table.number("dip_direction")) rule.dip_direction = context.turned(*direction);
  rule.kappa = table.number("kappa");
  parse_shape(table, rule.shape);
  input.rules.push_back(std::move(rule));
}

/// K-means and sets that are stated: which of them was meant is not for the program to choose.
void check_clusters(const TableReader& root, const survey::SurveyInput& input) {
  if (!input.clusters) return;
  const auto refuse = [&](std::string what, std::string_view remedy) {
    root.error("clusters", std::move(what), fmt::format("remove `clusters`, or {}", remedy));
  };
  const auto drawn = std::ranges::find_if(input.rules, [](const auto& rule) { return !rule.polygon.empty(); });
  if (drawn != input.rules.end()) {
    refuse(fmt::format("stands beside the polygon of the set \"{}\": both would say which joints belong to it",
                       drawn->name.substr(0, 60)),
           "the polygons");
  }
  const auto stated = [](const std::string& set) { return !set.empty(); };
  bool any = std::ranges::any_of(input.orientations, stated, &survey::MeasuredOrientation::set);
  for (const survey::LineSurvey& line : input.lines) any = any || std::ranges::any_of(line.sets, stated);
  if (any) {
    refuse("stands beside sets that the tables state: both would say which joints belong to which",
           "the column (or key) `set`");
  }
}

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
                "sets for axial K-means, in place of polygons and of a column `set`; silhouettes of 2 to 8 sets are "
                "reported in "
                "any case, the choice is yours"},
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

  survey::SurveyInput& input = scene.input;
  std::size_t empty = 0;
  for (const TableReader& table : root.each("orientations")) parse_orientations(context, table, input, empty);
  for (const TableReader& table : root.each("scanline")) parse_line(context, table, input);
  for (const TableReader& table : root.each("borehole")) parse_line(context, table, input);
  for (const TableReader& table : root.each("window")) parse_window(context, table, input);
  for (const TableReader& table : root.each("set")) parse_set(context, table, input);
  check_clusters(root, input);
  if (input.orientations.empty() && input.windows.empty() && input.lines.empty() && context.problems.errors() == 0) {
    root.problems().error(1, "survey", "holds no data",
                          "add [[orientations]], [[scanline]], [[borehole]] or [[window]]");
  }
  if (empty > 0) {
    root.problems().note(1, "orientations", fmt::format("{} rows hold no orientation and are left out", empty),
                         "fill or remove them");
  }
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  const std::size_t slash = shown.find_last_of('/');
  scene.file_name = slash == std::string::npos ? shown : shown.substr(slash + 1);
  scene.sha256 = sha256_hex(text);
  scene.files = std::move(context.files);
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
