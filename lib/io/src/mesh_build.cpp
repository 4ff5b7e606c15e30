#include "mesh_build.hpp"

#include <optional>
#include <utility>

namespace cleave::io {

std::uint32_t MeshBuilder::group_named(std::string_view name) {
  const auto found = group_numbers_.find(name);
  if (found != group_numbers_.end()) return found->second;
  const std::uint32_t number = new_group(name);
  group_numbers_.emplace(name, number);
  return number;
}

std::uint32_t MeshBuilder::new_group(std::string_view name) {
  mesh_.groups.emplace_back(name);
  return static_cast<std::uint32_t>(mesh_.groups.size() - 1);
}

void MeshBuilder::add_face(std::span<const geometry::Vec3> corners, std::uint32_t group, std::uint32_t line) {
  for (const geometry::Vec3& p : corners) {
    const geometry::Vec3 at{p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0 is 0
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [vertex, is_new] = vertex_numbers_.try_emplace({at.x, at.y, at.z}, next);
    if (is_new) mesh_.vertices.push_back(at);
    mesh_.corners.push_back(vertex->second);
  }
  mesh_.ends.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  mesh_.group.push_back(group);
  mesh_.lines.push_back(line);
}

MeshData MeshBuilder::finish() && {
  std::vector<std::optional<std::uint32_t>> numbers(mesh_.groups.size());
  std::vector<std::string> used;
  for (std::uint32_t& group : mesh_.group) {
    if (!numbers[group]) {
      numbers[group] = static_cast<std::uint32_t>(used.size());
      used.push_back(std::move(mesh_.groups[group]));
    }
    group = *numbers[group];
  }
  mesh_.groups = std::move(used);
  return std::move(mesh_);
}

}  // namespace cleave::io
