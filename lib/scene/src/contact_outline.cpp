#include "contact_outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cleave/bem/outline.hpp"
#include "plane_input.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr double degree = std::numbers::pi / 180;

TableReader inner(const TableReader& body, string_view key, const TomlTable& table, std::span<const string_view> keys) {
  return {table, body.line_of(key), body.path_of(key), body.problems(), keys};
}

Vec2 need_pair(const TableReader& table, string_view key) {
  if (!table.has(key)) table.missing(key, "write " + std::string{key} + " = [x, y]");
  return pair(table, key, rule::coordinate).value_or(Vec2{});
}

Vec2 direction(double degrees) { return {std::cos(degrees * degree), std::sin(degrees * degree)}; }

std::vector<Vec2> rectangle(const TableReader& table) {
  const Vec2 corner = need_pair(table, "corner");
  const double width = table.need_number("width", rule::length).value_or(1);
  const double height = table.need_number("height", rule::length).value_or(1);
  const double angle = table.number("angle", rule::turn).value_or(0) * degree;
  std::vector<Vec2> out;
  for (const Vec2 p : {Vec2{0, 0}, Vec2{width, 0}, Vec2{width, height}, Vec2{0, height}}) {
    out.push_back(corner + (angle == 0 ? p : bem::rotated(p, angle)));
  }
  return out;
}

std::vector<Vec2> regular(Vec2 centre, double radius, std::int64_t sides, double angle) {
  std::vector<Vec2> out;
  for (std::int64_t k = 0; k < sides; ++k) {
    out.push_back(centre + radius * direction(angle + 360.0 * static_cast<double>(k) / static_cast<double>(sides)));
  }
  return out;
}

/// A stone of an arch: a sector of a ring, its arcs as chords.
std::vector<Vec2> voussoir(const TableReader& table) {
  const Vec2 centre = need_pair(table, "centre");
  const double radius = table.need_number("radius", rule::length).value_or(1);
  const double thickness = table.need_number("thickness", rule::length).value_or(0.1);
  const double from = table.need_number("from", rule::turn).value_or(0);
  const double to = table.need_number("to", rule::turn).value_or(10);
  const auto chords = static_cast<int>(table.integer("chords", 1, 1000).value_or(4));
  if (!(thickness < 2 * radius))
    table.error("thickness", "is not less than twice the radius", "make the stone thinner");
  if (!(to > from) || !(to - from < 180)) {
    table.error("to", "must lie above from, by less than 180 degrees", "angles count anticlockwise from the x axis");
  }
  std::vector<Vec2> out;
  for (int k = 0; k <= chords; ++k) {
    out.push_back(centre + (radius + thickness / 2) * direction(from + (to - from) * k / chords));
  }
  for (int k = chords; k >= 0; --k) {
    out.push_back(centre + (radius - thickness / 2) * direction(from + (to - from) * k / chords));
  }
  return out;
}

std::vector<Vec2> written(const TableReader& body, string_view& key) {
  constexpr std::array<string_view, 5> kinds{"outline", "rectangle", "polygon", "circle", "voussoir"};
  const TomlEntry* entry = body.one_of(kinds);
  if (entry == nullptr) return {};
  key = entry->key;
  if (key == "outline") return corners_of(body, entry->node, body.path_of(key)).value_or(std::vector<Vec2>{});
  const TomlTable* table = body.table(key);
  if (table == nullptr) return {};
  if (key == "rectangle") {
    constexpr std::array<string_view, 4> keys{"corner", "width", "height", "angle"};
    return rectangle(inner(body, key, *table, keys));
  }
  if (key == "polygon") {
    constexpr std::array<string_view, 4> keys{"centre", "radius", "sides", "angle"};
    const auto t = inner(body, key, *table, keys);
    if (!t.has("sides")) t.missing("sides", "write how many: sides = 6");
    return regular(need_pair(t, "centre"), t.need_number("radius", rule::length).value_or(1),
                   t.integer("sides", 3, 10000).value_or(6), t.number("angle", rule::turn).value_or(0));
  }
  if (key == "circle") {
    constexpr std::array<string_view, 3> keys{"centre", "radius", "sides"};
    const auto t = inner(body, key, *table, keys);
    const std::int64_t sides = t.integer("sides", 6, 10000).value_or(32);
    const double angle = 2 * std::numbers::pi / static_cast<double>(sides);
    // Of the circle's area, with a flat side below.
    const double radius = t.need_number("radius", rule::length).value_or(1) * std::sqrt(angle / std::sin(angle));
    return regular(need_pair(t, "centre"), radius, sides, -90 + 180.0 / static_cast<double>(sides));
  }
  constexpr std::array<string_view, 6> keys{"centre", "radius", "thickness", "from", "to", "chords"};
  return voussoir(inner(body, key, *table, keys));
}

}  // namespace

ContactOutline parse_contact_outline(const TableReader& body) {
  ContactOutline out;
  string_view key = "outline";
  const std::size_t before = body.problems().errors();
  std::vector<Vec2> corners = written(body, key);
  if (body.problems().errors() != before || corners.empty()) return out;
  if (corners.size() < 3) {
    body.error(key, fmt::format("has {} corners, which make no outline", corners.size()), "write at least three");
    return out;
  }
  const auto checked = bem::check_loops({bem::polygon(corners)}, false);
  if (!checked) {
    body.error(key, describe(checked.error()), "mend the corners");
    return out;
  }
  const std::size_t n = corners.size();
  out.side_of.resize(n);
  if (checked->turned.empty()) {
    for (std::size_t k = 0; k < n; ++k) out.side_of[k] = k;
  } else {
    body.note(key, "runs clockwise and was turned; sides keep their numbers", "write the corners anticlockwise");
    std::ranges::reverse(corners);
    for (std::size_t k = 0; k < n; ++k) out.side_of[k] = (2 * n - 2 - k) % n;
  }
  out.corners = std::move(corners);
  return out;
}

}  // namespace cleave::scene
