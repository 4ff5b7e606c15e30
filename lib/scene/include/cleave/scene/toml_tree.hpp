#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace cleave::scene {

struct TomlNode;
struct TomlEntry;

struct TomlArray {
  std::vector<TomlNode> items;
};
/// Entries in the order of the file.
struct TomlTable {
  std::vector<TomlEntry> entries;
};
/// A date or time: valid TOML that no key of a scene takes.
struct TomlDate {};

/// A value of a TOML file with the line it stands on. No invariants: what `read_toml` saw.
struct TomlNode {
  std::variant<bool, std::int64_t, double, std::string, TomlDate, TomlArray, TomlTable> value;
  std::uint32_t line = 1;
};
struct TomlEntry {
  std::string key;
  std::uint32_t line = 1;    ///< of the key
  std::uint32_t column = 1;  ///< of the key
  TomlNode node;
};

struct TomlSyntaxError {
  std::uint32_t line;
  std::string what;
  std::string remedy = "fix the syntax: see https://toml.io";
};

/// Text to tree; the only place that knows the TOML library, which stops at the first syntax error.
[[nodiscard]] std::expected<TomlTable, TomlSyntaxError> read_toml(std::string_view text);

}  // namespace cleave::scene
