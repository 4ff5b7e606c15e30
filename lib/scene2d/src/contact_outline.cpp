#include "contact_outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "body_keys.hpp"
#include "cleave/bem/problem.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr double degree = std::numbers::pi / 180;

const KeyTable& rectangle_keys() {
  static const KeyTable keys{
      .name = "body.rectangle",
      .keys = {{"corner", key::pair(rule::coordinate), required, "`[x, y]` in m"},
               {"width", key::number(rule::length), required, "m"},
               {"height", key::number(rule::length), required, "m"},
               {"angle", key::number(rule::turn), "0", "degrees about its corner, counter-clockwise"}}};
  return keys;
}

const KeyTable& polygon_keys() {
  static const KeyTable keys{.name = "body.polygon",
                             .keys = {{"centre", key::pair(rule::coordinate), required, "`[x, y]` in m"},
                                      {"radius", key::number(rule::length), required, "m, through the corners"},
                                      {"sides", key::whole(3, 10'000), required, "of the regular polygon"},
                                      {"angle", key::number(rule::turn), "0", "degrees, counter-clockwise"}}};
  return keys;
}

const KeyTable& circle_keys() {
  static const KeyTable keys{.name = "body.circle",
                             .keys = {{"centre", key::pair(rule::coordinate), required, "`[x, y]` in m"},
                                      {"radius", key::number(rule::length), required, "m"},
                                      {"sides", key::whole(6, 10'000), "32", "of the polygon of the circle's area"}}};
  return keys;
}

const KeyTable& voussoir_keys() {
  static const KeyTable keys{
      .name = "body.voussoir",
      .keys = {{"centre", key::pair(rule::coordinate), required, "`[x, y]` in m"},
               {"radius", key::number(rule::length), required, "m, mean radius of the arch"},
               {"thickness", key::number(rule::length), required, "m"},
               {"from", key::number(rule::turn), required, "degrees counter-clockwise from the x axis"},
               {"to", key::number(rule::turn), required, "degrees counter-clockwise from the x axis"},
               {"chords", key::whole(1, 1000), "4", "of each arc"}}};
  return keys;
}

Vec2 need_pair(const TableReader& table, string_view key) {
  if (!table.has(key)) table.missing(key, "write " + std::string{key} + " = [x, y]");
  return pair(table, key).value_or(Vec2{});
}

Vec2 direction(double degrees) { return {std::cos(degrees * degree), std::sin(degrees * degree)}; }

std::vector<Vec2> rectangle(const TableReader& table) {
  const Vec2 corner = need_pair(table, "corner");
  const double width = table.need_number("width").value_or(1);
  const double height = table.need_number("height").value_or(1);
  const double angle = table.value("angle") * degree;
  std::vector<Vec2> out;
  for (const Vec2 p : {Vec2{0, 0}, Vec2{width, 0}, Vec2{width, height}, Vec2{0, height}}) {
    out.push_back(corner + (angle == 0 ? p : rotated(p, angle)));
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
  const double radius = table.need_number("radius").value_or(1);
  const double thickness = table.need_number("thickness").value_or(0.1);
  const double from = table.need_number("from").value_or(0);
  const double to = table.need_number("to").value_or(10);
  const auto chords = static_cast<int>(table.count("chords"));
  if (!(thickness < 2 * radius))
    table.error("thickness", "is not less than twice the radius", "make the stone thinner");
  if (!(to > from) || !(to - from < 180)) {
    table.error("to", "must lie above from, by less than 180 degrees",
                "angles count counter-clockwise from the x axis");
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
  const TomlEntry* entry = body.one_of();
  if (entry == nullptr) return {};
  key = entry->key;
  if (key == "outline") return corners_of(body, entry->node, body.path_of(key)).value_or(std::vector<Vec2>{});
  const auto found = body.sub(key);
  if (!found) return {};
  const TableReader& t = *found;
  if (key == "rectangle") return rectangle(t);
  if (key == "voussoir") return voussoir(t);
  const Vec2 centre = need_pair(t, "centre");
  const double radius = t.need_number("radius").value_or(1);
  if (key == "polygon") {
    if (!t.has("sides")) t.missing("sides", "write how many: sides = 6");
    return regular(centre, radius, t.integer("sides").value_or(6), t.value("angle"));
  }
  const std::int64_t sides = t.count("sides");
  const double angle = 2 * std::numbers::pi / static_cast<double>(sides);
  // Of the circle's area, with a flat side below.
  return regular(centre, radius * std::sqrt(angle / std::sin(angle)), sides, -90 + 180.0 / static_cast<double>(sides));
}

}  // namespace

std::vector<Key> outline_keys() {
  return {
      {"outline", key::pairs(), "", "corners in m, counter-clockwise, convex or not; no holes"},
      {"rectangle", key::table(&rectangle_keys), "", "`{ corner, width, height, angle = 0 }`: turned about its corner"},
      {"polygon", key::table(&polygon_keys), "",
       "`{ centre, radius, sides, angle = 0 }`: regular; `radius` through the corners"},
      {"circle", key::table(&circle_keys), "", "`{ centre, radius, sides = 32 }`: a polygon of the circle's area"},
      {"voussoir", key::table(&voussoir_keys), "",
       "`{ centre, radius, thickness, from, to, chords = 4 }`: stone of an arch of this mean radius, degrees "
       "counter-clockwise from the x axis"}};
}

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
    body.error(key, describe(checked.error()), "correct the corners");
    return out;
  }
  const std::size_t n = corners.size();
  out.side_of.resize(n);
  if (checked->turned.empty()) {
    for (std::size_t k = 0; k < n; ++k) out.side_of[k] = k;
  } else {
    body.note(key, "runs clockwise and was turned; sides keep their numbers", "write the corners counter-clockwise");
    std::ranges::reverse(corners);
    for (std::size_t k = 0; k < n; ++k) out.side_of[k] = (2 * n - 2 - k) % n;
  }
  out.corners = std::move(corners);
  return out;
}

}  // namespace cleave::scene
