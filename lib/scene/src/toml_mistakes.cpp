#include "toml_mistakes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

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

/// True for "true".
bool same_letters(string_view word, string_view small) {
  return std::ranges::equal(word, small,
                            [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

/// 45,5 as the whole value.
bool decimal_comma(string_view value) {
  value = trimmed(value.substr(0, value.find('#')));
  if (value.starts_with('-') || value.starts_with('+')) value.remove_prefix(1);
  const std::size_t comma = value.find(',');
  return comma != string_view::npos && digits(value.substr(0, comma)) && digits(value.substr(comma + 1));
}

/// A decimal comma of a number inside an inline table: "{ dip = 45,5, dip_direction = 90 }". What stands behind a comma
/// there is a key, so digits without an equals sign are the rest of a number.
bool inner_decimal_comma(string_view line) {
  for (std::size_t at = line.find('='); at != string_view::npos; at = line.find('=', at + 1)) {
    string_view value = trimmed(line.substr(at + 1));
    if (value.starts_with('-') || value.starts_with('+')) value.remove_prefix(1);
    const std::size_t comma = value.find_first_not_of("0123456789");
    if (comma == 0 || comma == string_view::npos || value[comma] != ',') continue;
    value.remove_prefix(comma + 1);
    const std::size_t end = std::min(value.find_first_not_of("0123456789"), value.size());
    const string_view behind = trimmed(value.substr(end));
    if (end > 0 && (behind.starts_with(',') || behind.starts_with('}'))) return true;
  }
  return false;
}

/// A word, or a file's name, that begins where a value should.
bool bare_word(string_view value) {
  if (value.empty() || !is_letter(value.front())) return false;
  const string_view word = value.substr(0, value.find_first_of(" \t\r#"));
  return word != "true" && word != "false" && word != "inf" && word != "nan";
}

/// The line without what stands in quotes and without its comment.
std::string bare(string_view line) {
  std::string out;
  char quote = 0;
  for (const char c : line) {
    if (quote == 0 && c == '#') break;
    if (quote == 0 && (c == '"' || c == '\''))
      quote = c;
    else if (c == quote)
      quote = 0;
    out += quote != 0 ? '"' : c;
  }
  return out;
}

/// 2,700: may be one number of thousands.
std::optional<std::string> thousands(string_view value) {
  value = trimmed(value.substr(0, value.find('#')));
  const std::size_t comma = value.find(',');
  if (comma == string_view::npos || comma == 0 || comma > 3 || value.front() == '0') return std::nullopt;
  const string_view before = value.substr(0, comma), behind = value.substr(comma + 1);
  if (!digits(before) || !digits(behind) || behind.size() != 3) return std::nullopt;
  return std::string{before} + std::string{behind};
}

Mistake decimal_comma_of(string_view value) {
  if (const auto whole = thousands(value)) {
    return {"the number has a comma",
            "write " + *whole + " where thousands are meant, a point where the comma is a decimal one"};
  }
  return {"the number has a decimal comma", "write a point"};
}

/// What is wrong with a value that begins like a number.
std::optional<Mistake> wrong_number(string_view value) {
  string_view number = trimmed(value.substr(0, value.find_first_of(",]};")));
  if (number.empty()) return std::nullopt;
  const std::string written{number};
  const bool sign = number.front() == '-' || number.front() == '+';
  const std::string before = sign ? written.substr(0, 1) : std::string{};
  if (sign) number.remove_prefix(1);
  const std::size_t end = std::min(number.find_first_not_of("0123456789."), number.size());
  const string_view figures = number.substr(0, end), rest = trimmed(number.substr(end));
  if (figures.empty() || figures == "." || std::ranges::count(figures, '.') > 1) return std::nullopt;
  const bool exponent = rest.size() > 1 && (rest.front() == 'e' || rest.front() == 'E') && !is_letter(rest[1]);
  const bool unit =
      !rest.empty() && !exponent && (is_letter(rest.front()) || rest.front() == '%' || rest.starts_with("\u00b0"));
  if (unit && figures != "0") {
    return Mistake{"a number with its unit stands in quotes", "write \"" + written.substr(0, 40) + "\""};
  }
  if (!rest.empty() && !exponent) return std::nullopt;
  if (figures.starts_with('.')) {
    return Mistake{"a number begins with a digit", "write " + before + "0" + std::string{number}};
  }
  if (figures.ends_with('.')) {
    return Mistake{"a point stands between digits", "write " + before + std::string{figures} + "0" + std::string{rest}};
  }
  if (figures.size() > 1 && figures.front() == '0' && figures[1] != '.') {
    const std::size_t first = figures.find_first_not_of('0');
    const string_view shown = first == string_view::npos ? figures.substr(0, 1)
                              : figures[first] == '.'    ? figures.substr(first - 1)
                                                         : figures.substr(first);
    return Mistake{"a number begins with no 0 before other digits", "write " + before + std::string{shown}};
  }
  return std::nullopt;
}

/// The first of the values of a line, those of inline tables and lists too, that is no number as one is written.
std::optional<Mistake> wrong_number_in(string_view line) {
  for (std::size_t at = line.find_first_of("=[,"); at != string_view::npos; at = line.find_first_of("=[,", at + 1)) {
    if (auto mistake = wrong_number(trimmed(line.substr(at + 1)))) return mistake;
  }
  return std::nullopt;
}

/// Signs that other languages have where TOML has another one.
std::optional<Mistake> foreign_sign(string_view line) {
  const std::string own = bare(line);
  const string_view text = trimmed(own);
  if (text.contains("//") || text.starts_with(';')) {
    return Mistake{
        text.starts_with(';') ? "a comment begins with #, not with ;" : "a comment begins with #, not with //",
        "write #"};
  }
  if (text.ends_with(';')) return Mistake{"a line has no semicolon at its end", "leave it out"};
  const std::size_t colon = text.find(':'), equals = text.find('=');
  const auto part_of_key = [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
  if (equals == string_view::npos && colon != string_view::npos && colon > 0 &&
      std::ranges::all_of(trimmed(text.substr(0, colon)), part_of_key)) {
    return Mistake{"a key and its value are joined by =, not by a colon",
                   "write " + std::string{trimmed(text.substr(0, colon))} + " = ..."};
  }
  if (equals != string_view::npos && text.contains('{') && text.find(':', equals) != string_view::npos) {
    return Mistake{"a key and its value are joined by =, not by a colon", "write ="};
  }
  return std::nullopt;
}

/// An inline table that goes on in the next line: this line or the one before opens it.
std::optional<Mistake> table_over_lines(string_view text, std::uint32_t number) {
  for (const std::uint32_t at : {number, number - 1}) {
    if (at == 0) continue;
    const std::string line = bare(line_of(text, at));
    if (line.find('=') == std::string::npos) continue;
    if (std::ranges::count(line, '{') <= std::ranges::count(line, '}')) continue;
    return Mistake{"a table between { and } ends on the line on which it begins",
                   "write it on one line, or as a [table] of its own with one key a line"};
  }
  return std::nullopt;
}

/// A backslash between double quotes.
bool backslash_in_quotes(string_view line) {
  const std::size_t quote = line.find('"');
  return quote != string_view::npos && line.find('\\', quote) != string_view::npos;
}

/// The name of a table's header, and whether it is one of several: [[joint]].
struct Header {
  string_view name;
  bool several = false;
};
std::optional<Header> header_of(string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  if (!line.starts_with('[') || !line.ends_with(']')) return std::nullopt;
  const bool several = line.starts_with("[[") && line.ends_with("]]");
  const std::size_t brackets = several ? 2 : 1;
  if (line.size() <= 2 * brackets) return std::nullopt;
  return Header{trimmed(line.substr(brackets, line.size() - 2 * brackets)), several};
}

/// A header that stood before. Where there may be several tables of that name, all have double brackets.
std::optional<Mistake> table_twice(string_view text, std::uint32_t number) {
  constexpr std::array<string_view, 10> of_several{"joint", "joint_set", "excavation", "load",   "support.bolts",
                                                   "body",  "scanline",  "borehole",   "window", "set"};
  const auto header = header_of(line_of(text, number));
  if (!header) return std::nullopt;
  for (std::uint32_t before = 1; before < number; ++before) {
    const std::size_t end = text.find('\n');
    const auto other = header_of(text.substr(0, end));
    text.remove_prefix(end == string_view::npos ? text.size() : end + 1);
    if (!other || other->name != header->name || (other->several && header->several)) continue;
    const std::string name{header->name};
    const std::string what =
        "[" + name + "] stands twice, in lines " + std::to_string(before) + " and " + std::to_string(number);
    if (other->several || header->several || std::ranges::find(of_several, header->name) != of_several.end()) {
      return Mistake{what, "write [[" + name + "]], with double brackets, each time"};
    }
    return Mistake{what, "put all its keys under one of them"};
  }
  return std::nullopt;
}

Mistake backslash() {
  return {"a backslash in double quotes begins a sign such as \\n", "write paths with / or in single quotes"};
}

}  // namespace

std::optional<Mistake> not_a_text(string_view bytes) {
  if (bytes.starts_with("PK\x03\x04")) {
    return Mistake{"is a workbook or an archive (.xlsx, .zip), not a text",
                   "save the scene as plain text, tables as CSV"};
  }
  if (bytes.starts_with("\xD0\xCF\x11\xE0")) {
    return Mistake{"is a document of an office program (.xls, .doc), not a text",
                   "save the scene as plain text, tables as CSV"};
  }
  if (bytes.starts_with("%PDF")) return Mistake{"is a PDF, not a text", "save the scene as plain text"};
  const bool zeros = bytes.size() > 3 && ((bytes[1] == 0 && bytes[3] == 0) || (bytes[0] == 0 && bytes[2] == 0));
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF") || zeros) {
    return Mistake{"is UTF-16 text", "save it as UTF-8 (in Notepad: Save as, Encoding UTF-8)"};
  }
  return std::nullopt;
}

std::optional<Mistake> backslash_in_path(string_view text, std::uint32_t number) {
  const string_view line = line_of(text, number);
  if (!backslash_in_quotes(line) || !line.substr(line.find('\\')).contains('.')) return std::nullopt;
  return backslash();
}

std::optional<Mistake> likely_mistake(string_view text, std::uint32_t number) {
  const string_view line = line_of(text, number);
  constexpr std::array<string_view, 6> curly{"\xE2\x80\x9C", "\xE2\x80\x9D", "\xE2\x80\x9E",
                                             "\xE2\x80\x98", "\xE2\x80\x99", "\xC2\xAB"};
  if (std::ranges::any_of(curly, [&](string_view quote) { return line.contains(quote); })) {
    return Mistake{"the quotes are those of a word processor", "write straight ones (\")"};
  }
  if (auto twice = table_twice(text, number)) return twice;
  if (auto sign = foreign_sign(line)) return sign;
  const std::size_t equals = line.find('=');
  if (equals == string_view::npos) return table_over_lines(text, number);
  const string_view value = trimmed(line.substr(equals + 1));
  if (decimal_comma(value) || inner_decimal_comma(line)) return decimal_comma_of(value);
  if (backslash_in_quotes(value)) return backslash();
  if (auto wrong = wrong_number_in(bare(line))) return wrong;
  if (bare_word(value)) {
    const string_view word = value.substr(0, std::min(value.find_first_of(" \t\r#,}]"), std::size_t{40}));
    for (const string_view truth : {"true", "false"}) {
      if (same_letters(word, truth)) return Mistake{"true and false are written small", "write " + std::string{truth}};
    }
    return Mistake{"text stands in quotes", "write \"" + std::string{word} + "\""};
  }
  return table_over_lines(text, number);
}

}  // namespace cleave::scene
