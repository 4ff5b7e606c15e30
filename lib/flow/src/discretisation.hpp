#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/flow/flow.hpp"

namespace cleave::flow {

using Index = std::uint32_t;
inline constexpr Index none = UINT32_MAX;
/// Heads that differ by less, of the extent of the network, are one.
inline constexpr double same_head = 1e-9;

/// m, along the axis in which it is largest.
[[nodiscard]] inline double extent_of(const Mesh& mesh) noexcept {
  if (mesh.points.empty()) return 0;
  const geometry::Vec3 size = geometry::box_of(mesh.points).size();
  return std::max({size.x, size.y, size.z});
}

/// `mesh_of` with every side, however short: what hangs together is decided by no tolerance.
[[nodiscard]] Mesh mesh_as_cut(const topology::BlockComplex& complex, const JointSurfaces& surfaces);

/// The sides of a mesh, numbered in the order of their ends.
class Sides final {
 public:
  explicit Sides(const Mesh& mesh);
  [[nodiscard]] std::size_t count() const noexcept { return ends_.size(); }
  [[nodiscard]] const std::array<Index, 2>& ends(Index side) const { return ends_[side]; }
  [[nodiscard]] std::optional<Index> find(Index a, Index b) const;
  /// Of a triangle: side k is that across from corner k.
  [[nodiscard]] const std::array<Index, 3>& of(std::size_t triangle) const { return of_triangle_[triangle]; }
  [[nodiscard]] std::span<const Index> triangles(Index side) const {
    return std::span{triangles_}.subspan(begin_[side], begin_[side + std::size_t{1}] - begin_[side]);
  }

 private:
  std::vector<std::array<Index, 2>> ends_;  ///< ascending
  std::vector<std::array<Index, 3>> of_triangle_;
  std::vector<Index> begin_, triangles_;  ///< of each side (CSR)
};

/// Splits all marked triangles at the middle of their longest sides, and what must follow so that the mesh still
/// conforms (Rivara 1984, over any number of triangles at a side). `states`: one a border, handed down to its halves.
void refine(Mesh& mesh, const std::vector<std::uint8_t>& marked, std::vector<std::uint8_t>& states);

/// Puts points where borders with standing water cross its level.
void split_at_levels(Mesh& mesh, std::span<const Surface> surfaces);

/// Turns sides within parts until each triangle's circle is empty of the corner beyond (Lawson 1977), where a part has
/// no line on them: better angles, the same points.
void flip_sides(Mesh& mesh);

/// The mesh for `solve_for_two_points`. Where lines meet at sharp angles splitting need not come to an end: a few
/// passes, and no more triangles than asked for. `states` as in `refine`.
void make_two_point(Mesh& mesh, const Network& network, std::vector<std::uint8_t>& states, std::size_t most_triangles);

}  // namespace cleave::flow
