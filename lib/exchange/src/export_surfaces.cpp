#include <string>

#include "cell_faces.hpp"
#include "cleave/exchange/text.hpp"
#include "export_writers.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

void append_point(std::string& out, Vec3 p) {
  append_number(out, p.x);
  out += ' ';
  append_number(out, p.y);
  out += ' ';
  append_number(out, p.z);
  out += '\n';
}

constexpr std::string_view unit_line = "metres, x east, y north, z up, no offset subtracted; blocks count from 0";

}  // namespace

Exported blocks_obj(const Cells& cells, std::string_view title) {
  Exported result;
  std::string& out = result.bytes;
  out += "# " + header_of(title) + "\n# ";
  out += unit_line;
  out +=
      "\n# a group is a closed surface; a block with cavities is several: block_N, block_N_part_2, ...,\n"
      "# and faces that two of these share lie inside it: they are no joints\n";
  for (const Vec3& p : cells.points) {
    out += "v ";
    append_point(out, p);
  }
  const std::vector<std::string> names = names_of_cells(cells);
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    out += "g " + names[cell] + "\n";
    for (const CellFace& face : convex_faces_of_cell(cells, cell)) {
      out += 'f';
      for (const std::uint32_t point : face) out += ' ' + std::to_string(std::size_t{point} + 1);
      out += '\n';
    }
  }
  return result;
}

Exported blocks_ply(const Cells& cells, std::string_view title) {
  std::string faces;
  std::size_t count = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const auto& face : triangles_of_cell(cells, cell)) {
      faces += '3';
      for (const std::uint32_t point : face) faces += ' ' + std::to_string(point);
      faces += ' ' + std::to_string(cells.block[cell].value()) + '\n';
      ++count;
    }
  }
  Exported result;
  std::string& out = result.bytes;
  out += "ply\nformat ascii 1.0\ncomment " + header_of(title) + "\ncomment ";
  out += unit_line;
  out += "\nelement vertex " + std::to_string(cells.points.size());
  out += "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(count);
  out += "\nproperty list int int vertex_indices\nproperty int block\nend_header\n";
  for (const Vec3& p : cells.points) append_point(out, p);
  out += faces;
  return result;
}

Exported blocks_stl(const Cells& cells, std::string_view title) {
  Exported result;
  std::string& out = result.bytes;
  const std::vector<std::string> names = names_of_cells(cells);
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    // the format has no comments: what must be said stands in the first name
    out += "solid " + names[cell];
    if (cell == 0) {
      out += " (" + header_of(title) + "; ";
      out += unit_line;
      out += ')';
    }
    out += '\n';
    for (const auto& triangle : triangles_of_cell(cells, cell)) {
      const Vec3 a = cells.points[triangle[0]];
      const Vec3 b = cells.points[triangle[1]];
      const Vec3 c = cells.points[triangle[2]];
      const Vec3 area = cross(b - a, c - a);
      const double length = norm(area);
      out += "facet normal ";
      append_point(out, length > 0 ? area / length : Vec3{});
      out += "outer loop\n";
      for (const Vec3& p : {a, b, c}) {
        out += "vertex ";
        append_point(out, p);
      }
      out += "endloop\nendfacet\n";
    }
    out += "endsolid " + names[cell] + "\n";
  }
  return result;
}

}  // namespace cleave::report::detail
