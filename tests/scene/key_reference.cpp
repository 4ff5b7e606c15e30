#include "key_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "cleave/field_data/survey_file.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"
#include "cleave/scene3d/key_tables.hpp"

namespace cleave::scene {
namespace {

using Form = KeyType::Form;
using std::string_view;

/// A kind of file, by its root table.
struct Root {
  string_view title;
  const KeyTable& (*keys)();
};
const std::vector<Root>& roots() {
  static const std::vector<Root> all{{"Blocks in three dimensions", &scene_keys},
                                     {"Elastic bodies", &elastic_scene_keys},
                                     {"Bodies in contact", &contact_scene_keys},
                                     {"Field data", &survey_keys}};
  return all;
}

/// Calls `use` for a table and all tables below it, each once, in the order of their keys.
template <class Use>
void each_table(const KeyTable& table, std::set<const KeyTable*>& seen, const Use& use);

template <class Use>
void each_table(const KeyType& type, std::set<const KeyTable*>& seen, const Use& use) {
  if (type.keys != nullptr) each_table(type.keys(), seen, use);
  for (const KeyType& part : type.of) each_table(part, seen, use);
}

template <class Use>
void each_key(const KeyTable& table, const Use& use) {
  for (const Key& key : table.keys) use(key, string_view{});
  for (const KeyVariant& variant : table.variants) {
    for (const Key& key : variant.keys) use(key, variant.word);
  }
}

template <class Use>
void each_table(const KeyTable& table, std::set<const KeyTable*>& seen, const Use& use) {
  if (!seen.insert(&table).second) return;
  use(table);
  each_key(table, [&](const Key& key, string_view) { each_table(key.type, seen, use); });
}

template <class Use>
void each_table(const Use& use) {
  std::set<const KeyTable*> seen;
  for (const Root& root : roots()) each_table(root.keys(), seen, use);
}

std::string in_quotes(string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string joined(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); }

/// Markdown to plain text.
std::string plain(string_view help) {
  std::string out;
  for (const char c : help) {
    if (c != '`') out += c;
  }
  return out;
}

std::string limits(const NumberRule& rule) {
  return fmt::format("\"{}\": {:g}, \"{}\": {:g}", rule.low_open ? "exclusiveMinimum" : "minimum", rule.low,
                     rule.high_open ? "exclusiveMaximum" : "maximum", rule.high);
}

std::string number_schema(const NumberRule& rule) {
  const std::string number = fmt::format("\"type\": \"number\", {}", limits(rule));
  const auto symbols = unit_symbols(rule);
  if (symbols.empty()) return number;
  return fmt::format(R"("anyOf": [{{{}}}, {{"type": "string", "pattern": "^-?[0-9.eE+-]+ *({})$", "examples": [{}]}}])",
                     number, fmt::join(symbols, "|"), in_quotes(unit_example(rule)));
}

/// The members of the schema of a type, without braces.
std::string type_schema(const KeyType& type) {
  switch (type.form) {
    case Form::number: return number_schema(type.rule);
    case Form::whole: return fmt::format(R"("type": "integer", "minimum": {}, "maximum": {})", type.low, type.high);
    case Form::flag: return R"("type": "boolean")";
    case Form::text: return R"("type": "string")";
    case Form::word: {
      std::vector<std::string> words;
      for (const string_view word : type.words) words.push_back(in_quotes(word));
      return fmt::format("\"enum\": [{}]", joined(words));
    }
    case Form::array:
      return fmt::format(R"("type": "array", "items": {{{}}}{}{})", type_schema(type.of.front()),
                         type.low > 0 ? fmt::format(", \"minItems\": {}", type.low) : "",
                         type.high < key::any_length ? fmt::format(", \"maxItems\": {}", type.high) : "");
    case Form::table: return fmt::format("\"$ref\": \"#/$defs/{}\"", type.keys().name);
    case Form::named:
      return fmt::format(R"("type": "object", "additionalProperties": {{{}}})", type_schema(type.of.front()));
    case Form::either: break;
  }
  std::vector<std::string> parts;
  for (const KeyType& part : type.of) parts.push_back(fmt::format("{{{}}}", type_schema(part)));
  return fmt::format("\"anyOf\": [{}]", joined(parts));
}

/// A default that JSON can hold as it is written.
bool is_value(string_view standard) {
  if (standard.empty()) return false;
  const bool digit = standard.front() >= '0' && standard.front() <= '9';
  if (digit) return standard.find_first_not_of("0123456789.e-") == string_view::npos;
  return standard == "true" || standard == "false" || standard.front() == '"' || standard.front() == '[';
}

std::string key_schema(const Key& key) {
  const bool value = is_value(key.standard);
  std::string text = plain(key.help);
  if (!value && !key.standard.empty() && key.standard != required) text += "; default: " + plain(key.standard);
  std::string out = fmt::format("   {}: {{\"description\": {}, {}{}}}", in_quotes(key.name), in_quotes(text),
                                type_schema(key.type), value ? fmt::format(", \"default\": {}", key.standard) : "");
  if (!key.was.empty()) {
    out += fmt::format(",\n   {}: {{\"description\": {}, {}, \"deprecated\": true}}", in_quotes(key.was),
                       in_quotes(fmt::format("old name of {}: {}", key.name, text)), type_schema(key.type));
  }
  return out;
}

/// Keys that an object with these has to have: those without another name.
std::string conditions(const KeyTable& table, const std::vector<Key>& keys) {
  std::vector<std::string> needed;
  for (const Key& key : keys) {
    if (key.standard == required && key.was.empty()) needed.push_back(in_quotes(key.name));
  }
  std::string out = needed.empty() ? "" : fmt::format(",\n  \"required\": [{}]", joined(needed));
  for (const auto& group : table.one_of) {
    std::vector<std::string> choices;
    for (const string_view name : group) choices.push_back(fmt::format(R"({{"required": [{}]}})", in_quotes(name)));
    out += fmt::format(",\n  \"oneOf\": [{}]", joined(choices));
  }
  return out;
}

std::string object_schema(const KeyTable& table, const KeyVariant* variant) {
  std::vector<Key> keys = table.keys;
  if (variant != nullptr) keys.insert(keys.end(), variant->keys.begin(), variant->keys.end());
  std::vector<std::string> properties;
  for (const Key& key : keys) {
    if (variant != nullptr && key.name == table.select) {
      properties.push_back(fmt::format(R"(   {}: {{"description": {}, "const": {}}})", in_quotes(key.name),
                                       in_quotes(plain(key.help)), in_quotes(variant->word)));
    } else {
      properties.push_back(key_schema(key));
    }
  }
  return fmt::format("  \"type\": \"object\", \"additionalProperties\": false,\n  \"properties\": {{\n{}\n  }}{}",
                     fmt::join(properties, ",\n"), conditions(table, keys));
}

std::string table_schema(const KeyTable& table) {
  if (table.variants.empty())
    return fmt::format(" {}: {{\n{}\n }}", in_quotes(table.name), object_schema(table, nullptr));
  std::vector<std::string> choices;
  for (const KeyVariant& variant : table.variants)
    choices.push_back(fmt::format("{{\n{}}}", object_schema(table, &variant)));
  return fmt::format(" {}: {{\"oneOf\": [{}]}}", in_quotes(table.name), joined(choices));
}

/// Rows of the keys of a table; keys of several variants stand once, with the words of these.
std::string rows_of(const KeyTable& table) {
  struct Row {
    const Key* key;
    std::vector<string_view> words;
  };
  std::vector<Row> rows;
  each_key(table, [&](const Key& key, string_view word) {
    const auto same = std::ranges::find_if(
        rows, [&](const Row& row) { return row.key->name == key.name && row.key->help == key.help && !word.empty(); });
    if (same == rows.end()) {
      rows.push_back({&key, {}});
      if (!word.empty()) rows.back().words.push_back(word);
    } else {
      same->words.push_back(word);
    }
  });
  std::string out = "\n| key | default | meaning |\n|---|---|---|\n";
  for (const Row& row : rows) {
    const string_view standard = row.key->standard;
    std::string shown{standard == required ? string_view{"required"} : standard};
    if (is_value(standard)) shown = fmt::format("`{}`", shown);
    std::string help{row.key->help};
    for (std::size_t at = 0; (at = help.find('|', at)) != std::string::npos; at += 2) help.insert(at, 1, '\\');
    if (!row.key->was.empty()) help += fmt::format(" (was `{}`)", row.key->was);
    if (!row.words.empty()) help += fmt::format(" (`{}`)", fmt::join(row.words, "`, `"));
    out += fmt::format("| `{}` | {} | {} |\n", row.key->name, shown, help);
  }
  return out + '\n';
}

/// Lines of `text`, where `made` takes the place of those from a line that begins with `begin` to the line `end`.
template <class Made>
std::string replaced(string_view text, string_view begin, string_view end, const Made& made) {
  std::string out;
  bool within = false;
  while (!text.empty()) {
    const std::size_t stop = std::min(text.find('\n'), text.size() - 1);
    const string_view line = text.substr(0, stop + 1);
    text.remove_prefix(stop + 1);
    if (line.starts_with(end)) within = false;
    if (!within) out += line;
    if (!line.starts_with(begin) || line.starts_with(end)) continue;
    within = true;
    out += made(line.substr(begin.size()));
  }
  return out;
}

}  // namespace

std::string schema_text() {
  std::vector<std::string> kinds, tables;
  for (const Root& root : roots()) {
    kinds.push_back(fmt::format(R"(  {{"title": {}, "$ref": "#/$defs/{}"}})", in_quotes(root.title), root.keys().name));
  }
  std::set<std::string> names;
  each_table([&](const KeyTable& table) {
    if (!names.insert(table.name).second) tables.push_back(fmt::format("two tables are called {}", table.name));
    tables.push_back(table_schema(table));
  });
  return fmt::format(R"({{
 "$schema": "https://json-schema.org/draft/2020-12/schema",
 "title": "cleave scene",
 "description": "Scene and survey files of cleave (TOML). SI units, angles in degrees, x = east, y = north, z = up.",
 "anyOf": [
{}
 ],
 "$defs": {{
{}
 }}
}}
)",
                     fmt::join(kinds, ",\n"), fmt::join(tables, ",\n"));
}

std::string with_key_tables(string_view page) {
  std::map<std::string, const KeyTable*, std::less<>> by_name;
  each_table([&](const KeyTable& table) { by_name.emplace(table.name, &table); });
  return replaced(page, "<!-- keys ", "<!-- end of keys", [&](string_view rest) {
    const auto at = by_name.find(rest.substr(0, rest.find(" -->")));
    return at == by_name.end() ? fmt::format("there is no table {}", rest) : rows_of(*at->second);
  });
}

std::string with_units(string_view dictionary) {
  std::set<std::string> words;
  const auto add = [&](const auto& self, const KeyType& type) -> void {
    for (const string_view symbol : type.form == Form::number ? unit_symbols(type.rule) : std::vector<string_view>{}) {
      if (std::ranges::all_of(symbol, [](char c) { return c > ' ' && c < 127; })) words.insert(in_quotes(symbol));
    }
    for (const KeyType& part : type.of) self(self, part);
  };
  each_table([&](const KeyTable& table) { each_key(table, [&](const Key& key, string_view) { add(add, key.type); }); });
  for (const Root& root : roots()) {
    for (const Key& key : root.keys().keys) {
      if (key.type.form == Form::table) words.insert(fmt::format("\"[{}]\\x0a\"", key.name));
      if (key.type.form == Form::array) words.insert(fmt::format("\"[[{}]]\\x0a\"", key.name));
    }
  }
  return replaced(dictionary, "# units and tables", "# end of units",
                  [&](string_view) { return fmt::format("{}\n", fmt::join(words, "\n")); });
}

}  // namespace cleave::scene
