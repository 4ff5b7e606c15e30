#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

/// The block system as closed polyhedra with one shell and simple faces without holes each, as VTK, DEM programs and
/// meshers want them.
///
/// Made from the complex alone:
/// - a face with holes, or whose outline passes a vertex twice, is cut into triangles on its own vertices;
/// - a block with cavities is cut by axis-parallel planes through them into several cells of the same block; their
/// volumes add up to the
///   block's to rounding;
/// - where a block touches itself along an edge the points of that edge are doubled (or each pair of faces gets a
/// middle point of
///   its own), so that each edge of a cell is used exactly twice, once in each direction.
/// Cells are in the order of the blocks. Several cells share the points of the complex.
struct Cells {
  std::vector<geometry::Vec3> points;  ///< m, absolute coordinates
  /// Per cell: number of faces, then for each face its number of points and the points, counter-clockwise seen from
  /// outside.
  std::vector<std::int64_t> face_stream;
  std::vector<std::int64_t> face_ends;     ///< per cell: index one past its last entry in `face_stream`
  std::vector<std::int64_t> connectivity;  ///< per cell: its distinct points, ascending
  std::vector<std::int64_t> ends;          ///< per cell: index one past its last entry in `connectivity`
  std::vector<topology::BlockId> block;    ///< per cell
  std::vector<double> volume;              ///< m3, of the cell
  /// Blocks with cavities that were not cut open, as more than 64 planes were needed: one cell with several shells.
  std::vector<topology::BlockId> with_cavities;

  [[nodiscard]] std::size_t size() const noexcept { return block.size(); }
  [[nodiscard]] std::span<const std::int64_t> faces_of(std::size_t cell) const {
    const auto begin = cell == 0 ? std::size_t{0} : static_cast<std::size_t>(face_ends[cell - 1]);
    return std::span{face_stream}.subspan(begin, static_cast<std::size_t>(face_ends[cell]) - begin);
  }
};

[[nodiscard]] Cells make_cells(const topology::BlockComplex& complex);

/// The surface of a block as triangles on corners of the complex, face by face, counter-clockwise seen from outside:
/// every edge is used once in each direction (twice where the block touches itself).
[[nodiscard]] std::vector<std::array<topology::VertexId, 3>> triangles_of(const topology::BlockComplex& complex,
                                                                          topology::BlockId block);

// ---- VTK ------------------------------------------------------------------------------------------------------------

/// Number of `mode` in blocks.vtu: that of stability::Mode; this one for a block that was not judged.
inline constexpr std::uint8_t mode_not_judged = 255;
/// What `factor_of_safety` holds for an infinite factor (infinities spoil colour scales) and for a block without a
/// factor; `factor_known` tells which: 0 none, 1 a number, 2 infinite.
inline constexpr double factor_when_infinite = 1e9;
inline constexpr double factor_when_unknown = -1;

struct VtuText {
  std::string title;  ///< of the scene
  std::string scene_file;
  /// Sequential excavation: of each block, for the cell array `stage`; none at all: no such array.
  std::span<const std::optional<std::uint32_t>> stage_of_block = {};
};

/// blocks.vtu: polyhedra in the layout that every VTK reads (faces + faceoffsets), all arrays base64 inline, so the
/// file is valid XML.
///
/// Cell arrays: block (Int64, index from 0), volume (Float64, m3, of the cell), batch (Int32, -1: stays), mode (UInt8,
/// see mode_not_judged; names in the field data array mode_names), key (UInt8), factor_of_safety (Float64) with
/// factor_known (UInt8), net_force (Float64 x 3, N, along the first motion; against it for blocks that hold). Values
/// are those before force transfer. All but block and volume are absent when `analysis` is null. stage (Int32):
/// in blocks.vtu the first stage in which a part of the block left, -1 when it stays; in blocks_stage_K.vtu K.
[[nodiscard]] std::string blocks_vtu(const Cells& cells, const stability::Analysis* analysis, const VtuText& text);

// ---- Other programs -------------------------------------------------------------------------------------------------

// Blocks in the formats of other programs (docs/formats.md has each layout). Coordinates are metres, z up, absolute,
// unless a format says otherwise; numbers are the shortest text that reads back to the same double.

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
