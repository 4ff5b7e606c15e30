#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

/// A result struct says its figures once, in a function `fields(visitor, x)` beside it that calls
/// `visitor(name, value, help)` for each: what is written, its schema and its tables are visitors over it.
///
/// The name ends with the unit (`volume_m3`). A value is a number, a text, a flag, a range of values or a struct with
/// `fields` of its own; an optional that is empty is not written. The functions below say what else can be.
namespace cleave {

// ---- Names of enumerations

// The names of an enumeration are its enumerators: they stand in one place, and no list can be out of step with them.
// For enumerations that count from 0 without a gap.

namespace detail {

/// "red" for Colour::red; empty for a value that no enumerator has.
template <auto Value>
consteval std::string_view enumerator() {
  constexpr std::string_view text =
      __PRETTY_FUNCTION__;  // "... [with auto Value = ns::Colour::red; ...]", "[Value = ...]"
  constexpr std::size_t begin = text.find("Value = ") + 8;
  constexpr std::string_view value = text.substr(begin, text.find_first_of(";]", begin) - begin);
  if (value.front() == '(') return {};
  return value.substr(value.rfind(':') + 1);
}

template <class Enum, std::size_t Count = 0>
consteval std::size_t count_enumerators() {
  if constexpr (enumerator<static_cast<Enum>(Count)>().empty()) {
    return Count;
  } else {
    return count_enumerators<Enum, Count + 1>();
  }
}

}  // namespace detail

/// All names, in order.
template <class Enum>
  requires std::is_enum_v<Enum>
inline constexpr auto enum_names = []<std::size_t... I>(std::index_sequence<I...>) {
  return std::array<std::string_view, sizeof...(I)>{detail::enumerator<static_cast<Enum>(I)>()...};
}(std::make_index_sequence<detail::count_enumerators<Enum>()>{});

template <class Enum>
  requires std::is_enum_v<Enum>
[[nodiscard]] constexpr std::string_view enum_name(Enum value) noexcept {
  return enum_names<Enum>.at(static_cast<std::size_t>(value));
}

// ---- Figures

/// A value that holds nothing, from which the schema is made; specialised for types that have no default.
template <class T>
struct Sample {
  static T make() { return T{}; }
};

/// Written as null where there is none: a value that is not finite, or an empty optional.
template <class T>
struct OrNull {
  std::optional<T> value;
};
[[nodiscard]] inline OrNull<double> or_null(double value) { return {value}; }
/// `part` of `whole`, if there is a whole.
template <class Whole, class Part>
[[nodiscard]] auto or_null(const std::optional<Whole>& whole, Part Whole::* part) {
  return whole ? OrNull<Part>{(*whole).*part} : OrNull<Part>{};
}

/// Written only when `present`.
template <class T>
struct When {
  bool present;
  const T& value;
};
template <class T>
[[nodiscard]] When<T> when(bool present, const T& value) {
  return {present, value};
}
template <std::ranges::range T>
[[nodiscard]] When<T> when_any(const T& values) {
  return {!std::ranges::empty(values), values};
}

/// One of these texts.
struct OneOf {
  std::string_view value;
  std::span<const std::string_view> names;
};
/// To be used where it is made: `names` are those of the call.
[[nodiscard]] inline OneOf one_of(std::string_view value, std::initializer_list<std::string_view> names) {
  return {value, std::span{names}};
}
template <class Enum>
  requires std::is_enum_v<Enum>
[[nodiscard]] constexpr OneOf one_of(Enum value) noexcept {
  return {enum_name(value), enum_names<Enum>};
}

/// An object that has no struct: `body(visitor)` names its figures.
template <class Body>
struct Group {
  Body body;
};
template <class Body>
[[nodiscard]] Group<Body> group(Body body) {
  return {std::move(body)};
}

/// An object for each element: `body(visitor, element)` or `body(visitor, element, index)` names its figures. For the
/// schema it is called with an element that holds nothing, though the range be empty.
template <class Range, class Body>
struct Each {
  const Range& range;
  Body body;
};
template <std::ranges::range Range, class Body>
[[nodiscard]] Each<Range, Body> each(const Range& range, Body body) {
  return {range, std::move(body)};
}

template <class Range, class Body>
[[nodiscard]] When<Each<Range, Body>> when_any(const Each<Range, Body>& rows) {
  return {!std::ranges::empty(rows.range), rows};
}

/// The same as members of one object, named by `name` of each element.
template <class Range, class Name, class Body>
struct ByName {
  const Range& range;
  Name name;
  Body body;
};
template <std::ranges::range Range, class Name, class Body>
[[nodiscard]] ByName<Range, Name, Body> by_name(const Range& range, Name name, Body body) {
  return {range, name, std::move(body)};
}

/// An array of `values`, each seen as `view` of it.
template <std::ranges::range Range, class View>
[[nodiscard]] auto each_as(const Range& range, View view) {
  return std::views::transform(range, view);
}

}  // namespace cleave
