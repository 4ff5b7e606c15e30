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
#include "cleave/io/file.hpp"

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

/// The mesh without the faces that two parts of one block share: groups named `block_4`, `block_4_part_2`, ..., as
/// cleave writes a block with cavities, cut open. Such a face lies inside the block, so it is no joint.
[[nodiscard]] MeshData without_faces_between_parts(MeshData mesh);

/// The welded mesh as a closed body; face numbers are those of `mesh`, tags its group names ("surface" for the
/// nameless).
[[nodiscard]] std::expected<geometry::Solid, geometry::SolidError> solid_of(const MeshData& mesh);

// ---- Writing --------------------------------------------------------------------------------------------------------

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

// ---- Files of modellers and drawing programs ------------------------------------------------------------------------

/// What the files of drawing programs and of geologists' modellers hold. Plain data: corners exist and are finite,
/// nothing else is checked. Coordinates in metres, x = east, y = north, z = up.
struct Surfaces {
  MeshData polygons;               ///< every face is a joint by itself; its group is the layer or the set
  MeshData surfaces;               ///< the faces of one group together are one surface; names may repeat
  std::vector<std::string> notes;  ///< worth telling the user, not wrong

  [[nodiscard]] std::size_t faces() const noexcept { return polygons.faces() + surfaces.faces(); }
  friend bool operator==(const Surfaces&, const Surfaces&) = default;
};

/// DXF as text, of any release: 3DFACE, polygon meshes and polyface meshes make one surface a layer; closed POLYLINE
/// and LWPOLYLINE are polygons. Corners that repeat are one; four corners that are not in a plane are cut along 1-3;
/// faces without area and faces given twice are left out (all with a note). `$INSUNITS` other than metres is converted,
/// with a note, also where it is not stated. Open polylines, block references and other entities are not read: a note
/// says how many there are.
[[nodiscard]] std::expected<Surfaces, ReadError> parse_dxf(std::string_view bytes, std::string_view name);

/// GoCAD TSurf: each object of the file is one surface, named by its header. VRTX, PVRTX, ATOM, PATOM, TRGL; vertex
/// numbers need not begin at 1 nor be dense. `ZPOSITIVE Depth` turns z and the faces over; feet are converted. Objects
/// of other kinds are skipped with a note.
[[nodiscard]] std::expected<Surfaces, ReadError> parse_tsurf(std::string_view bytes, std::string_view name);

/// FracMan, text: each FRACTURE is a polygon, each TESSFRACTURE a surface; groups are named by the sets. Corners that
/// miss their plane by at most 1 % of the fracture's size are moved into it (a note says how many and how far); what is
/// bent more stays bent. `XAxis = East`; metres or feet.
[[nodiscard]] std::expected<Surfaces, ReadError> parse_fab(std::string_view bytes, std::string_view name);

/// Polygons of dfnWorks: `nPolygons: N`, then N times a count and {x, y, z} groups; braces and commas are optional.
/// Each polygon is a joint.
[[nodiscard]] std::expected<Surfaces, ReadError> parse_dfnworks_polygons(std::string_view bytes, std::string_view name);

// ---- Polyhedra ------------------------------------------------------------------------------------------------------

/// Polyhedra as a VTU file lists them. Plain data: indices exist, coordinates are within 1e9 m, every cell has four
/// faces or more, every face three corners or more; each cell is closed, its faces look outwards, none comes twice,
/// and its volume is the one that the file states, to 1e-6.
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
