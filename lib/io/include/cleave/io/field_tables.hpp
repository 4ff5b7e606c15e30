#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/io/file.hpp"

/// What all readers of tables in text share.
namespace cleave::io {

class LineReader;

/// Takes a table apart into rows and cells: trimmed, without their quotes. Quotes as in RFC 4180, also over line ends.
/// Blank lines and lines that begin with # are skipped; so is a byte order mark.
class CsvRows final {
 public:
  CsvRows(std::string_view bytes, std::string_view file);
  ~CsvRows();
  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  /// The line on which the next row begins; nothing at the end.
  [[nodiscard]] std::optional<std::string_view> next();
  /// The cells of the row that begins with `line`. A blank as the separator: any number of blanks and tabs.
  [[nodiscard]] std::expected<std::vector<std::string>, ReadError> cells(std::string_view line, char separator);
  /// Number of the line that was read last, from 1.
  [[nodiscard]] std::uint32_t line() const noexcept;

 private:
  [[nodiscard]] std::expected<std::string, ReadError> take_quoted(std::string_view& line);

  std::unique_ptr<LineReader> lines_;
};

/// The first of `separators` that stands in the line outside quotes; else the last of them.
[[nodiscard]] char separator_of(std::string_view line, std::string_view separators);

struct RowFault {
  std::string what, remedy;
};
/// A row with fewer cells than its table has columns, or with more that are not empty. `columns_are`: what says how
/// many there are.
[[nodiscard]] std::optional<RowFault> fault_of_row(const std::vector<std::string>& cells, std::size_t columns,
                                                   char separator, std::string_view columns_are = "the header has");

/// 40,5 as 40.5. False: it is no number with a decimal comma, and stays.
bool take_decimal_comma(std::string& cell);
/// For a cell that is no number.
[[nodiscard]] std::string remedy_of_number(std::string_view cell, char separator);

/// Angles without a unit, all small and not all whole, may be radians.
class AngleWatch final {
 public:
  void look_at(double inclination, double bearing);
  /// For the column of inclinations.
  [[nodiscard]] std::optional<std::string> note(std::string_view inclined) const;

 private:
  double largest_inclination_ = 0, largest_bearing_ = 0;
  bool any_broken_ = false;
};

}  // namespace cleave::io
