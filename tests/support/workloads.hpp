#pragma once

/// The benchmark scenes: regular grids, persistent planes, finite rectangles, discs and degenerate cases. The same
/// numbers come out on every machine: a generator of random numbers of its own, and every formula in a fixed order.
///
///   grid-N     [0,1]^3 cut by N-1 equally spaced squares an axis: N^3 blocks
///   gridr-N    the same scene turned about three axes (coordinates with rounding)
///   persist-K  80 x 80 x 60 m, three joint sets of K box-spanning planes
///   rect-K     the same box and sets, 3 x K finite rectangles
///   disc-N     100 m cube, N octagons of exponential radius
///   deg-*      degenerate scenes, mostly with known counts

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/cut_input.hpp"

namespace cleave::testing {

struct Workload {
  std::string name;
  std::array<geometry::Vec3, 8> corners;  ///< of the domain; bit 0, 1, 2 of the index = x, y, z side
  std::vector<std::vector<geometry::Vec3>> polygons;
  /// Known in closed form; for turned scenes the count intended, which rounded coordinates need not have.
  std::optional<std::uint64_t> expected;
  /// What at least two independent exact programs found for these very coordinates, micro-blocks included.
  std::optional<std::uint64_t> consensus;
};

/// Empty for a name that is none of the above.
[[nodiscard]] std::optional<Workload> make_workload(std::string_view name);

/// The domain is the hexahedron on the corners, each polygon a joint of its own. Aborts when a polygon is refused.
[[nodiscard]] topology::CutInput cut_input(const Workload& workload, Length snap = metres(0));

}  // namespace cleave::testing
