#include "cleave/core/text.hpp"

#include <algorithm>

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

std::string csv_field(std::string_view text, std::string_view others) {
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

}  // namespace cleave
