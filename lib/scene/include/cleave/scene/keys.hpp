#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/scene/plan.hpp"

/// The keys of scene and survey files, each declared once: what it holds, its unit, range, usual values, default and
/// one line of help. Parsers read by these declarations, and docs/scene.schema.json and the tables of keys in docs are
/// made from them.
namespace cleave::scene {

/// What a number may be. `unit` is "" or starts with a blank (" m").
struct NumberRule {
  double low;
  bool low_open;
  double high;
  bool high_open;
  std::string_view unit;
  /// Sizes that rock, loads, bolts or shotcrete have; a number outside them is a note that names the likely unit.
  struct Usual {
    double low, high;
    std::string_view otherwise = {};  ///< the note's remedy where no unit makes the number a usual one
  };
  std::optional<Usual> usual = {};

  /// "from 0 to 90 degrees", "above 0 and below ..."
  [[nodiscard]] std::string words() const;
  [[nodiscard]] bool accepts(double v) const noexcept;
  /// The same rule with a usual range.
  [[nodiscard]] constexpr NumberRule usually(double from, double to, std::string_view otherwise = {}) const noexcept {
    NumberRule rule = *this;
    rule.usual = {from, to, otherwise};
    return rule;
  }
  /// 0 is nothing, and usual everywhere.
  [[nodiscard]] bool is_usual(double v) const noexcept;
};

namespace rule {
inline constexpr NumberRule coordinate{-1e9, false, 1e9, false, " m"};
inline constexpr NumberRule length{0, true, 1e9, false, " m"};
inline constexpr NumberRule length_or_zero{0, false, 1e9, false, " m"};
inline constexpr NumberRule volume{0, true, 1e9, false, " m3"};
inline constexpr NumberRule dip{0, false, 90, false, " degrees"};
inline constexpr NumberRule dip_direction{0, false, 360, false, " degrees"};
inline constexpr NumberRule half_turn{0, false, 180, false, " degrees"};
inline constexpr NumberRule turn{-360, false, 360, false, " degrees"};
inline constexpr NumberRule friction = NumberRule{0, false, 90, true, " degrees"}.usually(3, 80);
inline constexpr NumberRule stress{0, false, 1e15, false, " Pa"};
inline constexpr NumberRule strength = NumberRule{0, false, 1e15, false, " Pa"}.usually(500, 1e7);
inline constexpr NumberRule density = NumberRule{0, true, 1e5, false, " kg/m3"}.usually(500, 10000);
inline constexpr NumberRule acceleration{-1e3, false, 1e3, false, " m/s2"};
/// `of` for weight: that of the moon is the least usual one, and in a centrifuge it is some 50 times that of the earth.
constexpr NumberRule as_gravity(const NumberRule& of) noexcept {
  return of.usually(1.5, 500, "that of the earth is 9.81; it is taken as it stands: check it");
}
inline constexpr NumberRule probability{0, false, 1, false, ""};
inline constexpr NumberRule share{0, true, 1, false, ""};
inline constexpr NumberRule kappa{0, false, 1e12, false, ""};
inline constexpr NumberRule factor{0, true, 100, false, ""};
inline constexpr NumberRule ratio{-1e3, false, 1e3, false, ""};
inline constexpr NumberRule any{-1e15, false, 1e15, false, ""};
}  // namespace rule

struct KeyTable;

/// What a key holds.
struct KeyType {
  enum class Form : std::uint8_t {
    number,
    whole,
    flag,
    text,
    word,   ///< one of `words`
    array,  ///< of `of[0]`, from `low` to `high` items
    table,  ///< with the keys of `keys()`
    named,  ///< names of the user's to `of[0]`
    either  ///< one of `of`
  };
  Form form = Form::text;
  NumberRule rule{};
  std::int64_t low = 0, high = 0;  ///< whole: its range; array: its length
  std::span<const std::string_view> words{};
  std::vector<KeyType> of{};
  const KeyTable& (*keys)() = nullptr;

  /// This type, or the alternative of that form; null when there is none.
  [[nodiscard]] const KeyType* as(Form wanted) const noexcept;
};

namespace key {
inline constexpr std::int64_t any_length = 1'000'000'000;
[[nodiscard]] KeyType number(const NumberRule& rule);
[[nodiscard]] KeyType whole(std::int64_t low, std::int64_t high);
[[nodiscard]] KeyType flag();
[[nodiscard]] KeyType text();
[[nodiscard]] KeyType word(std::span<const std::string_view> words);
/// One of the enumerators.
template <class Enum>
[[nodiscard]] KeyType word() {
  return word(enum_names<Enum>);
}
[[nodiscard]] KeyType array(KeyType of, std::int64_t low = 0, std::int64_t high = any_length);
[[nodiscard]] KeyType vector(const NumberRule& rule);                     ///< [x, y, z]
[[nodiscard]] KeyType pair(const NumberRule& rule);                       ///< [x, y]
[[nodiscard]] KeyType points(const NumberRule& rule = rule::coordinate);  ///< [[x, y, z], ...]
[[nodiscard]] KeyType pairs(const NumberRule& rule = rule::coordinate);   ///< [[x, y], ...]
[[nodiscard]] KeyType texts();                                            ///< ["a", "b"]
[[nodiscard]] KeyType table(const KeyTable& (*keys)());                   ///< { ... } or [NAME]
[[nodiscard]] KeyType tables(const KeyTable& (*keys)());                  ///< [{ ... }] or [[NAME]]
[[nodiscard]] KeyType named(KeyType of);                                  ///< { NAME = ... }
[[nodiscard]] KeyType either(std::initializer_list<KeyType> alternatives);
}  // namespace key

/// The default of a key that has to be given.
inline constexpr std::string_view required = "required";

struct Key {
  std::string_view name;
  KeyType type;
  /// As TOML, or words; `required`; empty: none.
  std::string_view standard;
  std::string_view help;
  std::string_view was = {};  ///< an old name, which is still read, with a note
};

/// Keys that a table has when the key `select` holds `word`.
struct KeyVariant {
  std::string_view word;
  std::vector<Key> keys;
};

/// The keys of one table. The key `select` of type word chooses among `variants`, in the order of its words.
struct KeyTable {
  std::string name;  ///< in the schema and in docs: "stability"
  std::vector<Key> keys;
  std::vector<std::vector<std::string_view>> one_of = {};  ///< of each list exactly one is given
  std::string_view select = {};
  std::vector<KeyVariant> variants = {};
  /// Of a whole scene: what takes which keys.
  std::vector<std::pair<Step, std::vector<std::string_view>>> steps = {};

  [[nodiscard]] const Key* find(std::string_view key, std::optional<std::size_t> variant) const noexcept;
  /// Names of all keys, of one variant where there are any.
  [[nodiscard]] std::vector<std::string_view> names(std::optional<std::size_t> variant) const;
};

/// A text with a unit ("50 kPa") in the unit of a rule.
struct UnitError {
  std::string what, remedy;
};
/// The number in the unit of `rule`; empty where the text is no number with a unit of that kind.
[[nodiscard]] std::optional<double> with_unit(std::string_view text, const NumberRule& rule);
/// Texts that a rule takes: "50 kPa"; empty where it has no unit.
[[nodiscard]] std::string unit_example(const NumberRule& rule);
/// Symbols of the units of that kind.
[[nodiscard]] std::vector<std::string_view> unit_symbols(const NumberRule& rule);
/// The unit that makes a bare number outside the usual range a usual one: "kPa"; empty where none does.
[[nodiscard]] std::optional<std::string_view> likely_unit(double bare, const NumberRule& rule);

}  // namespace cleave::scene
