#include "csv_table.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/units.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

std::string header_name(std::string_view cell) {
  std::string name = lower(trimmed(cell));
  std::ranges::replace(name, ' ', '_');
  std::ranges::replace(name, '-', '_');
  return name;
}

/// A cell in quotes may go over several lines.
bool holds_control(const std::string& cell) {
  if (!cell.contains('\n')) return has_control_characters(cell);
  std::string lines = cell;
  std::erase_if(lines, [](char c) { return c == '\n' || c == '\r'; });
  return has_control_characters(lines);
}

class CsvReader final {
 public:
  CsvReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<CsvTable, ReadError> run() {
    std::string_view line;
    bool has_header = false;
    while (lines_.next(line)) {
      if (const std::string_view text = trimmed(line); text.empty() || text.starts_with('#')) continue;
      if (!has_header) {
        CLEAVE_CHECK(find_separator(line));
        table_.header_line = lines_.number();
      }
      const std::uint32_t first_line = lines_.number();
      CLEAVE_TRY(std::vector<std::string> cells, split(line));
      if (!has_header) {
        for (std::string& cell : cells) {
          const ColumnHead head = column_head(cell);
          table_.units.emplace_back(head.unit);
          cell = header_name(head.name);
        }
        table_.header = std::move(cells);
        has_header = true;
      } else if (std::ranges::any_of(cells, [](const std::string& c) { return !c.empty(); })) {
        table_.rows.push_back({first_line, std::move(cells)});
      }
    }
    if (!has_header) {
      return std::unexpected(
          whole_file(ReadFault::empty, lines_.file(), "is empty", "give a table with a header line"));
    }
    return std::move(table_);
  }

 private:
  std::expected<void, ReadError> find_separator(std::string_view line) {
    bool quoted = false;
    bool comma = false;
    bool semicolon = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      comma = comma || (!quoted && c == ',');
      semicolon = semicolon || (!quoted && c == ';');
    }
    if (comma && semicolon) {
      return std::unexpected(lines_.error(ReadFault::bad_columns, "the header has both commas and semicolons",
                                          "separate columns by one of them"));
    }
    if (!comma && !semicolon && line.contains('\t')) {
      return std::unexpected(lines_.error(ReadFault::bad_columns, "the header has tabs between its columns",
                                          "separate columns by commas or semicolons: save the table as CSV"));
    }
    table_.separator = semicolon ? ';' : ',';
    return {};
  }

  std::expected<std::vector<std::string>, ReadError> split(std::string_view line) {
    std::vector<std::string> cells;
    while (true) {
      line = left_trimmed(line);
      std::string cell;
      if (line.starts_with('"')) {
        CLEAVE_TRY(cell, take_quoted(line));
        line = left_trimmed(line);
        if (!line.empty() && line.front() != table_.separator) {
          return std::unexpected(
              lines_.error(ReadFault::syntax, "text follows a closing quote", "double quotes inside quotes"));
        }
      } else {
        const std::string_view raw = line.substr(0, line.find(table_.separator));
        cell = trimmed(raw);
        line.remove_prefix(raw.size());
      }
      if (holds_control(cell)) {
        return std::unexpected(
            lines_.error(ReadFault::syntax, "a cell holds control characters", "save the table as plain text"));
      }
      // An apostrophe that keeps a spreadsheet from taking a text for a formula is no part of it.
      if (cell.starts_with('\'') && is_formula(std::string_view{cell}.substr(1))) cell.erase(0, 1);
      cells.push_back(std::move(cell));
      if (line.empty()) return cells;
      line.remove_prefix(1);
    }
  }

  [[nodiscard]] static std::string_view left_trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    return text;
  }

  std::expected<std::string, ReadError> take_quoted(std::string_view& line) {
    line.remove_prefix(1);
    std::string cell;
    while (true) {
      const std::size_t quote = line.find('"');
      if (quote == std::string_view::npos) {
        cell += line;
        cell += '\n';
        if (!lines_.next(line)) {
          return std::unexpected(lines_.error(ReadFault::truncated, "a quoted cell is not closed", "close the quotes"));
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

  LineReader lines_;
  CsvTable table_;
};

}  // namespace

std::expected<CsvTable, ReadError> parse_csv(std::string_view bytes, std::string_view name) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return std::unexpected(whole_file(ReadFault::unknown_format, name, "is UTF-16 text", "save it as UTF-8"));
  }
  return CsvReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
