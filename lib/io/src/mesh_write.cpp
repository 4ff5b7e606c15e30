#include "cleave/io/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "cleave/geometry/triangulate.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

/// Every face as triangles: visit(face, a, b, c) with vertex numbers.
template <class Visit>
void for_each_triangle(const MeshData& mesh, Visit&& visit) {
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    if (face.size() == 3) {
      visit(f, face[0], face[1], face[2]);
      continue;
    }
    const auto pieces = geometry::triangulate(mesh.corners_of(f));
    if (!pieces) continue;
    for (const auto& [a, b, c] : *pieces) visit(f, face[a], face[b], face[c]);
  }
}

void append_u32(std::string& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xFFU);
}

void append_floats(std::string& out, Vec3 p) {
  for (const double x : {p.x, p.y, p.z}) append_u32(out, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
}

}  // namespace

std::string write_obj(const MeshData& mesh, std::span<const std::string> comments) {
  std::string out;
  auto to = std::back_inserter(out);
  for (const std::string& comment : comments) fmt::format_to(to, "# {}\n", comment);
  for (const Vec3& p : mesh.vertices) fmt::format_to(to, "v {} {} {}\n", p.x, p.y, p.z);
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const bool enters = f == 0 ? !mesh.groups[mesh.group[f]].empty() : mesh.group[f] != mesh.group[f - 1];
    if (enters) fmt::format_to(to, "g {}\n", mesh.groups[mesh.group[f]]);
    out += 'f';
    for (const std::uint32_t v : mesh.face(f)) fmt::format_to(to, " {}", std::uint64_t{v} + 1);
    out += '\n';
  }
  return out;
}

std::string write_ply(const MeshData& mesh, std::span<const std::string> comments) {
  std::string out = "ply\nformat ascii 1.0\n";
  auto to = std::back_inserter(out);
  for (const std::string& comment : comments) fmt::format_to(to, "comment {}\n", comment);
  fmt::format_to(to,
                 "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n"
                 "property list int uint vertex_indices\nend_header\n",
                 mesh.vertices.size(), mesh.faces());
  for (const Vec3& p : mesh.vertices) fmt::format_to(to, "{} {} {}\n", p.x, p.y, p.z);
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    fmt::format_to(to, "{}", mesh.face(f).size());
    for (const std::uint32_t v : mesh.face(f)) fmt::format_to(to, " {}", v);
    out += '\n';
  }
  return out;
}

std::string write_stl_text(const MeshData& mesh) {
  std::string out;
  auto to = std::back_inserter(out);
  std::size_t solid = mesh.groups.size();  // none open
  const auto close = [&] {
    if (solid < mesh.groups.size()) fmt::format_to(to, "endsolid {}\n", mesh.groups[solid]);
  };
  for_each_triangle(mesh, [&](std::size_t f, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (solid != mesh.group[f]) {
      close();
      solid = mesh.group[f];
      fmt::format_to(to, "solid {}\n", mesh.groups[solid]);
    }
    const Vec3 p = mesh.vertices[a], q = mesh.vertices[b], r = mesh.vertices[c];
    const Vec3 n = cross(q - p, r - p);
    const double length = norm(n);
    const Vec3 unit = std::isfinite(length) && length > 0 ? n / length : Vec3{};
    fmt::format_to(to, "facet normal {:.6g} {:.6g} {:.6g}\nouter loop\n", unit.x, unit.y, unit.z);
    for (const Vec3 v : {p, q, r}) fmt::format_to(to, "vertex {} {} {}\n", v.x, v.y, v.z);
    out += "endloop\nendfacet\n";
  });
  close();
  return out;
}

std::string describe(const FloatTooCoarse& error) {
  return fmt::format(
      "binary STL holds float32 numbers, which step by {:.3g} m at these coordinates (the mesh is {:.6g} m wide); "
      "subtract an origin, or "
      "write OBJ, PLY or text STL",
      error.step, error.extent);
}

std::expected<std::string, FloatTooCoarse> write_stl_binary(const MeshData& mesh, Vec3 origin) {
  double largest = 0;
  geometry::Box box;
  for (const Vec3& v : mesh.vertices) {
    const Vec3 p = v - origin;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    box.add(p);
  }
  const double extent = mesh.vertices.empty() ? 0 : std::max({box.size().x, box.size().y, box.size().z});
  const double step = largest * 0x1p-23;
  if (step > 1e-5 * extent || largest > static_cast<double>(std::numeric_limits<float>::max())) {
    return std::unexpected(FloatTooCoarse{step, extent});
  }
  std::string out = "binary STL, units metres, z up";
  out.resize(84, ' ');
  std::uint32_t count = 0;
  for_each_triangle(mesh, [&](std::size_t, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3 p = mesh.vertices[a] - origin, q = mesh.vertices[b] - origin, r = mesh.vertices[c] - origin;
    const Vec3 n = cross(q - p, r - p);
    const double length = norm(n);
    append_floats(out, std::isfinite(length) && length > 0 ? n / length : Vec3{});
    for (const Vec3 v : {p, q, r}) append_floats(out, v);
    out.append(2, '\0');
    ++count;
  });
  std::string number;
  append_u32(number, count);
  out.replace(80, 4, number);
  return out;
}

}  // namespace cleave::io
