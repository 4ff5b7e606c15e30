#include "survey_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <system_error>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// The names that other programs give to the same column.
std::string canonical(string_view name) {
  constexpr std::array<std::pair<string_view, string_view>, 15> aliases{{{"dipdir", "dip_direction"},
                                                                         {"dipdirection", "dip_direction"},
                                                                         {"dip_dir", "dip_direction"},
                                                                         {"dd", "dip_direction"},
                                                                         {"azimuth", "dip_direction"},
                                                                         {"dip_angle", "dip"},
                                                                         {"dipangle", "dip"},
                                                                         {"inclination", "dip"},
                                                                         {"depth", "distance"},
                                                                         {"position", "distance"},
                                                                         {"chainage", "distance"},
                                                                         {"joint_set", "set"},
                                                                         {"trace_length", "length"},
                                                                         {"persistence", "length"},
                                                                         {"terminations", "ends"}}};
  std::string word = lower(name);
  std::ranges::replace_if(word, [](char c) { return c == ' ' || c == '-'; }, '_');
  for (const auto& [alias, own] : aliases) {
    if (word == alias) return std::string{own};
  }
  return word;
}

/// Without blanks and quotes at both ends.
string_view bare(string_view text) {
  constexpr string_view blank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// 40,5;100 as 40.5;100: where semicolons part the cells and no number of the row has a point.
void take_decimal_commas(std::vector<std::string>& cells) {
  if (std::ranges::any_of(cells, [](const std::string& c) { return c.contains('.'); })) return;
  for (std::string& cell : cells) {
    const std::size_t comma = cell.find(',');
    if (comma != std::string::npos && cell.find_first_not_of("+-0123456789,") == std::string::npos) cell[comma] = '.';
  }
}

std::vector<std::string> split(string_view line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') {
    while (!line.empty()) {
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first == string_view::npos) break;
      line.remove_prefix(first);
      const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
      cells.emplace_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    return cells;
  }
  for (;;) {
    const std::size_t end = line.find(separator);
    cells.emplace_back(bare(line.substr(0, end)));
    if (end == string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

std::optional<double> number_of(string_view text) {
  double value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::size_t> SurveyTable::column(string_view name) const {
  const auto it = std::ranges::find(columns, name);
  if (it == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(it - columns.begin());
}

std::optional<SurveyTable> read_survey_table(Context& context, const LoadedFile& file,
                                             const std::vector<std::string>& columns) {
  SurveyTable table;
  for (const std::string& name : columns) table.columns.push_back(canonical(name));
  string_view bytes = file.bytes;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  std::uint32_t line = 0;
  char separator = 0;
  while (!bytes.empty()) {
    ++line;
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const string_view text = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    const string_view content = bare(text);
    if (content.empty() || content.starts_with('#')) continue;
    if (separator == 0) {
      separator = text.contains(';') ? ';' : text.contains(',') ? ',' : text.contains('\t') ? '\t' : ' ';
    }
    std::vector<std::string> cells = split(text, separator);
    if (separator == ';') take_decimal_commas(cells);
    if (table.columns.empty()) {
      if (std::ranges::any_of(cells, [](const std::string& c) { return number_of(c).has_value(); })) {
        context.problems.error_in(file.shown, line, "columns",
                                  "the table has no header: both orders of dip and dip direction are in use",
                                  "state columns = [\"dip_direction\", \"dip\"] in the survey, or add a header");
        return std::nullopt;
      }
      for (const std::string& cell : cells) table.columns.push_back(canonical(cell));
      continue;
    }
    const bool heading = table.rows.empty() && !columns.empty() &&
                         std::ranges::none_of(cells, [](const std::string& c) { return number_of(c).has_value(); });
    if (!heading) table.rows.push_back({line, std::move(cells)});
  }
  if (table.rows.empty()) {
    context.problems.error_in(file.shown, 1, "file", "holds no measurements", "add a line for each joint");
    return std::nullopt;
  }
  return table;
}

std::optional<double> cell_number(Context& context, const LoadedFile& file, const SurveyTable& table,
                                  const SurveyTable::Row& row, string_view name) {
  const auto at = table.column(name);
  if (!at || *at >= row.cells.size() || row.cells[*at].empty()) return std::nullopt;
  const auto value = number_of(row.cells[*at]);
  if (!value) {
    context.problems.error_in(file.shown, row.line, std::string{name},
                              fmt::format("\"{}\" is not a number", row.cells[*at].substr(0, 40)), "mend or empty it");
  }
  return value;
}

}  // namespace cleave::scene
