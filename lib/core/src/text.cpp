#include "cleave/core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <system_error>

namespace cleave {

std::string lower(std::string_view text) {
  std::string result{text};
  std::ranges::transform(result, result.begin(), [](char c) { return lower(c); });
  return result;
}

std::string_view trimmed(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool has_control_characters(std::string_view text) noexcept {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\t') || byte == 0x7F) return true;
    const bool two = byte == 0xC2 && i + 1 < text.size();
    if (two && static_cast<unsigned char>(text[i + 1]) < 0xA0) return true;
  }
  return false;
}

std::size_t utf8_length(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const auto tail = [&](std::size_t i) { return i < text.size() && (byte(i) & 0xC0U) == 0x80U; };
  const unsigned b = byte(0);
  if (b < 0x80U) return 1;
  if (b >= 0xC2U && b <= 0xDFU) return tail(1) ? 2 : 0;
  if (b >= 0xE0U && b <= 0xEFU) {
    if (!tail(1) || !tail(2)) return 0;
    if (b == 0xE0U && byte(1) < 0xA0U) return 0;
    if (b == 0xEDU && byte(1) > 0x9FU) return 0;  // surrogates
    return 3;
  }
  if (b >= 0xF0U && b <= 0xF4U) {
    if (!tail(1) || !tail(2) || !tail(3)) return 0;
    if (b == 0xF0U && byte(1) < 0x90U) return 0;
    if (b == 0xF4U && byte(1) > 0x8FU) return 0;
    return 4;
  }
  return 0;
}

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string on_one_line(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view one = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0) {
      out += "\xEF\xBF\xBD";
    } else if (one == "\t" || has_control_characters(one)) {
      out += ' ';
    } else {
      out += one;
    }
    text.remove_prefix(one.size());
  }
  return out;
}

namespace {

/// The whole of it, and within the range of a double.
bool is_number(std::string_view text) {
#ifdef __cpp_lib_to_chars
  double value = 0;
  const char* const stop = std::to_address(text.end());
  const auto [end, error] = std::from_chars(std::to_address(text.begin()), stop, value);
  return error == std::errc{} && end == stop;
#else  // LLVM's library reads no floating-point numbers before version 20
  if (text.empty() || text.find_first_of(" \t\n\v\f\rxX+") == 0) return false;
  const std::string copy{text};
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  return end == std::to_address(copy.end()) && std::abs(value) <= std::numeric_limits<double>::max();
#endif
}

}  // namespace

bool is_formula(std::string_view text) {
  if (text.empty() || !std::string_view{"=+-@"}.contains(text.front())) return false;
  return !is_number(text.front() == '+' ? text.substr(1) : text);
}

std::string csv_field(std::string_view text, std::string_view others) {
  if (is_formula(text)) {
    std::string shown{'\''};
    shown += text;
    return csv_field(shown, others);
  }
  const bool plain =
      text.find_first_of(",\"\r\n") == std::string_view::npos && text.find_first_of(others) == std::string_view::npos;
  if (plain) return std::string{text};
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view more) {
  return std::to_string(count) + ' ' + std::string{count == 1 ? one : more};
}

}  // namespace cleave
