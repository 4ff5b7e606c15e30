#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/units.hpp"
#include "cleave/io/file.hpp"
#include "csv_table.hpp"

namespace cleave::io {

/// A column of a table of joints: first the name that we write, then what else is understood.
struct ColumnNames {
  std::string_view unit;  ///< that numbers are read in; empty: text
  std::array<std::string_view, 7> names;
};

/// Finds the columns of a table by their names and units, and reads its cells. Collects up to 20 problems.
class ColumnReader {
 public:
  static constexpr std::size_t most_problems = 20;
  /// What is to be said of a column: of one that is not known (its number in the table), and of a known one.
  using Remark = std::function<std::optional<std::string>(std::size_t)>;

  ColumnReader(const CsvTable& csv, std::string_view file, std::span<const ColumnNames> known)
      : csv_{csv}, file_{file}, known_{known}, place_(known.size()), unit_(known.size()) {}

  /// Notes come in the order of the columns, behind the one that says how they were read. False after a report: there
  /// is no header (`example` of one).
  bool find_columns(std::string_view example, const Remark& on_unknown, const Remark& on_known);
  [[nodiscard]] bool has(std::size_t column) const { return place_[column].has_value(); }
  /// As stated behind the name in the header.
  [[nodiscard]] const Unit* unit(std::size_t column) const { return unit_[column]; }
  [[nodiscard]] std::string_view name_of(std::size_t column) const { return known_[column].names[0]; }
  /// As if it were not there.
  void forget(std::size_t column) { place_[column].reset(); }

  [[nodiscard]] std::string_view cell(const CsvTable::Row& row, std::size_t column) const;
  /// Nothing for an empty cell, or after a problem was reported.
  std::optional<double> number(const CsvTable::Row& row, std::size_t column);
  /// An empty cell is reported.
  double required(const CsvTable::Row& row, std::size_t column);
  /// Of UTF-8, which is checked.
  std::string text(const CsvTable::Row& row, std::size_t column);
  /// False after a report: too few cells, or too many.
  bool has_all_cells(const CsvTable::Row& row);

  using Number = std::optional<std::uint32_t>;  ///< from 1
  void report(ReadFault fault, Number line, Number column, std::string what, std::string remedy);
  void problem(const CsvTable::Row& row, std::size_t column, ReadFault fault, std::string what, std::string remedy);
  void bad_header(std::string what, std::string remedy);
  [[nodiscard]] std::size_t problems() const { return problems_.size(); }
  [[nodiscard]] std::vector<ReadError> take_problems() { return std::move(problems_); }
  [[nodiscard]] std::vector<std::string>& notes() { return notes_; }
  [[nodiscard]] const CsvTable& csv() const { return csv_; }

 private:
  void take_unit(std::size_t column, std::string_view stated);

  const CsvTable& csv_;
  std::string_view file_;
  std::span<const ColumnNames> known_;
  std::vector<std::optional<std::size_t>> place_;
  std::vector<const Unit*> unit_;
  bool seen_comma_ = false, seen_point_ = false;
  std::vector<std::string> notes_;
  std::vector<ReadError> problems_;
};

/// Without the bytes of a workbook, which are refused.
[[nodiscard]] std::expected<CsvTable, std::vector<ReadError>> table_of_text(std::string_view bytes,
                                                                            std::string_view name);

}  // namespace cleave::io
