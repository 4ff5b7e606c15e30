#pragma once

/// Surfaces that are closed on paper, in doubles: sets of polygons whose corners are the same numbers wherever they are
/// shared, and how many parts they cut space into. Knows nothing of the cutter.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::support {

using Corners = std::vector<geometry::Vec3>;

struct ClosedSet {
  std::string name;
  std::vector<Corners> polygons;
  std::size_t parts = 0;  ///< besides the outside
  bool convex = true;     ///< so are all the parts
};

/// A source of numbers in [0, 1).
using Uniform = std::function<double()>;

/// All lie within the cube [-1, 1]^3 and keep some way from its sides, unless said otherwise.
[[nodiscard]] ClosedSet cube_of_squares();
/// Each side of the cube as n x n squares.
[[nodiscard]] ClosedSet cube_of_tiles(int n);
[[nodiscard]] ClosedSet dodecahedron();
/// n^3 boxes; every square is there once.
[[nodiscard]] ClosedSet crate(int n);
/// Prism over a regular n-gon, and two pyramids over one.
[[nodiscard]] ClosedSet prism(int n);
[[nodiscard]] ClosedSet bipyramid(int n);
/// m x n trapezia.
[[nodiscard]] ClosedSet torus(int m, int n);
/// Cells of random seeds in a box; every face is there once. `hull`: those on the box too.
[[nodiscard]] ClosedSet voronoi(std::size_t seeds, const Uniform& uniform, double half = 0.6, bool hull = true);
/// The common inside of random half-spaces about a ball: every corner has three sides.
[[nodiscard]] ClosedSet simple_polyhedron(int planes, const Uniform& uniform);
/// A random one of all these.
[[nodiscard]] ClosedSet any_closed_set(const Uniform& uniform);

/// A turn about three axes (angles in rad), then a scale, then a shift.
struct Placement {
  std::array<double, 3> angles{};
  double scale = 1;
  geometry::Vec3 shift{};
  [[nodiscard]] geometry::Vec3 operator()(geometry::Vec3 p) const;
};
[[nodiscard]] ClosedSet placed(ClosedSet set, const Placement& at);

/// The polygons, which are convex, and some of them once more in pieces, as blocks on either side may give one wall: a
/// fan about a point inside, or parts along chords. New corners are rounded, so they lie a little off the plane.
[[nodiscard]] std::vector<Corners> some_again_in_pieces(const std::vector<Corners>& polygons, const Uniform& uniform);

}  // namespace cleave::support
