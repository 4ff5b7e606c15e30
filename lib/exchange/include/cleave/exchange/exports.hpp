#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/exchange/cells.hpp"

/// Blocks in the formats of other programs (docs/formats.md has each layout). Coordinates are metres, z up, absolute,
/// unless a format says otherwise; numbers are the shortest text that reads back to the same double.
namespace cleave::report {

enum class ExportFormat : std::uint8_t {
  obj,        ///< Wavefront OBJ: a group a cell, convex polygons and triangles
  ply,        ///< PLY, ascii: triangles with a property `block`
  stl,        ///< STL, text: a solid a cell, triangles
  threedec,   ///< 3DEC 7 and 9 commands: convex parts, joined to blocks. Experimental
  threedec5,  ///< 3DEC 5 and before. Experimental
  lsdyna,     ///< LS-DYNA keyword, long format: shells of the surface, a part a block, coordinates less an origin
  nmm3d,      ///< points, then faces of each block: for 3D-DDA and NMM-3D. Experimental
  dda,        ///< lines of a vertical section, for 2D DDA. Experimental
};

struct ExportName {
  ExportFormat format;
  std::string_view name;    ///< in [output] exports
  std::string_view ending;  ///< of the file, with its point
};
[[nodiscard]] std::span<const ExportName> export_names() noexcept;
[[nodiscard]] const ExportName& name_of(ExportFormat format);

struct Exported {
  std::string bytes;
  std::vector<std::string> notes;  ///< what the user should know: short edges, blocks left out
};

/// `title`: of the scene, for the header comment.
[[nodiscard]] Exported export_blocks(const Cells& cells, ExportFormat format, std::string_view title);

}  // namespace cleave::report
