#include "toml_tree.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace cleave::scene {
namespace {

TomlNode convert(const toml::node& node, std::uint32_t fallback_line);

TomlTable convert_table(const toml::table& table) {
  TomlTable result;
  for (const auto& [key, node] : table) {
    // Tables that only a longer header implies ([a.b] implies a) have no place of their own but the header's.
    const std::uint32_t line = std::max<std::uint32_t>(1, key.source().begin.line);
    result.entries.push_back({std::string{key.str()}, line, key.source().begin.column, convert(node, line)});
  }
  // The library sorts by name; messages read better in the order of the file.
  std::sort(result.entries.begin(), result.entries.end(), [](const TomlEntry& a, const TomlEntry& b) {
    return std::tie(a.line, a.column, a.key) < std::tie(b.line, b.column, b.key);
  });
  return result;
}

TomlArray convert_array(const toml::array& array, std::uint32_t line) {
  TomlArray result;
  result.items.reserve(array.size());
  for (const toml::node& node : array) result.items.push_back(convert(node, line));
  return result;
}

TomlNode convert(const toml::node& node, std::uint32_t fallback_line) {
  const std::uint32_t own = node.source().begin.line;
  const std::uint32_t line = own == 0 ? fallback_line : own;
  switch (node.type()) {
    case toml::node_type::table: return {convert_table(*node.as_table()), line};
    case toml::node_type::array: return {convert_array(*node.as_array(), line), line};
    case toml::node_type::string: return {node.as_string()->get(), line};
    case toml::node_type::integer: return {node.as_integer()->get(), line};
    case toml::node_type::floating_point: return {node.as_floating_point()->get(), line};
    case toml::node_type::boolean: return {node.as_boolean()->get(), line};
    case toml::node_type::date:
    case toml::node_type::time:
    case toml::node_type::date_time:
    case toml::node_type::none: return {TomlDate{}, line};
  }
  std::unreachable();
}

}  // namespace

std::expected<TomlTable, TomlSyntaxError> read_toml(std::string_view text) {
  const toml::parse_result result = toml::parse(text);
  if (!result) {
    const toml::parse_error& error = result.error();
    return std::unexpected(
        TomlSyntaxError{std::max<std::uint32_t>(1, error.source().begin.line), std::string{error.description()}});
  }
  return convert_table(result.table());
}

}  // namespace cleave::scene
