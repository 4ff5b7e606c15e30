#pragma once

#include <initializer_list>
#include <optional>
#include <ranges>
#include <string_view>
#include <type_traits>
#include <utility>

/// A result struct says its figures once, in a function `fields(visitor, x)` beside it that calls
/// `visitor(name, value, help)` for each: what is written, its schema and its tables are visitors over it.
///
/// The name ends with the unit (`volume_m3`). A value is a number, a text, a flag, a range of values or a struct with
/// `fields` of its own; an optional that is empty is not written. The functions below say what else can be.
namespace cleave {

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
  std::initializer_list<std::string_view> names;
};
[[nodiscard]] inline OneOf one_of(std::string_view value, std::initializer_list<std::string_view> names) {
  return {value, names};
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
