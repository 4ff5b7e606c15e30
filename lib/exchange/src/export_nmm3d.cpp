#include <string>

#include "cell_faces.hpp"
#include "cleave/exchange/text.hpp"
#include "export_writers.hpp"

namespace cleave::report::detail {

Exported blocks_nmm3d(const Cells& cells, std::string_view title) {
  Exported result;
  std::string& out = result.bytes;
  out += "# " + header_of(title) +
         "\n# block file for 3D-DDA and NMM-3D, experimental; metres, z up, no offset subtracted\n";
  out += "# POINTS CELLS, then x y z of each point (from 1), then for each cell: block (from 0), volume, faces;\n";
  out += "# for each face: corners, their points counter-clockwise seen from outside\n";
  out += std::to_string(cells.points.size()) + ' ' + std::to_string(cells.size()) + '\n';
  for (const geometry::Vec3& p : cells.points) {
    append_number(out, p.x);
    out += ' ';
    append_number(out, p.y);
    out += ' ';
    append_number(out, p.z);
    out += '\n';
  }
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const std::vector<CellFace> faces = faces_of_cell(cells, cell);
    out += std::to_string(cells.block[cell].value()) + ' ';
    append_number(out, cells.volume[cell]);
    out += ' ' + std::to_string(faces.size()) + '\n';
    for (const CellFace& face : faces) {
      out += std::to_string(face.size());
      for (const std::uint32_t point : face) out += ' ' + std::to_string(std::size_t{point} + 1);
      out += '\n';
    }
  }
  return result;
}

}  // namespace cleave::report::detail
