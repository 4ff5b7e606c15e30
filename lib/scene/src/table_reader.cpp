#include "cleave/scene/table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/nearest.hpp"
#include "key_homes.hpp"
#include "unit_text.hpp"

namespace cleave::scene {
namespace {

/// Long values are cut: a message is for reading.
std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  if (text.size() <= longest) return fmt::format("\"{}\"", text);
  return fmt::format("\"{}...\"", text.substr(0, longest));
}

std::string list_of(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string{word};
  return text;
}

/// As a text with a unit.
std::optional<UnitText> unit_text_of(const TomlNode& node, const NumberRule& rule) {
  const auto* text = std::get_if<std::string>(&node.value);
  return text != nullptr ? unit_text(*text, rule) : std::nullopt;
}

/// With or without a unit; 0 where it is no number.
double plain_value_of(const TomlNode& node, const NumberRule& rule) {
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  const auto stated = unit_text_of(node, rule);
  return stated ? to_unit(stated->number, *stated->unit) : 0;
}

/// How numbers of an array are written: "a, b".
std::string form_of(const KeyType& array) {
  if (array.low == array.high && array.low <= 3) return array.low == 2 ? "a, b" : "x, y, z";
  return "a, b, c, ...";
}

}  // namespace

TableReader::TableReader(const TomlTable& table, std::uint32_t line, std::string path, Problems& problems,
                         const KeyTable& keys)
    : table_{&table}, line_{line}, path_{std::move(path)}, problems_{&problems}, keys_{&keys} {
  if (!keys.select.empty()) {
    const Key& select = declared(keys.select);
    if (has(select.name)) {
      variant_ = choice(select.name);
      if (!variant_) return;  // what else is known depends on it
    } else if (select.standard == required) {
      missing(select.name, fmt::format("add {} = \"...\"", select.name));
      return;
    } else {
      variant_ = word_number(select.name);
    }
  }
  report_unknown();
}

void TableReader::report_unknown() const {
  const std::vector<std::string_view> known = keys_->names(variant_);
  for (const TomlEntry& entry : table_->entries) {
    if (std::ranges::find(known, entry.key) != known.end()) continue;
    const auto renamed = std::ranges::find_if(
        known, [&](std::string_view name) { return declared(name).was == entry.key && !entry.key.empty(); });
    if (renamed != known.end()) {
      if (std::ranges::find(table_->entries, *renamed, &TomlEntry::key) != table_->entries.end()) {
        problems_->error(entry.line, path_of(entry.key), fmt::format("stands beside \"{}\", its new name", *renamed),
                         "give one of them");
      } else {
        problems_->note(entry.line, path_of(entry.key), fmt::format("is now called \"{}\"", *renamed),
                        "write the new name: the old one goes with the next version");
      }
      continue;
    }
    if (entry.key == "strike" && std::ranges::find(known, "dip_direction") != known.end()) {
      problems_->error(entry.line, path_of(entry.key), "unknown key",
                       "give dip_direction = strike + 90 (right-hand rule: the plane dips to the right of its strike)");
      continue;
    }
    if (entry.key == "radius" && std::ranges::find(known, "size") != known.end()) {
      problems_->error(entry.line, path_of(entry.key), "unknown key",
                       "give size = 2 radius: the size of a disc is its diameter");
      continue;
    }
    const auto guess = nearest(entry.key, known);
    const auto home = home_of(entry.key);
    problems_->error(entry.line, path_of(entry.key), "unknown key",
                     guess  ? fmt::format("did you mean \"{}\"?", *guess)
                     : home ? fmt::format("it belongs to {}; known here: {}", *home, list_of(known))
                            : fmt::format("known here: {}", list_of(known)));
  }
}

const Key& TableReader::declared(std::string_view key) const {
  const Key* found = keys_->find(key, variant_);
  CLEAVE_ASSERT(found != nullptr);
  return *found;
}

const KeyType& TableReader::type_of(std::string_view key, KeyType::Form form) const {
  const KeyType* type = declared(key).type.as(form);
  CLEAVE_ASSERT(type != nullptr);
  return *type;
}

std::string TableReader::path_of(std::string_view key) const {
  const TomlEntry* entry = find(key);
  const std::string_view written = entry == nullptr ? key : std::string_view{entry->key};  // its old name, perhaps
  const std::string_view shown = written.empty() ? std::string_view{"\"\""} : written;     // TOML allows it
  return path_.empty() ? std::string{shown} : fmt::format("{}.{}", path_, shown);
}
std::uint32_t TableReader::line_of(std::string_view key) const {
  const TomlEntry* entry = find(key);
  return entry == nullptr ? line_ : entry->line;
}
const TomlEntry* TableReader::find(std::string_view key) const {
  auto it = std::ranges::find(table_->entries, key, &TomlEntry::key);
  if (it == table_->entries.end()) {
    const Key* declared = keys_->find(key, variant_);
    if (declared == nullptr || declared->was.empty()) return nullptr;
    it = std::ranges::find(table_->entries, declared->was, &TomlEntry::key);
  }
  return it == table_->entries.end() ? nullptr : &*it;
}
void TableReader::error(std::string_view key, std::string what, std::string remedy) const {
  problems_->error(line_of(key), path_of(key), std::move(what), std::move(remedy));
}
void TableReader::note(std::string_view key, std::string what, std::string remedy) const {
  problems_->note(line_of(key), path_of(key), std::move(what), std::move(remedy));
}
void TableReader::missing(std::string_view key, std::string remedy) const {
  problems_->error(line_, path_of(key), "is missing", std::move(remedy));
}

const TomlEntry* TableReader::one_of(std::span<const std::string_view> keys) const {
  const TomlEntry* found = nullptr;
  for (const std::string_view key : keys) {
    const TomlEntry* entry = find(key);
    if (entry == nullptr) continue;
    if (found != nullptr) {
      error(key, fmt::format("stands beside \"{}\"", found->key),
            fmt::format("give exactly one of: {}", list_of(keys)));
      return nullptr;
    }
    found = entry;
  }
  if (found == nullptr) {
    problems_->error(line_, path_, fmt::format("holds none of: {}", list_of(keys)), "give exactly one of them");
  }
  return found;
}

void TableReader::note_unusual(std::string_view key, const NumberRule& rule) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  note_unusual(array != nullptr ? std::span<const TomlNode>{array->items} : std::span{&entry->node, 1}, path_of(key),
               rule);
}

void TableReader::note_unusual(std::span<const TomlNode> nodes, const std::string& path, const NumberRule& rule) const {
  if (!rule.usual) return;
  double largest = 0;
  const TomlNode* at = nullptr;
  for (const TomlNode& node : nodes) {
    const double value = plain_value_of(node, rule);
    if (std::isnan(value) || std::abs(value) <= std::abs(largest)) continue;
    largest = value;
    at = &node;
  }
  if (rule.is_usual(largest)) return;
  const auto text = unit_text_of(*at, rule);
  const double number = text ? text->number : largest;
  const auto unit = text ? likely_unit(number, text->unit->factor, rule) : likely_unit(number, rule);
  const std::string stated = text && number != largest
                                 ? fmt::format("{} {} ({:.4g}{})", number, text->unit->symbol, largest, rule.unit)
                                 : fmt::format("{}{}", largest, rule.unit);
  problems_->note(
      at->line, path,
      fmt::format("is {}, which is far from usual ({:g} to {:g})", stated, rule.usual->low, rule.usual->high),
      unit ? fmt::format("if it is meant in {0}, write \"{1} {0}\"", *unit, number)
           : std::string{rule.usual->otherwise.empty() ? "it is taken as it stands: check it" : rule.usual->otherwise});
}

std::optional<double> TableReader::number_of(const TomlNode& node, const std::string& path,
                                             const NumberRule& rule) const {
  const auto value = plain_number_of(node, path, rule);
  if (value) note_unusual({&node, 1}, path, rule);
  return value;
}

std::optional<double> TableReader::plain_number_of(const TomlNode& node, const std::string& path,
                                                   const NumberRule& rule) const {
  double value = 0;
  const std::string example = unit_example(rule);
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) {
    value = static_cast<double>(*whole);
  } else if (const auto* real = std::get_if<double>(&node.value)) {
    value = *real;
  } else if (const auto* text = std::get_if<std::string>(&node.value); text != nullptr && !example.empty()) {
    const auto stated = with_unit(*text, rule);
    if (!stated) {
      problems_->error(node.line, path,
                       fmt::format("is {}, which is no number with a unit of{}", in_quotes(*text), rule.unit),
                       fmt::format("write a bare number {}, or a text with a unit such as \"{}\" (units: {})",
                                   rule.words(), example, list_of(unit_symbols(rule))));
      return std::nullopt;
    }
    value = *stated;
  } else {
    problems_->error(node.line, path, fmt::format("is {} but must be a number", kind_of(node)),
                     text != nullptr ? fmt::format("write a bare number {}, without quotes and unit", rule.words())
                                     : fmt::format("give a number {}", rule.words()));
    return std::nullopt;
  }
  if (!std::isfinite(value)) {
    problems_->error(node.line, path, fmt::format("is {}, which is not a number to work with", value),
                     fmt::format("give a number {}", rule.words()));
    return std::nullopt;
  }
  if (!rule.accepts(value)) {
    problems_->error(node.line, path, fmt::format("is {}", value), fmt::format("give a number {}", rule.words()));
    return std::nullopt;
  }
  return value;
}

std::optional<geometry::Vec3> TableReader::vec3_of(const TomlNode& node, const std::string& path,
                                                   const NumberRule& rule) const {
  const auto* array = std::get_if<TomlArray>(&node.value);
  if (array == nullptr) {
    problems_->error(node.line, path, fmt::format("is {} but must be three numbers", kind_of(node)), "write [x, y, z]");
    return std::nullopt;
  }
  if (array->items.size() != 3) {
    problems_->error(node.line, path, fmt::format("has {} entries but must have three", array->items.size()),
                     "write [x, y, z]");
    return std::nullopt;
  }
  const auto x = plain_number_of(array->items[0], path, rule);
  const auto y = plain_number_of(array->items[1], path, rule);
  const auto z = plain_number_of(array->items[2], path, rule);
  if (!x || !y || !z) return std::nullopt;
  note_unusual(array->items, path, rule);
  return geometry::Vec3{*x, *y, *z};
}

const NumberRule& TableReader::rule_of(std::string_view key) const { return type_of(key, KeyType::Form::number).rule; }

std::optional<std::vector<double>> TableReader::numbers(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const KeyType& type = type_of(key, KeyType::Form::array);
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  const auto length = array == nullptr ? -1 : static_cast<std::int64_t>(array->items.size());
  if (length < type.low || length > type.high) {
    const std::string how_many = type.low == type.high ? fmt::format("{} numbers", type.low)
                                 : type.high == key::any_length
                                     ? fmt::format("a list of {} or more numbers", type.low)
                                     : fmt::format("a list of at most {} numbers", type.high);
    error(key, fmt::format("must be {}", how_many), fmt::format("write {} = [{}]", key, form_of(type)));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < array->items.size(); ++i) {
    const auto value =
        plain_number_of(array->items[i], fmt::format("{}[{}]", path_of(key), i + 1), type.of.front().rule);
    if (value) values.push_back(*value);
  }
  if (values.size() != array->items.size()) return std::nullopt;
  note_unusual(array->items, path_of(key), type.of.front().rule);
  return values;
}

std::optional<std::array<double, 2>> TableReader::pair(std::string_view key) const {
  const auto values = numbers(key);
  if (!values) return std::nullopt;
  return std::array{values->at(0), values->at(1)};
}

std::optional<std::vector<std::array<double, 2>>> TableReader::pairs(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const NumberRule& rule = type_of(key, KeyType::Form::array).of.front().of.front().rule;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  std::vector<std::array<double, 2>> result;
  for (std::size_t i = 0; array != nullptr && i < array->items.size(); ++i) {
    const auto* items = std::get_if<TomlArray>(&array->items[i].value);
    if (items == nullptr || items->items.size() != 2) {
      array = nullptr;
      break;
    }
    const std::string path = fmt::format("{}[{}]", path_of(key), i + 1);
    const auto a = number_of(items->items[0], path, rule), b = number_of(items->items[1], path, rule);
    if (!a || !b) return std::nullopt;
    result.push_back({*a, *b});
  }
  if (array != nullptr) return result;
  error(key, "is not a list of pairs", fmt::format("write {} = [[a, b], [a, b], ...]", key));
  return std::nullopt;
}

std::optional<TableReader> TableReader::sub(std::string_view key) const {
  const TomlTable* found = table(key);
  if (found == nullptr) return std::nullopt;
  return TableReader{*found, line_of(key), path_of(key), *problems_, type_of(key, KeyType::Form::table).keys()};
}

std::vector<TableReader> TableReader::each(std::string_view key) const {
  std::vector<TableReader> readers;
  const std::vector<const TomlNode*> found = tables(key);
  const KeyTable& keys = type_of(key, KeyType::Form::array).of.front().keys();
  for (std::size_t i = 0; i < found.size(); ++i) {
    readers.push_back(TableReader{std::get<TomlTable>(found[i]->value), found[i]->line,
                                  fmt::format("{}[{}]", path_of(key), i + 1), *problems_, keys});
  }
  return readers;
}

const TomlEntry* TableReader::one_of(std::size_t n) const { return one_of(keys_->one_of.at(n)); }

double TableReader::value(std::string_view key) const {
  if (const auto given = number(key)) return *given;
  return std::strtod(std::string{declared(key).standard}.c_str(), nullptr);
}
std::int64_t TableReader::count(std::string_view key) const {
  if (const auto given = integer(key)) return *given;
  return std::strtoll(std::string{declared(key).standard}.c_str(), nullptr, 10);
}
bool TableReader::flag(std::string_view key) const { return boolean(key).value_or(declared(key).standard == "true"); }
std::size_t TableReader::word_number(std::string_view key) const {
  if (const auto given = choice(key)) return *given;
  const std::string_view standard = declared(key).standard;
  const auto words = type_of(key, KeyType::Form::word).words;
  const auto at =
      std::ranges::find_if(words, [&](std::string_view word) { return standard == fmt::format("\"{}\"", word); });
  return at == words.end() ? 0 : static_cast<std::size_t>(at - words.begin());
}
std::size_t TableReader::word_of(std::string_view key, std::span<const std::string_view> names) const {
  CLEAVE_ASSERT(type_of(key, KeyType::Form::word).words.data() == names.data());  // the enumeration it is declared with
  return word_number(key);
}

std::optional<double> TableReader::number(std::string_view key) const {
  const NumberRule& rule = rule_of(key);
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return number_of(entry->node, path_of(key), rule);
}

std::optional<std::int64_t> TableReader::integer(std::string_view key) const {
  const auto [low, high] = std::pair{type_of(key, KeyType::Form::whole).low, type_of(key, KeyType::Form::whole).high};
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const std::string remedy = fmt::format("give a whole number from {} to {}", low, high);
  const auto* value = std::get_if<std::int64_t>(&entry->node.value);
  if (value == nullptr) {
    if (const auto* real = std::get_if<double>(&entry->node.value)) {
      error(key, fmt::format("is {} but must be a whole number", *real), remedy);
    } else {
      error(key, fmt::format("is {} but must be a whole number", kind_of(entry->node)), remedy);
    }
    return std::nullopt;
  }
  if (*value < low || *value > high) {
    error(key, fmt::format("is {}", *value), remedy);
    return std::nullopt;
  }
  return *value;
}

std::optional<bool> TableReader::boolean(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* value = std::get_if<bool>(&entry->node.value)) return *value;
  error(key, fmt::format("is {} but must be true or false", kind_of(entry->node)),
        "write true or false, without quotes");
  return std::nullopt;
}

std::optional<std::string> TableReader::text(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* value = std::get_if<std::string>(&entry->node.value)) return *value;
  error(key, fmt::format("is {} but must be text", kind_of(entry->node)), "put it in double quotes");
  return std::nullopt;
}

std::optional<geometry::Vec3> TableReader::vec3(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return vec3_of(entry->node, path_of(key), type_of(key, KeyType::Form::array).of.front().rule);
}

std::optional<std::vector<geometry::Vec3>> TableReader::points(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  if (array == nullptr) {
    error(key, fmt::format("is {} but must be a list of points", kind_of(entry->node)),
          "write [[x, y, z], [x, y, z], ...]");
    return std::nullopt;
  }
  std::vector<geometry::Vec3> result;
  bool good = true;
  for (std::size_t i = 0; i < array->items.size(); ++i) {
    const auto point = vec3_of(array->items[i], fmt::format("{}[{}]", path_of(key), i + 1), rule::coordinate);
    if (point) {
      result.push_back(*point);
    } else {
      good = false;
    }
  }
  if (!good) return std::nullopt;
  return result;
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  std::vector<std::string> result;
  bool good = array != nullptr;
  if (array != nullptr) {
    for (const TomlNode& node : array->items) {
      const auto* word = std::get_if<std::string>(&node.value);
      good = good && word != nullptr;
      if (word != nullptr) result.push_back(*word);
    }
  }
  if (good) return result;
  error(key, "must be a list of texts", "write [\"a\", \"b\"]");
  return std::nullopt;
}

const TomlTable* TableReader::table(std::string_view key) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return nullptr;
  if (const auto* value = std::get_if<TomlTable>(&entry->node.value)) return value;
  const bool listed = std::holds_alternative<TomlArray>(entry->node.value);
  error(key, fmt::format("is {} but must be a table", kind_of(entry->node)),
        listed && path_.empty() ? fmt::format("write [{}] once, with single brackets", key)
                                : fmt::format("write {} = {{ ... }}", key));
  return nullptr;
}

std::vector<const TomlNode*> TableReader::tables(std::string_view key) const {
  std::vector<const TomlNode*> result;
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return result;
  const std::string remedy = fmt::format("write [[{}]], with double brackets", path_of(key));
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  if (array == nullptr) {
    error(key, fmt::format("is {} but must be a list of tables", kind_of(entry->node)), remedy);
    return result;
  }
  for (std::size_t i = 0; i < array->items.size(); ++i) {
    const TomlNode& node = array->items[i];
    if (std::holds_alternative<TomlTable>(node.value)) {
      result.push_back(&node);
    } else {
      problems_->error(node.line, fmt::format("{}[{}]", path_of(key), i + 1),
                       fmt::format("is {} but must be a table", kind_of(node)), remedy);
    }
  }
  return result;
}

std::optional<std::size_t> TableReader::choice(std::string_view key) const {
  const auto choices = type_of(key, KeyType::Form::word).words;
  const auto word = text(key);
  if (!word) return std::nullopt;
  if (const auto it = std::ranges::find(choices, *word); it != choices.end()) {
    return static_cast<std::size_t>(it - choices.begin());
  }
  const auto guess = nearest(*word, choices);
  error(key, fmt::format("{} is not known", in_quotes(*word)),
        (guess ? fmt::format("did you mean \"{}\"? ", *guess) : std::string{}) +
            fmt::format("choose one of: {}", list_of(choices)));
  return std::nullopt;
}

std::optional<double> TableReader::need_number(std::string_view key) const {
  if (!has(key)) missing(key, fmt::format("add {} = a number {}", key, rule_of(key).words()));
  return number(key);
}
std::optional<geometry::Vec3> TableReader::need_vec3(std::string_view key) const {
  if (!has(key)) missing(key, fmt::format("add {} = [x, y, z]", key));
  return vec3(key);
}
std::optional<std::string> TableReader::need_text(std::string_view key) const {
  if (!has(key)) missing(key, fmt::format("add {} = \"...\"", key));
  return text(key);
}

}  // namespace cleave::scene
