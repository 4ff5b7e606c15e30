#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "cleave/geometry/solid.hpp"
#include "cleave/io/mesh.hpp"

/// What solids from files share, whoever reads them.
namespace cleave::io {

/// Faces whose corners lie further off a plane than those of a polygon may, as the triangles by which the cutter takes
/// them: the body has one volume then, whatever is done with it. The note says how many there were and how far off.
struct Unbent {
  MeshData mesh;
  std::optional<std::string> note;
};
[[nodiscard]] Unbent without_bent_faces(MeshData mesh);

struct UnbentCells {
  Polyhedra cells;
  std::optional<std::string> note;
};
[[nodiscard]] UnbentCells without_bent_faces(const Polyhedra& cells);

/// Of a surface that is closed by the numbers of its vertices: faces that cross or coincide, and shells that look the
/// wrong way. Nothing is said of bodies thinner than the rounding of their coordinates.
[[nodiscard]] std::optional<geometry::SolidError> overlap_of(const MeshData& closed);

}  // namespace cleave::io
