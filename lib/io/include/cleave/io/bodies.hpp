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

/// Of surfaces, each closed by the numbers of its vertices: two that cross or coincide, and one that looks the wrong
/// way. Nothing is said of a single surface, whose faces may touch to a rounding of their corners, nor of bodies
/// thinner than that.
[[nodiscard]] std::optional<geometry::SolidError> overlap_of(const MeshData& closed);

}  // namespace cleave::io
