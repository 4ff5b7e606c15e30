#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/io/mesh.hpp"
#include "cleave/io/read_error.hpp"

namespace cleave::io {

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

}  // namespace cleave::io
