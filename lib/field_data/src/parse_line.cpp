#include "parse_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "cleave/core/text.hpp"
#include "parse_orientations.hpp"
#include "survey_rows.hpp"
#include "survey_table.hpp"

namespace cleave::scene {

using geometry::Vec3;

const KeyTable& line_keys() {
  static const KeyTable keys{
      .name = "scanline",
      .keys = {{"name", key::text(), "its number", "in the results"},
               {"trend", key::number(trend_rule), "", "degrees, of a straight line"},
               {"plunge", key::number(plunge_rule), "", "degrees below horizontal"},
               {"length", key::number(rule::length), "", "m"},
               {"points", key::points(), "", "`[[x, y, z], ...]` in m, of a bent line, instead of the three"},
               {"file", key::text(), required,
                "table with `distance` (m along the line) and, where measured, orientations (as above, or `alpha` and "
                "`beta` "
                "of an oriented core), and `length` of the trace with `ends` (0, 1, 2 of them seen; 2 where empty)"},
               {"columns", key::texts(), "[]", "names of the columns of a table without a header"},
               {"wrap", key::flag(), "false", "true: accept angles outside their range"},
               declination_key(),
               core_reference_key(),
               {"truncation", key::number(truncation_rule), "0", "m: shorter traces were not recorded"}}};
  return keys;
}

namespace {

/// Rows with a length, of the line that is read.
struct Lengths {
  std::size_t stated = 0, zero = 0, below = 0;
};

/// Where on the line the joint of a row is; one without a place would be lost.
std::optional<double> distance_of(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                  const SurveyTable::Row& row) {
  if (row.cells[*table.column("distance")].empty()) {
    context.problems.error_in(file.shown, row.line, "distance", "is empty",
                              "give metres along the line, or remove the row");
  }
  return cell_number(context, file, table, row, "distance");
}

/// Length of the trace that a row states, and how many of its ends were seen (column `ends`; none: both).
std::optional<survey::SeenLength> length_of(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                            const SurveyTable::Row& row, Length truncation, Lengths& lengths) {
  const auto length = cell_number(context, file, table, row, "length");
  const auto ends = cell_number(context, file, table, row, "ends");
  if (length && *length < 0) {
    context.problems.error_in(file.shown, row.line, "length", fmt::format("is {} m", *length),
                              "give the length that is seen, or leave it empty");
  }
  if (ends && *ends != 0 && *ends != 1 && *ends != 2) {
    context.problems.error_in(file.shown, row.line, "ends", fmt::format("is {}", *ends),
                              "give how many ends of the trace are seen: 0, 1 or 2");
    return {};
  }
  if (!length) return {};
  ++lengths.stated;
  if (*length == 0) ++lengths.zero;
  if (!(*length > 0)) return {};
  if (*length < truncation.si()) ++lengths.below;
  return survey::SeenLength{*length, static_cast<std::uint32_t>(ends.value_or(2))};
}

/// What counts for less than it seems to, of a line's lengths.
void note_lengths(InputContext& context, const LoadedFile& file, const SurveyTable& table, Length truncation,
                  const Lengths& lengths) {
  const auto note = [&](std::string what, std::string remedy) {
    context.problems.note_in(file.shown, 1, "length", std::move(what), std::move(remedy));
  };
  if (lengths.stated > 0 && !table.column("ends")) {
    note(fmt::format("there is no column ends: both ends of all {} traces are taken as seen, and the sizes as those of "
                     "whole traces",
                     lengths.stated),
         "add it with the number of ends seen, 0, 1 or 2; where all were seen whole, with 2");
  }
  if (lengths.zero > 0) {
    note(fmt::format("{} of {} are 0 and count as not measured", lengths.zero, lengths.stated),
         "give what is seen, or leave them empty");
  }
  if (lengths.below > 0) {
    note(fmt::format("{} of {} are below the truncation, {} m, and count for nothing in the laws of lengths and sizes",
                     lengths.below, lengths.stated, truncation.si()),
         "check truncation: the length below which no trace was recorded");
  }
}

/// Columns that are read.
std::initializer_list<std::string_view> line_columns() {
  static const std::initializer_list<std::string_view> all{"distance",      "length", "ends",  "dip",
                                                           "dip_direction", "strike", "trend", "plunge",
                                                           "alpha",         "beta",   "set",   "quantity"};
  return all;
}

/// Rows with the same measurements as an earlier one: a table that holds them twice has twice the joints. Of distances
/// alone many may be the same.
void note_repeated(InputContext& context, const LoadedFile& file, const SurveyTable& table) {
  std::map<std::string, std::uint32_t> seen;
  std::size_t repeated = 0;
  std::array<std::uint32_t, 2> first{};
  for (const SurveyTable::Row& row : table.rows) {
    std::string cells;
    std::size_t filled = 0;
    for (const std::string_view name : line_columns()) {
      const auto at = table.column(name);
      const std::string cell = at && *at < row.cells.size() ? row.cells[*at] : std::string{};
      filled += cell.empty() ? 0U : 1U;
      cells += cell + '\n';
    }
    if (filled < 2) continue;
    const auto [at, added] = seen.try_emplace(std::move(cells), row.line);
    if (added) continue;
    if (repeated++ == 0) first = {row.line, at->second};
  }
  if (repeated == 0) return;
  context.problems.note_in(
      file.shown, first[0], "row",
      fmt::format(
          "{} the measurements of an earlier one (this one those of line {}): each counts as a joint of its own",
          counted(repeated, "row repeats", "rows repeat"), first[1]),
      "remove them where the table holds them twice");
}

}  // namespace

void parse_line(InputContext& context, const TableReader& table, survey::SurveyInput& input) {
  survey::LineSurvey line;
  line.name = table.text("name").value_or(table.path());
  RowRules rules{.wrap = table.flag("wrap"), .declination = table.value("declination")};
  if (table.has("points")) {
    const auto points = table.points("points");
    if (!points) return;
    for (std::size_t i = 1; i < points->size(); ++i) {
      const Vec3 d = (*points)[i] - (*points)[i - 1];
      if (norm(d) > 0) line.pieces.emplace_back(normalized(d), norm(d));
    }
  } else {
    const auto trend = table.need_number("trend"), plunge = table.need_number("plunge");
    const auto length = table.need_number("length");
    if (!trend || !plunge || !length) return;
    line.pieces.emplace_back(line_of(context, *trend, *plunge), *length);
  }
  if (line.pieces.empty()) {
    table.error("points", "make a line without length", "give two different points or more");
    return;
  }
  if (!table.has("file")) table.missing("file", "add file = \"line.csv\" with a column distance");
  const auto file = context.file(table, "file");
  if (!file) return;
  // A line that meets no joint is data: it says how few there are.
  const auto data =
      read_survey_table(context, *file, table.texts("columns").value_or(std::vector<std::string>{}), true);
  if (!data) return;
  if (!data->column("distance")) {
    context.problems.error_in(file->shown, 1, "columns", "lacks the column distance", "give metres along the line");
    return;
  }
  if (!check_columns(context, *file, *data, line_columns(), "spacings follow from the distances") ||
      !check_halves(context, *file, *data)) {
    return;
  }
  note_radians(context, *file, *data);
  note_repeated(context, *file, *data);
  const bool core = has_core_angles(*data), oriented = core || has_orientation(*data);
  const bool has_lengths = data->column("length").has_value();
  if (table.has("reference") && !core) {
    table.error("reference", "belongs to a table with the columns alpha and beta", "remove it, or add them");
  }
  line.truncation = metres(table.number("truncation").value_or(0));
  std::size_t wrong = 0;
  Lengths lengths;
  for (const SurveyTable::Row& row : data->rows) {
    const std::size_t before = context.problems.errors();
    const auto at = distance_of(context, *file, *data, row);
    if (at && (*at < 0 || *at > line.length() * (1 + 1e-9))) {
      context.problems.error_in(file->shown, row.line, "distance",
                                fmt::format("is {} m, outside the line of {} m", *at, line.length()),
                                "correct it, or the line's length");
    }
    std::optional<Vec3> normal;
    if (at && core) {
      rules.core = parse_core(context, table, line.direction_at(*at));
      if (!rules.core) return;
    }
    if (at && oriented) normal = normal_of_row(context, *file, *data, row, rules);
    const std::size_t times = at ? quantity_of(context, *file, *data, row) : 0;
    const std::string set = set_of_row(context, *file, *data, row, "");
    const auto length =
        has_lengths && times > 0 ? length_of(context, *file, *data, row, line.truncation, lengths) : std::nullopt;
    for (std::size_t i = 0; i < times; ++i) {
      line.positions.push_back(*at);
      line.sets.push_back(set);
      if (has_lengths) line.lengths.push_back(length);
      // A joint without an orientation is one that the line meets.
      auto& joint = line.joints.emplace_back();
      if (!normal) continue;
      joint = input.orientations.size();
      input.orientations.push_back({*normal, set, line.direction_at(*at), std::nullopt});
    }
    if (too_many(context, *file, std::max(input.orientations.size(), line.positions.size()))) return;
    if (context.problems.errors() != before && ++wrong >= 20) return;
  }
  note_lengths(context, *file, *data, line.truncation, lengths);
  input.lines.push_back(std::move(line));
}

}  // namespace cleave::scene
