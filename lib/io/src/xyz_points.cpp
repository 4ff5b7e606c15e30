#include "xyz_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/units.hpp"
#include "cleave/io/field_tables.hpp"
#include "csv_table.hpp"
#include "height_limits.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using Cells = std::vector<std::string>;

constexpr std::array<std::string_view, 3> axis_names{"x", "y", "z"};
/// What else is understood.
constexpr std::array<std::array<std::string_view, 3>, 3> also_named{
    {{"easting", "east", "e"}, {"northing", "north", "n"}, {"elevation", "elev", "height"}}};

std::optional<std::size_t> axis_named(std::string_view name) {
  for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
    if (name == axis_names[axis] || std::ranges::find(also_named[axis], name) != also_named[axis].end()) return axis;
  }
  return std::nullopt;
}

/// What a cell of the header names, and its unit: behind the name in brackets, or after an underscore ("z_ft").
struct Head {
  std::string name;
  std::optional<std::size_t> axis;
  std::string unit;
};
Head head_of(std::string_view cell) {
  const ColumnHead head = column_head(cell);
  Head result{column_name(head.name), {}, std::string{head.unit}};
  result.axis = axis_named(result.name);
  const std::size_t at = result.name.rfind('_');
  if (result.axis || at == std::string::npos || !result.unit.empty()) return result;
  const std::string unit = result.name.substr(at + 1);
  const auto axis = axis_named(std::string_view{result.name}.substr(0, at));
  return axis && find_unit("m", unit) != nullptr ? Head{result.name, axis, unit} : result;
}

/// "z", "(ft)": blanks part the name from its unit too.
Cells with_units_joined(Cells cells) {
  Cells joined;
  for (std::string& cell : cells) {
    const bool is_unit = cell.starts_with('(') || cell.starts_with('[');
    if (is_unit && !joined.empty()) {
      joined.back() += cell;
    } else {
      joined.push_back(std::move(cell));
    }
  }
  return joined;
}

/// Cells of a first line such as "x,y,z" or "//X Y Elevation": all begin with a letter and none is a number.
bool are_names(const Cells& cells) {
  return std::ranges::all_of(cells, [](std::string_view cell) {
    if (cell.empty()) return true;
    while (cell.starts_with('/')) cell.remove_prefix(1);
    const char c = cell.empty() ? '/' : cell.front();
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '/';
    return letter && !number_of(cell) && !same_word(cell, "nan") && !same_word(cell, "inf");
  });
}

class PointReader final {
 public:
  PointReader(std::string_view bytes, std::string_view file, const HeightGridOptions& options)
      : rows_{bytes, file}, file_{file}, options_{options} {}

  std::expected<XyzPoints, ReadError> run() {
    bool is_first = true;
    while (const auto line = rows_.next()) {
      line_ = rows_.line();
      if (std::exchange(is_first, false)) {
        CLEAVE_TRY(const bool is_header, read_header(*line));
        if (is_header) continue;
      }
      CLEAVE_CHECK(read_row(line->substr(0, line->find('#'))));
    }
    if (points_.samples.empty()) {
      return std::unexpected(whole_file(ReadFault::empty, file_, "holds no height", "give lines of x y z"));
    }
    return std::move(points_);
  }

 private:
  [[nodiscard]] std::unexpected<ReadError> wrong(ReadFault fault, std::string what, std::string remedy) const {
    return std::unexpected(ReadError{fault, std::string{file_}, line_, {}, std::move(what), std::move(remedy)});
  }

  /// False where the line holds no names; it is the first row then.
  std::expected<bool, ReadError> read_header(std::string_view line) {
    line = trimmed(line.substr(0, line.find(" # ")));
    const char separator = separator_of(line, ";,\t ");
    CLEAVE_TRY(Cells cells, rows_.cells(line, separator));
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    cells = with_units_joined(std::move(cells));
    if (cells.empty() || !are_names(cells)) {
      // It is read once more as a row: a quoted cell that goes over the line is none of numbers.
      if (rows_.line() != line_) return wrong(ReadFault::bad_number, "holds a text over several lines", "give x, y, z");
      return false;
    }
    cells.front().erase(0, cells.front().find_first_not_of("/ "));
    columns_ = cells.size();
    by_tabs_ = separator == '\t';
    place_ = {};
    std::string understood, others;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const Head head = head_of(cells[c]);
      if (!head.axis) {
        if (!head.name.empty()) others += (others.empty() ? "" : ", ") + shown(cells[c]);
        continue;
      }
      CLEAVE_TRY(const std::string unit, take_column(*head.axis, c, head.unit));
      understood += fmt::format("{}{}", understood.empty() ? "" : ", ", axis_names[*head.axis]);
      if (head.name != axis_names[*head.axis]) understood += fmt::format(" (from {})", shown(head.name));
      understood += " in " + unit;
    }
    for (std::size_t axis = 0; axis < place_.size(); ++axis) {
      if (!place_[axis]) return missing(axis, others);
    }
    points_.notes.push_back("columns read: " + understood);
    if (!others.empty()) points_.notes.push_back("columns not used: " + others);
    return true;
  }

  [[nodiscard]] std::unexpected<ReadError> missing(std::size_t axis, const std::string& others) const {
    const std::string which = others.empty() ? "" : fmt::format("; not understood: {}", others);
    std::string remedy = fmt::format("name it {}, or one of {}", axis_names[axis], fmt::join(also_named[axis], ", "));
    if (axis == 2) remedy = "give heights above a level, which grow upwards, in a column z (or elevation, height)";
    return wrong(ReadFault::bad_columns, fmt::format("there is no column {}{}", axis_names[axis], which),
                 std::move(remedy));
  }

  /// The unit in which the column is read.
  std::expected<std::string, ReadError> take_column(std::size_t axis, std::size_t column, const std::string& stated) {
    if (place_[axis]) {
      return wrong(ReadFault::bad_columns, fmt::format("column {} comes twice", axis_names[axis]), "remove one");
    }
    place_[axis] = column;
    if (stated.empty()) return "m";
    unit_[axis] = find_unit("m", stated);
    if (unit_[axis] != nullptr) return std::string{unit_[axis]->symbol};
    return wrong(ReadFault::bad_columns,
                 fmt::format("the unit {} of column {} is not understood", shown(stated), axis_names[axis]),
                 "state it in m, or in another unit of length");
  }

  std::expected<void, ReadError> read_row(std::string_view line) {
    const char separator = separator_of(line, by_tabs_ ? ";,\t " : ";, ");
    CLEAVE_TRY(const Cells cells, rows_.cells(line, separator));
    const bool named = columns_.has_value();
    if (auto fault = fault_of_row(cells, columns_.value_or(3), separator,
                                  named ? "the header has" : "a table without a header has")) {
      const bool few = cells.size() < columns_.value_or(3);
      if (!named) {
        fault->remedy = few ? "give x, y and z on each line, in metres; with decimal commas part them by semicolons"
                            : "give x, y and z alone, or a first line with the names of all columns; with decimal "
                              "commas part them by semicolons";
      }
      return wrong(ReadFault::syntax, std::move(fault->what), std::move(fault->remedy));
    }
    std::array<double, 3> p{};
    for (std::size_t axis = 0; axis < p.size(); ++axis) {
      CLEAVE_TRY(p[axis], number(cells[place_[axis].value_or(axis)], axis, separator));
    }
    const bool none = options_.no_data && same_height(p[2], *options_.no_data);
    for (std::size_t axis = 0; axis < p.size(); ++axis) {
      if (unit_[axis] != nullptr) p[axis] = to_unit(p[axis], *unit_[axis]);
    }
    if (!(std::abs(p[0]) <= farthest && std::abs(p[1]) <= farthest && (none || std::abs(p[2]) <= farthest))) {
      return wrong(ReadFault::out_of_range, fmt::format("({}, {}, {}) is too far", p[0], p[1], p[2]),
                   "coordinates and heights reach from -1e9 to 1e9 m");
    }
    if (!none) points_.samples.push_back({{p[0], p[1], p[2]}, line_});
    return {};
  }

  /// A decimal comma where semicolons part the cells and no number of the table has a point.
  std::expected<double, ReadError> number(const std::string& cell, std::size_t axis, char separator) {
    std::string plain = cell;
    const bool point = cell.contains('.'), comma = separator == ';' && take_decimal_comma(plain);
    const auto value = number_of(plain);
    if (!value) {
      const bool parted = cell.find_first_of(" \t") != std::string::npos;
      return wrong(ReadFault::bad_number, fmt::format("{}: {}", axis_names[axis], value.error()),
                   parted ? "write nothing between thousands and one sign between numbers; with decimal commas part "
                            "them by semicolons"
                          : remedy_of_number(cell, separator));
    }
    if ((comma && seen_point_) || (point && seen_comma_)) {
      return wrong(
          ReadFault::bad_number,
          fmt::format("{}: {}: some numbers have a decimal comma, others a point", axis_names[axis], shown(cell)),
          "use one of them throughout");
    }
    seen_comma_ = seen_comma_ || comma;
    seen_point_ = seen_point_ || point;
    return *value;
  }

  CsvRows rows_;
  std::string_view file_;
  const HeightGridOptions& options_;
  std::uint32_t line_ = 0;
  std::optional<std::size_t> columns_;  ///< of the header
  bool by_tabs_ = false;                ///< tabs part the columns of the header: cells may hold blanks
  std::array<std::optional<std::size_t>, 3> place_{0, 1, 2};
  std::array<const Unit*, 3> unit_{};
  bool seen_comma_ = false, seen_point_ = false;
  XyzPoints points_;
};

}  // namespace

std::expected<XyzPoints, ReadError> read_xyz_points(std::string_view bytes, std::string_view name,
                                                    const HeightGridOptions& options) {
  return PointReader{bytes, name, options}.run();
}

}  // namespace cleave::io
