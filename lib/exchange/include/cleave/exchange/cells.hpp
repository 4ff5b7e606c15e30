#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"
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

}  // namespace cleave::report
