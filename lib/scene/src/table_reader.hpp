#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/problem.hpp"
#include "toml_tree.hpp"

namespace cleave::scene {

/// Collects what is wrong with one scene. Errors stop the scene from existing, notes do not.
class Problems final {
 public:
  explicit Problems(std::string file) : file_{std::move(file)} {}
  void error(std::uint32_t line, std::string key, std::string what, std::string remedy);
  void error_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy);
  void note(std::uint32_t line, std::string key, std::string what, std::string remedy);
  void note_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy);
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] std::size_t errors() const noexcept { return error_count_; }
  /// By file (the scene's own first), then line; at most 200, the last one then says how many are left out.
  [[nodiscard]] std::vector<Problem> take_errors() &&;
  [[nodiscard]] std::vector<Problem> take_notes() &&;

 private:
  std::string file_;
  std::vector<Problem> errors_, notes_;
  std::size_t error_count_ = 0;
};

/// What a number may be. `unit` is "" or starts with a blank (" m").
struct NumberRule {
  double low;
  bool low_open;
  double high;
  bool high_open;
  std::string_view unit;
  /// "from 0 to 90 degrees", "above 0 and below ..."
  [[nodiscard]] std::string words() const;
  [[nodiscard]] bool accepts(double v) const noexcept;
};

namespace rule {
inline constexpr NumberRule coordinate{-1e9, false, 1e9, false, " m"};
inline constexpr NumberRule length{0, true, 1e9, false, " m"};
inline constexpr NumberRule length_or_zero{0, false, 1e9, false, " m"};
inline constexpr NumberRule dip{0, false, 90, false, " degrees"};
inline constexpr NumberRule dip_direction{0, false, 360, false, " degrees"};
inline constexpr NumberRule turn{-360, false, 360, false, " degrees"};
inline constexpr NumberRule friction{0, false, 90, true, " degrees"};
inline constexpr NumberRule stress{0, false, 1e15, false, " Pa"};
inline constexpr NumberRule density{0, true, 1e5, false, " kg/m3"};
inline constexpr NumberRule acceleration{-1e3, false, 1e3, false, " m/s2"};
inline constexpr NumberRule ratio{-1e3, false, 1e3, false, ""};
inline constexpr NumberRule any{-1e15, false, 1e15, false, ""};
}  // namespace rule

/// Typed access to one table: each function reports what is wrong under the key's full path and line, and returns
/// empty. The constructor reports every key that is neither known nor promised for a later version.
class TableReader final {
 public:
  TableReader(const TomlTable& table, std::uint32_t line, std::string path, Problems& problems,
              std::span<const std::string_view> known, std::span<const std::string_view> later = {});

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
  /// Exactly one of `keys` must be there: that one, or empty after a report.
  [[nodiscard]] const TomlEntry* one_of(std::span<const std::string_view> keys) const;

  // Empty when the key is absent (no report) or wrong (reported).
  [[nodiscard]] std::optional<double> number(std::string_view key, const NumberRule& rule) const;
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  [[nodiscard]] std::optional<bool> boolean(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  [[nodiscard]] std::optional<geometry::Vec3> vec3(std::string_view key, const NumberRule& rule) const;
  [[nodiscard]] std::optional<std::vector<geometry::Vec3>> points(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key) const;
  [[nodiscard]] const TomlTable* table(std::string_view key) const;
  /// Tables of [[key]], or of a plain array of tables; empty when absent or wrong.
  [[nodiscard]] std::vector<const TomlNode*> tables(std::string_view key) const;
  /// One word out of `choices`; words in `later` get "not available in this version".
  [[nodiscard]] std::optional<std::size_t> choice(std::string_view key, std::span<const std::string_view> choices,
                                                  std::span<const std::string_view> later = {}) const;

  // As above, but an absent key is reported too.
  [[nodiscard]] std::optional<double> need_number(std::string_view key, const NumberRule& rule) const;
  [[nodiscard]] std::optional<geometry::Vec3> need_vec3(std::string_view key, const NumberRule& rule) const;
  [[nodiscard]] std::optional<std::string> need_text(std::string_view key) const;

  /// Any node as a number: shared by arrays.
  [[nodiscard]] std::optional<double> number_of(const TomlNode& node, const std::string& path,
                                                const NumberRule& rule) const;
  [[nodiscard]] std::optional<geometry::Vec3> vec3_of(const TomlNode& node, const std::string& path,
                                                      const NumberRule& rule) const;

 private:
  const TomlTable* table_;
  std::uint32_t line_;
  std::string path_;
  Problems* problems_;
};

/// What a node is, in words: "text", "a table", ...
[[nodiscard]] std::string_view kind_of(const TomlNode& node) noexcept;

/// The sentence for keys and values that the contract knows but this version does not.
[[nodiscard]] std::string not_available();

}  // namespace cleave::scene
