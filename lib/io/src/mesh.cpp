#include "cleave/io/mesh.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/file.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// For each vertex the first one at the same place.
std::vector<std::uint32_t> first_at_same_place(std::span<const geometry::Vec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) {
    const geometry::Vec3 p = vertices[i];
    return std::tuple{p.x, p.y, p.z, i};
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];  // -0 equals 0
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

std::vector<geometry::Vec3> MeshData::corners_of(std::size_t f) const {
  std::vector<geometry::Vec3> positions;
  for (const std::uint32_t v : face(f)) positions.push_back(vertices[v]);
  return positions;
}

MeshData welded(const MeshData& mesh) {
  const std::vector<std::uint32_t> first = first_at_same_place(mesh.vertices);
  MeshData result = mesh;
  result.vertices.clear();
  std::vector<std::uint32_t> number(mesh.vertices.size(), none);  // in the order of first use
  for (std::uint32_t& corner : result.corners) {
    std::uint32_t& at = number[first[corner]];
    if (at == none) {
      at = static_cast<std::uint32_t>(result.vertices.size());
      result.vertices.push_back(mesh.vertices[first[corner]]);
    }
    corner = at;
  }
  return result;
}

std::expected<geometry::Solid, geometry::SolidError> solid_of(const MeshData& mesh) {
  MeshData one = welded(mesh);
  std::vector<geometry::SolidFace> faces;
  faces.reserve(one.faces());
  for (std::size_t f = 0; f < one.faces(); ++f) {
    const auto corners = one.face(f);
    faces.push_back({{corners.begin(), corners.end()}, one.group[f]});
  }
  std::vector<std::string> tags = std::move(one.groups);
  for (std::string& tag : tags) {
    if (tag.empty()) tag = "surface";
  }
  return geometry::Solid::make(std::move(one.vertices), std::move(faces), std::move(tags));
}

std::expected<MeshData, ReadError> read_mesh(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string extension = lower(path.extension().string());
  const bool known = extension == ".obj" || extension == ".stl" || extension == ".ply";
  CLEAVE_TRY(const std::string bytes, read_file(path));
  if (!known) {
    return std::unexpected(ReadError{ReadFault::unknown_format, name, 0, 0,
                                     "the kind of this file cannot be told by its name", "name it .obj, .stl or .ply"});
  }
  if (bytes.empty())
    return std::unexpected(ReadError{ReadFault::empty, name, 0, 0, "is empty", "give a file with faces"});
  if (extension == ".obj") return parse_obj(bytes, name);
  return extension == ".stl" ? parse_stl(bytes, name) : parse_ply(bytes, name);
}

}  // namespace cleave::io
