#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/io/read_error.hpp"

namespace cleave::io {

/// Polyhedra as a VTU file lists them. Plain data: indices exist, coordinates are finite, every cell has four faces or
/// more, every face three corners or more; nothing else is checked.
struct Polyhedra {
  std::vector<geometry::Vec3> points;
  /// Per cell: number of faces, then for each face its number of points and the points.
  std::vector<std::int64_t> face_stream;
  std::vector<std::int64_t> face_ends;  ///< per cell: index one past its last entry in `face_stream`
  std::vector<std::uint32_t> block;     ///< per cell: the cell array `block`, or the number of the cell

  [[nodiscard]] std::size_t size() const noexcept { return face_ends.size(); }
  friend bool operator==(const Polyhedra&, const Polyhedra&) = default;
};

/// VTU (VTK XML unstructured grid) of polyhedra in the older layout (`faces`, `faceoffsets`), one piece, arrays as
/// ascii or inline base64 without compression: what cleave writes, and what VTK and meshio write when asked to.
[[nodiscard]] std::expected<Polyhedra, ReadError> parse_vtu(std::string_view bytes, std::string_view name);

}  // namespace cleave::io
