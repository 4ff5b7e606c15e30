#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/units.hpp"
#include "cleave/scene/common_keys.hpp"

namespace cleave::scene {

/// A table of field data: comma, semicolon, tab or blank separated, with a header, or with the columns that the survey
/// names; cells as io::CsvRows takes them.
struct SurveyTable {
  struct Row {
    std::uint32_t line;
    std::vector<std::string> cells;
  };
  std::vector<std::string> columns;  ///< lower case, aliases replaced, without units
  std::vector<std::string> heads;    ///< as they are written
  std::vector<const Unit*> units;    ///< behind each name in brackets; null: in that of the column
  std::vector<Row> rows;
  char separator = 0;

  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const;
};

/// `columns`: from the survey; empty: the first line is the header. Reports what is wrong.
[[nodiscard]] std::optional<SurveyTable> read_survey_table(InputContext& context, const LoadedFile& file,
                                                           const std::vector<std::string>& columns,
                                                           bool may_be_empty = false);

/// Reports columns of `read` that come twice (then false), and notes the columns that are none of these; `remedy`:
/// where trace lengths or spacings are among them.
[[nodiscard]] bool check_columns(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                 std::initializer_list<std::string_view> read, std::string_view remedy);

/// A number of a cell; nothing when the cell is empty; reported when it is no number.
[[nodiscard]] std::optional<double> cell_number(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                                const SurveyTable::Row& row, std::string_view name);

/// The same; nothing, without a word, when it is no number.
[[nodiscard]] std::optional<double> plain_number(const SurveyTable& table, const SurveyTable::Row& row,
                                                 std::string_view name);

}  // namespace cleave::scene
