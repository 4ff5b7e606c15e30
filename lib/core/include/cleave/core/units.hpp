#pragma once

#include <string_view>
#include <vector>

namespace cleave {

struct Unit {
  std::string_view symbol;
  double factor;  ///< to the unit of its kind
};

/// Units of one kind of quantity, by the unit that the program itself uses.
struct UnitKind {
  std::string_view unit;
  std::string_view example;
  std::vector<Unit> units;
};

/// "m", "degrees", "Pa", "kg/m3", ...: what else such a quantity is stated in. Null for what has no unit.
[[nodiscard]] const UnitKind* units_of(std::string_view unit);
/// A value stated in `of`, in the unit of its kind.
[[nodiscard]] double to_unit(double value, const Unit& of);

/// The unit of that name among those of `unit`'s kind, in any case and as people write it ("kpa", "metres", "deg.").
[[nodiscard]] const Unit* find_unit(std::string_view unit, std::string_view as_written);

/// A column's name and the unit in brackets behind it: "Depth (m)", "dip [deg]". Empty where there is none.
struct ColumnHead {
  std::string_view name;
  std::string_view unit;
};
[[nodiscard]] ColumnHead column_head(std::string_view cell);

}  // namespace cleave
