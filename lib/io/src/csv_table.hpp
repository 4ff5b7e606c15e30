#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/io/file.hpp"

namespace cleave::io {

/// A table of text cells with a header. Cells are trimmed and without their quotes.
struct CsvTable {
  struct Row {
    std::uint32_t line;  ///< on which it begins, from 1
    std::vector<std::string> cells;
  };
  std::vector<std::string> header;  ///< lower case, blanks and hyphens as underscores, without units
  std::vector<std::string> units;   ///< in brackets behind each name, as written; empty where none is stated
  std::uint32_t header_line = 0;
  char separator = ',';
  std::vector<Row> rows;
};

/// Lower case, blanks and hyphens as underscores.
[[nodiscard]] std::string column_name(std::string_view cell);

/// Comma or semicolon, found from the header (both outside quotes: an error). Quotes as in RFC 4180, also over line
/// ends. Blank lines and lines that begin with # are skipped; so is a byte order mark.
[[nodiscard]] std::expected<CsvTable, ReadError> parse_csv(std::string_view bytes, std::string_view name);

}  // namespace cleave::io
