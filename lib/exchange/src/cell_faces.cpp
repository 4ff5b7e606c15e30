#include "cell_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "cleave/core/text.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/triangulate.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

/// Twice the area vector.
Vec3 area_of(const CellFace& face, std::span<const Vec3> points) {
  Vec3 sum;
  const Vec3 o = points[face[0]];
  for (std::size_t i = 1; i + 1 < face.size(); ++i) sum += cross(points[face[i]] - o, points[face[i + 1]] - o);
  return sum;
}

/// No corner turns back, and the corners go round once.
bool is_convex(const CellFace& face, std::span<const Vec3> points, Vec3 area) {
  const std::size_t n = face.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 a = points[face[i]];
    const Vec3 b = points[face[(i + 1) % n]];
    const Vec3 c = points[face[(i + 2) % n]];
    if (dot(cross(b - a, c - b), area) < 0) return false;
    // a triangle of a fan about the first corner that is turned over: the corners go round more than once
    if (i > 0 && i + 1 < n && dot(cross(a - points[face[0]], b - points[face[0]]), area) < 0) return false;
  }
  return true;
}

}  // namespace

std::vector<CellFace> faces_of_cell(const Cells& cells, std::size_t cell) {
  const auto stream = cells.faces_of(cell);
  std::vector<CellFace> faces(static_cast<std::size_t>(stream[0]));
  std::size_t at = 1;
  for (CellFace& face : faces) {
    const auto count = static_cast<std::size_t>(stream[at]);
    for (const std::int64_t point : stream.subspan(at + 1, count)) face.push_back(static_cast<std::uint32_t>(point));
    at += count + 1;
  }
  return faces;
}

std::vector<CellFace> convex_faces_of_cell(const Cells& cells, std::size_t cell) {
  std::vector<CellFace> result;
  for (CellFace& face : faces_of_cell(cells, cell)) {
    const Vec3 area = area_of(face, cells.points);
    if (face.size() == 3 || is_convex(face, cells.points, area)) {
      result.push_back(std::move(face));
      continue;
    }
    const std::vector<CellFace> loops{std::move(face)};
    for (const Triangle& t : triangulate(loops, cells.points, area)) result.push_back({t[0], t[1], t[2]});
  }
  return result;
}

std::vector<std::array<std::uint32_t, 3>> triangles_of_cell(const Cells& cells, std::size_t cell) {
  std::vector<std::array<std::uint32_t, 3>> result;
  for (CellFace& face : faces_of_cell(cells, cell)) {
    if (face.size() == 3) {
      result.push_back({face[0], face[1], face[2]});
      continue;
    }
    const Vec3 area = area_of(face, cells.points);
    const std::vector<CellFace> loops{std::move(face)};
    for (const Triangle& t : triangulate(loops, cells.points, area)) result.push_back(t);
  }
  return result;
}

std::vector<std::string> names_of_cells(const Cells& cells) {
  std::map<std::uint32_t, std::uint32_t> parts;
  std::vector<std::string> names;
  names.reserve(cells.size());
  for (const topology::BlockId block : cells.block) {
    const std::uint32_t part = ++parts[block.value()];
    std::string name = "block_" + std::to_string(block.value());
    if (part > 1) name += "_part_" + std::to_string(part);
    names.push_back(std::move(name));
  }
  return names;
}

std::string header_of(std::string_view title) {
  std::string text = "cleave " CLEAVE_VERSION "; scene: " + on_one_line(title);
  while (text.ends_with('\\') || text.ends_with('&') || text.ends_with(' '))
    text.pop_back();  // continue lines in places
  return text;
}

geometry::Box extent_of(const Cells& cells) {
  geometry::Box extent;
  for (const std::int64_t point : cells.connectivity) extent.add(cells.points[static_cast<std::size_t>(point)]);
  return extent;
}

}  // namespace cleave::report::detail
