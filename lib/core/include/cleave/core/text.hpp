#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Small things of text, of ASCII only, whatever the locale.
namespace cleave {

[[nodiscard]] constexpr char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
[[nodiscard]] std::string lower(std::string_view text);

/// Space, tab, carriage return, vertical tab, form feed; the end of a line is none.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
/// Without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

/// Whether it holds characters that steer a terminal instead of showing: those below the space but for tabs, and 127 to
/// 159 (in UTF-8). Line ends count.
[[nodiscard]] bool has_control_characters(std::string_view text) noexcept;

/// Length in bytes of the well-formed character of UTF-8 that `text` (not empty) starts with; 0 where it is none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// For comments of files: control characters (line ends and tabs too) as blanks, U+FFFD for bytes that are not UTF-8.
[[nodiscard]] std::string on_one_line(std::string_view text);

/// Whether spreadsheets take it for a formula: it begins with = + - or @ and is no number.
[[nodiscard]] bool is_formula(std::string_view text);

/// One field of a CSV row: in quotes where it holds a comma, a quote, a line end or one of `others`; what would be a
/// formula has an apostrophe before it.
[[nodiscard]] std::string csv_field(std::string_view text, std::string_view others = {});

/// "1 block", "3 blocks": the count, and the word for one or for more.
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view one, std::string_view more);

}  // namespace cleave
