#include "column_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cleave/core/text.hpp"
#include "cleave/io/field_tables.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

/// What a cell of the header names, and its unit: behind the name in brackets, or after an underscore ("radius_mm").
struct Head {
  std::optional<std::size_t> column = {};
  std::string_view unit = {};
};
Head head_of(std::span<const ColumnNames> known, std::string_view cell, std::string_view unit) {
  const auto column_of = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto named = [&](const ColumnNames& k) { return std::ranges::find(k.names, name) != k.names.end(); };
    const auto at = name.empty() ? known.end() : std::ranges::find_if(known, named);
    return at == known.end() ? std::nullopt : std::optional{static_cast<std::size_t>(at - known.begin())};
  };
  if (const auto column = column_of(cell)) return {column, unit};
  const std::size_t at = cell.rfind('_');
  if (at == std::string_view::npos || !unit.empty()) return {};
  const auto column = column_of(cell.substr(0, at));
  if (!column || known[*column].unit.empty() || find_unit(known[*column].unit, cell.substr(at + 1)) == nullptr) {
    return {};
  }
  return {column, cell.substr(at + 1)};
}

}  // namespace

void ColumnReader::report(ReadFault fault, Number line, Number column, std::string what, std::string remedy) {
  if (problems_.size() >= most_problems) return;
  problems_.push_back({fault, std::string{file_}, line, column, std::move(what), std::move(remedy)});
}

void ColumnReader::problem(const CsvTable::Row& row, std::size_t column, ReadFault fault, std::string what,
                           std::string remedy) {
  report(fault, row.line, static_cast<std::uint32_t>(place_[column].value_or(0)) + 1, std::move(what),
         std::move(remedy));
}

void ColumnReader::bad_header(std::string what, std::string remedy) {
  report(ReadFault::bad_columns, csv_.header_line, {}, std::move(what), std::move(remedy));
}

void ColumnReader::take_unit(std::size_t column, std::string_view stated) {
  if (known_[column].unit.empty() || stated.empty()) return;
  unit_[column] = find_unit(known_[column].unit, stated);
  if (unit_[column] != nullptr) return;
  if (!is_utf8(stated)) {  // a sign of degrees in another encoding
    bad_header(fmt::format("the unit \"{}\" of column {} is not UTF-8 text", on_one_line(stated), name_of(column)),
               "save the table as UTF-8");
    return;
  }
  bad_header(fmt::format("the unit {} of column {} is not understood", shown(stated), name_of(column)),
             fmt::format("state it in {}, or in another unit of that kind", known_[column].unit));
}

bool ColumnReader::find_columns(std::string_view example, const Remark& on_unknown, const Remark& on_known) {
  if (std::ranges::any_of(csv_.header, [](const std::string& cell) { return number_of(cell).has_value(); })) {
    bad_header("the first line holds numbers where the names of the columns should stand",
               fmt::format("add a header such as {}", example));
    return false;
  }
  std::string understood;
  for (std::size_t c = 0; c < csv_.header.size(); ++c) {
    const std::string& cell = csv_.header[c];
    const auto [found, unit] = head_of(known_, cell, csv_.units[c]);
    if (!found) {
      if (cell.empty()) continue;
      if (auto note = on_unknown(c)) notes_.push_back(*std::move(note));
      continue;
    }
    std::optional<std::size_t>& place = place_[*found];
    if (place) bad_header(fmt::format("column {} comes twice", name_of(*found)), "remove one");
    place = c;
    take_unit(*found, unit);
    understood += fmt::format("{}{}", understood.empty() ? "" : ", ", name_of(*found));
    if (cell != name_of(*found)) understood += fmt::format(" (from {})", shown(cell));
    if (auto note = on_known(c)) notes_.push_back(*std::move(note));
    if (!known_[*found].unit.empty()) {
      understood += " in " + std::string{unit_[*found] != nullptr ? unit_[*found]->symbol : known_[*found].unit};
    }
  }
  notes_.insert(notes_.begin(), "columns read: " + understood);
  return true;
}

std::string_view ColumnReader::cell(const CsvTable::Row& row, std::size_t column) const {
  const std::optional<std::size_t> place = place_[column];
  return place && *place < row.cells.size() ? std::string_view{row.cells[*place]} : std::string_view{};
}

std::optional<double> ColumnReader::number(const CsvTable::Row& row, std::size_t column) {
  const std::string_view text = cell(row, column);
  if (text.empty()) return std::nullopt;
  std::string plain{text};
  const bool comma =
      csv_.separator == ';' && std::ranges::count(plain, ',') == 1 && plain.find('.') == std::string::npos;
  const bool point = plain.find('.') != std::string::npos;
  if (comma) std::ranges::replace(plain, ',', '.');
  if ((comma && seen_point_) || (point && seen_comma_)) {
    problem(row, column, ReadFault::bad_number,
            fmt::format("{} {}: some numbers have a decimal comma, others a point", name_of(column), shown(text)),
            "use one of them throughout");
    return std::nullopt;
  }
  seen_comma_ = seen_comma_ || comma;
  seen_point_ = seen_point_ || point;
  const auto value = number_of(plain);
  if (!value) {
    problem(row, column, ReadFault::bad_number, fmt::format("{}: {}", name_of(column), value.error()),
            remedy_of_number(text, csv_.separator));
    return std::nullopt;
  }
  const Unit* unit = unit_[column];
  return unit != nullptr ? to_unit(*value, *unit) : *value;
}

double ColumnReader::required(const CsvTable::Row& row, std::size_t column) {
  const std::size_t before = problems_.size();
  const std::optional<double> value = number(row, column);
  if (!value && problems_.size() == before) {
    problem(row, column, ReadFault::syntax, fmt::format("{} is empty", name_of(column)), "give a number");
  }
  return value.value_or(0);
}

std::string ColumnReader::text(const CsvTable::Row& row, std::size_t column) {
  std::string text{cell(row, column)};
  if (!is_utf8(text)) {
    problem(row, column, ReadFault::syntax, fmt::format("\"{}\" is not UTF-8 text", on_one_line(text)),
            "save the table as UTF-8");
  }
  return text;
}

bool ColumnReader::has_all_cells(const CsvTable::Row& row) {
  auto fault = fault_of_row(row.cells, csv_.header.size(), csv_.separator);
  if (fault) report(ReadFault::syntax, row.line, {}, std::move(fault->what), std::move(fault->remedy));
  return !fault;
}

std::expected<CsvTable, std::vector<ReadError>> table_of_text(std::string_view bytes, std::string_view name) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\xD0\xCF\x11\xE0")) {
    return std::unexpected(std::vector{
        whole_file(ReadFault::syntax, name, "is a workbook, not a table in text", "export the sheet as CSV")});
  }
  auto csv = parse_csv(bytes, name);
  if (!csv) return std::unexpected(std::vector{std::move(csv).error()});
  return *std::move(csv);
}

}  // namespace cleave::io
