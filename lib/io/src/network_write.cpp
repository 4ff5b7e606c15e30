#include "cleave/io/network_write.hpp"

#include <fmt/format.h>

#include <iterator>

namespace cleave::io {

using geometry::Vec3;

std::string write_fab(const MeshData& mesh) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to,
                 "BEGIN FORMAT\n    Format = Ascii\n    Length_Unit = Meter\n    XAxis = East\n    Scale = 1\n"
                 "    No_Fractures = {}\n    No_TessFractures = 0\n    No_Properties = 0\nEND FORMAT\n"
                 "BEGIN PROPERTIES\nEND PROPERTIES\nBEGIN SETS\n",
                 mesh.faces());
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    fmt::format_to(to, "    Set{} = \"{}\"\n", g + 1, mesh.groups[g]);
  }
  out += "END SETS\nBEGIN FRACTURE\n";
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    fmt::format_to(to, "    {} {} {}\n", f + 1, face.size(), std::uint64_t{mesh.group[f]} + 1);
    Vec3 area{};
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 p = mesh.vertices[face[i]];
      fmt::format_to(to, "        {} {} {} {}\n", i + 1, p.x, p.y, p.z);
      if (i >= 2) {
        const Vec3 first = mesh.vertices[face[0]];
        area += cross(mesh.vertices[face[i - 1]] - first, p - first);
      }
    }
    const Vec3 n = norm(area) > 0 ? normalized(area) : Vec3{};
    fmt::format_to(to, "        0 {} {} {}\n", n.x, n.y, n.z);
  }
  out += "END FRACTURE\nBEGIN TESSFRACTURE\nEND TESSFRACTURE\nBEGIN ROCKBLOCK\nEND ROCKBLOCK\n";
  return out;
}

std::string write_dfnworks_polygons(const MeshData& mesh) {
  std::string out = fmt::format("nPolygons: {}\n", mesh.faces());
  auto to = std::back_inserter(out);
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    fmt::format_to(to, "{}", mesh.face(f).size());
    for (const std::uint32_t v : mesh.face(f)) {
      const Vec3 p = mesh.vertices[v];
      fmt::format_to(to, " {{{}, {}, {}}}", p.x, p.y, p.z);
    }
    out += '\n';
  }
  return out;
}

}  // namespace cleave::io
