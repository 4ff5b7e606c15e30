#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

/// The names of an enumeration are its enumerators: they stand in one place, and no list can be out of step with them.
/// For enumerations that count from 0 without a gap.
namespace cleave {
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

}  // namespace cleave
