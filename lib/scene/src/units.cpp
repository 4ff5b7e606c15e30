#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <numbers>

#include "keys.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

struct Unit {
  string_view symbol;
  double factor;  ///< to the unit of the rule
};

/// Units of one kind of quantity, by the unit in which rules of it are stated.
struct Kind {
  string_view unit;  ///< as in NumberRule, without what follows a comma
  string_view example;
  std::vector<Unit> units;
};

/// A unit weight stated for a density: divided by this.
constexpr double gravity = 9.81;

const std::vector<Kind>& kinds() {
  constexpr double per_radian = 180 / std::numbers::pi;
  static const std::vector<Kind> all{
      {" m", "75 mm", {{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"ft", 0.3048}, {"in", 0.0254}}},
      {" m2", "2 m2", {{"m2", 1}, {"cm2", 1e-4}, {"mm2", 1e-6}}},
      {" m3", "0.5 m3", {{"m3", 1}, {"l", 1e-3}, {"cm3", 1e-6}}},
      {" degrees", "35 deg", {{"deg", 1}, {"degrees", 1}, {"°", 1}, {"rad", per_radian}}},
      {" Pa",
       "50 kPa",
       {{"Pa", 1},
        {"kPa", 1e3},
        {"MPa", 1e6},
        {"GPa", 1e9},
        {"bar", 1e5},
        {"N/mm2", 1e6},
        {"kN/m2", 1e3},
        {"psi", 6894.757293168361}}},
      {" Pa/m", "27 kPa/m", {{"Pa/m", 1}, {"kPa/m", 1e3}, {"MPa/m", 1e6}, {"kN/m3", 1e3}}},
      {" kg/m3",
       "2.7 t/m3",
       {{"kg/m3", 1},
        {"t/m3", 1e3},
        {"g/cm3", 1e3},
        {"kN/m3", 1e3 / gravity},
        {"N/m3", 1 / gravity},
        {"MN/m3", 1e6 / gravity}}},
      {" N/m3", "9.81 kN/m3", {{"N/m3", 1}, {"kN/m3", 1e3}, {"MN/m3", 1e6}}},
      {" N", "200 kN", {{"N", 1}, {"kN", 1e3}, {"MN", 1e6}, {"tf", 9806.65}}},
      {" N/m", "300 kN/m", {{"N/m", 1}, {"kN/m", 1e3}, {"MN/m", 1e6}, {"N/mm", 1e3}, {"kN/mm", 1e6}}},
      {" m/s2", "9.81 m/s2", {{"m/s2", 1}, {"g", 9.80665}}},
      {" m/s", "2 m/s", {{"m/s", 1}, {"mm/s", 1e-3}, {"cm/s", 1e-2}, {"km/h", 1 / 3.6}}},
      {" s", "20 ms", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}},
      {" Hz", "2 Hz", {{"Hz", 1}, {"kHz", 1e3}}},
      {" rad/s", "1 rad/s", {{"rad/s", 1}, {"deg/s", 1 / per_radian}}},
      {" 1/m", "0.1 1/m", {{"1/m", 1}, {"m2/m3", 1}}},
      {" 1/s", "0.1 1/s", {{"1/s", 1}}},
  };
  return all;
}

const Kind* kind_of(const NumberRule& rule) {
  const string_view unit = rule.unit.substr(0, rule.unit.find(','));
  const auto at = std::ranges::find(kinds(), unit, &Kind::unit);
  return at == kinds().end() ? nullptr : std::to_address(at);
}

}  // namespace

std::optional<double> with_unit(string_view text, const NumberRule& rule) {
  const Kind* kind = kind_of(rule);
  if (kind == nullptr) return std::nullopt;
  double value = 0;
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{}) return std::nullopt;
  string_view symbol = text.substr(static_cast<std::size_t>(stop - text.data()));
  while (symbol.starts_with(' ')) symbol.remove_prefix(1);
  while (symbol.ends_with(' ')) symbol.remove_suffix(1);
  const auto unit = std::ranges::find(kind->units, symbol, &Unit::symbol);
  if (unit == kind->units.end()) return std::nullopt;
  // 0.03 for "30 mm", not 30 times a rounded thousandth.
  const double inverse = std::round(1 / unit->factor);
  if (unit->factor < 1 && std::abs(inverse * unit->factor - 1) < 1e-12) return value / inverse;
  return value * unit->factor;
}

std::string unit_example(const NumberRule& rule) {
  const Kind* kind = kind_of(rule);
  return kind == nullptr ? std::string{} : std::string{kind->example};
}

std::vector<string_view> unit_symbols(const NumberRule& rule) {
  std::vector<string_view> symbols;
  if (const Kind* kind = kind_of(rule)) {
    for (const Unit& unit : kind->units) symbols.push_back(unit.symbol);
  }
  return symbols;
}

std::optional<string_view> likely_unit(double bare, const NumberRule& rule) {
  const Kind* kind = kind_of(rule);
  if (kind == nullptr) return std::nullopt;
  for (const Unit& unit : kind->units) {
    const double value = std::abs(bare) * unit.factor;
    if (unit.factor != 1 && value >= rule.usual_low && value <= rule.usual_high) return unit.symbol;
  }
  return std::nullopt;
}

}  // namespace cleave::scene
