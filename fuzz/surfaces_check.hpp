#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "cleave/core/assert.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/io/mesh.hpp"

/// What must hold for a reader of io::Surfaces, whatever the bytes.
namespace cleave::fuzz {

inline void check_mesh(const io::MeshData& mesh) {
  CLEAVE_ASSERT(mesh.group.size() == mesh.faces() && mesh.lines.size() == mesh.faces());
  CLEAVE_ASSERT(mesh.faces() == 0 ? mesh.corners.empty() : mesh.ends.back() == mesh.corners.size());
  for (const std::uint32_t corner : mesh.corners) CLEAVE_ASSERT(corner < mesh.vertices.size());
  for (const std::uint32_t group : mesh.group) CLEAVE_ASSERT(group < mesh.groups.size());
  for (const geometry::Vec3& p : mesh.vertices) CLEAVE_ASSERT(geometry::is_finite(p));
  for (std::size_t f = 0; f < mesh.faces(); ++f) CLEAVE_ASSERT(mesh.face(f).size() >= 3 && mesh.lines[f] > 0);
  if (mesh.faces() > 400) return;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (mesh.face(f).size() < 200) static_cast<void>(geometry::Polygon::make(mesh.corners_of(f)));
  }
  if (mesh.faces() > 0) static_cast<void>(io::solid_of(mesh));
}

inline std::string with_windows_line_ends(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

template <class Parse>
void check_reader(std::span<const std::uint8_t> bytes, Parse&& parse) {
  const std::string text(bytes.begin(), bytes.end());
  const auto surfaces = parse(text, "fuzz");
  const auto windows = parse(with_windows_line_ends(text), "fuzz");
  CLEAVE_ASSERT(surfaces.has_value() == windows.has_value());
  if (!surfaces) {
    CLEAVE_ASSERT(!surfaces.error().what.empty() && !surfaces.error().remedy.empty() &&
                  surfaces.error().file == "fuzz");
    return;
  }
  CLEAVE_ASSERT(*surfaces == *windows);
  CLEAVE_ASSERT(surfaces->faces() > 0);
  check_mesh(surfaces->polygons);
  check_mesh(surfaces->surfaces);
}

}  // namespace cleave::fuzz
