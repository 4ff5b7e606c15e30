#include "cleave/io/mesh.hpp"

#include <algorithm>
#include <limits>
#include <map>
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

bool is_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return '0' <= c && c <= '9'; });
}

/// "block_4" of "block_4_part_2"; the whole name where it is not of this form.
std::string_view whole_of(std::string_view group) {
  constexpr std::string_view block = "block_", part = "_part_";
  const std::size_t at = group.rfind(part);
  if (at == std::string_view::npos || !group.starts_with(block) || at < block.size()) return group;
  const bool ours =
      is_number(group.substr(block.size(), at - block.size())) && is_number(group.substr(at + part.size()));
  return ours ? group.substr(0, at) : group;
}

/// For each group the first one that is of the same whole.
std::vector<std::uint32_t> first_of_whole(std::span<const std::string> groups) {
  std::map<std::string_view, std::uint32_t> numbers;
  std::vector<std::uint32_t> first(groups.size());
  for (std::uint32_t g = 0; g < groups.size(); ++g)
    first[g] = numbers.try_emplace(whole_of(groups[g]), g).first->second;
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

MeshData without_faces_between_parts(MeshData mesh) {
  const std::vector<std::uint32_t> whole = first_of_whole(mesh.groups);
  std::vector<std::size_t> groups_of(mesh.groups.size(), 0);
  for (const std::uint32_t w : whole) ++groups_of[w];
  if (std::ranges::none_of(groups_of, [](std::size_t n) { return n > 1; })) return mesh;
  const std::vector<std::uint32_t> place = first_at_same_place(mesh.vertices);
  struct Face {
    std::uint32_t whole, group;
    std::vector<std::uint32_t> corners;
    std::size_t number;
  };
  std::vector<Face> faces;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const std::uint32_t group = mesh.group[f];
    if (groups_of[whole[group]] < 2) continue;
    Face& face = faces.emplace_back(Face{whole[group], group, {}, f});
    for (const std::uint32_t corner : mesh.face(f)) face.corners.push_back(place[corner]);
    std::ranges::sort(face.corners);
  }
  std::ranges::sort(faces, {}, [](const Face& f) { return std::tie(f.whole, f.corners, f.group, f.number); });
  std::vector<std::uint8_t> between(mesh.faces(), 0);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const Face &a = faces[i - 1], &b = faces[i];
    if (a.whole != b.whole || a.group == b.group || a.corners != b.corners) continue;
    between[a.number] = between[b.number] = 1;
  }
  MeshData kept{.vertices = std::move(mesh.vertices),
                .corners = {},
                .ends = {},
                .group = {},
                .groups = std::move(mesh.groups),
                .lines = {},
                .notes = std::move(mesh.notes)};
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (between[f] != 0) continue;
    const auto corners = mesh.face(f);
    kept.corners.insert(kept.corners.end(), corners.begin(), corners.end());
    kept.ends.push_back(static_cast<std::uint32_t>(kept.corners.size()));
    kept.group.push_back(mesh.group[f]);
    kept.lines.push_back(mesh.lines[f]);
  }
  return kept;
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
  const bool by_name = extension == ".obj" || extension == ".stl" || extension == ".ply";
  CLEAVE_TRY(const std::string bytes, read_file(path));
  if (!by_name) {
    return std::unexpected(whole_file(ReadFault::unknown_format, name,
                                      "the kind of this file cannot be told by its name",
                                      "name it .obj, .stl or .ply"));
  }
  if (bytes.empty()) return std::unexpected(whole_file(ReadFault::empty, name, "is empty", "give a file with faces"));
  if (extension == ".obj") return parse_obj(bytes, name);
  return extension == ".stl" ? parse_stl(bytes, name) : parse_ply(bytes, name);
}

}  // namespace cleave::io
