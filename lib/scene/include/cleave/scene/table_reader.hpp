#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/keys.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/toml_tree.hpp"

namespace cleave::scene {

/// Collects what is wrong with one scene. Errors stop the scene from existing, notes do not.
class Problems final {
 public:
  explicit Problems(std::string file) : file_{std::move(file)} {}
  void error(std::uint32_t line, std::string key, std::string what, std::string remedy);
  void error_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy);
  void note(std::uint32_t line, std::string key, std::string what, std::string remedy);
  void note_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy);
  /// What could not be read, by name: that something else names it, too, is no second mistake.
  void unread(std::string name) { unread_.push_back(std::move(name)); }
  [[nodiscard]] bool is_unread(std::string_view name) const noexcept;
  [[nodiscard]] bool all_read() const noexcept { return unread_.empty(); }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] std::size_t errors() const noexcept { return error_count_; }
  /// By file (the scene's own first), then line; at most 200, the last one then says how many are left out.
  [[nodiscard]] std::vector<Problem> take_errors() &&;
  [[nodiscard]] std::vector<Problem> take_notes() &&;

 private:
  std::string file_;
  std::vector<Problem> errors_, notes_;
  std::vector<std::string> unread_;
  std::size_t error_count_ = 0, not_shown_ = 0;
};

/// Typed access to one table by the declaration of its keys: each function reports what is wrong under the key's full
/// path and line, and returns empty. The constructor reports every key that is not known.
class TableReader final {
 public:
  TableReader(const TomlTable& table, std::uint32_t line, std::string path, Problems& problems, const KeyTable& keys);
  /// The word of the key that chooses among the variants of the keys; empty where it is missing or wrong (reported).
  [[nodiscard]] std::optional<std::size_t> variant() const noexcept { return variant_; }

  // By the declaration of the key; empty when the key is absent (no report) or wrong (reported).
  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key) const;
  [[nodiscard]] std::optional<std::size_t> choice(std::string_view key) const;
  [[nodiscard]] std::optional<geometry::Vec3> vec3(std::string_view key) const;
  [[nodiscard]] std::optional<std::array<double, 2>> pair(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<std::array<double, 2>>> pairs(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key) const;
  /// The table of a key, or of each item of a list of tables.
  [[nodiscard]] std::optional<TableReader> sub(std::string_view key) const;
  [[nodiscard]] std::vector<TableReader> each(std::string_view key) const;
  [[nodiscard]] const NumberRule& rule_of(std::string_view key) const;
  /// Of the n-th list of keys that exclude each other.
  [[nodiscard]] const TomlEntry* one_of(std::size_t n = 0) const;
  // An absent key is reported too.
  [[nodiscard]] std::optional<double> need_number(std::string_view key) const;
  [[nodiscard]] std::optional<geometry::Vec3> need_vec3(std::string_view key) const;
  // With the declared default.
  [[nodiscard]] double value(std::string_view key) const;
  [[nodiscard]] std::int64_t count(std::string_view key) const;
  [[nodiscard]] bool flag(std::string_view key) const;
  /// Of a key declared as `key::word<Enum>()`.
  template <class Enum>
  [[nodiscard]] Enum word(std::string_view key) const {
    return static_cast<Enum>(word_of(key, enum_names<Enum>));
  }
  /// The same without the default: empty when absent or wrong.
  template <class Enum>
  [[nodiscard]] std::optional<Enum> given_word(std::string_view key) const {
    return find(key) != nullptr && choice(key) ? std::optional{word<Enum>(key)} : std::nullopt;
  }

  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] Problems& problems() const noexcept { return *problems_; }
  [[nodiscard]] std::string path_of(std::string_view key) const;
  /// Line of the key, or of the table when it is not there.
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const;
  [[nodiscard]] const TomlEntry* find(std::string_view key) const;
  [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }
  void error(std::string_view key, std::string what, std::string remedy) const;
  void note(std::string_view key, std::string what, std::string remedy) const;
  /// Reports `key` as missing.
  void missing(std::string_view key, std::string remedy) const;
  /// A note where the number under `key`, or the largest of its list, is none of the usual ones of `rule`, with
  /// the likely unit.
  void note_unusual(std::string_view key, const NumberRule& rule) const;
  /// Exactly one of `keys` must be there: that one, or empty after a report.
  [[nodiscard]] const TomlEntry* one_of(std::span<const std::string_view> keys) const;

  // Empty when the key is absent (no report) or wrong (reported).
  [[nodiscard]] std::optional<bool> boolean(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<geometry::Vec3>> points(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key) const;
  [[nodiscard]] const TomlTable* table(std::string_view key) const;
  /// Tables of [[key]], or of a plain array of tables; empty when absent or wrong.
  [[nodiscard]] std::vector<const TomlNode*> tables(std::string_view key) const;
  // As above, but an absent key is reported too.
  [[nodiscard]] std::optional<std::string> need_text(std::string_view key) const;

  /// Any node as a number: shared by arrays.
  [[nodiscard]] std::optional<double> number_of(const TomlNode& node, const std::string& path,
                                                const NumberRule& rule) const;
  [[nodiscard]] std::optional<geometry::Vec3> vec3_of(const TomlNode& node, const std::string& path,
                                                      const NumberRule& rule) const;

 private:
  /// The same without a look at usual sizes.
  [[nodiscard]] std::optional<double> plain_number_of(const TomlNode& node, const std::string& path,
                                                      const NumberRule& rule) const;
  /// Of the numbers among `nodes` the largest is looked at: components of a vector may be small.
  void note_unusual(std::span<const TomlNode> nodes, const std::string& path, const NumberRule& rule) const;
  [[nodiscard]] const Key& declared(std::string_view key) const;
  [[nodiscard]] const KeyType& type_of(std::string_view key, KeyType::Form form) const;
  [[nodiscard]] std::size_t word_number(std::string_view key) const;
  [[nodiscard]] std::size_t word_of(std::string_view key, std::span<const std::string_view> names) const;
  void report_unknown() const;

  const TomlTable* table_;
  std::uint32_t line_;
  std::string path_;
  Problems* problems_;
  const KeyTable* keys_;
  std::optional<std::size_t> variant_ = std::nullopt;
};

/// What a node is, in words: "text", "a table", ...
[[nodiscard]] std::string_view kind_of(const TomlNode& node) noexcept;

}  // namespace cleave::scene
