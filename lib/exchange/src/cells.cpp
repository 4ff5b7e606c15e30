#include "cleave/exchange/exports.hpp"

#include <algorithm>
#include <utility>

#include "cavities.hpp"
#include "cleave/exchange/polygons.hpp"

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

// The block cut open through its cavities; false when that did not work out.
bool append_parts(Cells& cells, const BlockComplex& complex, BlockId block) {
  const std::size_t before = cells.points.size();
  auto triangles = detail::surface_of(complex, block, complex.vertices().items(), true);
  detail::separate_pinches(triangles, cells.points);
  const auto parts = detail::cut_through_cavities(std::move(triangles), cells.points);
  if (!parts) {
    cells.points.resize(before);
    return false;
  }
  for (const auto& part : *parts) append_cell(cells, part, block, cubic_metres(detail::volume_of(part, cells.points)));
  return true;
}

}  // namespace

Cells make_cells(const BlockComplex& complex) {
  Cells cells;
  cells.points.reserve(complex.vertices().size());
  for (const topology::VertexId v : complex.vertices().ids()) cells.points.push_back(complex.position(v));
  for (const BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    if (block.counts.shells > 1) {
      if (append_parts(cells, complex, id)) continue;
      cells.with_cavities.push_back(id);
    }
    auto polygons = detail::surface_of(complex, id, complex.vertices().items(), false);
    detail::separate_pinches(polygons, cells.points);
    append_cell(cells, polygons, id, block.volume);
  }
  return cells;
}

}  // namespace cleave::report
