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
#include "cleave/io/field_tables.hpp"
#include "cleave/scene/file_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// In lower case, words joined by underscores.
std::string own_name(string_view name) {
  std::string word = lower(name);
  std::ranges::replace_if(word, [](char c) { return c == ' ' || c == '-'; }, '_');
  return word;
}

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
  std::string word = own_name(name);
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

std::optional<double> number_of(string_view text) {
  double value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// 40,5;100 as 40.5;100: where semicolons part the cells and no number of the row has a point.
void take_decimal_commas(std::vector<std::string>& cells) {
  const auto has_point = [](const std::string& c) { return c.contains('.') && number_of(c).has_value(); };
  if (std::ranges::any_of(cells, has_point)) return;
  for (std::string& cell : cells) io::take_decimal_comma(cell);
}

}  // namespace

std::optional<std::size_t> SurveyTable::column(string_view name) const {
  const auto it = std::ranges::find(columns, name);
  if (it == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(it - columns.begin());
}

namespace {

/// What stands before the header of tables that other programs write: "Version, 1", "Units, m", "Declination, 2.5".
/// `lengths`: the unit that it states for these.
bool is_preamble(InputContext& context, const LoadedFile& file, std::uint32_t line,
                 const std::vector<std::string>& cells, const Unit*& lengths) {
  const std::string word = lower(string_view{cells.front()}.substr(0, cells.front().find(':')));
  const bool known = word.starts_with("version") || word == "units" || word == "unit" || word == "declination";
  const std::size_t colon = cells.front().find(':');
  if (!known || (cells.size() != 2 && colon == std::string::npos)) return false;
  const std::string value{
      bare(cells.size() == 2 ? string_view{cells[1]} : string_view{cells.front()}.substr(colon + 1))};
  if (word.starts_with("unit")) lengths = find_unit("m", value);
  if (word.starts_with("unit") && lengths == nullptr && !lower(value).starts_with("met")) {
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

class SurveyTableReader final {
 public:
  SurveyTableReader(InputContext& context, const LoadedFile& file, bool may_be_empty)
      : context_{context}, file_{file}, may_be_empty_{may_be_empty} {}

  std::optional<SurveyTable> run(const std::vector<std::string>& columns) {
    columns_are_ = columns.empty() ? "the header has" : "`columns` has";
    if (!std::ranges::all_of(columns, [&](const std::string& name) { return add(1, name); })) return std::nullopt;
    io::CsvRows rows{file_.bytes, file_.shown};
    while (const auto text = rows.next()) {
      const std::uint32_t line = rows.line();
      if (table_.separator == 0) table_.separator = io::separator_of(*text, ";,\t ");
      auto cells = rows.cells(*text, table_.separator);
      if (!cells) {
        report_read_error(context_.problems, cells.error());
        return std::nullopt;
      }
      if (std::ranges::all_of(*cells, [](const std::string& c) { return c.empty(); })) continue;
      if (table_.separator == ';') take_decimal_commas(*cells);
      const Next next = table_.columns.empty() ? header(line, *cells) : row(line, *std::move(cells), !columns.empty());
      if (next == Next::fail) return std::nullopt;
      if (next == Next::end) break;
    }
    if (faults_ > 0) return std::nullopt;
    take_lengths();
    if (table_.rows.empty() && (!may_be_empty_ || table_.columns.empty())) {
      context_.problems.error_in(file_.shown, 1, "file", "holds no measurements", "add a line for each joint");
      return std::nullopt;
    }
    return std::move(table_);
  }

 private:
  enum class Next : std::uint8_t { more, end, fail };

  bool add(std::uint32_t line, string_view cell) {
    if (add_column(table_, cell)) return true;
    if (!is_utf8(cell)) {
      context_.problems.error_in(file_.shown, line, "columns",
                                 fmt::format("the column \"{}\" is not UTF-8 text", on_one_line(cell.substr(0, 40))),
                                 "save the table as UTF-8");
      return false;
    }
    context_.problems.error_in(
        file_.shown, line, "columns",
        fmt::format("the unit of column \"{}\" is not understood", on_one_line(cell.substr(0, 40))),
        fmt::format("state it in {}, or in a unit of that kind", unit_of(table_.columns.back())));
    return false;
  }

  static bool holds_numbers(const std::vector<std::string>& cells) {
    return std::ranges::any_of(cells, [](const std::string& c) { return number_of(c).has_value(); });
  }

  bool before_header(std::uint32_t line, const std::vector<std::string>& cells) {
    if (!is_preamble(context_, file_, line, cells, lengths_)) return false;
    preamble_ = true;
    table_.separator = 0;
    return true;
  }

  /// The unit above the table is that of all lengths that have none of their own.
  void take_lengths() {
    if (lengths_ == nullptr) return;
    for (std::size_t k = 0; k < table_.columns.size(); ++k) {
      if (unit_of(table_.columns[k]) == "m" && table_.units[k] == nullptr) table_.units[k] = lengths_;
    }
  }

  Next header(std::uint32_t line, const std::vector<std::string>& cells) {
    if (before_header(line, cells)) return Next::more;
    if (holds_numbers(cells)) {
      context_.problems.error_in(file_.shown, line, "columns",
                                 "the table has no header: both orders of dip and dip direction are in use",
                                 "state columns = [\"dip_direction\", \"dip\"] in the survey, or add a header");
      return Next::fail;
    }
    return std::ranges::all_of(cells, [&](const std::string& cell) { return add(line, cell); }) ? Next::more
                                                                                                : Next::fail;
  }

  Next row(std::uint32_t line, std::vector<std::string> cells, bool columns_stated) {
    // Behind the joints such files have a table of their sets.
    if (preamble_ && !table_.rows.empty() && !holds_numbers(cells)) {
      context_.problems.note_in(file_.shown, line, "file", "what follows the joints is not read", "");
      return Next::end;
    }
    if (table_.rows.empty() && columns_stated && before_header(line, cells)) return Next::more;
    if (table_.rows.empty() && columns_stated && !holds_numbers(cells)) return Next::more;  // a header all the same
    if (const auto fault = io::fault_of_row(cells, table_.columns.size(), table_.separator, columns_are_)) {
      context_.problems.error_in(file_.shown, line, "row", fault->what, fault->remedy);
      return ++faults_ < 20 ? Next::more : Next::fail;
    }
    table_.rows.push_back({line, std::move(cells)});
    return Next::more;
  }

  InputContext& context_;
  const LoadedFile& file_;
  bool may_be_empty_, preamble_ = false;
  string_view columns_are_;
  std::size_t faults_ = 0;
  const Unit* lengths_ = nullptr;  ///< stated above the header
  SurveyTable table_;
};

}  // namespace

std::optional<SurveyTable> read_survey_table(InputContext& context, const LoadedFile& file,
                                             const std::vector<std::string>& columns, bool may_be_empty) {
  return SurveyTableReader{context, file, may_be_empty}.run(columns);
}

namespace {

/// Some call the strike so.
void note_azimuth(InputContext& context, const LoadedFile& file, string_view head) {
  if (own_name(column_head(head).name) != "azimuth") return;
  context.problems.note_in(file.shown, 1, "columns",
                           fmt::format("\"{}\" is read as the dip direction", on_one_line(head.substr(0, 40))),
                           "where it is the strike, name it strike");
}

}  // namespace

bool check_columns(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                   std::initializer_list<string_view> read, string_view remedy) {
  std::string names;
  bool measures = false, good = true;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    if (std::ranges::find(read, table.columns[k]) != read.end()) {
      const std::size_t first = *table.column(table.columns[k]);
      if (first == k) note_azimuth(context, file, table.heads[k]);
      if (first == k) continue;
      context.problems.error_in(file.shown, 1, "columns",
                                fmt::format("{} comes twice: \"{}\" and \"{}\"", table.columns[k],
                                            on_one_line(string_view{table.heads[first]}.substr(0, 40)),
                                            on_one_line(string_view{table.heads[k]}.substr(0, 40))),
                                "remove one");
      good = false;
    }
    if (!good || table.heads[k].empty()) continue;
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", on_one_line(string_view{table.heads[k]}.substr(0, 40)));
    measures = measures || table.columns[k] == "length" || table.columns[k] == "ends" ||
               table.columns[k].starts_with("spacing");
  }
  if (good && !names.empty()) {
    context.problems.note_in(file.shown, 1, "columns", "not read: " + names,
                             measures ? std::string{remedy} : std::string{});
  }
  return good;
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
    context.problems.error_in(
        file.shown, row.line, std::string{name}, fmt::format("\"{}\" is not a number", row.cells[*at].substr(0, 40)),
        row.cells[*at].contains(',') ? io::remedy_of_number(row.cells[*at], table.separator) : "correct or empty it");
  }
  if (value && table.units[*at] != nullptr) return to_unit(*value, *table.units[*at]);
  return value;
}

}  // namespace cleave::scene
