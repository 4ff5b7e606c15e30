#include "body_keys.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace cleave::scene {

using bem::Vec2;
using std::string_view;

std::optional<Vec2> pair_of(const TableReader& table, const TomlNode& node, const std::string& path,
                            const NumberRule& rule) {
  const auto* array = std::get_if<TomlArray>(&node.value);
  if (array == nullptr || array->items.size() != 2) {
    table.problems().error(node.line, path, "must be two numbers", "write [x, y]");
    return std::nullopt;
  }
  const auto x = table.number_of(array->items[0], path, rule);
  const auto y = table.number_of(array->items[1], path, rule);
  if (!x || !y) return std::nullopt;
  return Vec2{*x, *y};
}

std::optional<Vec2> pair(const TableReader& table, string_view key) {
  const auto values = table.pair(key);
  if (!values) return std::nullopt;
  return Vec2{(*values)[0], (*values)[1]};
}

std::optional<std::vector<Vec2>> corners_of(const TableReader& table, const TomlNode& node, const std::string& path) {
  const auto* array = std::get_if<TomlArray>(&node.value);
  if (array == nullptr || array->items.size() < 2) {
    table.problems().error(node.line, path, "must be a list of corners", "write [[x, y], [x, y], [x, y], ...]");
    return std::nullopt;
  }
  std::vector<Vec2> corners;
  for (std::size_t i = 0; i < array->items.size(); ++i) {
    const auto p = pair_of(table, array->items[i], fmt::format("{}[{}]", path, i + 1), rule::coordinate);
    if (!p) return std::nullopt;
    corners.push_back(*p);
  }
  // Drawn closed: the first corner stands at the end, too.
  if (corners.size() > 3 && corners.back() == corners.front()) corners.pop_back();
  return corners;
}

namespace {

const KeyTable& body_rock_keys() {
  static const KeyTable keys{
      .name = "rock of bodies",
      .keys = {{"density", key::number(body_density_rule), "2700", "kg/m3, of bodies that state none"},
               {"young", key::number(young_rule), "", "Pa, of bodies that state none"},
               {"poisson", key::number(poisson_rule), "", "Poisson's ratio of bodies that state none"}}};
  return keys;
}

}  // namespace

std::vector<Key> side_keys() {
  return {{"side", key::whole(1, 1'000'000), "", "a side, counted from 1 in the order of the corners"},
          {"sides", key::either({key::array(key::whole(1, 1'000'000)), key::word(all_sides)}), "",
           "several sides, or `\"all\"`"}};
}

std::vector<Key> body_load_keys() {
  std::vector<Key> keys = side_keys();
  const std::vector<Key> more{
      {"at", key::pair(rule::coordinate), "", "`[x, y]` in m: where `force` acts"},
      {"pressure", key::number(pressure_rule), "", "Pa, against the body"},
      {"traction", key::pair(pressure_rule), "", "`[x, y]`, Pa"},
      {"force", key::pair(force_per_metre_rule), "", "`[x, y]`, N/m, at a point"},
      {"time", key::table(&time_function_keys), "", "how it changes with time, in moving scenes"}};
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

std::vector<Key> history_keys() {
  return {{"name", key::text(), "`point N`", "in the results"},
          {"at", key::pair(rule::coordinate), required, "`[x, y]` in m"},
          {"body", key::text(), "the one that holds it", "name of the body it moves with"}};
}

std::vector<Key> head_keys() {
  return {{"schema", key::whole(1, 1), "1", "version of this format"},
          {"title", key::text(), "the file's name", "shown in the results"},
          {"project", key::table(&project_keys), "", "heads the report and `summary.json`; in no other file"},
          {"seed", key::whole(0, INT64_MAX), "1", "whole number from 0"},
          {"rock", key::table(&body_rock_keys), "", "material of bodies that state none"},
          {"output", key::table(&output_keys), "", "files of the result"}};
}

std::vector<Key> material_keys() {
  return {{"young", key::number(young_rule), "that of `[rock]`", "Pa"},
          {"poisson", key::number(poisson_rule), "that of `[rock]`", "below 0.5"},
          {"density", key::number(body_density_rule), "that of `[rock]`", "kg/m3"}};
}

const KeyTable& in_situ_keys() {
  static constexpr NumberRule gradient_rule{-1e18, false, 1e18, false, " Pa/m"};
  static const KeyTable keys{.name = "body.in_situ",
                             .keys = {{"stress", key::vector(pressure_rule), required,
                                       "`[sxx, syy, sxy]` at `level`, Pa, compression negative"},
                                      {"level", key::number(rule::coordinate), "0", "m, y"},
                                      {"gradient", key::vector(gradient_rule), "0", "change per metre upwards"}}};
  return keys;
}

bem::InSitu parse_in_situ(const TableReader& table) {
  const auto stress_of = [&](string_view key) {
    const auto v = table.vec3(key);
    return v ? bem::Sym2{v->x, v->z, v->y} : bem::Sym2{};  // written xx, yy, xy
  };
  if (!table.has("stress")) table.missing("stress", "write stress = [sxx, syy, sxy] in Pa, compression negative");
  return {.stress = stress_of("stress"), .level = table.value("level"), .gradient = stress_of("gradient")};
}

RockDefaults parse_rock_defaults(const TableReader& root, const NumberRule& density) {
  RockDefaults out;
  const auto found = root.sub("rock");
  if (!found) return out;
  const TableReader& table = *found;
  out.density = table.value("density");
  table.note_unusual("density", density);
  out.young = table.number("young");
  out.poisson = table.number("poisson");
  out.young_given = table.has("young");
  out.poisson_given = table.has("poisson");
  return out;
}

}  // namespace cleave::scene
