#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/io/read_error.hpp"

namespace cleave::io {

/// Faces as a file lists them: plain data, nothing checked but that the numbers are finite and the corners exist. Used
/// for joint soups (a face is a joint) and for closed surfaces.
struct MeshData {
  std::vector<geometry::Vec3> vertices;  ///< m
  std::vector<std::uint32_t> corners;    ///< vertex numbers from 0, of all faces one after the other
  std::vector<std::uint32_t> ends;       ///< one past the last corner of each face
  std::vector<std::uint32_t> group;      ///< of each face, index into `groups`
  std::vector<std::string> groups;       ///< OBJ o and g, STL solids; "" where the file names none
  std::vector<std::uint32_t> lines;      ///< where each face is in the file, from 1; 0 in binary files
  std::vector<std::string> notes;  ///< worth telling the user, not wrong: "1 byte after the last triangle ignored"

  [[nodiscard]] std::size_t faces() const noexcept { return ends.size(); }
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const {
    const std::size_t begin = f == 0 ? 0 : ends[f - 1];
    return std::span{corners}.subspan(begin, ends[f] - begin);
  }
  /// Positions of the corners of a face, for geometry::Polygon::make.
  [[nodiscard]] std::vector<geometry::Vec3> corners_of(std::size_t f) const;

  friend bool operator==(const MeshData&, const MeshData&) = default;
};

/// Readers of one format each, from the bytes of a file; `name` is for the errors only.
///
/// OBJ: v, f (i, i/t, i//n, i/t/n; negative = from the end), o and g as groups, `\` continues a line; other records of
/// the format are skipped, unknown ones are errors. A face has 1 to 4096 corners (too few are for geometry to refuse).
[[nodiscard]] std::expected<MeshData, ReadError> parse_obj(std::string_view bytes, std::string_view name);
/// STL: binary when the size is 84 + 50 n, whatever the header says; else text when it reads as text; up to 49 bytes
/// after the last binary triangle are ignored with a note. Normals are ignored. Three vertices of its own for each
/// triangle, not welded.
[[nodiscard]] std::expected<MeshData, ReadError> parse_stl(std::string_view bytes, std::string_view name);
/// PLY: ascii and binary of either order; vertex x, y, z and face vertex_indices or vertex_index of any type; all else
/// is skipped.
[[nodiscard]] std::expected<MeshData, ReadError> parse_ply(std::string_view bytes, std::string_view name);

/// Reads a file by its extension: .obj, .stl, .ply in either case.
[[nodiscard]] std::expected<MeshData, ReadError> read_mesh(const std::filesystem::path& path);

/// Vertices at exactly one place become one, vertices no face uses are left out. Faces keep their numbers.
[[nodiscard]] MeshData welded(const MeshData& mesh);

/// The welded mesh as a closed body; face numbers are those of `mesh`, tags its group names ("surface" for the
/// nameless).
[[nodiscard]] std::expected<geometry::Solid, geometry::SolidError> solid_of(const MeshData& mesh);

}  // namespace cleave::io
