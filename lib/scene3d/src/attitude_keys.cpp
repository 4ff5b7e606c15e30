#include "attitude_keys.hpp"

#include <string_view>

#include "cleave/geometry/orientation.hpp"

namespace cleave::scene {

std::vector<Key> attitude_keys(bool sole) {
  return {{"dip", key::number(rule::dip), "", sole ? "degrees" : "degrees, of the mean plane"},
          {"dip_direction", key::number(rule::dip_direction), "", sole ? "degrees" : "degrees, of the mean plane"},
          {"trend", key::number(rule::dip_direction), "",
           "degrees, of the pole (the normal that points down), instead of `dip` and `dip_direction`"},
          {"plunge", key::number(rule::dip), "", "degrees, of the pole"}};
}

std::optional<geometry::Attitude> parse_attitude(const Context& context, const TableReader& table) {
  const bool pole = table.has("trend") || table.has("plunge");
  for (const std::string_view key : {"dip", "dip_direction"}) {
    if (!pole || !table.has(key)) continue;
    table.error(key, "stands beside the pole's trend and plunge", "give dip and dip_direction, or trend and plunge");
    return std::nullopt;
  }
  if (!pole) {
    const auto dip = table.need_number("dip"), direction = table.need_number("dip_direction");
    if (!dip || !direction) return std::nullopt;
    return geometry::Attitude{Dip::degrees(*dip), context.turned(*direction)};
  }
  const auto trend = table.need_number("trend"), plunge = table.need_number("plunge");
  if (!trend || !plunge) return std::nullopt;
  return geometry::Attitude{Dip::degrees(90 - *plunge), context.turned(geometry::wrap_degrees(*trend + 180))};
}

}  // namespace cleave::scene
