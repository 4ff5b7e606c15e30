#pragma once

#include <span>
#include <string>

#include "cleave/io/mesh.hpp"

namespace cleave::io {

/// Writers of fracture networks: every face of the mesh is one fracture, its group the set. Numbers are the shortest
/// text that reads back to the same double, so the readers give the same corners back.

/// FracMan, text, in metres, x = east; no properties.
[[nodiscard]] std::string write_fab(const MeshData& mesh);

/// Polygons of dfnWorks (`nPolygons: N`, then a count and {x, y, z} groups a line). It names no sets.
[[nodiscard]] std::string write_dfnworks_polygons(const MeshData& mesh);

}  // namespace cleave::io
