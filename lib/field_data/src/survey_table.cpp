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
  constexpr std::array<std::pair<string_view, string_view>, 25> aliases{{{"dipdir", "dip_direction"},
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
                                                                         {"terminations", "ends"},
                                                                         {"set_id", "set"},
                                                                         {"joint_set_id", "set"},
                                                                         {"easting", "x"},
                                                                         {"northing", "y"},
                                                                         {"elevation", "z"},
                                                                         {"qty", "quantity"},
                                                                         {"traverse_id", "traverse"},
                                                                         {"pole_trend", "trend"},
                                                                         {"pole_plunge", "plunge"},
                                                                         {"strike_right", "strike"}}};
  std::string word = lower(name);
  std::ranges::replace_if(word, [](char c) { return c == ' ' || c == '-'; }, '_');
  for (const auto& [alias, own] : aliases) {
    if (word == alias) return std::string{own};
  }
  return word;
}

/// The unit a column is read in; empty: it has none.
string_view unit_of(string_view column) {
  constexpr std::array<std::pair<string_view, string_view>, 12> units{{{"dip", "degrees"},
                                                                       {"dip_direction", "degrees"},
                                                                       {"strike", "degrees"},
                                                                       {"trend", "degrees"},
                                                                       {"plunge", "degrees"},
                                                                       {"alpha", "degrees"},
                                                                       {"beta", "degrees"},
                                                                       {"distance", "m"},
                                                                       {"length", "m"},
                                                                       {"x", "m"},
                                                                       {"y", "m"},
                                                                       {"z", "m"}}};
  for (const auto& [name, unit] : units) {
    if (column == name) return unit;
  }
  return {};
}

/// A column of the header; false when its unit is not one of its kind.
bool add_column(SurveyTable& table, string_view cell) {
  const ColumnHead head = column_head(cell);
  table.columns.push_back(canonical(head.name));
  table.heads.emplace_back(cell);
  const string_view own = unit_of(table.columns.back());
  const std::string stated = lower(head.unit);
  // "X (Easting)" says which way the axis goes, no unit.
  if (own == "m" && (stated == "easting" || stated == "northing" || stated == "elevation")) {
    table.units.push_back(nullptr);
    return true;
  }
  table.units.push_back(own.empty() || head.unit.empty() ? nullptr : find_unit(own, head.unit));
  return own.empty() || head.unit.empty() || table.units.back() != nullptr;
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

namespace {

/// What stands before the header of tables that other programs write: "Version, 1", "Units, m", "Declination, 2.5".
bool is_preamble(InputContext& context, const LoadedFile& file, std::uint32_t line,
                 const std::vector<std::string>& cells) {
  const std::string word = lower(string_view{cells.front()}.substr(0, cells.front().find(':')));
  const bool known = word.starts_with("version") || word == "units" || word == "unit" || word == "declination";
  const std::size_t colon = cells.front().find(':');
  if (!known || (cells.size() != 2 && colon == std::string::npos)) return false;
  const std::string value{
      bare(cells.size() == 2 ? string_view{cells[1]} : string_view{cells.front()}.substr(colon + 1))};
  if (word.starts_with("unit") && find_unit("m", value) == nullptr && !lower(value).starts_with("met")) {
    context.problems.error_in(file.shown, line, "units", fmt::format("are \"{}\"", value.substr(0, 40)),
                              "convert the table to metres, or state the units behind the columns' names");
  }
  if (const auto degrees = number_of(value); word == "declination" && degrees && *degrees != 0) {
    context.problems.note_in(file.shown, line, "declination",
                             fmt::format("the file names {} degrees, which are not added to its directions", *degrees),
                             "write declination in the survey where they are from magnetic north");
  }
  return true;
}

}  // namespace

std::optional<SurveyTable> read_survey_table(InputContext& context, const LoadedFile& file,
                                             const std::vector<std::string>& columns, bool may_be_empty) {
  SurveyTable table;
  const auto add = [&](std::uint32_t line, string_view cell) {
    if (add_column(table, cell)) return true;
    context.problems.error_in(file.shown, line, "columns",
                              fmt::format("the unit of column \"{}\" is not understood", cell.substr(0, 40)),
                              fmt::format("state it in {}, or in a unit of that kind", unit_of(table.columns.back())));
    return false;
  };
  for (const std::string& name : columns) {
    if (!add(1, name)) return std::nullopt;
  }
  string_view bytes = file.bytes;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  std::uint32_t line = 0;
  char separator = 0;
  bool preamble = false;
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
    if (std::ranges::any_of(cells, [](const std::string& c) { return has_control_characters(c); })) {
      context.problems.error_in(file.shown, line, "file", "holds control characters", "save the table as plain text");
      return std::nullopt;
    }
    if (separator == ';') take_decimal_commas(cells);
    if (table.columns.empty() && is_preamble(context, file, line, cells)) {
      preamble = true;
      separator = 0;
      continue;
    }
    if (table.columns.empty()) {
      if (std::ranges::any_of(cells, [](const std::string& c) { return number_of(c).has_value(); })) {
        context.problems.error_in(file.shown, line, "columns",
                                  "the table has no header: both orders of dip and dip direction are in use",
                                  "state columns = [\"dip_direction\", \"dip\"] in the survey, or add a header");
        return std::nullopt;
      }
      for (const std::string& cell : cells) {
        if (!add(line, cell)) return std::nullopt;
      }
      continue;
    }
    const bool heading = table.rows.empty() && !columns.empty() &&
                         std::ranges::none_of(cells, [](const std::string& c) { return number_of(c).has_value(); });
    // Behind the joints such files have a table of their sets.
    if (preamble && !table.rows.empty() &&
        std::ranges::none_of(cells, [](const std::string& c) { return number_of(c).has_value(); })) {
      context.problems.note_in(file.shown, line, "file", "what follows the joints is not read", "");
      break;
    }
    if (!heading) table.rows.push_back({line, std::move(cells)});
  }
  if (table.rows.empty() && (!may_be_empty || table.columns.empty())) {
    context.problems.error_in(file.shown, 1, "file", "holds no measurements", "add a line for each joint");
    return std::nullopt;
  }
  return table;
}

void note_unread_columns(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                         std::initializer_list<string_view> read, string_view remedy) {
  std::string names;
  bool measures = false;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    if (std::ranges::find(read, table.columns[k]) != read.end() || table.heads[k].empty()) continue;
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", table.heads[k].substr(0, 40));
    measures = measures || table.columns[k] == "length" || table.columns[k] == "ends" ||
               table.columns[k].starts_with("spacing");
  }
  if (names.empty()) return;
  context.problems.note_in(file.shown, 1, "columns", "not read: " + names,
                           measures ? std::string{remedy} : std::string{});
}

std::optional<double> plain_number(const SurveyTable& table, const SurveyTable::Row& row, string_view name) {
  const auto at = table.column(name);
  if (!at || *at >= row.cells.size()) return std::nullopt;
  return number_of(row.cells[*at]);
}

std::optional<double> cell_number(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                  const SurveyTable::Row& row, string_view name) {
  const auto at = table.column(name);
  if (!at || *at >= row.cells.size() || row.cells[*at].empty()) return std::nullopt;
  const auto value = number_of(row.cells[*at]);
  if (!value) {
    context.problems.error_in(file.shown, row.line, std::string{name},
                              fmt::format("\"{}\" is not a number", row.cells[*at].substr(0, 40)),
                              "correct or empty it");
  }
  if (value && table.units[*at] != nullptr) return to_unit(*value, *table.units[*at]);
  return value;
}

}  // namespace cleave::scene
