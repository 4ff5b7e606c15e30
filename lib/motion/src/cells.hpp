#pragma once

#include <cstdint>
#include <expected>
#include <vector>

#include "cleave/motion/world.hpp"

/// A body as a union of convex cells that share no volume.
namespace cleave::motion {

struct Side {
  std::vector<std::uint32_t> corners = {};  ///< counter-clockwise seen from outside
  Vec3 normal = {};
  std::uint32_t surface = 0;
  bool outer = true;  ///< some of it is skin of the body, not only a border to another cell
};
struct Edge {
  std::uint32_t a, b;         ///< corners
  std::uint32_t left, right;  ///< sides
  bool outer = true;          ///< both sides are outer
};
struct Cell {
  std::vector<Vec3> vertices;
  std::vector<Side> sides;
  std::vector<Edge> edges;
};

/// A convex body as its polygons.
struct Piece {
  struct Polygon {
    std::vector<Vec3> corners;
    Vec3 normal;
    std::int32_t plane = -1;  ///< whose cut it comes from
  };
  std::vector<Polygon> polygons;
};
/// The part with normal . x <= offset; corners within `tolerance` of the plane lie on it. Empty when nothing is left.
[[nodiscard]] Piece clip(const Piece& piece, Vec3 normal, double offset, double tolerance, std::int32_t plane);

/// Of a polyhedron with this volume; one cell when it is convex. Refused when the cells do not add up to it.
[[nodiscard]] std::expected<std::vector<Cell>, BadPolyhedron> convex_cells(const Polyhedron& polyhedron, double volume);

/// Largest distance between two corners of its box.
[[nodiscard]] double extent_of(const std::vector<Vec3>& points) noexcept;

}  // namespace cleave::motion
