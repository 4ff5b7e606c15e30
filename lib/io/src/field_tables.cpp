#include "cleave/io/field_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

/// A cell in quotes may go over several lines.
bool holds_control(const std::string& cell) {
  if (!cell.contains('\n')) return has_control_characters(cell);
  std::string lines = cell;
  std::erase_if(lines, [](char c) { return c == '\n' || c == '\r'; });
  return has_control_characters(lines);
}

/// Without the blanks before it that are no separators.
std::string_view left_trimmed(std::string_view text, char separator) {
  while (!text.empty() && is_blank(text.front()) && (separator != '\t' || text.front() != '\t')) text.remove_prefix(1);
  return text;
}

}  // namespace

CsvRows::CsvRows(std::string_view bytes, std::string_view file)
    : lines_{std::make_unique<LineReader>(without_bom(bytes), file)} {}
CsvRows::~CsvRows() = default;

std::uint32_t CsvRows::line() const noexcept { return lines_->number(); }

std::optional<std::string_view> CsvRows::next() {
  std::string_view line;
  while (lines_->next(line)) {
    if (const std::string_view text = trimmed(line); !text.empty() && !text.starts_with('#')) return line;
  }
  return std::nullopt;
}

std::expected<std::vector<std::string>, ReadError> CsvRows::cells(std::string_view line, char separator) {
  const bool by_blanks = separator == ' ';
  std::vector<std::string> cells;
  while (true) {
    line = left_trimmed(line, separator);
    if (by_blanks && line.empty()) return cells;
    std::string cell;
    if (line.starts_with('"')) {
      CLEAVE_TRY(cell, take_quoted(line));
      if (!by_blanks) line = left_trimmed(line, separator);
      if (!line.empty() && line.front() != separator && !(by_blanks && is_blank(line.front()))) {
        return std::unexpected(
            lines_->error(ReadFault::syntax, "text follows a closing quote", "double quotes inside quotes"));
      }
    } else {
      const std::string_view raw = line.substr(0, by_blanks ? line.find_first_of(" \t\r\v\f") : line.find(separator));
      cell = trimmed(raw);
      line.remove_prefix(raw.size());
    }
    if (holds_control(cell)) {
      return std::unexpected(
          lines_->error(ReadFault::syntax, "a cell holds control characters", "save the table as plain text"));
    }
    // An apostrophe that keeps a spreadsheet from taking a text for a formula is no part of it.
    if (cell.starts_with('\'') && is_formula(std::string_view{cell}.substr(1))) cell.erase(0, 1);
    cells.push_back(std::move(cell));
    if (line.empty()) return cells;
    line.remove_prefix(1);
  }
}

std::expected<std::string, ReadError> CsvRows::take_quoted(std::string_view& line) {
  line.remove_prefix(1);
  std::string cell;
  while (true) {
    const std::size_t quote = line.find('"');
    if (quote == std::string_view::npos) {
      cell += line;
      cell += '\n';
      if (!lines_->next(line)) {
        return std::unexpected(lines_->error(ReadFault::truncated, "a quoted cell is not closed", "close the quotes"));
      }
      continue;
    }
    cell += line.substr(0, quote);
    line.remove_prefix(quote + 1);
    if (!line.starts_with('"')) break;
    cell += '"';
    line.remove_prefix(1);
  }
  return std::string{trimmed(cell)};
}

char separator_of(std::string_view line, std::string_view separators) {
  for (const char separator : separators) {
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (!quoted && c == separator) return separator;
    }
  }
  return separators.back();
}

std::optional<RowFault> fault_of_row(const std::vector<std::string>& cells, std::size_t columns, char separator,
                                     std::string_view columns_are) {
  const bool too_long =
      cells.size() > columns && std::any_of(cells.begin() + static_cast<std::ptrdiff_t>(columns), cells.end(),
                                            [](const std::string& c) { return !c.empty(); });
  if (!too_long && cells.size() >= columns) return std::nullopt;
  return RowFault{
      fmt::format("{} cells, {} {}", cells.size(), columns_are, columns),
      separator == ',' ? "give every column; with decimal commas separate columns by semicolons" : "give every column"};
}

bool take_decimal_comma(std::string& cell) {
  const std::size_t comma = cell.find(',');
  if (comma == std::string::npos || cell.find_first_not_of("+-0123456789,eE") != std::string::npos) return false;
  if (cell.find(',', comma + 1) != std::string::npos) return false;
  cell[comma] = '.';
  return true;
}

std::string remedy_of_number(std::string_view cell, char separator) {
  if (!cell.contains(',')) return "give a number";
  return separator == ';' ? "use decimal points, or decimal commas, throughout and nothing between thousands"
                          : "write a decimal point; with decimal commas separate columns by semicolons";
}

void AngleWatch::look_at(double inclination, double bearing) {
  largest_inclination_ = std::max(largest_inclination_, inclination);
  largest_bearing_ = std::max(largest_bearing_, bearing);
  any_broken_ = any_broken_ || std::round(inclination) != inclination || std::round(bearing) != bearing;
}

std::optional<std::string> AngleWatch::note(std::string_view inclined) const {
  constexpr double right_angle = 1.571, whole_turn = 6.284;
  if (!any_broken_ || largest_inclination_ > right_angle || largest_bearing_ > whole_turn) return std::nullopt;
  return fmt::format(
      "no {0} is above {1} and no direction above {2}, in degrees: if they are meant in radians, say so in the names "
      "of the columns, as in \"{0} (rad)\"",
      inclined, largest_inclination_, largest_bearing_);
}

}  // namespace cleave::io
