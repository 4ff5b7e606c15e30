#include "cleave/core/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave {
namespace {

/// A unit weight stated for a density: divided by this.
constexpr double gravity = 9.81;

const std::vector<UnitKind>& kinds() {
  constexpr double per_radian = 180 / std::numbers::pi;
  static const std::vector<UnitKind> all{
      {"m", "75 mm", {{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"ft", 0.3048}, {"in", 0.0254}}},
      {"m2", "2 m2", {{"m2", 1}, {"cm2", 1e-4}, {"mm2", 1e-6}}},
      {"m3", "0.5 m3", {{"m3", 1}, {"l", 1e-3}, {"cm3", 1e-6}}},
      {"degrees", "35 deg", {{"deg", 1}, {"degrees", 1}, {"°", 1}, {"rad", per_radian}, {"gon", 0.9}}},
      {"Pa",
       "50 kPa",
       {{"Pa", 1},
        {"kPa", 1e3},
        {"MPa", 1e6},
        {"GPa", 1e9},
        {"bar", 1e5},
        {"N/mm2", 1e6},
        {"kN/m2", 1e3},
        {"psi", 6894.757293168361}}},
      {"Pa/m", "27 kPa/m", {{"Pa/m", 1}, {"kPa/m", 1e3}, {"MPa/m", 1e6}, {"kN/m3", 1e3}}},
      {"kg/m3",
       "2.7 t/m3",
       {{"kg/m3", 1},
        {"t/m3", 1e3},
        {"g/cm3", 1e3},
        {"kN/m3", 1e3 / gravity},
        {"N/m3", 1 / gravity},
        {"MN/m3", 1e6 / gravity}}},
      {"N/m3", "9.81 kN/m3", {{"N/m3", 1}, {"kN/m3", 1e3}, {"MN/m3", 1e6}}},
      {"N", "200 kN", {{"N", 1}, {"kN", 1e3}, {"MN", 1e6}, {"tf", 9806.65}}},
      {"N/m", "300 kN/m", {{"N/m", 1}, {"kN/m", 1e3}, {"MN/m", 1e6}, {"N/mm", 1e3}, {"kN/mm", 1e6}}},
      {"m/s2", "9.81 m/s2", {{"m/s2", 1}, {"g", 9.80665}}},
      {"m/s", "2 m/s", {{"m/s", 1}, {"mm/s", 1e-3}, {"cm/s", 1e-2}, {"km/h", 1 / 3.6}}},
      {"s", "20 ms", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}},
      {"Hz", "2 Hz", {{"Hz", 1}, {"kHz", 1e3}}},
      {"rad/s", "1 rad/s", {{"rad/s", 1}, {"deg/s", 1 / per_radian}}},
      {"1/m", "0.1 1/m", {{"1/m", 1}, {"m2/m3", 1}}},
      {"1/s", "0.1 1/s", {{"1/s", 1}}},
  };
  return all;
}

/// Without blanks at both ends, which names of columns have as underscores.
std::string_view between_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t_");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t_") - first + 1);
}

}  // namespace

const UnitKind* units_of(std::string_view unit) {
  const auto at = std::ranges::find(kinds(), unit, &UnitKind::unit);
  return at == kinds().end() ? nullptr : std::to_address(at);
}

const Unit* find_unit(std::string_view unit, std::string_view as_written) {
  const UnitKind* kind = units_of(unit);
  if (kind == nullptr) return nullptr;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 16> spellings{{{"metre", "m"},
                                                                                     {"metres", "m"},
                                                                                     {"meter", "m"},
                                                                                     {"meters", "m"},
                                                                                     {"feet", "ft"},
                                                                                     {"foot", "ft"},
                                                                                     {"inch", "in"},
                                                                                     {"deg.", "deg"},
                                                                                     {"degree", "deg"},
                                                                                     {"\u00ba", "deg"},
                                                                                     {"radian", "rad"},
                                                                                     {"radians", "rad"},
                                                                                     {"grad", "gon"},
                                                                                     {"grads", "gon"},
                                                                                     {"gradian", "gon"},
                                                                                     {"gradians", "gon"}}};
  std::string word = lower(as_written);
  for (const auto& [spelling, symbol] : spellings) {
    if (word == spelling) word = symbol;
  }
  const auto at = std::ranges::find_if(kind->units, [&](const Unit& u) { return lower(u.symbol) == word; });
  return at == kind->units.end() ? nullptr : std::to_address(at);
}

ColumnHead column_head(std::string_view cell) {
  cell = between_blanks(cell);
  if (cell.empty() || (cell.back() != ')' && cell.back() != ']')) return {cell, {}};
  const std::size_t open = cell.rfind(cell.back() == ')' ? '(' : '[');
  if (open == std::string_view::npos || open == 0) return {cell, {}};
  return {between_blanks(cell.substr(0, open)), between_blanks(cell.substr(open + 1, cell.size() - open - 2))};
}

double to_unit(double value, const Unit& of) {
  // 0.03 for "30 mm", not 30 times a rounded thousandth.
  const double inverse = std::round(1 / of.factor);
  if (of.factor < 1 && std::abs(inverse * of.factor - 1) < 1e-12) return value / inverse;
  return value * of.factor;
}

}  // namespace cleave
