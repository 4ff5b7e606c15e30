#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

/// A triangle of a surface: vertex numbers and the face it is a part of. Not degenerate.
struct SurfaceTriangle {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t face;
};

/// Two faces, lowest numbers first, with triangles that have more in common than the vertices and edges they share:
/// they cross, overlap or touch. Exact. Vertices at one place must have one number. Triangles of one face are not
/// compared.
[[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> first_crossing_faces(
    std::span<const Vec3> vertices, std::span<const SurfaceTriangle> triangles);

}  // namespace cleave::geometry
