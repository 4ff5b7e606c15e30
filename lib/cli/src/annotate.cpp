#include "annotate.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave::cli {
namespace {

using scene::Key, scene::KeyTable, scene::KeyType;

/// Longer comments end at the end of a sentence, else at a semicolon, else at a comma.
constexpr std::size_t longest = 84, first_column = 31;

/// The table that a type holds, alone or in a list; null: none. Names of the user's are stepped over by `named`.
const KeyTable* table_in(const KeyType& type, bool& named) {
  if (type.keys != nullptr) return &type.keys();
  if (type.form == KeyType::Form::named) named = true;
  for (const KeyType& of : type.of) {
    if (const KeyTable* const keys = table_in(of, named)) return keys;
  }
  return nullptr;
}

/// A key of the table or of any of its variants.
const Key* find_key(const KeyTable& table, std::string_view name) {
  if (const Key* const key = table.find(name, std::nullopt)) return key;
  for (std::size_t v = 0; v < table.variants.size(); ++v) {
    if (const Key* const key = table.find(name, v)) return key;
  }
  return nullptr;
}

/// The table of "[[support.bolts]]" or "[joints.A]".
const KeyTable* table_of(const KeyTable& root, std::string_view path) {
  const KeyTable* table = &root;
  bool named = false;
  while (!path.empty() && table != nullptr) {
    const std::string_view part = path.substr(0, path.find('.'));
    path.remove_prefix(std::min(part.size() + 1, path.size()));
    if (std::exchange(named, false)) continue;
    const Key* const key = find_key(*table, part);
    table = key != nullptr ? table_in(key->type, named) : nullptr;
  }
  return table;
}

/// All that is opened is closed.
bool closed(std::string_view text) {
  return std::ranges::count(text, '(') == std::ranges::count(text, ')') &&
         std::ranges::count(text, '{') == std::ranges::count(text, '}') && std::ranges::count(text, '"') % 2 == 0;
}

/// What a key says of itself, as plain text; of an inline table with one key what that one says.
std::string words_of(const Key& key, std::string_view value) {
  bool named = false;
  const KeyTable* const inner = table_in(key.type, named);
  if (inner != nullptr && !named && value.starts_with('{') && std::ranges::count(value, '=') == 1) {
    const Key* const only = find_key(*inner, trimmed(value.substr(1, value.find('=') - 1)));
    if (only != nullptr) return words_of(*only, trimmed(value.substr(value.find('=') + 1)));
  }
  std::string text{key.help};
  std::erase(text, '`');
  if (text.starts_with('{') || text.starts_with('[')) return {};  // the form, which the value shows
  if (text.ends_with(", below")) text.resize(text.size() - 7);
  while (text.size() > longest || !closed(text)) {
    const std::size_t most = std::min(longest, text.size() - 1);
    std::size_t end = text.rfind(". ", most);
    if (end == std::string::npos) end = text.rfind(';', most);
    if (end == std::string::npos) end = text.find_last_of(",:", most);
    if (end == std::string::npos || end == 0) return {};
    text.resize(end);
  }
  return std::string{trimmed(text)};
}

}  // namespace

std::string annotated(std::string_view scene, const KeyTable& keys) {
  std::string out;
  std::set<std::pair<const KeyTable*, std::string_view>> told;
  const KeyTable* table = &keys;
  while (!scene.empty()) {
    const std::string_view line = scene.substr(0, scene.find('\n'));
    scene.remove_prefix(std::min(line.size() + 1, scene.size()));
    out += line;
    const std::size_t equals = line.find(" = ");
    if (line.starts_with('[')) {
      const std::size_t from = line.find_first_not_of('[');
      table = table_of(keys, line.substr(from, line.find(']') - from));
    } else if (table != nullptr && equals != std::string_view::npos && !line.contains('#') && !line.starts_with(' ')) {
      const std::string_view name = line.substr(0, equals), value = trimmed(line.substr(equals + 3));
      const Key* const key = find_key(*table, name);
      const bool whole = std::ranges::count(value, '[') == std::ranges::count(value, ']') &&
                         std::ranges::count(value, '{') == std::ranges::count(value, '}');
      if (key != nullptr && whole && told.emplace(table, name).second) {
        if (const std::string words = words_of(*key, value); !words.empty()) {
          out.append(std::max(first_column, line.size() + 3) - line.size(), ' ').append("# ").append(words);
        }
      }
    }
    out += '\n';
  }
  return out;
}

}  // namespace cleave::cli
