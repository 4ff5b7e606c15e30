#include "table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "nearest.hpp"

namespace cleave::scene {
namespace {

constexpr std::size_t most_errors = 200;

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

}  // namespace

std::string not_available() { return "is not available in version 0.1"; }

std::string_view kind_of(const TomlNode& node) noexcept {
  return std::visit(overloaded{[](bool) -> std::string_view { return "true or false"; },
                               [](std::int64_t) -> std::string_view { return "a whole number"; },
                               [](double) -> std::string_view { return "a number"; },
                               [](const std::string&) -> std::string_view { return "text"; },
                               [](const TomlDate&) -> std::string_view { return "a date or time"; },
                               [](const TomlArray&) -> std::string_view { return "an array"; },
                               [](const TomlTable&) -> std::string_view { return "a table"; }},
                    node.value);
}

void Problems::error(std::uint32_t line, std::string key, std::string what, std::string remedy) {
  error_in(file_, line, std::move(key), std::move(what), std::move(remedy));
}
void Problems::error_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy) {
  ++error_count_;
  if (errors_.size() < most_errors) {
    errors_.push_back({std::move(file), line, std::move(key), std::move(what), std::move(remedy)});
  }
}
void Problems::note(std::uint32_t line, std::string key, std::string what, std::string remedy) {
  note_in(file_, line, std::move(key), std::move(what), std::move(remedy));
}
void Problems::note_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy) {
  if (notes_.size() < most_errors) {
    notes_.push_back({std::move(file), line, std::move(key), std::move(what), std::move(remedy)});
  }
}

std::vector<Problem> Problems::take_errors() && {
  const auto place = [&](const Problem& problem) {
    return std::tuple{problem.file != file_, std::string_view{problem.file}, problem.line};
  };
  std::vector<std::size_t> order(errors_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair{place(errors_[a]), a} < std::pair{place(errors_[b]), b};
  });
  std::vector<Problem> sorted;
  sorted.reserve(errors_.size() + 1);
  for (const std::size_t i : order) sorted.push_back(std::move(errors_[i]));
  errors_ = std::move(sorted);
  if (error_count_ > errors_.size()) {
    errors_.push_back({file_, 1, "scene", fmt::format("{} more errors are not shown", error_count_ - errors_.size()),
                       "mend these first"});
  }
  return std::move(errors_);
}
std::vector<Problem> Problems::take_notes() && { return std::move(notes_); }

bool NumberRule::accepts(double v) const noexcept {
  return (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high);
}

std::string NumberRule::words() const {
  if (!low_open && !high_open) return fmt::format("from {:g} to {:g}{}", low, high, unit);
  return fmt::format("{} {:g} and {} {:g}{}", low_open ? "above" : "at least", low, high_open ? "below" : "at most",
                     high, unit);
}

TableReader::TableReader(const TomlTable& table, std::uint32_t line, std::string path, Problems& problems,
                         std::span<const std::string_view> known, std::span<const std::string_view> later)
    : table_{&table}, line_{line}, path_{std::move(path)}, problems_{&problems} {
  for (const TomlEntry& entry : table.entries) {
    if (std::ranges::find(known, entry.key) != known.end()) continue;
    if (std::ranges::find(later, entry.key) != later.end()) {
      problems.error(entry.line, path_of(entry.key), not_available(), "remove it");
      continue;
    }
    std::vector<std::string_view> all{known.begin(), known.end()};
    all.insert(all.end(), later.begin(), later.end());
    const auto guess = nearest(entry.key, all);
    problems.error(entry.line, path_of(entry.key), "unknown key",
                   guess ? fmt::format("did you mean \"{}\"?", *guess) : fmt::format("known here: {}", list_of(known)));
  }
}

std::string TableReader::path_of(std::string_view key) const {
  const std::string_view shown = key.empty() ? std::string_view{"\"\""} : key;  // TOML allows a key without letters
  return path_.empty() ? std::string{shown} : fmt::format("{}.{}", path_, shown);
}
std::uint32_t TableReader::line_of(std::string_view key) const {
  const TomlEntry* entry = find(key);
  return entry == nullptr ? line_ : entry->line;
}
const TomlEntry* TableReader::find(std::string_view key) const {
  const auto it = std::ranges::find(table_->entries, key, &TomlEntry::key);
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

std::optional<double> TableReader::number_of(const TomlNode& node, const std::string& path,
                                             const NumberRule& rule) const {
  double value = 0;
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) {
    value = static_cast<double>(*whole);
  } else if (const auto* real = std::get_if<double>(&node.value)) {
    value = *real;
  } else {
    const bool is_text = std::holds_alternative<std::string>(node.value);
    problems_->error(node.line, path, fmt::format("is {} but must be a number", kind_of(node)),
                     is_text ? fmt::format("write a bare number {}, without quotes and unit", rule.words())
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
  const auto x = number_of(array->items[0], path, rule);
  const auto y = number_of(array->items[1], path, rule);
  const auto z = number_of(array->items[2], path, rule);
  if (!x || !y || !z) return std::nullopt;
  return geometry::Vec3{*x, *y, *z};
}

std::optional<double> TableReader::number(std::string_view key, const NumberRule& rule) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return number_of(entry->node, path_of(key), rule);
}

std::optional<std::int64_t> TableReader::integer(std::string_view key, std::int64_t low, std::int64_t high) const {
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

std::optional<geometry::Vec3> TableReader::vec3(std::string_view key, const NumberRule& rule) const {
  const TomlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return vec3_of(entry->node, path_of(key), rule);
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

std::optional<std::size_t> TableReader::choice(std::string_view key, std::span<const std::string_view> choices,
                                               std::span<const std::string_view> later) const {
  const auto word = text(key);
  if (!word) return std::nullopt;
  if (const auto it = std::ranges::find(choices, *word); it != choices.end()) {
    return static_cast<std::size_t>(it - choices.begin());
  }
  if (std::ranges::find(later, *word) != later.end()) {
    error(key, fmt::format("{} {}", in_quotes(*word), not_available()),
          fmt::format("choose one of: {}", list_of(choices)));
    return std::nullopt;
  }
  std::vector<std::string_view> all{choices.begin(), choices.end()};
  all.insert(all.end(), later.begin(), later.end());
  const auto guess = nearest(*word, all);
  error(key, fmt::format("{} is not known", in_quotes(*word)),
        (guess ? fmt::format("did you mean \"{}\"? ", *guess) : std::string{}) +
            fmt::format("choose one of: {}", list_of(choices)));
  return std::nullopt;
}

std::optional<double> TableReader::need_number(std::string_view key, const NumberRule& rule) const {
  if (!has(key)) {
    missing(key, fmt::format("add {} = a number {}", key, rule.words()));
    return std::nullopt;
  }
  return number(key, rule);
}
std::optional<geometry::Vec3> TableReader::need_vec3(std::string_view key, const NumberRule& rule) const {
  if (!has(key)) {
    missing(key, fmt::format("add {} = [x, y, z]", key));
    return std::nullopt;
  }
  return vec3(key, rule);
}
std::optional<std::string> TableReader::need_text(std::string_view key) const {
  if (!has(key)) {
    missing(key, fmt::format("add {} = \"...\"", key));
    return std::nullopt;
  }
  return text(key);
}

}  // namespace cleave::scene
