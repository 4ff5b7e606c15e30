#include "attitude_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "cleave/geometry/orientation.hpp"

namespace cleave::scene {

std::vector<Key> attitude_keys(bool sole) {
  return {{"dip", key::number(rule::dip), "", sole ? "degrees" : "degrees, of the mean plane"},
          {"dip_direction", key::number(rule::dip_direction), "", sole ? "degrees" : "degrees, of the mean plane"},
          {"trend", key::number(rule::dip_direction), "",
           "degrees, of the pole (the normal that points down), instead of `dip` and `dip_direction`"},
          {"plunge", key::number(rule::dip), "", "degrees, of the pole"}};
}

namespace {

/// A bare number as it stands.
std::optional<double> bare(const TableReader& table, std::string_view key) {
  const TomlEntry* entry = table.find(key);
  if (entry == nullptr) return std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(&entry->node.value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(&entry->node.value);
  return real != nullptr ? std::optional{*real} : std::nullopt;
}

/// In the other order the two would be right: dip = 210, dip_direction = 45.
bool swapped(const TableReader& table) {
  const auto dip = bare(table, "dip"), direction = bare(table, "dip_direction");
  return dip && direction && *dip > 90 && *dip <= 360 && *direction >= 0 && *direction <= 90;
}

/// Bare angles, both small and not both whole, may be radians.
void note_radians(const TableReader& table, std::string_view inclination, std::string_view bearing) {
  constexpr double right_angle = 1.571, whole_turn = 6.284, least_radians = 0.052;
  const auto a = bare(table, inclination), b = bare(table, bearing);
  if (!a || !b || *a > right_angle) return;
  if (*b > whole_turn) {
    // The inclination alone: of 3 degrees on as radians, and finer than level planes are stated in degrees.
    const double tenths = *a * 10;
    if (*a < least_radians || std::abs(std::round(tenths) - tenths) < 1e-9) return;
    table.note(inclination, fmt::format("is {} beside {} = {}, in degrees", *a, bearing, *b),
               fmt::format("if it is meant in radians, write \"{} rad\"", *a));
    return;
  }
  if (std::round(*a) == *a && std::round(*b) == *b) return;
  table.note(inclination, fmt::format("is {} beside {} = {}, in degrees", *a, bearing, *b),
             fmt::format("if they are meant in radians, write \"{} rad\" and \"{} rad\"", *a, *b));
}

}  // namespace

std::optional<geometry::Attitude> parse_attitude(const Context& context, const TableReader& table) {
  const bool pole = table.has("trend") || table.has("plunge");
  for (const std::string_view key : {"dip", "dip_direction"}) {
    if (!pole || !table.has(key)) continue;
    table.error(key, "stands beside the pole's trend and plunge", "give dip and dip_direction, or trend and plunge");
    return std::nullopt;
  }
  if (!pole && swapped(table)) {
    table.error("dip", fmt::format("is {}", *bare(table, "dip")),
                fmt::format("give a number {}, or swap dip and dip_direction", rule::dip.words()));
    return std::nullopt;
  }
  if (!pole) {
    const auto dip = table.need_number("dip"), direction = table.need_number("dip_direction");
    if (!dip || !direction) return std::nullopt;
    note_radians(table, "dip", "dip_direction");
    return geometry::Attitude{Dip::degrees(*dip), context.turned(*direction)};
  }
  const auto trend = table.need_number("trend"), plunge = table.need_number("plunge");
  if (!trend || !plunge) return std::nullopt;
  note_radians(table, "plunge", "trend");
  return geometry::Attitude{Dip::degrees(90 - *plunge), context.turned(geometry::wrap_degrees(*trend + 180))};
}

}  // namespace cleave::scene
