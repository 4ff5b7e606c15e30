#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/io/mesh.hpp"

namespace cleave::io {

struct CellFault {
  std::string what, remedy;
};

/// The first cell that is no solid: a coordinate beyond 1e9 m, a face given twice, an open surface, faces that look
/// inwards, no volume, or a volume other than the one stated for it. `stated`: a volume a cell, m3, or empty.
[[nodiscard]] std::optional<CellFault> fault_of_cells(const Polyhedra& cells, const std::vector<double>& stated);

}  // namespace cleave::io
