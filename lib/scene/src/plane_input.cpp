#include "plane_input.hpp"

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

std::optional<Vec2> pair(const TableReader& table, string_view key, const NumberRule& rule) {
  const TomlEntry* entry = table.find(key);
  if (entry == nullptr) return std::nullopt;
  return pair_of(table, entry->node, table.path_of(key), rule);
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
  return corners;
}

TableReader reader(const TomlNode& node, std::string path, Problems& problems, std::span<const string_view> keys) {
  return TableReader{*std::get_if<TomlTable>(&node.value), node.line, std::move(path), problems, keys};
}

TimeFunction parse_time_function(const TableReader& load, bool& follows) {
  TimeFunction out;
  const TomlTable* found = load.table("time");
  if (found == nullptr) return out;
  constexpr std::array<string_view, 4> keys{"kind", "duration", "frequency", "follows"};
  constexpr std::array<string_view, 4> kinds{"step", "ramp", "pulse", "harmonic"};
  const TableReader table{*found, load.line_of("time"), load.path_of("time"), load.problems(), keys};
  const auto kind = table.choice("kind", kinds);
  if (!table.has("kind")) table.missing("kind", "write one of: step ramp pulse harmonic");
  out.kind = static_cast<TimeFunction::Kind>(kind.value_or(0));
  const bool lasts = out.kind == TimeFunction::Kind::ramp || out.kind == TimeFunction::Kind::pulse;
  if (lasts) {
    out.duration = table.need_number("duration", time_rule).value_or(1);
  }
  if (out.kind == TimeFunction::Kind::harmonic) {
    out.frequency = table.need_number("frequency", {0, true, 1e9, false, " Hz"}).value_or(1);
  }
  for (const auto& [key, used] : {std::pair{string_view{"duration"}, lasts},
                                  std::pair{string_view{"frequency"}, out.kind == TimeFunction::Kind::harmonic}}) {
    if (kind && !used && table.has(key)) {
      table.error(key, fmt::format("has no meaning for kind = \"{}\"", kinds[*kind]),
                  "duration belongs to ramp and pulse, frequency to harmonic: remove it");
    }
  }
  follows = table.boolean("follows").value_or(false);
  return out;
}

RockDefaults parse_rock_defaults(const TableReader& root) {
  RockDefaults out;
  const TomlTable* found = root.table("rock");
  if (found == nullptr) return out;
  constexpr std::array<string_view, 3> keys{"density", "young", "poisson"};
  const TableReader table{*found, root.line_of("rock"), "rock", root.problems(), keys};
  out.density = table.number("density", body_density_rule).value_or(out.density);
  out.young = table.number("young", young_rule);
  out.poisson = table.number("poisson", poisson_rule);
  out.young_given = table.has("young");
  out.poisson_given = table.has("poisson");
  return out;
}

std::string file_name_of(const std::string& shown) {
  const std::size_t slash = shown.find_last_of('/');
  return slash == std::string::npos ? shown : shown.substr(slash + 1);
}

}  // namespace cleave::scene
