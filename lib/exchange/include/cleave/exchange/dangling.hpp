#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

/// The parts of joints that bound no block, as triangles. Spikes (edges that end inside a piece) are left out.
struct DanglingMesh {
  std::vector<geometry::Vec3> points;  ///< m, absolute
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> piece;  ///< of each triangle: index into Dangling::pieces
};
[[nodiscard]] DanglingMesh make_dangling_mesh(const topology::BlockComplex& complex);

/// dangling.vtu: the triangles with cell arrays piece, joint, block (Int64, from 0) and isolated (UInt8). Empty pieces
/// where the complex kept none.
[[nodiscard]] std::string dangling_vtu(const topology::BlockComplex& complex, std::string_view title);
/// dangling.obj: the same, one group a piece: "joint_J_block_B".
[[nodiscard]] std::string dangling_obj(const topology::BlockComplex& complex, std::string_view title);

}  // namespace cleave::report
