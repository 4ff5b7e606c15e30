#pragma once

#include <optional>
#include <string_view>

#include "cleave/core/units.hpp"
#include "cleave/scene/keys.hpp"

namespace cleave::scene {

/// A text such as "50 kPa", taken apart.
struct UnitText {
  double number;
  const Unit* unit;
};
/// Empty where the text is no number with a unit of the rule's kind.
[[nodiscard]] std::optional<UnitText> unit_text(std::string_view text, const NumberRule& rule);
/// The unit in place of one with that factor that makes a number outside the usual range a usual one; empty: none does.
[[nodiscard]] std::optional<std::string_view> likely_unit(double number, double factor, const NumberRule& rule);

}  // namespace cleave::scene
