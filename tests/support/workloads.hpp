#pragma once

/// Scenes with known block counts, small and large, for tests and benchmarks: grids, random planes, rectangles and
/// discs in a box, and scenes that are degenerate on purpose. Made by a fixed random generator of their own
/// (SplitMix64), to the last bit the same on every machine whose sin, cos and log round alike.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::support {

struct Workload {
  std::string name;
  std::array<geometry::Vec3, 8> corners;              ///< of the domain, bits 0, 1, 2 of the index = x, y, z side
  std::vector<std::vector<geometry::Vec3>> polygons;  ///< one convex polygon a joint
  /// As several exact programs counted them for these coordinates, or as intended; none where nobody knows.
  std::optional<std::uint64_t> blocks;
};

[[nodiscard]] Workload grid(std::uint32_t n);          ///< unit cube, n - 1 squares an axis: n^3 blocks
[[nodiscard]] Workload rotated_grid(std::uint32_t n);  ///< the same, turned about three axes, with rounded coordinates
[[nodiscard]] Workload persistent(std::uint32_t k);    ///< 80 x 80 x 60 m, three sets of k planes
[[nodiscard]] Workload rectangles(
    std::uint32_t k);  ///< the same box and sets, 3 k rectangles with sides of 40 to 120 m
/// `rectangles` of 13, moved by (east, north, 0) m: large coordinates, as in national grids.
[[nodiscard]] Workload far_rectangles(double east, double north);
[[nodiscard]] Workload discs(std::uint32_t n);  ///< 100 m cube, n octagons with radii of 1 to 15 m

[[nodiscard]] Workload coplanar_squares();          ///< 20 overlapping squares in one plane, and two planes across: 8
[[nodiscard]] Workload rotated_coplanar_squares();  ///< the same with rounded coordinates: 8 intended
[[nodiscard]] Workload fan();                       ///< 12 half-planes that share an edge, and a plane across: 24
[[nodiscard]] Workload rotated_fan();               ///< the same with rounded coordinates
[[nodiscard]] Workload common_vertex(std::uint32_t m);  ///< m planes through one point: m^2 - m + 2
[[nodiscard]] Workload rotated_common_vertex(
    std::uint32_t m);  ///< the same, turned and moved, with rounded coordinates
[[nodiscard]] Workload slivers(std::uint32_t m,
                               double angle);  ///< m planes, each turned by `angle` (rad) against the last
[[nodiscard]] Workload touching();             ///< contacts exactly at an edge or a vertex: 4
[[nodiscard]] Workload cavities();             ///< closed boxes, nested and touching: 6
[[nodiscard]] Workload ring();                 ///< a closed square ring: 2, both with a handle

/// By the published name: grid-N gridr-N persist-K rect-K disc-N deg-coplanar deg-coplanarr deg-fan12 deg-fan12r
/// deg-vertex8 deg-vertex8r deg-vertex20 deg-vertex20r deg-sliver10-1e-06 (-09, -12) deg-touch deg-cavity deg-ring
/// deg-utm6 deg-utm7. Empty for any other.
[[nodiscard]] std::optional<Workload> workload_named(std::string_view name);

/// What the cutter takes. Aborts where a polygon is refused: the scenes above are all good.
[[nodiscard]] topology::CutInput cut_input(const Workload& workload);

}  // namespace cleave::support
