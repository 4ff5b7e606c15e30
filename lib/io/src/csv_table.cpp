#include "csv_table.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/units.hpp"
#include "cleave/io/field_tables.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

class CsvReader final {
 public:
  CsvReader(std::string_view bytes, std::string_view file) : rows_{bytes, file}, file_{file} {}

  std::expected<CsvTable, ReadError> run() {
    bool has_header = false;
    while (const auto line = rows_.next()) {
      const std::uint32_t first_line = rows_.line();
      if (!has_header) {
        CLEAVE_CHECK(find_separator(*line));
        table_.header_line = first_line;
      }
      CLEAVE_TRY(std::vector<std::string> cells, rows_.cells(*line, table_.separator));
      if (!has_header) {
        for (std::string& cell : cells) {
          const ColumnHead head = column_head(cell);
          table_.units.emplace_back(head.unit);
          cell = column_name(head.name);
        }
        table_.header = std::move(cells);
        has_header = true;
      } else if (std::ranges::any_of(cells, [](const std::string& c) { return !c.empty(); })) {
        table_.rows.push_back({first_line, std::move(cells)});
      }
    }
    if (!has_header) {
      return std::unexpected(whole_file(ReadFault::empty, file_, "is empty", "give a table with a header line"));
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
      return std::unexpected(
          bad_header("the header has both commas and semicolons", "separate columns by one of them"));
    }
    if (!comma && !semicolon && line.contains('\t')) {
      return std::unexpected(bad_header("the header has tabs between its columns",
                                        "separate columns by commas or semicolons: save the table as CSV"));
    }
    table_.separator = semicolon ? ';' : ',';
    return {};
  }

  [[nodiscard]] ReadError bad_header(std::string what, std::string remedy) const {
    return {ReadFault::bad_columns, std::string{file_}, rows_.line(), {}, std::move(what), std::move(remedy)};
  }

  CsvRows rows_;
  std::string_view file_;
  CsvTable table_;
};

}  // namespace

std::string column_name(std::string_view cell) {
  std::string name = lower(trimmed(cell));
  std::ranges::replace(name, ' ', '_');
  std::ranges::replace(name, '-', '_');
  return name;
}

std::expected<CsvTable, ReadError> parse_csv(std::string_view bytes, std::string_view name) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return std::unexpected(whole_file(ReadFault::unknown_format, name, "is UTF-16 text", "save it as UTF-8"));
  }
  return CsvReader{bytes, name}.run();
}

}  // namespace cleave::io
