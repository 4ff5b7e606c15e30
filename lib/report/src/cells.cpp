#include "cleave/report/cells.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "cavities.hpp"
#include "polygons.hpp"

namespace cleave::report {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;

void append_cell(Cells& cells, const std::vector<detail::Polygon>& polygons, BlockId block, Volume volume) {
  const std::size_t first = cells.connectivity.size();
  cells.face_stream.push_back(static_cast<std::int64_t>(polygons.size()));
  for (const detail::Polygon& polygon : polygons) {
    cells.face_stream.push_back(static_cast<std::int64_t>(polygon.corners.size()));
    for (const std::uint32_t point : polygon.corners) {
      cells.face_stream.push_back(point);
      cells.connectivity.push_back(point);
    }
  }
  const auto begin = cells.connectivity.begin() + static_cast<std::ptrdiff_t>(first);
  std::ranges::sort(begin, cells.connectivity.end());
  cells.connectivity.erase(std::unique(begin, cells.connectivity.end()), cells.connectivity.end());
  cells.face_ends.push_back(static_cast<std::int64_t>(cells.face_stream.size()));
  cells.ends.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
  cells.block.push_back(block);
  cells.volume.push_back(volume.si());
}

// Numbers the piece's vertices behind the points there are.
void append_pieces(Cells& cells, const BlockComplex& pieces, Vec3 origin, BlockId block) {
  const std::size_t base = cells.points.size();
  for (const topology::VertexId v : pieces.vertices().ids()) cells.points.push_back(origin + pieces.position(v));
  for (const BlockId piece : pieces.blocks().ids()) {
    auto polygons = detail::surface_of(pieces, piece, pieces.vertices().items(), false);
    for (detail::Polygon& polygon : polygons) {
      for (std::uint32_t& point : polygon.corners) point += static_cast<std::uint32_t>(base);
    }
    detail::separate_pinches(polygons, cells.points);
    append_cell(cells, polygons, block, pieces.blocks()[piece].volume);
  }
}

}  // namespace

Cells make_cells(const BlockComplex& complex) {
  Cells cells;
  cells.points.reserve(complex.vertices().size());
  for (const topology::VertexId v : complex.vertices().ids()) cells.points.push_back(complex.position(v));
  for (const BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    if (block.counts.shells > 1) {
      if (const auto pieces = detail::cut_through_cavities(complex, id)) {
        append_pieces(cells, *pieces, complex.origin(), id);
        continue;
      }
      cells.with_cavities.push_back(id);
    }
    auto polygons = detail::surface_of(complex, id, complex.vertices().items(), false);
    detail::separate_pinches(polygons, cells.points);
    append_cell(cells, polygons, id, block.volume);
  }
  return cells;
}

}  // namespace cleave::report
