#include "toml_mistakes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "cleave/core/text.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

string_view line_of(string_view text, std::uint32_t line) {
  for (std::uint32_t at = 1; at < line; ++at) {
    const std::size_t end = text.find('\n');
    if (end == string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

bool digits(string_view text) { return !text.empty() && text.find_first_not_of("0123456789") == string_view::npos; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// 45,5 as the whole value.
bool decimal_comma(string_view value) {
  value = trimmed(value.substr(0, value.find('#')));
  if (value.starts_with('-') || value.starts_with('+')) value.remove_prefix(1);
  const std::size_t comma = value.find(',');
  return comma != string_view::npos && digits(value.substr(0, comma)) && digits(value.substr(comma + 1));
}

/// A word, or a file's name, that begins where a value should.
bool bare_word(string_view value) {
  if (value.empty() || !is_letter(value.front())) return false;
  const string_view word = value.substr(0, value.find_first_of(" \t\r#"));
  return word != "true" && word != "false" && word != "inf" && word != "nan";
}

/// A backslash between double quotes.
bool backslash_in_quotes(string_view line) {
  const std::size_t quote = line.find('"');
  return quote != string_view::npos && line.find('\\', quote) != string_view::npos;
}

}  // namespace

std::optional<std::string> not_a_text(string_view bytes) {
  if (bytes.starts_with("PK\x03\x04")) {
    return "is a workbook or an archive (.xlsx, .zip), not a text: save the scene as plain text, tables as CSV";
  }
  if (bytes.starts_with("\xD0\xCF\x11\xE0")) {
    return "is a document of an office program (.xls, .doc), not a text: save the scene as plain text, tables as CSV";
  }
  if (bytes.starts_with("%PDF")) return "is a PDF, not a text: save the scene as plain text";
  const bool zeros = bytes.size() > 3 && ((bytes[1] == 0 && bytes[3] == 0) || (bytes[0] == 0 && bytes[2] == 0));
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF") || zeros) {
    return "is UTF-16 text: save it as UTF-8 (in Notepad: Save as, Encoding UTF-8)";
  }
  return std::nullopt;
}

std::optional<std::string> likely_mistake(string_view text, std::uint32_t number) {
  const string_view line = line_of(text, number);
  constexpr std::array<string_view, 6> curly{"\xE2\x80\x9C", "\xE2\x80\x9D", "\xE2\x80\x9E",
                                             "\xE2\x80\x98", "\xE2\x80\x99", "\xC2\xAB"};
  if (std::ranges::any_of(curly, [&](string_view quote) { return line.contains(quote); })) {
    return "the quotes are those of a word processor: write straight ones (\")";
  }
  const std::size_t equals = line.find('=');
  if (equals == string_view::npos) return std::nullopt;
  const string_view value = trimmed(line.substr(equals + 1));
  if (decimal_comma(value)) return "the number has a decimal comma: write a point";
  if (backslash_in_quotes(value)) {
    return "a backslash in double quotes begins a sign such as \\n: write paths with / or in single quotes";
  }
  if (bare_word(value))
    return "text stands in quotes: write \"" +
           std::string{value.substr(0, std::min(value.find_first_of(" \t\r#"), std::size_t{40}))} + "\"";
  return std::nullopt;
}

}  // namespace cleave::scene
