#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Small building blocks of every writer: numbers, escapes, base64. Independent of the locale.
namespace cleave::report {

/// Shortest text that reads back to the same double: "0.1", "1e+300", "inf", "-inf", "nan". -0 is written as 0.
void append_number(std::string& out, double value);
[[nodiscard]] std::string number(double value);

/// For people: `digits` significant digits, no trailing zeros, thin spaces between groups of three ("12 345.6"); "∞"
/// for inf.
[[nodiscard]] std::string display(double value, int digits = 4);
/// Whole numbers for people: "22 782".
[[nodiscard]] std::string display_count(std::uint64_t value);

/// A JSON string with its quotes. Control characters, quotes and backslashes are escaped; "<" too, so that the text may
/// stand inside an HTML script element. Bytes that are not UTF-8 become U+FFFD.
void append_json_string(std::string& out, std::string_view text);

/// & < > " ' as entities, so that the text may stand between tags and in attributes; control characters but tab and
/// line feed and bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string escape_xml(std::string_view text);

/// RFC 4648 with padding, no line breaks.
void append_base64(std::string& out, std::span<const std::byte> bytes);

}  // namespace cleave::report
