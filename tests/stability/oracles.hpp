#pragma once

#include <array>
#include <cstddef>
#include <vector>

/// What the motion of a block is judged against. Built on its own, without the include path of any module: it cannot
/// share a line with what it checks. Each part has bugs planted in it (tests/mutations.list).
namespace stability_oracle {

/// min |r + sum N n|, N >= 0, by Lawson and Hanson (1974) in long double: any number of planes.
namespace least_squares {

using Real = long double;
using V = std::array<Real, 3>;

[[nodiscard]] Real dot(const V& a, const V& b);

struct Left {
  V s;                   ///< r + sum N n
  std::size_t pressing;  ///< how many N are above zero
};
/// `broken` plants a bug: it stops one face too early.
[[nodiscard]] Left residual(const std::vector<V>& n, const V& r, bool broken = false);

/// Some direction is let go: the normals do not span space by non-negative sums.
[[nodiscard]] bool removable(const std::vector<V>& n);

}  // namespace least_squares

/// The same minimum in double by trying all sets of one, two and three planes: the optimum is reached on linearly
/// independent normals (Caratheodory), so it is the smallest over all sets whose unconstrained solution has N >= 0.
/// Uses neither the sign conditions on the other rows nor the cone.
namespace exhaustion {

struct V {
  double x, y, z;
};
[[nodiscard]] V residual(const std::vector<V>& n, V r);
[[nodiscard]] double distance(V a, V b);

}  // namespace exhaustion

/// Dimension of {d : n.d >= 0} for normals with components -1, 0, 1: every generator of it (cross products of rows,
/// perpendiculars within a plane of rows) is an integer vector within [-4, 4]^3, so the rank of the admissible vectors
/// of that box is the dimension, exactly.
[[nodiscard]] int dimension_by_exhaustion(const std::vector<std::array<int, 3>>& normals);

}  // namespace stability_oracle
