#pragma once

#include <expected>
#include <span>
#include <string>

#include "cleave/geometry/vec3.hpp"
#include "cleave/io/mesh.hpp"

namespace cleave::io {

/// Writers from plain data to the bytes of a file. Numbers are the shortest text that reads back to the same double.
/// `comments`: lines of the header comment (program, version, unit, origin), each without line ends.

/// Groups as `g` records; faces of any number of corners as they are. Reads back to the same mesh but for `lines` and
/// `notes`.
[[nodiscard]] std::string write_obj(const MeshData& mesh, std::span<const std::string> comments = {});

/// Ascii with double coordinates and int counts. No groups.
[[nodiscard]] std::string write_ply(const MeshData& mesh, std::span<const std::string> comments = {});

/// Text STL, full double digits; one solid a run of faces of one group. Faces of more than three corners are cut into
/// triangles; those that cannot be (no area, crossing themselves) are left out.
[[nodiscard]] std::string write_stl_text(const MeshData& mesh);

struct FloatTooCoarse {
  double step;    ///< m, between neighbouring float32 values at the largest coordinate
  double extent;  ///< m, of the mesh
};
[[nodiscard]] std::string describe(const FloatTooCoarse& error);

/// Binary STL of the coordinates less `origin`. Refused when a float32 steps by more than 1e-5 of the mesh's extent.
[[nodiscard]] std::expected<std::string, FloatTooCoarse> write_stl_binary(const MeshData& mesh,
                                                                          geometry::Vec3 origin = {});

}  // namespace cleave::io
