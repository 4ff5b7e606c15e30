#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "mesh_build.hpp"

namespace cleave::io {

/// Adds the faces of drawings to a mesh: corners that repeat become one, quads out of plane are cut along 1-3, faces
/// without area and repeated ones are left out; counts what it did.
class FaceCleaner final {
 public:
  /// Three or four corners.
  void add(std::span<const geometry::Vec3> corners, std::uint32_t group, std::uint32_t line);
  [[nodiscard]] MeshBuilder& builder() noexcept { return builder_; }
  /// What was done, in words.
  void describe(std::vector<std::string>& notes) const;

 private:
  void add_simple(std::span<const geometry::Vec3> corners, std::uint32_t group, std::uint32_t line);

  using Place = std::tuple<double, double, double>;
  MeshBuilder builder_;
  std::set<std::vector<Place>> known_;
  std::uint64_t cut_ = 0;
  std::uint64_t flat_ = 0;
  std::uint64_t repeated_ = 0;
};

}  // namespace cleave::io
