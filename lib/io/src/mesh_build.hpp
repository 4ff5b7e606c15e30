#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/io/mesh.hpp"

namespace cleave::io {

/// Puts a MeshData together face by face from corners in space; corners at exactly one place become one vertex.
class MeshBuilder final {
 public:
  /// The number of a group of that name, made when new.
  [[nodiscard]] std::uint32_t group_named(std::string_view name);
  /// A group of its own, whatever other groups are called.
  [[nodiscard]] std::uint32_t new_group(std::string_view name);
  void add_face(std::span<const geometry::Vec3> corners, std::uint32_t group, std::uint32_t line);
  [[nodiscard]] std::size_t faces() const noexcept { return mesh_.faces(); }
  /// True when the next face of `corners` corners would make more corners than numbers can count.
  [[nodiscard]] bool full(std::size_t corners) const noexcept {
    return mesh_.corners.size() + corners >= std::size_t{0xFFFFFFFE};
  }
  /// The mesh; groups without a face are left out.
  [[nodiscard]] MeshData finish() &&;

 private:
  MeshData mesh_;
  std::map<std::string, std::uint32_t, std::less<>> group_numbers_;
  std::map<std::array<double, 3>, std::uint32_t> vertex_numbers_;
};

}  // namespace cleave::io
