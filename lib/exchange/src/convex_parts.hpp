#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cell_faces.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::report::detail {

/// A convex polyhedron; faces counter-clockwise seen from outside.
struct ConvexPart {
  std::vector<geometry::Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;

  [[nodiscard]] double volume() const;  ///< m3
};

/// The cell cut into convex polyhedra along the planes of its own faces (a binary space partition, Thibault and Naylor
/// 1987). For programs that take convex blocks only: parts meet in faces, but not corner to corner. Empty when the
/// parts do not add up to the cell's volume to 1e-9 (faces closer than doubles can tell) or are more than `most`.
[[nodiscard]] std::optional<std::vector<ConvexPart>> convex_parts(const Cells& cells, std::size_t cell,
                                                                  std::size_t most = 5000);

}  // namespace cleave::report::detail
