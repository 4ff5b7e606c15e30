#include "survey_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "cleave/core/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/field_tables.hpp"

namespace cleave::scene {

using geometry::Vec3;
using std::string_view;

Vec3 line_of(const InputContext& context, double trend, double plunge) {
  return geometry::line_vector({geometry::Trend::degrees(trend + context.north), geometry::Plunge::degrees(plunge)});
}
Vec3 normal_of(const InputContext& context, double dip, double direction) {
  return geometry::upward_normal({Dip::degrees(dip), context.turned(direction)});
}

namespace {

/// Degrees of a row within [0, high], or any when the survey allows it: all that follows is periodic, and a dip beyond
/// its range turns the plane as it does on a compass (-35/400 is 35/220).
std::optional<double> angle(InputContext& context, const LoadedFile& file, const SurveyTable::Row& row,
                            string_view name, std::optional<double> value, double high, bool wrap, bool swapped) {
  if (!value) return std::nullopt;
  if (*value >= 0 && *value <= high) return value;
  if (wrap) return geometry::wrap_degrees(*value);
  context.problems.error_in(file.shown, row.line, std::string{name},
                            fmt::format("is {}, outside 0 to {} degrees", *value, high),
                            swapped ? "are dip and dip direction swapped? Then swap their names; else correct it, or "
                                      "write wrap = true"
                                    : "correct it, or write wrap = true");
  return std::nullopt;
}

/// Whether a row would be right if dip and direction were in the other order.
bool looks_swapped(std::optional<double> dip, std::optional<double> direction) {
  return dip && direction && *dip > 90 && *dip <= 360 && *direction >= 0 && *direction <= 90;
}

/// Tables may state an orientation twice, in two conventions; then both must say the same, within a degree and a half
/// where one is worked out from the other.
bool agree(InputContext& context, const LoadedFile& file, const SurveyTable::Row& row, string_view name, Vec3 one,
           Vec3 other, string_view first, string_view second) {
  constexpr double cosine = 0.99966;
  if (std::abs(dot(one, other)) >= cosine) return true;
  context.problems.error_in(file.shown, row.line, std::string{name},
                            fmt::format("{} and {} of this row are not the same plane", first, second),
                            "strike goes by the right-hand rule (dip direction - 90), trend and plunge are the pole's: "
                            "correct the row, or remove the columns of one convention");
  return false;
}

/// Core angles beside an orientation in space, which knows more of how the hole runs than a straight line does: they
/// may differ by ten degrees.
bool core_agrees(InputContext& context, const LoadedFile& file, const SurveyTable::Row& row, Vec3 in_core,
                 Vec3 stated) {
  constexpr double most_degrees = 10;
  const double apart = std::acos(std::min(1.0, std::abs(dot(in_core, stated)))) * 180 / std::numbers::pi;
  if (apart <= most_degrees) return true;
  const geometry::Attitude plane = geometry::attitude_of(in_core);
  context.problems.error_in(
      file.shown, row.line, "alpha",
      fmt::format("alpha and beta give the plane {:.1f}/{:05.1f} in this hole, {:.0f} degrees off the orientation that "
                  "the row states",
                  plane.dip.degrees(), plane.direction.degrees(), apart),
      "check trend, plunge and reference of the hole, and which end of the ellipse beta is measured to; or remove the "
      "columns of one convention");
  return false;
}

}  // namespace

namespace {

Vec3 across(Vec3 line, Vec3 towards) { return towards - dot(towards, line) * line; }

std::optional<Core> core_towards(Vec3 line, Vec3 towards) {
  const Vec3 off = across(line, towards);
  if (norm(off) < 1e-6) return std::nullopt;
  return Core{line, normalized(off)};
}

Vec3 upwards(Vec3 normal) { return normal.z < 0 ? -normal : normal; }

}  // namespace

std::optional<Core> core_of(Vec3 line, CoreReference side) {
  return core_towards(line, {0, 0, side == CoreReference::bottom ? -1.0 : 1.0});
}

std::optional<Core> core_of(const InputContext& context, Vec3 line, double azimuth) {
  return core_towards(line, line_of(context, azimuth, 0));
}

Vec3 normal_in_core(const Core& core, double alpha, double beta) {
  // Towards the ellipse's lower end: clockwise seen down the hole is the right-hand turn about it.
  const Vec3 end =
      geometry::cos_degrees(beta) * core.reference + geometry::sin_degrees(beta) * cross(core.down, core.reference);
  return upwards(geometry::sin_degrees(alpha) * core.down - geometry::cos_degrees(alpha) * end);
}

bool has_core_angles(const SurveyTable& table) {
  return table.column("alpha").has_value() && table.column("beta").has_value();
}

std::size_t quantity_of(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                        const SurveyTable::Row& row) {
  constexpr double most = 10'000;
  const auto value = cell_number(context, file, table, row, "quantity");
  if (!value) return 1;
  if (*value >= 0 && *value <= most && *value == std::floor(*value)) return static_cast<std::size_t>(*value);
  context.problems.error_in(file.shown, row.line, "quantity", fmt::format("is {}", *value),
                            fmt::format("give a whole number of like joints, 0 to {}", most));
  return 0;
}

namespace {

/// Whether the cells of the orientation in space are filled.
bool states_orientation(const SurveyTable& table, const SurveyTable::Row& row) {
  const auto filled = [&](string_view name) {
    const auto at = table.column(name);
    return at && !row.cells[*at].empty();
  };
  if (filled("trend") && filled("plunge")) return true;
  return filled("dip") && (filled("dip_direction") || filled("strike"));
}

std::optional<Vec3> normal_of_dip(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                  const SurveyTable::Row& row, const RowRules& rules) {
  bool swapped = false;
  const auto plain = [&](string_view name) { return plain_number(table, row, name); };
  const auto value = [&](string_view name, double high) {
    return angle(context, file, row, name, cell_number(context, file, table, row, name), high, rules.wrap, swapped);
  };
  const bool by_strike = !table.column("dip_direction") || row.cells[*table.column("dip_direction")].empty();
  if (!rules.wrap) swapped = looks_swapped(plain("dip"), plain(by_strike ? "strike" : "dip_direction"));
  const auto dip = value("dip", 90), strike = value("strike", 360);
  auto direction = by_strike ? strike : value("dip_direction", 360);
  if (!dip || !direction) return std::nullopt;
  if (by_strike) {
    *direction = geometry::wrap_degrees(*direction + 90);
  } else if (strike && std::abs(std::remainder(*strike + 90 - *direction, 360)) > 1.5) {
    // Of directions, not of planes: near level planes would always agree.
    context.problems.error_in(
        file.shown, row.line, "strike",
        fmt::format("{} does not belong to dip_direction {} by the right-hand rule (dip direction "
                    "- 90)",
                    *strike, *direction),
        "correct the row, or remove one of the two columns");
    return std::nullopt;
  }
  return upwards(normal_of(context, *dip, *direction + rules.declination));
}

}  // namespace

std::optional<Vec3> normal_of_row(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                  const SurveyTable::Row& row, const RowRules& rules) {
  const auto value = [&](string_view name, double high) {
    return angle(context, file, row, name, cell_number(context, file, table, row, name), high, rules.wrap, false);
  };
  if (rules.core && has_core_angles(table)) {
    const auto alpha = value("alpha", 90), beta = value("beta", 360);
    if (!alpha || !beta) return std::nullopt;
    const Vec3 normal = normal_in_core(*rules.core, *alpha, *beta);
    if (!has_orientation(table) || !states_orientation(table, row)) return normal;
    RowRules in_space = rules;
    in_space.core.reset();
    const auto stated = normal_of_row(context, file, table, row, in_space);
    if (!stated || !core_agrees(context, file, row, normal, *stated)) return std::nullopt;
    return normal;
  }
  const auto filled = [&](string_view name) {
    const auto at = table.column(name);
    return at && !row.cells[*at].empty();
  };
  const bool dips = filled("dip") && (filled("dip_direction") || filled("strike"));
  const bool poles = table.column("trend") && table.column("plunge");
  if (!poles || (dips && !filled("trend") && !filled("plunge"))) {
    return normal_of_dip(context, file, table, row, rules);
  }
  const auto trend = value("trend", 360), plunge = value("plunge", 90);
  if (!trend || !plunge) return std::nullopt;
  const Vec3 normal = upwards(line_of(context, *trend + rules.declination, *plunge));
  if (!dips) return normal;
  const auto dipping = normal_of_dip(context, file, table, row, rules);
  if (!dipping || !agree(context, file, row, "trend", normal, *dipping, "trend and plunge",
                         filled("dip_direction") ? "dip and dip_direction" : "dip and strike")) {
    return std::nullopt;
  }
  return normal;
}

void note_radians(InputContext& context, const LoadedFile& file, const SurveyTable& table) {
  for (const auto& [inclined, bearing] : std::array<std::pair<string_view, string_view>, 4>{
           {{"dip", "dip_direction"}, {"dip", "strike"}, {"plunge", "trend"}, {"alpha", "beta"}}}) {
    const auto first = table.column(inclined), second = table.column(bearing);
    if (!first || !second || table.units[*first] != nullptr || table.units[*second] != nullptr) continue;
    io::AngleWatch angles;
    for (const SurveyTable::Row& row : table.rows) {
      const auto one = plain_number(table, row, inclined), other = plain_number(table, row, bearing);
      if (one && other) angles.look_at(*one, *other);
    }
    if (auto note = angles.note(inclined)) {
      context.problems.note_in(file.shown, 1, "columns", *std::move(note), "");
      return;
    }
  }
}

bool has_orientation(const SurveyTable& table) {
  return (table.column("trend") && table.column("plunge")) ||
         (table.column("dip") && (table.column("dip_direction") || table.column("strike")));
}

namespace {

/// Rows in which one cell of the two of an orientation is empty: such a joint has none.
void note_half_rows(InputContext& context, const LoadedFile& file, const SurveyTable& table) {
  using Pair = std::pair<string_view, string_view>;
  const Pair one = has_core_angles(table)                            ? Pair{"alpha", "beta"}
                   : table.column("trend") && table.column("plunge") ? Pair{"plunge", "trend"}
                   : table.column("dip_direction")                   ? Pair{"dip", "dip_direction"}
                                                                     : Pair{"dip", "strike"};
  const auto first = table.column(one.first), second = table.column(one.second);
  if (!first || !second) return;
  const auto half = [&](const SurveyTable::Row& row) {
    return row.cells[*first].empty() != row.cells[*second].empty();
  };
  const auto at = std::ranges::find_if(table.rows, half);
  if (at == table.rows.end()) return;
  context.problems.note_in(file.shown, at->line, std::string{one.first},
                           fmt::format("{} rows from here on have {} or {} alone: their joints have no orientation",
                                       std::ranges::count_if(table.rows, half), one.first, one.second),
                           "");
}

}  // namespace

bool check_halves(InputContext& context, const LoadedFile& file, const SurveyTable& table) {
  const auto has = [&](string_view name) { return table.column(name).has_value(); };
  const auto head = [&](string_view name) {
    const std::string written = on_one_line(string_view{table.heads[*table.column(name)]}.substr(0, 40));
    return written == name ? written : fmt::format("{} (\"{}\")", name, written);
  };
  const bool whole = has_orientation(table) || has_core_angles(table);
  for (const auto& [one, other, missing] : std::array<std::array<string_view, 3>, 7>{
           {{"dip", has("strike") ? "strike" : "dip_direction", "dip_direction or strike"},
            {"dip_direction", "dip", "dip"},
            {"strike", "dip", "dip"},
            {"trend", "plunge", "plunge"},
            {"plunge", "trend", "trend"},
            {"alpha", "beta", "beta"},
            {"beta", "alpha", "alpha"}}}) {
    if (!has(one) || has(other)) continue;
    if (!whole) {
      context.problems.error_in(file.shown, 1, "columns",
                                fmt::format("lacks the columns of an orientation: {} without {}", head(one), missing),
                                fmt::format("add {}, or remove {}: the joints then have no orientation", missing, one));
      return false;
    }
    context.problems.note_in(file.shown, 1, "columns",
                             fmt::format("{} is not used: there is no {}", head(one), missing), "");
  }
  note_half_rows(context, file, table);
  return true;
}

std::string set_of_row(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                       const SurveyTable::Row& row, const std::string& otherwise) {
  const auto at = table.column("set");
  if (!at || *at >= row.cells.size() || row.cells[*at].empty()) return otherwise;
  const std::string& name = row.cells[*at];
  if (!is_utf8(name)) {
    context.problems.error_in(file.shown, row.line, "set", fmt::format("\"{}\" is not UTF-8 text", on_one_line(name)),
                              "save the table as UTF-8");
  }
  if (has_control_characters(name)) {
    context.problems.error_in(file.shown, row.line, "set", "holds a line end or control characters",
                              "give the set a name on one line");
  }
  return name;
}

}  // namespace cleave::scene
