#include <string>

#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {

const KeyTable& scanline_keys() {
  static const KeyTable keys{
      .name = "scanline in rock",
      .keys = {{"name", key::text(), "its number", "in the results"},
               {"points", key::points(), "", "`[[x, y, z], ...]` in m, straight or bent; or the four that follow"},
               {"from", key::vector(rule::coordinate), "", "m, where a straight line begins"},
               {"trend", key::number(rule::dip_direction), "", "degrees"},
               {"plunge", key::number(NumberRule{-90, false, 90, false, " degrees"}), "", "degrees below horizontal"},
               {"length", key::number(rule::length), "", "m"}}};
  return keys;
}

std::vector<ScanLine> parse_lines(const Context& context, const TableReader& root) {
  std::vector<ScanLine> lines;
  for (const TableReader& table : root.each("scanline")) {
    ScanLine line{.name = table.text("name").value_or(std::to_string(lines.size() + 1)), .points = {}};
    if (table.has("points")) {
      for (const std::string_view other : {"from", "trend", "plunge", "length"}) {
        if (table.has(other)) table.error(other, "stands beside \"points\"", "give points, or the other four");
      }
      line.points = table.points("points").value_or(std::vector<geometry::Vec3>{});
    } else {
      const auto from = table.need_vec3("from");
      const auto trend = table.need_number("trend"), plunge = table.need_number("plunge");
      const auto length = table.need_number("length");
      if (!from || !trend || !plunge || !length) continue;
      const geometry::Vec3 way =
          geometry::line_vector({geometry::Trend::degrees(*trend + context.north), geometry::Plunge::degrees(*plunge)});
      line.points = {*from, *from + *length * way};
    }
    double length = 0;
    for (std::size_t i = 1; i < line.points.size(); ++i) length += norm(line.points[i] - line.points[i - 1]);
    if (!(length > 0)) {
      table.error("points", "make a line without length", "give two different points or more");
      continue;
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace cleave::scene
