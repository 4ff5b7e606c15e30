#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <system_error>

#include "cell_faces.hpp"
#include "cleave/exchange/text.hpp"
#include "export_writers.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

constexpr std::size_t width = 20;  ///< of a field in the long format

/// As many digits as a field holds: shortest text first, else fewer digits.
std::string field(double value) {
  std::string text = number(value);
  for (int digits = 17; text.size() > width && digits > 0; --digits) {
    std::array<char, 64> buffer{};
    const auto [end, failure] =
        std::to_chars(buffer.data(), std::to_address(buffer.end()), value, std::chars_format::general, digits);
    if (failure == std::errc{}) text.assign(buffer.data(), end);
  }
  return std::string(width - text.size(), ' ') + text;
}
std::string field(std::uint64_t value) {
  const std::string text = std::to_string(value);
  return std::string(width - text.size(), ' ') + text;
}

}  // namespace

Exported blocks_lsdyna(const Cells& cells, std::string_view title) {
  const geometry::Box extent = extent_of(cells);
  // whole kilometres off: small numbers keep their digits, and adding it back is exact
  const auto kilometres = [](double low, double high) { return 1000 * std::round((low + high) / 2000); };
  const Vec3 origin = cells.size() == 0
                          ? Vec3{}
                          : Vec3{kilometres(extent.min.x, extent.max.x), kilometres(extent.min.y, extent.max.y),
                                 kilometres(extent.min.z, extent.max.z)};
  Exported result;
  std::string& out = result.bytes;
  out += "*KEYWORD LONG=Y\n$ " + header_of(title) + "\n";
  out += "$ metres, x east, y north, z up; origin subtracted: " + number(origin.x) + " " + number(origin.y) + " " +
         number(origin.z) + "\n";
  out += "$ Shells on the surface of each block, normals outwards; a part a block (part N + 1 is block N).\n";
  out += "$ *SECTION_SHELL 1 and *MAT 1 are yours to add.\n";
  std::set<std::uint32_t> parts;
  for (const topology::BlockId block : cells.block) parts.insert(block.value());
  for (const std::uint32_t block : parts) {
    out += "*PART\nblock_" + std::to_string(block) + "\n";
    out += field(std::uint64_t{block} + 1) + field(std::uint64_t{1}) + field(std::uint64_t{1}) + "\n";
  }
  // Nodes are not shared between blocks, so that blocks can part.
  std::string nodes;
  std::string shells;
  std::uint64_t node_count = 0;
  std::uint64_t shell_count = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    std::map<std::uint32_t, std::uint64_t> numbers;
    for (const auto& triangle : triangles_of_cell(cells, cell)) {
      std::array<std::uint64_t, 3> corner{};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [at, is_new] = numbers.try_emplace(triangle[c], node_count + 1);
        if (is_new) {
          const Vec3 p = cells.points[triangle[c]] - origin;
          nodes += field(++node_count) + field(p.x) + field(p.y) + field(p.z) + "\n";
        }
        corner[c] = at->second;
      }
      shells += field(++shell_count) + field(std::uint64_t{cells.block[cell].value()} + 1);
      shells += field(corner[0]) + field(corner[1]) + field(corner[2]) + field(corner[2]) + "\n";
    }
  }
  out += "*NODE\n" + nodes + "*ELEMENT_SHELL\n" + shells + "*END\n";
  return result;
}

}  // namespace cleave::report::detail
