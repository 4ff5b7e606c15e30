#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "unit_text.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// By the rule's unit, without what follows a comma.
const UnitKind* kind_of(const NumberRule& rule) {
  const string_view unit = rule.unit.substr(0, rule.unit.find(','));
  return unit.starts_with(' ') ? units_of(unit.substr(1)) : nullptr;
}

/// kg/m3 of kg/m³.
std::string without_superscripts(string_view symbol) {
  std::string out{symbol};
  for (const auto& [raised, plain] : {std::pair{string_view{"\u00b2"}, '2'}, {string_view{"\u00b3"}, '3'}}) {
    for (std::size_t at = out.find(raised); at != std::string::npos; at = out.find(raised)) {
      out.replace(at, raised.size(), 1, plain);
    }
  }
  return out;
}

}  // namespace

std::optional<UnitText> unit_text(string_view text, const NumberRule& rule) {
  const UnitKind* kind = kind_of(rule);
  if (kind == nullptr) return std::nullopt;
  double value = 0;
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{}) return std::nullopt;
  string_view symbol = text.substr(static_cast<std::size_t>(stop - text.data()));
  while (symbol.starts_with(' ')) symbol.remove_prefix(1);
  while (symbol.ends_with(' ')) symbol.remove_suffix(1);
  const auto unit = std::ranges::find(kind->units, string_view{without_superscripts(symbol)}, &Unit::symbol);
  if (unit == kind->units.end()) return std::nullopt;
  return UnitText{value, std::to_address(unit)};
}

std::optional<double> with_unit(string_view text, const NumberRule& rule) {
  const auto stated = unit_text(text, rule);
  return stated ? std::optional{to_unit(stated->number, *stated->unit)} : std::nullopt;
}

std::string unit_example(const NumberRule& rule) {
  const UnitKind* kind = kind_of(rule);
  return kind == nullptr ? std::string{} : std::string{kind->example};
}

std::vector<string_view> unit_symbols(const NumberRule& rule) {
  std::vector<string_view> symbols;
  if (const UnitKind* kind = kind_of(rule)) {
    for (const Unit& unit : kind->units) symbols.push_back(unit.symbol);
  }
  return symbols;
}

bool NumberRule::is_usual(double v) const noexcept {
  const double size = std::abs(v);
  return !usual || size == 0 || (size >= usual->low && size <= usual->high);
}

std::optional<string_view> likely_unit(double bare, const NumberRule& rule) { return likely_unit(bare, 1, rule); }

std::optional<string_view> likely_unit(double number, double factor, const NumberRule& rule) {
  const UnitKind* kind = kind_of(rule);
  if (kind == nullptr || !rule.usual) return std::nullopt;
  for (const Unit& unit : kind->units) {
    const double value = std::abs(number) * unit.factor, times = unit.factor / factor;
    // gon for degrees is no slip that shows, and nobody gives a thickness in km.
    const bool of_other_size = (times < 0.5 || times > 2) && (kind->unit != "m" || unit.factor <= rule.usual->high);
    if (of_other_size && value >= rule.usual->low && value <= rule.usual->high) return unit.symbol;
  }
  return std::nullopt;
}

}  // namespace cleave::scene
